/* Builds the levels of a picture, fills uncovered pixels (push-pull) and sharpens every level. */
#include "pipeline/samples/pyramid.h"

#include <assert.h>
#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/samples/shading.h"

int pyramid_init(struct pyramid *pyramid, uint32_t side_px)
{
	*pyramid = (struct pyramid){ 0 };
	for (uint32_t side = side_px;; side = (side + 1) / 2) {
		uint32_t level = pyramid->level_count++;

		assert(level < PYRAMID_LEVELS_MAX);
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

void pyramid_set(struct pyramid *pyramid, const uint8_t *rgba, uint64_t *covered, uint64_t *backs)
{
	size_t count = (size_t)pyramid->side_px[0] * pyramid->side_px[0];

	*covered = *backs = 0;
	memcpy(pyramid->levels[0], rgba, count * 4);
	for (size_t i = 0; i < count; i++) {
		uint8_t *alpha = &pyramid->levels[0][i][3];
		unsigned samples = *alpha / SHADING_COVERED;

		*covered += samples;
		*backs += *alpha % SHADING_COVERED;
		*alpha = (uint8_t)(samples * 255 / SHADING_SAMPLES);
	}
}

/* Averages the existing ones of four pixels, weighted by coverage. */
static void reduce_pixel(uint8_t to[4], const uint8_t *const four[4], unsigned count)
{
	unsigned sum[3] = { 0 }, weight = 0;

	for (unsigned k = 0; k < count; k++) {
		weight += four[k][3];
		for (int c = 0; c < 3; c++)
			sum[c] += (unsigned)four[k][c] * four[k][3];
	}
	for (int c = 0; c < 3; c++)
		to[c] = weight ? (uint8_t)((sum[c] + weight / 2) / weight) : 0;
	to[3] = (uint8_t)((weight + 3) / 4);
}

static void reduce(const struct pyramid *pyramid, uint32_t level)
{
	uint32_t side = pyramid->side_px[level], finer = pyramid->side_px[level - 1];
	const uint8_t(*from)[4] = (const uint8_t(*)[4])pyramid->levels[level - 1];

	for (uint32_t y = 0; y < side; y++) {
		for (uint32_t x = 0; x < side; x++) {
			const uint8_t *first = from[(size_t)2 * y * finer + 2 * x], *four[4];
			uint8_t *to = pyramid->levels[level][(size_t)y * side + x];
			bool right = 2 * x + 1 < finer, below = 2 * y + 1 < finer;
			unsigned count = 0, covered = 0;

			four[count++] = first;
			if (right)
				four[count++] = first + 4;
			if (below)
				four[count++] = first + (size_t)4 * finer;
			if (right && below)
				four[count++] = first + (size_t)4 * finer + 4;
			for (unsigned k = 0; k < count; k++)
				covered += four[k][3];
			if (covered == 0) {
				memset(to, 0, 4);
			} else if (covered == 4 * 255) {
				for (int c = 0; c < 3; c++)
					to[c] = (uint8_t)((four[0][c] + four[1][c] + four[2][c] +
							   four[3][c] + 2) /
							  4);
				to[3] = 255;
			} else {
				reduce_pixel(to, four, count);
			}
		}
	}
}

void pyramid_reduce(struct pyramid *pyramid)
{
	for (uint32_t level = 1; level < pyramid->level_count; level++)
		reduce(pyramid, level);
}

/* Fills bilinearly: the centre of a fine pixel is a quarter of a coarse pixel away from the coarse
 * one's. */
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

/* The share, in 64ths, of the difference to each of its four neighbours that is added to a
 * pixel. */
enum { SHARPENING = 8 };

static void sharpen_row(uint8_t (*to)[4], const uint8_t (*above)[4], const uint8_t (*row)[4],
			const uint8_t (*below)[4], uint32_t side)
{
	for (uint32_t x = 0; x < side; x++) {
		const uint8_t *left = row[x - (x > 0)], *right = row[x + (x + 1 < side)];

		for (int c = 0; c < 3; c++) {
			int bend = 4 * row[x][c] - left[c] - right[c] - above[x][c] - below[x][c];
			int value = (64 * row[x][c] + SHARPENING * bend + 32) >> 6;

			to[x][c] = (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
		}
	}
}

/* rows: room for two rows, which keep their old values while the picture changes. */
static void sharpen(const struct pyramid *pyramid, uint32_t level, uint8_t (*rows)[4])
{
	uint32_t side = pyramid->side_px[level];

	for (uint32_t y = 0; y < side; y++) {
		uint8_t(*at)[4] = pyramid->levels[level] + (size_t)y * side;
		uint8_t(*row)[4] = rows + (y % 2 ? side : 0);
		const uint8_t(*above)[4] = (const uint8_t(*)[4])rows + (y % 2 ? 0 : side);
		const uint8_t(*below)[4] = (const uint8_t(*)[4])at + side;

		memcpy(row, at, side * sizeof(*row));
		sharpen_row(at, y > 0 ? above : (const uint8_t(*)[4])row, (const uint8_t(*)[4])row,
			    y + 1 < side ? below : (const uint8_t(*)[4])row, side);
	}
}

int pyramid_sharpen(struct pyramid *pyramid)
{
	uint8_t(*rows)[4] = malloc(2 * pyramid->side_px[0] * sizeof(*rows));

	if (!rows)
		return -ENOMEM;
	for (uint32_t level = 0; level < pyramid->level_count; level++)
		sharpen(pyramid, level, rows);
	free(rows);
	return 0;
}
