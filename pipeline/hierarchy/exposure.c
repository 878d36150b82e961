/* Estimates the visibility of vertices: converts the scan to voxels and casts rays through them
 * from each vertex to a few viewpoints. */
#include "pipeline/hierarchy/exposure.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/parallel.h"
#include "base/progress.h"

enum {
	SIDE = 256, /* voxels along the longest axis */
	VOXEL_STEPS = 65536 / SIDE,
	VIEWPOINTS = 8, /* per vertex; neighbours have others, so a patch has many */
	PIECE_VERTICES = 4096
};

struct exposure {
	struct lattice_mesh *mesh;
	uint8_t *solid;            /* one bit per voxel, x fastest: material or enclosed by it */
	float low[3], high[3];     /* bounding box of the model, in voxels */
	struct progress *progress; /* counts vertices */
};

static void place_of(float out[3], const struct lattice_vertex *vertex)
{
	for (int k = 0; k < 3; k++)
		out[k] = (float)vertex->position[k] / VOXEL_STEPS;
}

static uint32_t bit_of(const int voxel[3])
{
	return (uint32_t)((voxel[2] * SIDE + voxel[1]) * SIDE + voxel[0]);
}

static bool is_solid(const struct exposure *exposure, const int voxel[3])
{
	uint32_t bit = bit_of(voxel);

	return exposure->solid[bit / 8] >> bit % 8 & 1;
}

/* Marks the voxels of sample points on the triangle, at most half a voxel apart. */
static void fill_triangle(struct exposure *exposure, const uint32_t triangle[3])
{
	float at[3][3], longest = 0;
	uint32_t parts;

	for (int c = 0; c < 3; c++)
		place_of(at[c], &exposure->mesh->vertices[triangle[c]]);
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < 3; k++)
			longest = fmaxf(longest, fabsf(at[c][k] - at[(c + 1) % 3][k]));
	parts = 1 + (uint32_t)(2 * longest);
	for (uint32_t u = 0; u <= parts; u++)
		for (uint32_t v = 0; u + v <= parts; v++) {
			float a = (float)u / (float)parts, b = (float)v / (float)parts;
			int voxel[3];
			uint32_t bit;

			for (int k = 0; k < 3; k++) {
				float x = at[0][k] + a * (at[1][k] - at[0][k]) +
					  b * (at[2][k] - at[0][k]);

				voxel[k] = (int)fminf(fmaxf(x, 0), SIDE - 1);
			}
			bit = bit_of(voxel);
			exposure->solid[bit / 8] |= (uint8_t)(1u << bit % 8);
		}
}

struct queue {
	uint32_t *bits, count, room;
};

static int reach(struct queue *queue, uint8_t *reached, const struct exposure *exposure,
		 const int voxel[3])
{
	uint32_t bit = bit_of(voxel);

	if ((exposure->solid[bit / 8] | reached[bit / 8]) >> bit % 8 & 1)
		return 0;
	if (queue->count == queue->room) {
		uint32_t room = 2 * queue->room + 4096;
		uint32_t *grown = realloc(queue->bits, room * sizeof(*grown));

		if (!grown)
			return -ENOMEM;
		queue->bits = grown;
		queue->room = room;
	}
	reached[bit / 8] |= (uint8_t)(1u << bit % 8);
	queue->bits[queue->count++] = bit;
	return 0;
}

static int reach_sides_and_top(struct queue *queue, uint8_t *reached,
			       const struct exposure *exposure)
{
	int rc = 0;

	for (int i = 0; i < SIDE; i++)
		for (int j = 0; rc == 0 && j < SIDE; j++) {
			const int starts[5][3] = { { 0, i, j },
						   { SIDE - 1, i, j },
						   { i, 0, j },
						   { i, SIDE - 1, j },
						   { i, j, SIDE - 1 } };

			for (int k = 0; rc == 0 && k < 5; k++)
				rc = reach(queue, reached, exposure, starts[k]);
		}
	return rc;
}

/* Marks enclosed air as solid: no camera gets there. Examples are hollow towers and statues that
 * are open below. */
static int close_hollows(struct exposure *exposure)
{
	uint8_t *reached = calloc(SIDE * SIDE / 8, SIDE);
	struct queue queue = { 0 };
	int rc = reached ? reach_sides_and_top(&queue, reached, exposure) : -ENOMEM;

	while (rc == 0 && queue.count > 0) {
		uint32_t bit = queue.bits[--queue.count];
		int at[3] = { (int)(bit % SIDE), (int)(bit / SIDE % SIDE),
			      (int)(bit / (SIDE * SIDE)) };

		for (int k = 0; k < 3; k++)
			for (int step = -1; rc == 0 && step < 2; step += 2) {
				int to[3] = { at[0], at[1], at[2] };

				to[k] += step;
				if (to[k] >= 0 && to[k] < SIDE)
					rc = reach(&queue, reached, exposure, to);
			}
	}
	for (uint32_t i = 0; rc == 0 && i < SIDE * SIDE / 8 * SIDE; i++)
		exposure->solid[i] = (uint8_t)~reached[i];
	free(queue.bits);
	free(reached);
	return rc;
}

/* Traces a ray through the voxels between two points (Amanatides and Woo 1987). Returns true if no
 * solid voxel is on the way. */
static bool is_free(const struct exposure *exposure, const float from[3], const float to[3])
{
	int at[3], step[3];
	float next[3],
		each[3]; /* ray parameter (0..1) at which the next voxel of each axis begins */

	for (int k = 0; k < 3; k++) {
		float d = to[k] - from[k], below = from[k] - floorf(from[k]);

		at[k] = (int)floorf(from[k]);
		step[k] = d < 0 ? -1 : 1;
		each[k] = d == 0 ? INFINITY : 1 / fabsf(d);
		next[k] = d == 0 ? INFINITY : (d < 0 ? below : 1 - below) * each[k];
	}
	for (;;) {
		int k = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : next[1] < next[2] ? 1 : 2;

		for (int i = 0; i < 3; i++)
			if (at[i] < 0 || at[i] >= SIDE)
				return true;
		if (is_solid(exposure, at))
			return false;
		if (!(next[k] < 1))
			return true;
		at[k] += step[k];
		next[k] += each[k];
	}
}

/* The n-th viewpoint of a vertex, in the box of twice the model's size above its lowest point. It
 * is a low-discrepancy sequence: multiples of powers of a root of x^4 = x + 1, as the golden ratio
 * is used in one dimension. It starts elsewhere for each vertex. */
static void viewpoint(float out[3], const struct exposure *exposure, uint32_t vertex, uint32_t n)
{
	static const float steps[3] = { 0.8191725f, 0.6710436f, 0.5497005f };
	static const uint32_t starts[3] = { 2654435761u, 2246822519u, 3266489917u };

	for (int k = 0; k < 3; k++) {
		float low = exposure->low[k], half = (exposure->high[k] - low) / 2;
		float start = (float)((vertex + 1) * starts[k] >> 8) / 16777216.0f;
		float t = fmodf(start + steps[k] * (float)n, 1.0f);

		out[k] = k == 2 ? low + t * 3 * half : low - half + t * 4 * half;
	}
}

static float seen_of(const struct exposure *exposure, uint32_t v)
{
	const struct lattice_vertex *vertex = &exposure->mesh->vertices[v];
	float at[3], seen = 0;

	place_of(at, vertex);
	for (uint32_t n = 0; n < VIEWPOINTS; n++) {
		float eye[3], from[3], cosine = 0, square = 0;

		viewpoint(eye, exposure, v, n);
		for (int k = 0; k < 3; k++) {
			cosine += (eye[k] - at[k]) * vertex->normal[k];
			square += (eye[k] - at[k]) * (eye[k] - at[k]);
		}
		/* Start outside the voxels that the surface itself fills, on the side of the
		 * viewpoint: the orientation of scans is not always right. */
		for (int k = 0; k < 3; k++)
			from[k] = at[k] + (cosine < 0 ? -1.5f : 1.5f) * vertex->normal[k];
		if (square > 0 && is_free(exposure, from, eye))
			seen += fabsf(cosine) / sqrtf(square);
	}
	return fminf(1, 2 * seen / VIEWPOINTS);
}

static int find_piece(void *user, uint32_t piece, uint32_t worker)
{
	struct exposure *exposure = user;
	struct lattice_mesh *mesh = exposure->mesh;
	uint32_t first = piece * PIECE_VERTICES, left = mesh->vertex_count - first;
	uint32_t count = left < PIECE_VERTICES ? left : PIECE_VERTICES;

	(void)worker;
	for (uint32_t v = first; v < first + count; v++)
		mesh->vertices[v].seen = (uint8_t)(255 * seen_of(exposure, v) + 0.5f);
	progress_add(exposure->progress, count);
	return 0;
}

static void find_box(struct exposure *exposure)
{
	for (uint32_t v = 0; v < exposure->mesh->vertex_count; v++) {
		float at[3];

		place_of(at, &exposure->mesh->vertices[v]);
		for (int k = 0; k < 3; k++) {
			exposure->low[k] = fminf(exposure->low[k], at[k]);
			exposure->high[k] = fmaxf(exposure->high[k], at[k]);
		}
	}
}

int exposure_find(struct lattice_mesh *mesh, uint32_t jobs)
{
	struct exposure exposure = {
		.mesh = mesh,
		.solid = calloc(SIDE * SIDE / 8, SIDE),
		.low = { SIDE, SIDE, SIDE },
	};
	uint32_t pieces = (mesh->vertex_count + PIECE_VERTICES - 1) / PIECE_VERTICES;
	int rc;

	if (!exposure.solid)
		return -ENOMEM;
	find_box(&exposure);
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		fill_triangle(&exposure, mesh->triangles[t]);
	rc = close_hollows(&exposure);
	exposure.progress = progress_start("looking", "vertices", mesh->vertex_count);
	if (rc == 0)
		rc = parallel_run(jobs, pieces, find_piece, &exposure);
	progress_end(exposure.progress);
	free(exposure.solid);
	return rc;
}
