/* Goes along a way in the longest steps that keep it. */
#include "pipeline/content/tour_keys.h"

#include <errno.h>
#include <stdlib.h>

#include "geometry/vec.h"

#define FINEST_M   0.001f
#define COARSEST_M 0.25f

/* Whether a straight way from one view to another passes all between them within a tolerance. */
static bool passes(const struct import_views *views, uint32_t from, uint32_t to, float off_m)
{
	const struct import_view *a = &views->items[from], *b = &views->items[to];
	const float span_s = b->time_s - a->time_s;

	for (uint32_t i = from + 1; i < to; i++) {
		const struct import_view *at = &views->items[i];
		const float share = span_s > 0 ? (at->time_s - a->time_s) / span_s : 0;
		float eye[3], target[3];

		vec_mix(eye, a->eye_m, b->eye_m, share);
		vec_mix(target, a->target_m, b->target_m, share);
		if (vec_distance(eye, at->eye_m) > off_m ||
		    vec_distance(target, at->target_m) > off_m)
			return false;
	}
	/* A jump takes no time, and is no way. */
	return span_s > 0 || to == from + 1;
}

/* Returns the last view to which a straight way leads: doubles the step while it is good, and then
 * halves what is too much. */
static uint32_t reach(const struct import_views *views, uint32_t from, float off_m)
{
	const uint32_t last = views->count - 1;
	uint32_t good = from + 1, bad = last + 1, step = 2;

	while (bad == last + 1 && good < last) {
		const uint32_t to = from + step < last ? from + step : last;

		if (passes(views, from, to, off_m))
			good = to;
		else
			bad = to;
		step *= 2;
	}
	while (good + 1 < bad) {
		const uint32_t middle = (good + bad) / 2;

		if (passes(views, from, middle, off_m))
			good = middle;
		else
			bad = middle;
	}
	return good;
}

/* Writes the numbers of the views that are kept, and returns how many; most + 1: too many. */
static uint32_t choose(uint32_t *out, const struct import_views *views, uint32_t most, float off_m)
{
	uint32_t count = 1, at = 0;

	out[0] = 0;
	while (at + 1 < views->count && count <= most) {
		at = reach(views, at, off_m);
		out[count++] = at;
	}
	return count;
}

int tour_keys_thin(struct import_views *views, uint32_t most, float *off_m)
{
	uint32_t *kept = malloc(((size_t)most + 2) * sizeof(*kept));
	uint32_t count = most + 1;

	if (!kept)
		return -ENOMEM;
	for (*off_m = FINEST_M / 2; count > most && *off_m < COARSEST_M;) {
		*off_m *= 2;
		count = choose(kept, views, most, *off_m);
	}
	for (uint32_t i = 0; count <= most && i < count; i++)
		views->items[i] = views->items[kept[i]];
	if (count <= most)
		views->count = count;
	free(kept);
	return 0;
}
