/* Checks and applies the matrix that places a scan. */
#include "pipeline/import/transform.h"

#include <math.h>
#include <string.h>

/* Aligners multiply many matrices, so the last row is 0 0 0 1 but for rounding. */
static const double row_tolerance = 1e-6;
/* Beyond this, products of three numbers lose their meaning. */
static const double number_max = 1e12;
/* of the determinant, where the columns have length 1: 0 is flat, 1 a rotation */
static const double flat = 1e-6;

static double determinant(const double m[3][4])
{
	return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
	       m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
	       m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static double column_length(const double m[3][4], int k)
{
	return sqrt(m[0][k] * m[0][k] + m[1][k] * m[1][k] + m[2][k] * m[2][k]);
}

const char *transform_set(struct transform *out, const double numbers[16])
{
	double volume = 1;

	for (int i = 0; i < 16; i++)
		if (!(fabs(numbers[i]) <= number_max))
			return isfinite(numbers[i]) ? "holds a number beyond 1e12"
						    : "holds a number that is not finite";
	for (int k = 0; k < 4; k++)
		if (fabs(numbers[12 + k] - (k == 3)) > row_tolerance)
			return "does not end with the row 0 0 0 1 (is it transposed?)";
	memcpy(out->rows, numbers, sizeof(out->rows));
	for (int k = 0; k < 3; k++)
		volume *= column_length(out->rows, k);
	if (!(fabs(determinant(out->rows)) > flat * volume))
		return "flattens the scan (its determinant is 0)";
	return NULL;
}

void transform_point(const struct transform *transform, const double from[3], double to[3])
{
	const double x = from[0], y = from[1], z = from[2];

	for (int k = 0; k < 3; k++) {
		const double *row = transform->rows[k];

		to[k] = row[0] * x + row[1] * y + row[2] * z + row[3];
	}
}

bool transform_mirrors(const struct transform *transform)
{
	return determinant(transform->rows) < 0;
}
