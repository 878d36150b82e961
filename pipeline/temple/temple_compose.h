/* The whole temple as sheets. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_COMPOSE_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_COMPOSE_H

#include "pipeline/temple/temple_plan.h"

/* Lays out the whole temple. The caller destroys the plan. The same seed gives the same temple.
 * Returns 0 or -ENOMEM; on failure the plan is empty. */
must_check int plan_create(struct plan *plan, uint32_t seed);

#endif
