#include "pipeline/pyramid.h"

#include <assert.h>
#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

int pyramid_init(struct pyramid *pyramid, uint32_t side_px)
{
	*pyramid = (struct pyramid){ 0 };
	for (uint32_t side = side_px;; side = (side + 1) / 2) {
		uint32_t level = pyramid->level_count++;

		assert(level < PYRAMID_LEVELS_MOST);
		pyramid->side_px[level] = side;
		pyramid->levels[level] = calloc((size_t)side * side, 4);
		if (!pyramid->levels[level]) {
			pyramid_finish(pyramid);
			return -ENOMEM;
		}
		if (side == 1)
			return 0;
	}
}

void pyramid_finish(struct pyramid *pyramid)
{
	if (!pyramid)
		return;
	for (uint32_t level = 0; level < pyramid->level_count; level++)
		free(pyramid->levels[level]);
	*pyramid = (struct pyramid){ 0 };
}

void pyramid_set(struct pyramid *pyramid, const uint8_t *rgba, uint8_t marked, uint64_t *covered,
		 uint64_t *marked_count)
{
	uint32_t side = pyramid->side_px[0];
	size_t row = (size_t)side * 2 * 4;
	uint64_t all = 0, with_mark = 0;

	for (uint32_t y = 0; y < side; y++) {
		const uint8_t *low = rgba + (size_t)(2 * (side - 1 - y)) * row;
		uint8_t(*to)[4] = pyramid->levels[0] + (size_t)y * side;

		for (uint32_t x = 0; x < side; x++, low += 8, to++) {
			const uint8_t *four[] = { low, low + 4, low + row, low + row + 4 };
			unsigned sum[3] = { 0 }, count = 0;

			for (int i = 0; i < 4; i++) {
				if (!four[i][3])
					continue;
				count++;
				with_mark += four[i][3] == marked;
				for (int c = 0; c < 3; c++)
					sum[c] += four[i][c];
			}
			all += count;
			for (int c = 0; c < 3; c++)
				(*to)[c] = count ? (uint8_t)((sum[c] + count / 2) / count) : 0;
			(*to)[3] = (uint8_t)(count * 255 / 4);
		}
	}
	*covered = all;
	*marked_count = with_mark;
}

static void reduce(const struct pyramid *pyramid, uint32_t level)
{
	uint32_t side = pyramid->side_px[level], finer = pyramid->side_px[level - 1];
	const uint8_t(*from)[4] = (const uint8_t(*)[4])pyramid->levels[level - 1];

	for (uint32_t i = 0; i < side * side; i++) {
		uint32_t x = 2 * (i % side), y = 2 * (i / side);
		uint8_t *to = pyramid->levels[level][i];
		unsigned sum[3] = { 0 }, weight = 0;

		for (uint32_t k = 0; k < 4; k++) {
			const uint8_t *p;

			if (x + k % 2 >= finer || y + k / 2 >= finer)
				continue;
			p = from[(size_t)(y + k / 2) * finer + x + k % 2];
			weight += p[3];
			for (int c = 0; c < 3; c++)
				sum[c] += (unsigned)p[c] * p[3];
		}
		for (int c = 0; c < 3; c++)
			to[c] = weight ? (uint8_t)((sum[c] + weight / 2) / weight) : 0;
		to[3] = (uint8_t)((weight + 3) / 4);
	}
}

void pyramid_reduce(struct pyramid *pyramid)
{
	for (uint32_t level = 1; level < pyramid->level_count; level++)
		reduce(pyramid, level);
}

/* Bilinear: a fine pixel's middle lies a quarter of a coarse one off its own. */
static void fill(const struct pyramid *pyramid, uint32_t level)
{
	uint32_t side = pyramid->side_px[level], coarser = pyramid->side_px[level + 1];
	const uint8_t(*from)[4] = (const uint8_t(*)[4])pyramid->levels[level + 1];

	for (uint32_t y = 0; y < side; y++) {
		uint32_t near_y = y / 2, far_y = y % 2 ? near_y + 1 : near_y - (near_y > 0);

		if (far_y >= coarser)
			far_y = coarser - 1;
		for (uint32_t x = 0; x < side; x++) {
			uint8_t *to = pyramid->levels[level][(size_t)y * side + x];
			uint32_t near_x = x / 2, far_x = x % 2 ? near_x + 1 : near_x - (near_x > 0);

			if (to[3])
				continue;
			if (far_x >= coarser)
				far_x = coarser - 1;
			for (int c = 0; c < 3; c++)
				to[c] = (uint8_t)((9 * from[(size_t)near_y * coarser + near_x][c] +
						   3 * from[(size_t)near_y * coarser + far_x][c] +
						   3 * from[(size_t)far_y * coarser + near_x][c] +
						   from[(size_t)far_y * coarser + far_x][c] + 8) /
						  16);
		}
	}
}

void pyramid_fill(struct pyramid *pyramid)
{
	for (uint32_t level = pyramid->level_count - 1; level > 0; level--)
		fill(pyramid, level - 1);
}
