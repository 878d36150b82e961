/* Range images of a bumpy ball whose surface is known, as a scanner would see it. */
#ifndef GOPURA_TESTS_PIPELINE_OCTREE_BUMPY_BALL_H
#define GOPURA_TESTS_PIPELINE_OCTREE_BUMPY_BALL_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "pipeline/import/transform.h"

/* Returns how far a place lies outside the ball, in metres; its radius is about half a metre. */
static inline double ball_outside(const double at[3])
{
	const double r = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);

	return r - 0.5 -
	       0.02 * sin(5 * at[0] / (r + 1e-9)) * sin(4 * at[1] / (r + 1e-9)) *
		       cos(6 * at[2] / (r + 1e-9));
}

/* A place of view v of 14 (faces and corners of a cube): its rotation from the file's axes, in
 * which the scanner is at +z. */
static inline struct transform ball_view(int v)
{
	static const double towards[14][3] = { { 1, 0, 0 },   { -1, 0, 0 },  { 0, 1, 0 },
					       { 0, -1, 0 },  { 0, 0, 1 },   { 0, 0, -1 },
					       { 1, 1, 1 },   { 1, 1, -1 },  { 1, -1, 1 },
					       { 1, -1, -1 }, { -1, 1, 1 },  { -1, 1, -1 },
					       { -1, -1, 1 }, { -1, -1, -1 } };
	const double *t = towards[v], length = sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
	const double z[3] = { t[0] / length, t[1] / length, t[2] / length };
	const double flat = sqrt(z[0] * z[0] + z[1] * z[1]);
	const double x[3] = { flat > 0.1 ? -z[1] / flat : 1, flat > 0.1 ? z[0] / flat : 0, 0 };
	struct transform transform = { 0 };

	for (int k = 0; k < 3; k++) {
		const int a = (k + 1) % 3, b = (k + 2) % 3;

		transform.rows[k][0] = x[k];
		transform.rows[k][1] = z[a] * x[b] - z[b] * x[a];
		transform.rows[k][2] = z[k];
	}
	return transform;
}

static inline double ball_noise(void)
{
	double sum = 0;

	for (int i = 0; i < 12; i++)
		sum += (double)rand() / RAND_MAX;
	return sum - 6; /* of standard deviation 1 */
}

/* Finds where a line of sight from z = 1 downwards meets the ball. */
static inline bool ball_hit(const struct transform *view, double x, double y, double *z)
{
	double low = NAN, high = 1;

	for (double at = 1; at > -1; at -= 0.02) {
		double place[3] = { x, y, at };

		transform_point(view, place, place);
		if (ball_outside(place) < 0) {
			low = at;
			break;
		}
		high = at;
	}
	for (int i = 0; i < 40; i++) {
		double place[3] = { x, y, (low + high) / 2 };

		transform_point(view, place, place);
		if (ball_outside(place) < 0)
			low = (low + high) / 2;
		else
			high = (low + high) / 2;
	}
	*z = low;
	return low == low;
}

/* Writes one view as an ASCII PLY with a range_grid, or as a binary one whose vertices are the
 * cells of the grid. Colour is by place, from red to blue along the common x. */
static inline void ball_write(const char *path, int v, int side, double noise_m, bool binary)
{
	const struct transform view = ball_view(v);
	const double step = 1.2 / side;
	double *depths = malloc((size_t)side * (size_t)side * sizeof(*depths));
	FILE *file = fopen(path, "wb");
	int seen = 0;

	if (!depths || !file)
		abort();
	for (int i = 0; i < side * side; i++) {
		const double x = (i % side + 0.5) * step - 0.6, y = (i / side + 0.5) * step - 0.6;

		depths[i] = NAN;
		if (ball_hit(&view, x, y, &depths[i])) {
			depths[i] += noise_m * ball_noise();
			seen++;
		}
	}
	fprintf(file,
		"ply\nformat %s 1.0\nobj_info num_cols %d\nobj_info num_rows %d\n"
		"element vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
		"property uchar red\nproperty uchar green\nproperty uchar blue\n",
		binary ? "binary_little_endian" : "ascii", side, side, binary ? side * side : seen);
	if (!binary)
		fprintf(file, "element range_grid %d\nproperty list uchar int vertex_indices\n",
			side * side);
	fputs("end_header\n", file);
	for (int i = 0; i < side * side; i++) {
		const double x = (i % side + 0.5) * step - 0.6, y = (i / side + 0.5) * step - 0.6;
		const float place[3] = { (float)x, (float)y, (float)depths[i] };
		double common[3] = { x, y, depths[i] };
		uint8_t colour[3] = { 0, 100, 0 };

		transform_point(&view, common, common);
		if (depths[i] == depths[i]) {
			colour[0] = (uint8_t)(127 - 200 * common[0]);
			colour[2] = (uint8_t)(127 + 200 * common[0]);
		}
		if (binary) {
			fwrite(place, sizeof(place), 1, file);
			fwrite(colour, sizeof(colour), 1, file);
		} else if (depths[i] == depths[i]) {
			fprintf(file, "%.7g %.7g %.7g %d %d %d\n", (double)place[0],
				(double)place[1], (double)place[2], colour[0], colour[1],
				colour[2]);
		}
	}
	for (int i = 0, at = 0; i < side * side && !binary; i++) {
		if (depths[i] == depths[i])
			fprintf(file, "1 %d\n", at++);
		else
			fputs("0\n", file);
	}
	free(depths);
	if (fclose(file) != 0)
		abort();
}

#endif
