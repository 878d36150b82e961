/* Membership, 1 or 0, is averaged twice from triangles to their vertices (weighted by area) and
 * back; then a triangle belongs to the region if it has more than a half. This is repeated. Only
 * triangles near the border can change, so averages are kept for the vertices near it alone. */
#include "curator/region/region_smooth.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/spill.h"
#include "geometry/vec.h"

/* Sums over the triangles of a vertex: of area, and of area times membership. */
struct average {
	float all_m2, in_m2, in_again_m2;
};

struct border {
	uint64_t *in, *out;       /* for each vertex, whether a triangle in or out of the region has
				     it */
	uint64_t *near;           /* whether a triangle that touches both has it */
	uint32_t *first;          /* for each word of near, how many vertices come before it */
	struct average *averages; /* of the near vertices, in the order of their numbers */
	uint32_t word_count;
};

static bool has(const uint64_t *bits, uint32_t n)
{
	return bits[n / 64] >> n % 64 & 1;
}

static void put_corners(uint64_t *bits, const uint32_t corners[3])
{
	for (int k = 0; k < 3; k++)
		bits[corners[k] / 64] |= (uint64_t)1 << corners[k] % 64;
}

static void border_finish(struct border *border)
{
	free(border->in);
	free(border->out);
	free(border->near);
	free(border->first);
	free(border->averages);
}

static int border_init(struct border *border, const struct mesh *mesh)
{
	const size_t bytes = (mesh->vertex_count / 64 + 1) * sizeof(uint64_t);

	*border = (struct border){ .word_count = mesh->vertex_count / 64 + 1 };
	border->in = malloc(bytes);
	border->out = malloc(bytes);
	border->near = malloc(bytes);
	border->first = malloc(bytes / 2);
	return border->in && border->out && border->near && border->first ? 0 : -ENOMEM;
}

static bool is_on_border(const struct border *border, const uint32_t corners[3])
{
	for (int k = 0; k < 3; k++)
		if (has(border->in, corners[k]) && has(border->out, corners[k]))
			return true;
	return false;
}

/* Returns the average of a near vertex. */
static struct average *average_of(const struct border *border, uint32_t vertex)
{
	const uint64_t below = ((uint64_t)1 << vertex % 64) - 1;
	const uint32_t w = vertex / 64;

	return &border->averages[border->first[w] +
				 (uint32_t)__builtin_popcountll(border->near[w] & below)];
}

/* Finds the vertices near the border and makes room for their averages. */
static int find_border(struct border *border, const struct region_set *set, const struct mesh *mesh)
{
	uint32_t count = 0;

	memset(border->in, 0, border->word_count * sizeof(*border->in));
	memset(border->out, 0, border->word_count * sizeof(*border->out));
	memset(border->near, 0, border->word_count * sizeof(*border->near));
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		put_corners(has(set->wanted, t) ? border->in : border->out, mesh->triangles[t]);
		spill_pass(t);
	}
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		if (is_on_border(border, mesh->triangles[t]))
			put_corners(border->near, mesh->triangles[t]);
		spill_pass(t);
	}
	for (uint32_t w = 0; w < border->word_count; w++) {
		border->first[w] = count;
		count += (uint32_t)__builtin_popcountll(border->near[w]);
	}
	free(border->averages);
	border->averages = calloc(count + 1, sizeof(*border->averages));
	return border->averages ? 0 : -ENOMEM;
}

static float area_m2(const struct mesh *mesh, const uint32_t corners[3])
{
	float a[3], b[3], normal[3];

	vec_sub(a, mesh->positions[corners[1]], mesh->positions[corners[0]]);
	vec_sub(b, mesh->positions[corners[2]], mesh->positions[corners[0]]);
	vec_cross(normal, a, b);
	return vec_length(normal) / 2;
}

/* Returns the mean of the corners' averages: of the first or of the second round. */
static float mean(const struct border *border, const uint32_t corners[3], bool again)
{
	float sum = 0;

	for (int k = 0; k < 3; k++) {
		const struct average *average;

		if (!has(border->near, corners[k])) {
			sum += has(border->in, corners[k]) ? 1 : 0;
			continue;
		}
		average = average_of(border, corners[k]);
		if (average->all_m2 > 0)
			sum += (again ? average->in_again_m2 : average->in_m2) / average->all_m2;
		else
			sum += 0.5f;
	}
	return sum / 3;
}

static bool is_near(const struct border *border, const uint32_t corners[3])
{
	return has(border->near, corners[0]) || has(border->near, corners[1]) ||
	       has(border->near, corners[2]);
}

/* From triangles to vertices: first their membership, then what came back from the vertices. */
static void add_up(const struct border *border, const struct region_set *set,
		   const struct mesh *mesh, bool again)
{
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const uint32_t *corners = mesh->triangles[t];
		float area, share;

		spill_pass(t);
		if (!is_near(border, corners))
			continue;
		area = area_m2(mesh, corners);
		share = again ? mean(border, corners, false) : has(set->wanted, t);
		for (int k = 0; k < 3; k++) {
			struct average *average;

			if (!has(border->near, corners[k]))
				continue;
			average = average_of(border, corners[k]);
			average->all_m2 += again ? 0 : area;
			*(again ? &average->in_again_m2 : &average->in_m2) += area * share;
		}
	}
}

static void decide(const struct border *border, struct region_set *set, const struct mesh *mesh)
{
	/* Within rounding of a half, a triangle stays what it is. */
	static const float rounding = 1e-4f;

	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const uint32_t *corners = mesh->triangles[t];

		spill_pass(t);
		if (is_near(border, corners)) {
			const float over = mean(border, corners, true) - 0.5f;

			if (fabsf(over) > rounding)
				region_set_put(set, t, over > 0);
		}
	}
}

int region_set_smooth(struct region_set *set, const struct mesh *mesh)
{
	struct border border;
	int rc = border_init(&border, mesh);

	region_set_begin(set);
	for (int pass = 0; rc == 0 && pass < REGION_SMOOTH_PASSES; pass++) {
		rc = find_border(&border, set, mesh);
		if (rc == 0) {
			add_up(&border, set, mesh, false);
			add_up(&border, set, mesh, true);
			decide(&border, set, mesh);
		}
	}
	border_finish(&border);
	return rc == 0 ? region_set_commit(set) : rc;
}
