/* Prepares the parts for labelling: bounding spheres, areas and outlines, with search trees for the
 * nearest surface and the nearest outline. */
#include "pipeline/release/label_source.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "geometry/vec.h"
#include "pipeline/import/mesh_edges.h"

/* The outline of a part that is a list of triangles: the edges that an odd number of its triangles
 * share. */
struct outline {
	uint32_t (*edges)[3]; /* owned; triangles of zero width */
	uint32_t count, room;
	bool failed;
	struct nearest *nearest;
};

struct label_source {
	const struct mesh *mesh;
	struct nearest *surface;
	struct label_source_part *parts; /* owned */
	struct outline *outlines;        /* owned; one per part */
	uint32_t part_count;
	float spacing_m;
};

/* ---- building */

static void note_edge(void *data, const struct mesh_edge *edge)
{
	struct outline *outline = data;

	if (edge->face_count % 2 == 0 || outline->failed)
		return;
	if (ARRAY_RESERVE(outline->edges, outline->room, outline->count + 1, UINT32_MAX) < 0) {
		outline->failed = true;
		return;
	}
	outline->edges[outline->count][0] = edge->ends[0];
	outline->edges[outline->count][1] = edge->ends[1];
	outline->edges[outline->count++][2] = edge->ends[1];
}

/* Copies the part's triangles, each with vertices of its own: what follows then does not grow with
 * the whole scan. */
static int copy_triangles(struct mesh *out, const struct mesh *mesh,
			  const struct label_source_part *part)
{
	size_t corners = (size_t)part->triangle_count * 3;

	if (corners >> 31)
		return -EFBIG;
	*out = (struct mesh){ .vertex_count = (uint32_t)corners,
			      .triangle_count = part->triangle_count,
			      .positions = malloc((corners + 1) * sizeof(*out->positions)),
			      .triangles = malloc((corners + 1) * sizeof(uint32_t)) };
	if (!out->positions || !out->triangles)
		return -ENOMEM;
	for (uint32_t i = 0; i < corners; i++) {
		uint32_t vertex = mesh->triangles[part->triangles[i / 3]][i % 3];

		memcpy(out->positions[i], mesh->positions[vertex], sizeof(out->positions[i]));
		out->triangles[i / 3][i % 3] = i;
	}
	return 0;
}

/* An open border of the scan also counts as outline here; nothing beyond it could be outside. */
static int find_outline(struct outline *outline, const struct mesh *mesh,
			const struct label_source_part *part)
{
	struct mesh own;
	struct mesh_edges edges = { 0 };
	int rc = copy_triangles(&own, mesh, part);

	if (rc == 0)
		rc = mesh_edges_init(&edges, &own, 1);
	if (rc == 0)
		rc = mesh_edges_each(&edges, note_edge, outline);
	if (rc == 0 && outline->failed)
		rc = -ENOMEM;
	for (uint32_t i = 0; i < outline->count; i++)
		for (int k = 0; k < 3; k++) {
			uint32_t corner = outline->edges[i][k];

			outline->edges[i][k] =
				mesh->triangles[part->triangles[corner / 3]][corner % 3];
		}
	if (rc == 0)
		rc = nearest_create(&outline->nearest, mesh->positions, outline->edges,
				    outline->count);
	mesh_edges_finish(&edges);
	mesh_finish(&own);
	return rc;
}

static double triangle_area(const struct mesh *mesh, uint32_t triangle, float centre[3])
{
	const uint32_t *t = mesh->triangles[triangle];
	float ab[3], ac[3], cross[3];

	vec_sub(ab, mesh->positions[t[1]], mesh->positions[t[0]]);
	vec_sub(ac, mesh->positions[t[2]], mesh->positions[t[0]]);
	vec_cross(cross, ab, ac);
	for (int i = 0; i < 3; i++)
		centre[i] = mesh->positions[t[0]][i] + (ab[i] + ac[i]) / 3;
	return vec_length(cross) / 2;
}

static void bound_box(struct label_source_part *part, const float low[3], const float high[3])
{
	float diagonal[3];

	for (int i = 0; i < 3; i++)
		part->centre_m[i] = (low[i] + high[i]) / 2;
	vec_sub(diagonal, high, low);
	part->radius_m = vec_length(diagonal) / 2;
}

static void bound_prism(struct label_source_part *part)
{
	const struct region *region = &part->region;
	float low[3] = { INFINITY, INFINITY, region->floor_m };
	float high[3] = { -INFINITY, -INFINITY, region->roof_m };

	for (uint32_t i = 0; i < region->corner_count; i++)
		for (int k = 0; k < 2; k++) {
			low[k] = fminf(low[k], region->corners_m[i][k]);
			high[k] = fmaxf(high[k], region->corners_m[i][k]);
		}
	bound_box(part, low, high);
}

static void bound_triangles(struct label_source_part *part, const struct mesh *mesh)
{
	float low[3] = { INFINITY, INFINITY, INFINITY };
	float high[3] = { -INFINITY, -INFINITY, -INFINITY };

	for (uint32_t i = 0; i < part->triangle_count; i++)
		for (int k = 0; k < 3; k++) {
			const float *at = mesh->positions[mesh->triangles[part->triangles[i]][k]];

			for (int axis = 0; axis < 3; axis++) {
				low[axis] = fminf(low[axis], at[axis]);
				high[axis] = fmaxf(high[axis], at[axis]);
			}
		}
	bound_box(part, low, high);
}

static void bound(struct label_source_part *part, const struct mesh *mesh)
{
	if (part->triangles) {
		bound_triangles(part, mesh);
		return;
	}
	memcpy(part->centre_m, part->region.centre_m, sizeof(part->centre_m));
	part->radius_m = part->region.radius_m;
	if (part->region.kind == REGION_BOX)
		part->radius_m = vec_length(part->region.half_m);
	if (part->region.kind == REGION_PRISM)
		bound_prism(part);
}

/* Measures the areas of all volumes in one pass over the scan, and of triangle lists. */
static int measure(struct label_source *source)
{
	double *areas = calloc(source->part_count + 1, sizeof(*areas));
	float centre[3];
	double all = 0;

	if (!areas)
		return -ENOMEM;
	for (uint32_t t = 0; t < source->mesh->triangle_count; t++) {
		double area = triangle_area(source->mesh, t, centre);

		all += area;
		for (uint32_t p = 0; p < source->part_count; p++) {
			const struct label_source_part *part = &source->parts[p];

			if (!part->triangles &&
			    vec_distance(centre, part->centre_m) <= part->radius_m &&
			    region_contains(&part->region, centre))
				areas[p] += area;
		}
	}
	for (uint32_t p = 0; p < source->part_count; p++) {
		struct label_source_part *part = &source->parts[p];

		for (uint32_t i = 0; part->triangles && i < part->triangle_count; i++)
			areas[p] += triangle_area(source->mesh, part->triangles[i], centre);
		part->area_m2 = (float)areas[p];
	}
	source->spacing_m = (float)sqrt(2 * all / (source->mesh->triangle_count + 1.0));
	free(areas);
	return 0;
}

int label_source_create(struct label_source **out, const struct mesh *mesh,
			const struct label_source_part *parts, uint32_t part_count)
{
	struct label_source *source = calloc(1, sizeof(*source));
	int rc;

	*out = NULL;
	if (!source)
		return -ENOMEM;
	source->mesh = mesh;
	source->parts = calloc(part_count + 1, sizeof(*source->parts));
	source->outlines = calloc(part_count + 1, sizeof(*source->outlines));
	rc = source->parts && source->outlines ? 0 : -ENOMEM;
	if (rc == 0) {
		source->part_count = part_count;
		memcpy(source->parts, parts, part_count * sizeof(*parts));
		rc = nearest_create(&source->surface, mesh->positions, mesh->triangles,
				    mesh->triangle_count);
	}
	for (uint32_t p = 0; rc == 0 && p < part_count; p++) {
		bound(&source->parts[p], mesh);
		if (source->parts[p].triangles)
			rc = find_outline(&source->outlines[p], mesh, &source->parts[p]);
	}
	if (rc == 0)
		rc = measure(source);
	if (rc < 0) {
		label_source_destroy(source);
		return rc;
	}
	*out = source;
	return 0;
}

void label_source_destroy(struct label_source *source)
{
	if (!source)
		return;
	for (uint32_t p = 0; p < source->part_count; p++) {
		nearest_destroy(source->outlines[p].nearest);
		free(source->outlines[p].edges);
	}
	nearest_destroy(source->surface);
	free(source->outlines);
	free(source->parts);
	free(source);
}

uint32_t label_source_part_count(const struct label_source *source)
{
	return source->part_count;
}

float label_source_spacing_m(const struct label_source *source)
{
	return source->spacing_m;
}

const struct label_source_part *label_source_part(const struct label_source *source, uint32_t part)
{
	return &source->parts[part];
}

/* ---- queries */

void label_source_place(const struct label_source *source, const float point_m[3],
			const float normal[3], float off_m, struct nearest_place *out)
{
	struct nearest_place same;

	nearest_find(source->surface, point_m, NULL, INFINITY, out);
	/* If it is much farther away, it is another place and not the other side of a wall. */
	if (!nearest_faces(source->surface, out->triangle, normal) &&
	    nearest_find(source->surface, point_m, normal, fmaxf(3 * out->distance_m, off_m),
			 &same))
		*out = same;
}

static bool has_triangle(const struct label_source_part *part, uint32_t triangle)
{
	uint32_t low = 0, high = part->triangle_count;

	while (low < high) {
		uint32_t middle = (low + high) / 2;

		if (part->triangles[middle] < triangle)
			low = middle + 1;
		else
			high = middle;
	}
	return low < part->triangle_count && part->triangles[low] == triangle;
}

float label_source_within(const struct label_source *source, uint32_t part,
			  const struct nearest_place *place, float most_m)
{
	const struct label_source_part *p = &source->parts[part];
	struct nearest_place border;
	float away = most_m;

	if (!p->triangles)
		return -region_distance(&p->region, place->at_m);
	if (nearest_find(source->outlines[part].nearest, place->at_m, NULL, most_m, &border))
		away = border.distance_m;
	return has_triangle(p, place->triangle) ? away : -away;
}
