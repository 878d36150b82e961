/* The surface of a master (pipeline/hierarchy/master.h): its pieces are the patches of all levels.
 */
#ifndef GOPURA_PIPELINE_SAMPLES_MODEL_MASTER_H
#define GOPURA_PIPELINE_SAMPLES_MODEL_MASTER_H

#include "pipeline/hierarchy/master.h"
#include "pipeline/samples/model.h"

/* *out is owned by the caller (model_destroy); NULL on failure. The master is borrowed for the
 * surface's lifetime. It may be made before processes are forked: what it reads later it keeps to
 * itself. Returns -ENOMEM. */
must_check int model_of_master(struct model **out, const struct master *master);

#endif
