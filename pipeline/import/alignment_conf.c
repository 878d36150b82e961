/* Parses the lines of Stanford's registration files. */
#include "pipeline/import/alignment_conf.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* The rotation of a quaternion (x, y, z, w) of any length, in Stanford's sense: its inverse turns
 * the scan into the common axes. */
static void rotation(double matrix[16], const double q[4], double squared)
{
	const double x = -q[0], y = -q[1], z = -q[2], w = q[3], s = 2 / squared;
	const double rows[3][3] = {
		{ 1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w) },
		{ s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w) },
		{ s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y) },
	};

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			matrix[4 * i + k] = rows[i][k];
}

int alignment_conf_parse(struct alignment_conf_line *out, const char *line)
{
	double move[3], q[4], squared = 0;
	int end = 0;

	*out = (struct alignment_conf_line){ .is_optional = strncmp(line, "mesh", 4) == 0 };
	if (strncmp(line, "bmesh", 5) != 0 && !out->is_optional)
		return 0;
	line += out->is_optional ? 4 : 5;
	if (*line != ' ' && *line != '\t')
		return 0;
	if (sscanf(line, "%511s %lf %lf %lf %lf %lf %lf %lf %n", out->name, &move[0], &move[1],
		   &move[2], &q[0], &q[1], &q[2], &q[3], &end) != 8 ||
	    line[end])
		return -EBADMSG;
	for (int k = 0; k < 4; k++)
		squared += q[k] * q[k];
	if (!(squared > 1e-12 && squared < 1e12))
		return -EBADMSG;
	rotation(out->matrix, q, squared);
	for (int k = 0; k < 3; k++)
		out->matrix[4 * k + 3] = move[k];
	out->matrix[15] = 1;
	return 1;
}
