/* Compares a picture with 1 or 2 x 2 samples per pixel with the samples of a GL frame. */
#ifndef GOPURA_TESTS_PIPELINE_SAMPLES_COMPARE_H
#define GOPURA_TESTS_PIPELINE_SAMPLES_COMPARE_H

#include <math.h>
#include <stdlib.h>

#include "pipeline/samples/drawing.h"
#include "pipeline/samples/shading.h"
#include "tests/check.h"

struct comparison {
	long shown, partial, coverage_differs, far_off; /* pixels; by more than 6 of 255 */
	double squares;                                 /* of all channels' differences */
};

/* samples: lowest row first. */
static inline struct comparison compare(const uint8_t *picture, const uint8_t *samples, int side,
					int finer)
{
	struct comparison all = { 0 };

	for (int i = 0; i < side / finer * (side / finer); i++) {
		int x = i % (side / finer), y = i / (side / finer), sum[3] = { 0 }, code = 0;
		int worst = 0;

		for (int k = 0; k < SHADING_SAMPLES; k++) { /* one counts as four */
			int row = finer * y + k / 2 % finer, column = finer * x + k % finer;
			const uint8_t *from =
				samples +
				4 * ((size_t)(side - 1 - row) * (size_t)side + (size_t)column);

			for (int c = 0; from[3] && c < 3; c++)
				sum[c] += from[c];
			code += from[3] ? SHADING_COVERED + (from[3] == DRAWING_BACK) : 0;
		}
		all.coverage_differs += picture[4 * i + 3] != code;
		all.shown += code > 0;
		all.partial += code > 0 && code < SHADING_COVERED * SHADING_SAMPLES;
		for (int c = 0; code == 0 && c < 3; c++)
			CHECK(picture[4 * i + c] == 0);
		for (int c = 0; code > 0 && c < 3; c++) {
			int off = abs(picture[4 * i + c] -
				      (int)lrintf((float)sum[c] / (float)(code / SHADING_COVERED)));

			worst = off > worst ? off : worst;
			all.squares += off * off;
		}
		all.far_off += worst > 6;
	}
	return all;
}

#endif
