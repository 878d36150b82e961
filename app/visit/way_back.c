/* The stack of places behind the back button: the oldest is dropped when it is full, and places
 * that look like the current one are skipped. */
#include "app/visit/way_back.h"

#include <string.h>

#include "geometry/vec.h"

#define SAME_VIEW 0.999f /* cosine of 2.5 degrees */

static bool is_same(const struct place *a, const struct place *b, float near_m)
{
	float from[3], to[3];

	if (a->card != b->card || a->page != b->page || a->searching != b->searching ||
	    strcmp(a->query, b->query) != 0 || a->on_tour != b->on_tour)
		return false;
	if (a->on_tour)
		return true; /* both are on a tour, which moves the eye */
	vec_sub(from, a->target_m, a->eye_m);
	vec_sub(to, b->target_m, b->eye_m);
	vec_normalise(from);
	vec_normalise(to);
	return vec_distance(a->eye_m, b->eye_m) <= near_m && vec_dot(from, to) >= SAME_VIEW;
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
