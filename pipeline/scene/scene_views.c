/* What the readers of views of VRML97 and glTF share. */
#include "pipeline/scene/scene_views.h"

#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "geometry/turn.h"

enum { VIEWS_MAX = 1 << 16 };

/* ---- moments */

static int by_time(const void *a, const void *b)
{
	const struct scene_moment *x = a, *y = b;

	if (x->time != y->time)
		return x->time > y->time ? 1 : -1;
	return y->is_before - x->is_before;
}

uint32_t scene_moments_sort(struct scene_moment *moments, uint32_t count)
{
	uint32_t kept = 0;

	qsort(moments, count, sizeof(*moments), by_time);
	for (uint32_t i = 0; i < count; i++)
		if (kept == 0 || by_time(&moments[i], &moments[kept - 1]) > 0)
			moments[kept++] = moments[i];
	return kept;
}

bool scene_moment_reaches(struct scene_moment moment, float key_time)
{
	return moment.is_before ? key_time < moment.time : key_time <= moment.time;
}

/* ---- views */

int scene_views_add(struct scene_views *views, float time_s, const float place[16],
		    const float position[3], const float turn[4])
{
	float ahead[3] = { 0, 0, -1 };
	struct scene_view *view;
	int rc = ARRAY_RESERVE(views->items, views->room, (uint64_t)views->count + 1, VIEWS_MAX);

	if (rc < 0)
		return rc;
	turn_vector(ahead, turn, ahead);
	view = &views->items[views->count++];
	view->time_s = time_s;
	for (int row = 0; row < 3; row++) {
		view->eye[row] = place[12 + row];
		view->target[row] = 0;
		for (int k = 0; k < 3; k++) {
			view->eye[row] += place[4 * k + row] * position[k];
			view->target[row] += place[4 * k + row] * ahead[k];
		}
		view->target[row] += view->eye[row];
	}
	return 0;
}

void scene_views_finish(struct scene_views *views)
{
	if (!views)
		return;
	free(views->items);
	*views = (struct scene_views){ 0 };
}
