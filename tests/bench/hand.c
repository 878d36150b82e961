/* Paths out of masks, and what a trembling hand makes of them. */
#include "tests/bench/hand.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"

/* Seconds for each width of a path, the moment before it, and the fastest that a hand moves. */
static const float steer_s = 0.1f, begin_s = 0.8f, fastest_px_s = 1000;

/* ---- chance: the same for a seed everywhere */

static uint64_t chance_state;

void hand_seed(uint64_t seed)
{
	chance_state = seed;
}

static double chance(void)
{
	chance_state = chance_state * 6364136223846793005u + 1442695040888963407u;
	return (double)(chance_state >> 11) / (double)(1ull << 53);
}

static double normal_chance(void)
{
	return sqrt(-2 * log(chance() + 1e-12)) * cos(2 * M_PI * chance());
}

/* ---- paths */

void hand_add_point(struct hand_path *path, float x, float y)
{
	if (path->count >= HAND_POINTS_MAX)
		return;
	path->points[path->count][0] = x;
	path->points[path->count++][1] = y;
}

/* The largest connected piece of a mask; returns its pixels. */
uint32_t hand_largest_piece(uint8_t *out, const uint8_t *mask)
{
	uint32_t *waiting = malloc(HAND_PIXELS * sizeof(*waiting)), best = 0, best_at = 0;
	uint8_t *seen = calloc(HAND_PIXELS, 1);

	for (int pass = 0; pass < 2; pass++) {
		if (pass == 1) {
			memset(seen, 0, HAND_PIXELS);
			memset(out, 0, HAND_PIXELS);
		}
		for (uint32_t from = pass ? best_at : 0; from < HAND_PIXELS; from++) {
			uint32_t count = 0, done = 0;

			if (!mask[from] || seen[from])
				continue;
			waiting[count++] = from;
			seen[from] = 1;
			while (done < count) {
				const uint32_t at = waiting[done++], x = at % HAND_WIDTH;
				const uint32_t to[4] = {
					x > 0 ? at - 1 : at, x + 1 < HAND_WIDTH ? at + 1 : at,
					at >= HAND_WIDTH ? at - HAND_WIDTH : at,
					at + HAND_WIDTH < HAND_PIXELS ? at + HAND_WIDTH : at
				};

				if (pass == 1)
					out[at] = 1;
				for (int k = 0; k < 4; k++)
					if (mask[to[k]] && !seen[to[k]]) {
						seen[to[k]] = 1;
						waiting[count++] = to[k];
					}
			}
			if (count > best) {
				best = count;
				best_at = from;
			}
			if (pass == 1)
				break;
		}
	}
	free(waiting);
	free(seen);
	return best;
}

/* The outer border of a piece, clockwise (Moore's neighbours). */
void hand_trace(struct hand_path *out, const uint8_t *mask)
{
	static const int dx[8] = { 1, 1, 0, -1, -1, -1, 0, 1 },
			 dy[8] = { 0, 1, 1, 1, 0, -1, -1, -1 };
	int x = 0, y = 0, from = 6;
	uint32_t start = 0;

	out->count = 0;
	while (start < HAND_PIXELS && !mask[start])
		start++;
	if (start == HAND_PIXELS)
		return;
	x = (int)(start % HAND_WIDTH);
	y = (int)(start / HAND_WIDTH);
	do {
		int k = 0;

		hand_add_point(out, (float)x + 0.5f, (float)y + 0.5f);
		for (; k < 8; k++) {
			const int way = (from + k) % 8, tx = x + dx[way], ty = y + dy[way];

			if (tx >= 0 && ty >= 0 && tx < HAND_WIDTH && ty < HAND_HEIGHT &&
			    mask[ty * HAND_WIDTH + tx]) {
				x = tx;
				y = ty;
				from = (way + 5) % 8;
				break;
			}
		}
		if (k == 8)
			break;
	} while ((uint32_t)(y * HAND_WIDTH + x) != start && out->count < HAND_POINTS_MAX - 1);
}

/* How far each pixel of a mask is from its end, roughly (3-4 chamfer, in thirds of a pixel). */
static void find_depths(uint32_t *depth, const uint8_t *mask)
{
	for (uint32_t at = 0; at < HAND_PIXELS; at++)
		depth[at] = mask[at] ? UINT32_MAX / 2 : 0;
#define BETTER(to, step) depth[at] = depth[to] + (step) < depth[at] ? depth[to] + (step) : depth[at]
	for (uint32_t y = 0, at = 0; y < HAND_HEIGHT; y++)
		for (uint32_t x = 0; x < HAND_WIDTH; x++, at++) {
			if (!mask[at])
				continue;
			if (x == 0 || y == 0 || x + 1 == HAND_WIDTH || y + 1 == HAND_HEIGHT) {
				depth[at] = 3;
				continue;
			}
			BETTER(at - 1, 3);
			BETTER(at - HAND_WIDTH, 3);
			BETTER(at - HAND_WIDTH - 1, 4);
			BETTER(at - HAND_WIDTH + 1, 4);
		}
	for (uint32_t at = HAND_PIXELS; at-- > 0;) {
		const uint32_t x = at % HAND_WIDTH, y = at / HAND_WIDTH;

		if (!mask[at] || x == 0 || y == 0 || x + 1 == HAND_WIDTH || y + 1 == HAND_HEIGHT)
			continue;
		BETTER(at + 1, 3);
		BETTER(at + HAND_WIDTH, 3);
		BETTER(at + HAND_WIDTH + 1, 4);
		BETTER(at + HAND_WIDTH - 1, 4);
	}
#undef BETTER
}

/* A stroke through the middle of a piece: from its deepest pixel both ways along its longer axis,
 * as far as it is deep. */
void hand_through_middle(struct hand_path *out, const uint8_t *mask)
{
	uint32_t *depth = malloc(HAND_PIXELS * sizeof(*depth)), deepest = 0;
	double sum[2] = { 0 }, square[3] = { 0 };
	uint32_t count = 0;

	find_depths(depth, mask);
	for (uint32_t at = 0; at < HAND_PIXELS; at++) {
		if (!mask[at])
			continue;
		const double x = at % HAND_WIDTH, y = at / HAND_WIDTH;
		deepest = depth[at] > depth[deepest] ? at : deepest;
		sum[0] += x;
		sum[1] += y;
		square[0] += x * x;
		square[1] += y * y;
		square[2] += x * y;
		count++;
	}
	out->count = 0;
	if (count > 0) {
		const double mx = sum[0] / count, my = sum[1] / count,
			     xx = square[0] / count - mx * mx, yy = square[1] / count - my * my,
			     xy = square[2] / count - mx * my;
		const double angle = 0.5 * atan2(2 * xy, xx - yy);
		const float sx = (float)(deepest % HAND_WIDTH) + 0.5f,
			    sy = (float)(deepest / HAND_WIDTH) + 0.5f;
		float ends[2][2];

		for (int way = 0; way < 2; way++) {
			const float cx = (float)cos(angle) * (way ? -1 : 1),
				    cy = (float)sin(angle) * (way ? -1 : 1);
			float t = 0;

			for (; t < 2000; t++) {
				const int x = (int)(sx + t * cx), y = (int)(sy + t * cy);
				if (x < 0 || y < 0 || x >= HAND_WIDTH || y >= HAND_HEIGHT ||
				    depth[y * HAND_WIDTH + x] * 2 < depth[deepest])
					break;
			}
			ends[way][0] = sx + t * cx;
			ends[way][1] = sy + t * cy;
		}
		const float length = hypotf(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]);
		for (float t = 0; t <= length; t += 4)
			hand_add_point(
				out, ends[0][0] + (ends[1][0] - ends[0][0]) * t / (length + 0.01f),
				ends[0][1] + (ends[1][1] - ends[0][1]) * t / (length + 0.01f));
	}
	free(depth);
}

/* What a hand makes of a path: it cuts corners, trembles and slips. Returns seconds. */
float hand_draw(struct hand_path *path, bool closed, float width_px)
{
	const float tremble = 0.2f * width_px, slip = 0.5f * width_px;
	const int smooth = (int)(width_px * 0.8f) + 1;
	float(*out)[2] = malloc(HAND_POINTS_MAX * sizeof(*out)), away = 0, length = 0, slipping = 0,
	slip_by = 0;
	const uint32_t n = path->count;

	for (uint32_t i = 0; i < n; i++) {
		float sum[2] = { 0 };
		int count = 0;

		for (int k = -smooth; k <= smooth; k++) {
			int64_t at = (int64_t)i + k;

			if (closed)
				at = (at + n) % n;
			else if (at < 0 || at >= n)
				continue;
			sum[0] += path->points[at][0];
			sum[1] += path->points[at][1];
			count++;
		}
		out[i][0] = sum[0] / (float)count;
		out[i][1] = sum[1] / (float)count;
	}
	for (uint32_t i = 0; i < n; i++) {
		const float *next = out[(i + 3) % n], *before = out[(i + n - 3) % n];
		float along[2] = { next[0] - before[0], next[1] - before[1] };
		const float size = hypotf(along[0], along[1]) + 1e-6f;

		/* neighbouring errors are alike over about 25 pixels */
		away += -away / 25 + tremble * (float)normal_chance() * sqrtf(2.0f / 25);
		if (slipping <= 0 && chance() < 1.0 / 400) {
			slipping = 30;
			slip_by = slip * (chance() < 0.5 ? -1.0f : 1.0f);
		}
		slipping -= 1;
		const float by =
			away + (slipping > 0 ? slip_by * sinf((float)M_PI * slipping / 30) : 0);
		path->points[i][0] = out[i][0] - along[1] / size * by;
		path->points[i][1] = out[i][1] + along[0] / size * by;
		if (i > 0)
			length += hypotf(out[i][0] - out[i - 1][0], out[i][1] - out[i - 1][1]);
	}
	free(out);
	return begin_s + vec_most(length / width_px * steer_s, length / fastest_px_s);
}
