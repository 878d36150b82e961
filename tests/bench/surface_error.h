/* How far two surfaces lie apart: points are spread over one by area, and the nearest point of the
 * other is found. Ends the program on failure. */
#ifndef GOPURA_TESTS_BENCH_SURFACE_ERROR_H
#define GOPURA_TESTS_BENCH_SURFACE_ERROR_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "geometry/vec.h"
#include "pipeline/release/nearest.h"

enum { POINTS = 200000, PIECE_POINTS = 4096 };

static inline void *need(void *memory)
{
	if (!memory) {
		fputs("out of memory\n", stderr);
		exit(EXIT_FAILURE);
	}
	return memory;
}

static inline void need_ok(int rc, const char *what)
{
	if (rc < 0) {
		fprintf(stderr, "%s: %s\n", what, strerror(-rc));
		exit(EXIT_FAILURE);
	}
}

struct surface {
	float (*positions)[3];
	uint32_t (*triangles)[3];
	uint32_t triangle_count;
	struct nearest *nearest;
};

static inline void surface_index(struct surface *surface)
{
	need_ok(nearest_create(&surface->nearest, surface->positions, surface->triangles,
			       surface->triangle_count),
		"tree of boxes");
}

static inline double area_of(const struct surface *surface, uint32_t triangle)
{
	const uint32_t *corners = surface->triangles[triangle];
	float ab[3], ac[3], normal[3];

	vec_sub(ab, surface->positions[corners[1]], surface->positions[corners[0]]);
	vec_sub(ac, surface->positions[corners[2]], surface->positions[corners[0]]);
	vec_cross(normal, ab, ac);
	return (double)vec_length(normal) / 2;
}

/* Returns the i-th element of the van der Corput sequence in base b: spread evenly, always the
 * same. */
static inline float spread(uint32_t i, uint32_t base)
{
	double value = 0, digit = 1;

	for (; i > 0; i /= base) {
		digit /= base;
		value += digit * (i % base);
	}
	return (float)value;
}

/* POINTS points, equally many on equal areas. */
static inline float (*spread_points(const struct surface *surface))[3]
{
	float(*points)[3] = need(malloc(POINTS * sizeof(*points)));
	double all = 0, passed = 0;
	uint32_t count = 0;

	for (uint32_t t = 0; t < surface->triangle_count; t++)
		all += area_of(surface, t);
	for (uint32_t t = 0; t < surface->triangle_count; t++) {
		const uint32_t *corners = surface->triangles[t];

		passed += area_of(surface, t);
		for (; count < POINTS && (count + 0.5) * all / POINTS <= passed; count++) {
			float u = sqrtf(spread(count + 1, 2)), v = spread(count + 1, 3);

			for (int i = 0; i < 3; i++)
				points[count][i] = (1 - u) * surface->positions[corners[0]][i] +
						   u * (1 - v) * surface->positions[corners[1]][i] +
						   u * v * surface->positions[corners[2]][i];
		}
	}
	for (; count > 0 && count < POINTS; count++)
		memcpy(points[count], points[count - 1], sizeof(*points));
	return points;
}

struct distances {
	const struct surface *to;
	float (*points)[3];
	float *metres;
};

static inline int measure_piece(void *user, uint32_t piece, uint32_t thread)
{
	const struct distances *distances = user;

	(void)thread;
	for (uint32_t p = piece * PIECE_POINTS; p < POINTS && p < (piece + 1) * PIECE_POINTS; p++) {
		struct nearest_place place;

		nearest_find(distances->to->nearest, distances->points[p], NULL, INFINITY, &place);
		distances->metres[p] = place.distance_m;
	}
	return 0;
}

struct error {
	double rms_mm, max_mm;
};

/* From one surface to another. */
static inline struct error error_between(const struct surface *from, const struct surface *to)
{
	struct distances distances = { to, spread_points(from),
				       need(malloc(POINTS * sizeof(float))) };
	struct error error = { 0, 0 };

	need_ok(parallel_run(parallel_cores(), POINTS / PIECE_POINTS + 1, measure_piece,
			     &distances),
		"distances");
	for (uint32_t p = 0; p < POINTS; p++) {
		double mm = 1000 * (double)distances.metres[p];

		error.rms_mm += mm * mm / POINTS;
		error.max_mm = mm > error.max_mm ? mm : error.max_mm;
	}
	error.rms_mm = sqrt(error.rms_mm);
	free(distances.points);
	free(distances.metres);
	return error;
}

static inline void print_errors(const char *name, struct surface *surface,
				const struct surface *scan)
{
	struct error out, back;

	surface_index(surface);
	out = error_between(scan, surface);
	back = error_between(surface, scan);
	nearest_destroy(surface->nearest);
	printf("\"%s\": {\"triangles\": %u, \"rms_mm\": %.3f, \"max_mm\": %.1f, "
	       "\"back_rms_mm\": %.3f, \"back_max_mm\": %.1f}",
	       name, surface->triangle_count, out.rms_mm, out.max_mm, back.rms_mm, back.max_mm);
	fflush(stdout);
}

#endif
