/* The whole temple as sheets. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_COMPOSE_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_COMPOSE_H

#include "pipeline/temple/temple_plan.h"

/* Fills *plan; the caller destroys it with plan_destroy. The same seed gives the same temple.
 * -ENOMEM. */
must_check int plan_create(struct plan *plan, uint32_t seed);

#endif
