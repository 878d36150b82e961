/* Chooses the low bits that are left out of positions, and rounds. */
#include "pipeline/release/publish_precision.h"

enum { ZEROS_MAX = 12 };

/* Positions are rounded to steps that are at most this part of the error. */
#define ERROR_SHARE 8

int precision_zeros_for(float error_m, double step_m)
{
	int zeros = 0;

	while (zeros < ZEROS_MAX && ERROR_SHARE * step_m * (2 << zeros) <= (double)error_m)
		zeros++;
	return zeros;
}

void precision_round_position(int32_t position[3], int zeros, int32_t places)
{
	int32_t step = 1 << zeros;

	for (int i = 0; i < 3; i++) {
		int32_t value = (position[i] + step / 2) / step * step;

		position[i] = value < places ? value : places - step;
	}
}
