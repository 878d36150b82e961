/* Quaternions, for what turns. */
#include "geometry/turn.h"

#include "geometry/vec.h"

static void make_unit(float turn[4])
{
	float length = 0;

	for (int k = 0; k < 4; k++)
		length += turn[k] * turn[k];
	for (int k = 0; k < 4 && length > 0; k++)
		turn[k] /= sqrtf(length);
}

void turn_about(float out[4], const float axis[3], float angle_rad)
{
	float unit[3] = { axis[0], axis[1], axis[2] };
	const float half = vec_normalise(unit) > 0 ? angle_rad / 2 : 0;

	vec_scale(out, sinf(half), unit);
	out[3] = cosf(half);
}

void turn_twice(float out[4], const float first[4], const float second[4])
{
	float turned[4];

	vec_cross(turned, second, first);
	for (int k = 0; k < 3; k++)
		turned[k] += second[3] * first[k] + first[3] * second[k];
	turned[3] = second[3] * first[3] - vec_dot(second, first);
	for (int k = 0; k < 4; k++)
		out[k] = turned[k];
	make_unit(out);
}

void turn_between(float out[4], const float a[4], const float b[4], float share)
{
	float cosine = 0, sign = 1, from = 1 - share, to = share;

	for (int k = 0; k < 4; k++)
		cosine += a[k] * b[k];
	if (cosine < 0)
		sign = -1;
	cosine *= sign;
	if (cosine < 0.9995f) { /* else a straight line is as good, and the sine too small */
		const float angle = acosf(cosine);

		from = sinf((1 - share) * angle) / sinf(angle);
		to = sinf(share * angle) / sinf(angle);
	}
	for (int k = 0; k < 4; k++)
		out[k] = from * a[k] + to * sign * b[k];
	make_unit(out);
}

void turn_vector(float out[3], const float turn[4], const float v[3])
{
	float once[3], twice[3];

	/* v + 2 w (q x v) + 2 q x (q x v) */
	vec_cross(once, turn, v);
	vec_cross(twice, turn, once);
	for (int k = 0; k < 3; k++)
		out[k] = v[k] + 2 * (turn[3] * once[k] + twice[k]);
}

void turn_matrix(float m[16], const float turn[4])
{
	const float x = turn[0], y = turn[1], z = turn[2], w = turn[3];

	m[0] = 1 - 2 * (y * y + z * z);
	m[1] = 2 * (x * y + z * w);
	m[2] = 2 * (x * z - y * w);
	m[4] = 2 * (x * y - z * w);
	m[5] = 1 - 2 * (x * x + z * z);
	m[6] = 2 * (y * z + x * w);
	m[8] = 2 * (x * z + y * w);
	m[9] = 2 * (y * z - x * w);
	m[10] = 1 - 2 * (x * x + y * y);
}
