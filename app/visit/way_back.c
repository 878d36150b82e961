/* The stack of places behind the back button: the oldest is dropped when it is full, and places
 * that look like the current one are skipped. */
#include "app/visit/way_back.h"

#include <string.h>

#include <cglm/cglm.h>

#define SAME_VIEW 0.999f /* cosine of 2.5 degrees */

static bool is_same(const struct place *a, const struct place *b, float near_m)
{
	float from[3], to[3];

	if (a->card != b->card || a->page != b->page || a->searching != b->searching ||
	    a->on_tour != b->on_tour)
		return false;
	if (a->on_tour)
		return true; /* both are on a tour, which moves the eye */
	glm_vec3_sub((float *)a->target_m, (float *)a->eye_m, from);
	glm_vec3_sub((float *)b->target_m, (float *)b->eye_m, to);
	glm_vec3_normalize(from);
	glm_vec3_normalize(to);
	return glm_vec3_distance((float *)a->eye_m, (float *)b->eye_m) <= near_m &&
	       glm_vec3_dot(from, to) >= SAME_VIEW;
}

void way_back_note(struct way_back *way, const struct place *here)
{
	if (way->count == WAY_BACK_MAX) {
		memmove(&way->places[0], &way->places[1],
			(WAY_BACK_MAX - 1) * sizeof(way->places[0]));
		way->count--;
	}
	way->places[way->count++] = *here;
}

bool way_back_take(struct way_back *way, const struct place *here, float near_m, struct place *out)
{
	while (way->count > 0) {
		*out = way->places[--way->count];
		if (!is_same(out, here, near_m))
			return true;
	}
	return false;
}
