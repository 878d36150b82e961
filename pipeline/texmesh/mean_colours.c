/* Finds for each vertex of the scan the nearest one that is left (Dijkstra's search along edges
 * from all of them at once), and averages. */
#include "pipeline/texmesh/mean_colours.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "geometry/search_queue.h"
#include "geometry/srgb.h"
#include "geometry/vec.h"

enum { CHANNELS = 4 }; /* light of three colours, open sky */

#define NOBODY UINT32_MAX

struct search {
	const struct reduced_mesh *whole;
	uint32_t *firsts; /* of the corners around each vertex, and their end; one spare to count */
	uint32_t *corners; /* numbers of corners: three times the triangle, and which */
	float *distances;  /* to the nearest vertex that is left */
	uint32_t *owners;  /* that vertex, as the reduced mesh counts it; NOBODY: not reached */
	struct search_queue queue;
};

/* What a vertex that is left stands for. */
struct sum {
	double channels[CHANNELS], area;
};

static void search_finish(struct search *search)
{
	free(search->firsts);
	free(search->corners);
	free(search->distances);
	free(search->owners);
	search_queue_finish(&search->queue);
}

/* Sorts all corners by their vertex. */
static void sort_corners(struct search *search)
{
	const struct reduced_mesh *whole = search->whole;
	const uint32_t count = 3 * whole->triangle_count;
	const uint32_t *vertex = whole->triangles[0];
	uint32_t *firsts = search->firsts;

	for (uint32_t c = 0; c < count; c++)
		firsts[vertex[c] + 2]++;
	for (uint32_t v = 0; v < whole->vertex_count; v++)
		firsts[v + 2] += firsts[v + 1];
	for (uint32_t c = 0; c < count; c++)
		search->corners[firsts[vertex[c] + 1]++] = c;
}

static int search_begin(struct search *search, const struct reduced_mesh *whole,
			const struct reduced_mesh *reduced)
{
	const size_t vertices = whole->vertex_count;
	int rc = 0;

	*search = (struct search){ .whole = whole };
	search->firsts = calloc(vertices + 2, sizeof(*search->firsts));
	search->corners = malloc((3 * (size_t)whole->triangle_count + 1) * sizeof(uint32_t));
	search->distances = malloc((vertices + 1) * sizeof(*search->distances));
	search->owners = malloc((vertices + 1) * sizeof(*search->owners));
	if (!search->firsts || !search->corners || !search->distances || !search->owners)
		return -ENOMEM;
	sort_corners(search);
	for (uint32_t v = 0; v < whole->vertex_count; v++) {
		search->owners[v] = NOBODY;
		search->distances[v] = INFINITY;
	}
	for (uint32_t v = 0; v < reduced->vertex_count && rc == 0; v++) {
		search->owners[reduced->origins[v]] = v;
		search->distances[reduced->origins[v]] = 0;
		rc = search_queue_add(&search->queue, 0, reduced->origins[v]);
	}
	return rc;
}

/* Goes on to a neighbour. */
static int step(struct search *search, uint32_t from, uint32_t to)
{
	const float(*at)[3] = (const float(*)[3])search->whole->positions;
	const float distance = search->distances[from] + vec_distance(at[from], at[to]);

	if (!(distance < search->distances[to]))
		return 0;
	search->distances[to] = distance;
	search->owners[to] = search->owners[from];
	return search_queue_add(&search->queue, distance, to);
}

static int search_all(struct search *search)
{
	int rc = 0;

	while (search->queue.count > 0 && rc == 0) {
		const float cost = search->queue.entries[0].cost;
		const uint32_t v = search_queue_take(&search->queue);

		/* what was reached by a shorter way since does not go on from here */
		for (uint32_t i = search->firsts[v];
		     cost <= search->distances[v] && i < search->firsts[v + 1] && rc == 0; i++) {
			const uint32_t corner = search->corners[i];
			const uint32_t *triangle = search->whole->triangles[corner / 3];

			rc = step(search, v, triangle[(corner + 1) % 3]);
			if (rc == 0)
				rc = step(search, v, triangle[(corner + 2) % 3]);
		}
	}
	return rc;
}

static void add(struct sum *sum, const uint8_t colour[4], const float light[256], float area)
{
	for (int k = 0; k < 3; k++)
		sum->channels[k] += (double)area * light[colour[k]];
	sum->channels[3] += (double)area * colour[3];
	sum->area += area;
}

/* Each corner of a triangle counts by a third of its area. */
static void sum_up(struct sum *sums, const struct search *search)
{
	const struct reduced_mesh *whole = search->whole;
	const float(*at)[3] = (const float(*)[3])whole->positions;
	float light[256];

	for (int i = 0; i < 256; i++)
		light[i] = srgb_to_light((float)i / 255);
	for (uint32_t t = 0; t < whole->triangle_count; t++) {
		const uint32_t *v = whole->triangles[t];
		float a[3], b[3], across[3];

		vec_sub(a, at[v[1]], at[v[0]]);
		vec_sub(b, at[v[2]], at[v[0]]);
		vec_cross(across, a, b);
		for (int k = 0; k < 3; k++)
			if (search->owners[v[k]] != NOBODY)
				add(&sums[search->owners[v[k]]], whole->colours[v[k]], light,
				    vec_length(across));
	}
}

static void set_colour(uint8_t out[4], const struct sum *sum)
{
	if (!(sum->area > 0)) /* of triangles without area: its own */
		return;
	for (int k = 0; k < 3; k++)
		out[k] = (uint8_t)lroundf(255 *
					  srgb_of_light((float)(sum->channels[k] / sum->area)));
	out[3] = (uint8_t)lround(sum->channels[3] / sum->area);
}

int mean_colours(struct reduced_mesh *reduced, const struct reduced_mesh *whole)
{
	struct sum *sums = calloc((size_t)reduced->vertex_count + 1, sizeof(*sums));
	struct search search;
	int rc = search_begin(&search, whole, reduced);

	if (rc == 0)
		rc = sums ? search_all(&search) : -ENOMEM;
	if (rc == 0)
		sum_up(sums, &search);
	for (uint32_t v = 0; v < reduced->vertex_count && rc == 0; v++)
		set_colour(reduced->colours[v], &sums[v]);
	search_finish(&search);
	free(sums);
	return rc;
}
