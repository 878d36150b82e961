/* A model whose pieces stay decoded once they were drawn, so that a frame beside the last one costs
 * drawing alone. Memory: up to the limit of pipeline/samples/pieces.h. */
#ifndef GOPURA_CURATOR_VIEW_KEPT_MODEL_H
#define GOPURA_CURATOR_VIEW_KEPT_MODEL_H

#include "pipeline/samples/model.h"

/* inner is taken, also on failure. *out is owned by the caller (model_destroy); NULL on failure.
 * -ENOMEM. */
must_check int kept_model_create(struct model **out, struct model *inner);

#endif
