/* Paints strokes as round pens, and fills what a closed stroke goes around. */
#include "curator/select/strokes.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"

enum { THINNER_MAX = 4 }; /* how often a heavy lasso is halved */

/* Where a side of a filled polygon crosses a row, and whether it goes down or up there. */
struct crossing {
	float x;
	int turn;
};

/* ---- pens */

static float distance_to_line(float x, float y, const float a[2], const float b[2])
{
	const float along[2] = { b[0] - a[0], b[1] - a[1] }, away[2] = { x - a[0], y - a[1] };
	const float length = along[0] * along[0] + along[1] * along[1];
	float share = length > 0 ? (along[0] * away[0] + along[1] * away[1]) / length : 0;

	share = vec_least(1, vec_most(0, share));
	return hypotf(away[0] - share * along[0], away[1] - share * along[1]);
}

static uint32_t clamp(float value, uint32_t most)
{
	return (uint32_t)vec_least((float)most, vec_most(0, value));
}

static void paint_line(uint8_t *marks, uint32_t width_px, uint32_t height_px, const float a[2],
		       const float b[2], float reach, uint8_t mark)
{
	const uint32_t left = clamp(vec_least(a[0], b[0]) - reach, width_px),
		       right = clamp(vec_most(a[0], b[0]) + reach + 1, width_px),
		       top = clamp(vec_least(a[1], b[1]) - reach, height_px),
		       bottom = clamp(vec_most(a[1], b[1]) + reach + 1, height_px);

	for (uint32_t y = top; y < bottom; y++)
		for (uint32_t x = left; x < right; x++)
			if (distance_to_line((float)x + 0.5f, (float)y + 0.5f, a, b) <= reach)
				marks[y * width_px + x] = mark;
}

void strokes_paint(uint8_t *marks, uint32_t width_px, uint32_t height_px,
		   const struct stroke *stroke, enum mark mark)
{
	const float reach = vec_most(0.71f, stroke->width_px / 2); /* a pixel at least */

	for (uint32_t n = 0; n < stroke->count; n++) {
		const float *from = stroke->points_px[n > 0 ? n - 1 : 0];

		paint_line(marks, width_px, height_px, from, stroke->points_px[n], reach,
			   (uint8_t)mark);
	}
}

/* Paints the line that closes a stroke too. */
static void paint_closed(uint8_t *marks, uint32_t width_px, uint32_t height_px,
			 const struct stroke *stroke, float width, uint8_t mark)
{
	const struct stroke wide = { stroke->points_px, stroke->count, width };

	strokes_paint(marks, width_px, height_px, &wide, mark);
	paint_line(marks, width_px, height_px, stroke->points_px[0],
		   stroke->points_px[stroke->count - 1], vec_most(0.71f, width / 2), mark);
}

/* ---- filling */

static int by_place(const void *a, const void *b)
{
	const struct crossing *left = a, *right = b;

	return (left->x > right->x) - (left->x < right->x);
}

/* The crossings of the closed stroke with the middle of a row. */
static uint32_t cross_row(struct crossing *out, const struct stroke *stroke, float y)
{
	uint32_t count = 0;

	for (uint32_t n = 0; n < stroke->count; n++) {
		const float *a = stroke->points_px[n];
		const float *b = stroke->points_px[(n + 1) % stroke->count];

		if ((a[1] <= y) == (b[1] <= y))
			continue;
		out[count].x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
		out[count++].turn = b[1] > a[1] ? 1 : -1;
	}
	qsort(out, count, sizeof(*out), by_place);
	return count;
}

int strokes_lasso(uint8_t *marks, uint32_t width_px, uint32_t height_px,
		  const struct stroke *stroke)
{
	struct crossing *crossings = malloc((stroke->count + 1) * sizeof(*crossings));
	bool any = false;

	if (!crossings)
		return -ENOMEM;
	memset(marks, MARK_REST, (size_t)width_px * height_px);
	for (uint32_t y = 0; y < height_px; y++) {
		const uint32_t count = cross_row(crossings, stroke, (float)y + 0.5f);
		int turns = 0;

		for (uint32_t n = 0; n + 1 < count; n++) {
			turns += crossings[n].turn;
			if (turns == 0) /* a loop within a loop is inside too */
				continue;
			const uint32_t from = clamp(crossings[n].x + 0.5f, width_px),
				       end = clamp(crossings[n + 1].x + 0.5f, width_px);
			memset(marks + y * width_px + from, MARK_PART, end - from);
			any = any || end > from;
		}
	}
	free(crossings);
	return any ? 0 : -EINVAL;
}

/* ---- the heavy lasso */

/* Sets the marks around a pen of that width, with what the lasso alone says in `inside`. Returns
 * how many pixels of the part are known. */
static uint32_t lay_band(uint8_t *marks, const uint8_t *inside, uint32_t width_px,
			 uint32_t height_px, const struct stroke *stroke, float width)
{
	enum { NEAR = 0xfe, UNDER = 0xff };
	uint32_t known = 0;

	memset(marks, 0, (size_t)width_px * height_px);
	paint_closed(marks, width_px, height_px, stroke, 2 * width, NEAR);
	paint_closed(marks, width_px, height_px, stroke, width, UNDER);
	for (uint32_t at = 0; at < width_px * height_px; at++) {
		const bool part = inside[at] == MARK_PART;

		if (marks[at] == UNDER) {
			marks[at] = MARK_UNKNOWN;
			continue;
		}
		known += part;
		if (marks[at] == NEAR)
			marks[at] = part ? MARK_PART_SEED : MARK_REST_SEED;
		else
			marks[at] = part ? MARK_PART : MARK_REST;
	}
	return known;
}

int strokes_heavy_lasso(uint8_t *marks, uint32_t width_px, uint32_t height_px,
			const struct stroke *stroke)
{
	uint8_t *inside = malloc((size_t)width_px * height_px);
	float width = stroke->width_px;
	uint32_t all = 0;
	int rc = inside ? strokes_lasso(inside, width_px, height_px, stroke) : -ENOMEM;

	for (uint32_t at = 0; rc == 0 && at < width_px * height_px; at++)
		all += inside[at] == MARK_PART;
	for (int n = 0; rc == 0 && n <= THINNER_MAX; n++, width /= 2)
		if (lay_band(marks, inside, width_px, height_px, stroke, width) > all / 8)
			break;
	free(inside);
	return rc;
}
