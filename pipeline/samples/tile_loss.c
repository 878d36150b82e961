/* Structural similarity of a tile and what is decoded of it, window by window. */
#include "pipeline/samples/tile_loss.h"

#include <math.h>
#include <stddef.h>

/* In 1000ths, so that sums are exact. */
static int64_t brightness(const uint8_t *pixel)
{
	return 299 * pixel[0] + 587 * pixel[1] + 114 * pixel[2];
}

double tile_window_ssim(const uint8_t *a, const uint8_t *b, uint32_t x0, uint32_t y0)
{
	const double c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;
	const double n = TILE_WINDOW_PX * TILE_WINDOW_PX;
	int64_t sums[5] = { 0 };
	double mean_a, mean_b, aa, bb, ab;

	for (uint32_t i = 0; i < TILE_WINDOW_PX * TILE_WINDOW_PX; i++) {
		uint32_t x = x0 + i % TILE_WINDOW_PX, y = y0 + i / TILE_WINDOW_PX;
		size_t at = 3 * ((size_t)y * SAMPLE_IMAGE_PX + x);
		int64_t u = brightness(a + at), v = brightness(b + at);

		sums[0] += u;
		sums[1] += v;
		sums[2] += u * u;
		sums[3] += v * v;
		sums[4] += u * v;
	}
	mean_a = (double)sums[0] / n / 1000;
	mean_b = (double)sums[1] / n / 1000;
	aa = (double)sums[2] / n / 1e6 - mean_a * mean_a;
	bb = (double)sums[3] / n / 1e6 - mean_b * mean_b;
	ab = (double)sums[4] / n / 1e6 - mean_a * mean_b;
	return (2 * mean_a * mean_b + c1) * (2 * ab + c2) /
	       ((mean_a * mean_a + mean_b * mean_b + c1) * (aa + bb + c2));
}

uint32_t tile_loss(const uint8_t *rgb, const uint8_t *decoded, const uint8_t covered[TILE_WINDOWS])
{
	uint32_t loss = 0;

	for (uint32_t w = 0; w < TILE_WINDOWS; w++) {
		double ssim;

		if (!covered[w])
			continue;
		ssim = tile_window_ssim(rgb, decoded, w % TILE_WINDOW_SIDE * TILE_WINDOW_PX,
					w / TILE_WINDOW_SIDE * TILE_WINDOW_PX);
		loss += (uint32_t)lrint(fmin(fmax(1 - ssim, 0), 1) * TILE_LOSS_WINDOW);
	}
	return loss;
}
