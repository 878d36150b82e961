/* Puts the whole temple together: terraces, then galleries, then towers. */
#include "pipeline/temple/temple_compose.h"
#include "pipeline/temple/temple_galleries.h"
#include "pipeline/temple/temple_terraces.h"
#include "pipeline/temple/temple_towers.h"

int plan_create(struct plan *plan, uint32_t seed)
{
	*plan = (struct plan){ .seed = seed };
	plan_terraces(plan);
	plan_galleries(plan);
	plan_towers(plan);
	if (plan->error) {
		int error = plan->error;
		plan_destroy(plan);
		return error;
	}
	return 0;
}
