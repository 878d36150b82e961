/* Packs a unit normal into two signed bytes by octahedral projection, and unpacks it. */
#include "format/normal.h"

#include <math.h>

static float sign_of(float value)
{
	return value < 0.0f ? -1.0f : 1.0f;
}

void normal_encode(int8_t out[2], const float normal[3])
{
	float sum = fabsf(normal[0]) + fabsf(normal[1]) + fabsf(normal[2]);
	float x, y;

	if (!(sum > 0.0f) || !isfinite(sum)) {
		out[0] = out[1] = 0;
		return;
	}
	x = normal[0] / sum;
	y = normal[1] / sum;
	if (normal[2] < 0.0f) {
		float folded = (1.0f - fabsf(y)) * sign_of(x);

		y = (1.0f - fabsf(x)) * sign_of(y);
		x = folded;
	}
	out[0] = (int8_t)lrintf(127.0f * x);
	out[1] = (int8_t)lrintf(127.0f * y);
}

void normal_decode(float out[3], const int8_t normal[2])
{
	float x = normal[0] / 127.0f, y = normal[1] / 127.0f;
	float z, length;

	/* The encoder never writes -128; it is read as -127. */
	x = x < -1.0f ? -1.0f : x;
	y = y < -1.0f ? -1.0f : y;
	z = 1.0f - fabsf(x) - fabsf(y);
	if (z < 0.0f) {
		float unfolded = (1.0f - fabsf(y)) * sign_of(x);

		y = (1.0f - fabsf(x)) * sign_of(y);
		x = unfolded;
	}
	length = sqrtf(x * x + y * y + z * z);
	out[0] = x / length;
	out[1] = y / length;
	out[2] = z / length;
}
