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
	pyramid->weighed = malloc((side_px / 2 + 3) * sizeof(*pyramid->weighed));
	if (!pyramid->weighed)
		return -ENOMEM;
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
	free(pyramid->weighed);
	*pyramid = (struct pyramid){ 0 };
}

vector_clones void pyramid_count(struct pyramid *pyramid, uint64_t *covered, uint64_t *backs)
{
	uint32_t side = pyramid->side_px[0];

	*covered = *backs = 0;
	for (uint32_t y = 0; y < side; y++) {
		uint8_t(*row)[4] = pyramid->levels[0] + (size_t)y * side;
		uint32_t covered_here = 0, backs_here = 0;

#pragma GCC ivdep
		for (uint32_t x = 0; x < side; x++) {
			uint32_t pixel, samples;

			memcpy(&pixel, row[x], sizeof(pixel));
			samples = (pixel >> 24) / SHADING_COVERED;
			covered_here += samples;
			backs_here += (pixel >> 24) % SHADING_COVERED;
			pixel = (pixel & 0xffffff) | samples * 255 / SHADING_SAMPLES << 24;
			memcpy(row[x], &pixel, sizeof(pixel));
		}
		*covered += covered_here;
		*backs += backs_here;
	}
}

vector_clones bool pyramid_shows(const struct pyramid *pyramid, uint32_t level, uint32_t x,
				 uint32_t y, uint32_t side_px)
{
	const uint8_t(*pixels)[4] = (const uint8_t(*)[4])pyramid->levels[level];

	for (uint32_t row = y; row < y + side_px; row++) {
		const uint8_t(*from)[4] = pixels + (size_t)row * pyramid->side_px[level] + x;
		uint32_t any = 0;

		for (uint32_t column = 0; column < side_px; column++) {
			uint32_t pixel;

			memcpy(&pixel, from[column], sizeof(pixel));
			any |= pixel;
		}
		if (any >> 24)
			return true;
	}
	return false;
}

/* Four bytes as four numbers of 16 bits, and back. */
vector_inline uint64_t widen(const uint8_t bytes[4])
{
	uint32_t packed;

	memcpy(&packed, bytes, sizeof(packed));
	return (packed & 255) | (uint64_t)(packed >> 8 & 255) << 16 |
	       (uint64_t)(packed >> 16 & 255) << 32 | (uint64_t)(packed >> 24) << 48;
}

vector_inline uint32_t narrow(uint64_t wide)
{
	return (uint32_t)(wide & 255) | (uint32_t)(wide >> 16 & 255) << 8 |
	       (uint32_t)(wide >> 32 & 255) << 16 | (uint32_t)(wide >> 48) << 24;
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

/* Reduces the pixels of a row whose four finer ones all show the surface, or none; the others are
 * set to 0. Returns true if there are others. upper, lower: twice as many finer pixels. */
static vector_clones bool reduce_row(uint8_t (*to)[4], const uint8_t (*upper)[4],
				     const uint8_t (*lower)[4], uint32_t count)
{
	const uint64_t half = 0x0002000200020002, quarters = 0x3fff3fff3fff3fff;
	uint32_t others = 0;

#pragma GCC ivdep
	for (uint32_t x = 0; x < count; x++) {
		size_t first = 2 * (size_t)x;
		uint64_t sum = widen(upper[first]) + widen(upper[first + 1]) + widen(lower[first]) +
			       widen(lower[first + 1]);
		uint32_t covered = (uint32_t)(sum >> 48);
		uint32_t mean = narrow((sum + half) >> 2 & quarters);

		mean = covered == 4 * 255 ? mean : 0;
		others |= covered > 0 && covered < 4 * 255 ? 1 : 0;
		memcpy(to[x], &mean, sizeof(mean));
	}
	return others;
}

/* As reduce_row, for the pixels that are 0 in the row: they may be covered in part, or lie at an
 * edge of odd length. */
static void reduce_others(const struct pyramid *pyramid, uint32_t level, uint32_t y)
{
	uint32_t side = pyramid->side_px[level], finer = pyramid->side_px[level - 1];
	const uint8_t(*from)[4] = (const uint8_t(*)[4])pyramid->levels[level - 1];

	for (uint32_t x = 0; x < side; x++) {
		const uint8_t *first = from[(size_t)2 * y * finer + 2 * x], *four[4];
		uint8_t *to = pyramid->levels[level][(size_t)y * side + x];
		bool right = 2 * x + 1 < finer, below = 2 * y + 1 < finer;
		unsigned count = 0;

		if (to[3])
			continue;
		four[count++] = first;
		if (right)
			four[count++] = first + 4;
		if (below)
			four[count++] = first + (size_t)4 * finer;
		if (right && below)
			four[count++] = first + (size_t)4 * finer + 4;
		reduce_pixel(to, four, count);
	}
}

static void reduce(const struct pyramid *pyramid, uint32_t level)
{
	uint32_t side = pyramid->side_px[level], finer = pyramid->side_px[level - 1];
	const uint8_t(*from)[4] = (const uint8_t(*)[4])pyramid->levels[level - 1];

	for (uint32_t y = 0; y < side; y++) {
		const uint8_t(*upper)[4] = from + (size_t)2 * y * finer;
		uint8_t(*to)[4] = pyramid->levels[level] + (size_t)y * side;

		if (finer % 2)
			memset(to, 0, (size_t)side * sizeof(*to));
		if (finer % 2 || reduce_row(to, upper, upper + finer, side))
			reduce_others(pyramid, level, y);
	}
}

void pyramid_reduce(struct pyramid *pyramid)
{
	for (uint32_t level = 1; level < pyramid->level_count; level++)
		reduce(pyramid, level);
}

/* Sets the uncovered pixels of a row at `first` and every second one after it from the row of the
 * coarser level, whose pixels have been weighed vertically (4 times as large). */
vector_inline void fill_pixels(uint8_t (*row)[4], const uint64_t *near, const uint64_t *far,
			       uint32_t count)
{
	const uint64_t sixteenths = 0x0fff0fff0fff0fff, half = 0x0008000800080008;

#pragma GCC ivdep
	for (uint32_t n = 0; n < count; n++) {
		uint32_t before, filled = narrow((3 * near[n] + far[n] + half) >> 4 & sixteenths);

		filled &= 0xffffff;
		memcpy(&before, row[2 * n], sizeof(before));
		before = before >> 24 ? before : filled;
		memcpy(row[2 * n], &before, sizeof(before));
	}
}

/* Fills bilinearly: the centre of a fine pixel is a quarter of a coarse pixel away from the coarse
 * one's. weighed: room for two more than a row of the coarser level. */
static vector_clones void fill(const struct pyramid *pyramid, uint32_t level, uint64_t *weighed)
{
	uint32_t side = pyramid->side_px[level], coarser = pyramid->side_px[level + 1];
	const uint8_t(*from)[4] = (const uint8_t(*)[4])pyramid->levels[level + 1];

	for (uint32_t y = 0; y < side; y++) {
		uint32_t near_y = y / 2, far_y = y % 2 ? near_y + 1 : near_y - (near_y > 0);
		uint8_t(*row)[4] = pyramid->levels[level] + (size_t)y * side;
		const uint8_t(*near)[4] = from + (size_t)near_y * coarser;
		const uint8_t(*far)[4];

		if (far_y >= coarser)
			far_y = coarser - 1;
		far = from + (size_t)far_y * coarser;
#pragma GCC ivdep
		for (uint32_t x = 0; x < coarser; x++)
			weighed[x + 1] = 3 * widen(near[x]) + widen(far[x]);
		weighed[0] = weighed[1];
		weighed[coarser + 1] = weighed[coarser];
		fill_pixels(row, weighed + 1, weighed, (side + 1) / 2);
		fill_pixels(row + 1, weighed + 1, weighed + 2, side / 2);
	}
}

void pyramid_fill(struct pyramid *pyramid)
{
	for (uint32_t level = pyramid->level_count - 1; level > 0; level--)
		fill(pyramid, level - 1, pyramid->weighed);
}

void pyramid_lay_over(struct pyramid *pyramid, const uint8_t rgb[3])
{
	for (uint32_t level = 0; level < pyramid->level_count; level++) {
		const size_t side = pyramid->side_px[level];
		uint8_t(*pixels)[4] = pyramid->levels[level];

		for (size_t i = 0; i < side * side; i++)
			for (int c = 0; c < 3; c++)
				pixels[i][c] = (uint8_t)((pixels[i][c] * pixels[i][3] +
							  rgb[c] * (255 - pixels[i][3]) + 127) /
							 255);
	}
}

/* The share, in 64ths, of the difference to each of its four neighbours that is added to a
 * pixel. */
enum { SHARPENING = 8 };

/* Sharpens a row of a square: the row, the one above and the one below, each 4 bytes per pixel. The
 * neighbours to the left and right are 4 bytes away. */
static vector_clones void sharpen_row(uint8_t *to, const uint8_t *row, const uint8_t *above,
				      const uint8_t *below, size_t bytes)
{
#pragma GCC ivdep
	for (size_t i = 0; i < bytes; i++) {
		int bend = 4 * row[i] - row[i - 4] - row[i + 4] - above[i] - below[i];
		int value = (64 * row[i] + SHARPENING * bend + 32) >> 6;

		to[i] = (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
	}
}

/* Leaves out every fourth byte; four pixels at once make three numbers. */
static vector_clones void pack_row(uint8_t *rgb, const uint8_t *rgba, uint32_t count)
{
	uint32_t whole = count / 4;

#pragma GCC ivdep
	for (uint32_t n = 0; n < whole; n++) {
		uint32_t four[4], three[3];

		memcpy(four, rgba + (size_t)n * 16, sizeof(four));
		three[0] = (four[0] & 0xffffff) | four[1] << 24;
		three[1] = (four[1] >> 8 & 0xffff) | four[2] << 16;
		three[2] = (four[2] >> 16 & 0xff) | four[3] << 8;
		memcpy(rgb + (size_t)n * 12, three, sizeof(three));
	}
	for (uint32_t n = 4 * whole; n < count; n++)
		memcpy(rgb + (size_t)n * 3, rgba + (size_t)n * 4, 3);
}

void pyramid_sharpen(const struct pyramid *pyramid, uint32_t level, uint32_t x, uint32_t y,
		     uint32_t side_px, uint8_t *rgb)
{
	uint32_t side = pyramid->side_px[level], last = side - 1;
	uint8_t rows[3][(PYRAMID_SQUARE_MAX + 2) * 4], sharp[PYRAMID_SQUARE_MAX * 4];

	assert(side_px <= PYRAMID_SQUARE_MAX);
	for (uint32_t row = 0; row < side_px; row++) {
		for (uint32_t k = 0; k < 3; k++) {
			uint32_t from = y + row + k < 1 ? 0 : y + row + k - 1;
			const uint8_t(*at)[4] = (const uint8_t(*)[4])pyramid->levels[level] +
						(size_t)(from < last ? from : last) * side;

			memcpy(rows[k] + 4, at[x], (size_t)side_px * 4);
			memcpy(rows[k], at[x > 0 ? x - 1 : 0], 4);
			memcpy(rows[k] + 4 * (size_t)(side_px + 1),
			       at[x + side_px < side ? x + side_px : last], 4);
		}
		sharpen_row(sharp, rows[1] + 4, rows[0] + 4, rows[2] + 4, (size_t)side_px * 4);
		pack_row(rgb, sharp, side_px);
		rgb += 3 * (size_t)side_px;
	}
}
