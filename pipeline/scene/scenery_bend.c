/* Computes normals of a surface in each of its shapes, and lets corners share a vertex that are one
 * point, of one colour and one place of the picture, with one normal in all shapes. */
#include "pipeline/scene/scenery_bend.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/map.h"
#include "format/hash.h"
#include "format/normal.h"
#include "geometry/vec.h"
#include "pipeline/scene/scenery_mesh.h"

struct bending {
	const struct soup *soup;
	const struct scenery_bend *bend;
	struct scenery_mesh *mesh;
	struct scenery_corner (*corners)[3]; /* owned; of the shape that is at hand */
	/* owned; at rest, and then shape by shape: of each corner */
	struct scenery_shape_vertex *all;
	struct map vertices; /* by hash */
	uint32_t vertex_room, uv_room;
	bool has_picture;
};

/* Returns the place of a corner in a shape; the rest is shape 0, the first shape 1. */
static const float *place_of(const struct bending *b, uint32_t shape, uint32_t triangle, int corner)
{
	const uint32_t point = b->soup->sources[triangle][corner];

	if (shape == 0)
		return b->soup->triangles[triangle].corners[corner].position;
	return b->bend->places[(size_t)(shape - 1) * b->bend->point_count + point];
}

/* Sets the lattice, which holds all shapes. */
static int measure(const struct bending *b)
{
	struct scenery_mesh *mesh = b->mesh;
	float high[3], longest = 0;

	vec_copy(mesh->origin_m, place_of(b, 0, 0, 0));
	vec_copy(high, mesh->origin_m);
	for (uint32_t shape = 0; shape <= b->bend->shape_count; shape++)
		for (uint32_t i = 0; i < 3 * b->soup->count; i++) {
			const float *at = place_of(b, shape, i / 3, (int)(i % 3));

			for (int k = 0; k < 3; k++) {
				if (!isfinite(at[k]))
					return -EBADMSG;
				mesh->origin_m[k] = vec_least(mesh->origin_m[k], at[k]);
				high[k] = vec_most(high[k], at[k]);
			}
		}
	for (int k = 0; k < 3; k++)
		longest = vec_most(longest, high[k] - mesh->origin_m[k]);
	/* The last place must not round past its 16 bits. */
	mesh->step_m = longest / (SCENERY_PLACE_MAX - 1);
	return mesh->step_m > 0 && isfinite(mesh->step_m) ? 0 : -EBADMSG;
}

static int take_shape(struct bending *b, uint32_t shape, float crease_rad)
{
	const uint32_t count = 3 * b->soup->count;
	const struct scenery_mesh *mesh = b->mesh;
	int rc;

	for (uint32_t i = 0; i < count; i++)
		vec_copy(b->corners[i / 3][i % 3].position,
			 place_of(b, shape, i / 3, (int)(i % 3)));
	rc = scenery_smooth(b->corners, b->soup->count, crease_rad);
	for (uint32_t i = 0; i < count && rc == 0; i++) {
		const struct scenery_corner *corner = &b->corners[i / 3][i % 3];
		struct scenery_shape_vertex *to = &b->all[(size_t)shape * count + i];

		for (int k = 0; k < 3; k++)
			to->place[k] = (uint16_t)lrintf((corner->position[k] - mesh->origin_m[k]) /
							mesh->step_m);
		normal_encode(to->normal, corner->normal);
	}
	return rc;
}

/* Sets the lattice of where pictures lie. */
static void measure_uvs(const struct bending *b)
{
	float low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };

	for (uint32_t i = 0; i < 3 * b->soup->count; i++) {
		float uv[2];

		scenery_uv(uv, &b->soup->triangles[i / 3].corners[i % 3]);
		for (int k = 0; k < 2; k++) {
			low[k] = vec_least(low[k], uv[k]);
			high[k] = vec_most(high[k], uv[k]);
		}
	}
	scenery_uv_lattice(b->mesh, low, high);
}

static void uv_of(uint16_t out[2], const struct bending *b, uint32_t corner)
{
	float uv[2];

	scenery_uv(uv, &b->soup->triangles[corner / 3].corners[corner % 3]);
	scenery_uv_encode(out, b->mesh, uv);
}

enum { KEY_BYTES = 3 + 2 * sizeof(uint16_t) /* beside the shapes */ };

/* Everything about a corner, as a hash. */
static map_key key_of(const struct bending *b, uint32_t corner, uint8_t *scratch)
{
	const size_t count = 3 * (size_t)b->soup->count;
	const uint32_t shapes = b->bend->shape_count + 1;
	const uint8_t *rgb = b->soup->triangles[corner / 3].corners[corner % 3].rgb;
	uint16_t uv[2] = { 0 };
	size_t at = KEY_BYTES;

	if (b->has_picture)
		uv_of(uv, b, corner);
	memcpy(scratch, rgb, 3);
	memcpy(scratch + 3, uv, sizeof(uv));
	for (uint32_t s = 0; s < shapes; s++, at += sizeof(*b->all))
		memcpy(scratch + at, &b->all[s * count + corner], sizeof(*b->all));
	return hash_key(hash_of((struct bytes){ scratch, at }));
}

static int find_vertex(struct bending *b, uint32_t corner, uint32_t *firsts, uint8_t *scratch,
		       uint16_t *number)
{
	struct scenery_mesh *mesh = b->mesh;
	const map_key key = key_of(b, corner, scratch);
	const uint64_t found = map_get(&b->vertices, key);
	struct scenery_vertex *vertex;
	int rc;

	if (found != MAP_NONE) {
		*number = (uint16_t)found;
		return 0;
	}
	rc = ARRAY_RESERVE(mesh->vertices, b->vertex_room, (uint64_t)mesh->vertex_count + 1,
			   SCENERY_VERTICES_MAX);
	if (rc == 0 && b->has_picture)
		rc = ARRAY_RESERVE(mesh->uvs, b->uv_room, (uint64_t)mesh->vertex_count + 1,
				   SCENERY_VERTICES_MAX);
	if (rc == 0)
		rc = map_set(&b->vertices, key, mesh->vertex_count);
	if (rc < 0)
		return rc;
	if (b->has_picture)
		uv_of(mesh->uvs[mesh->vertex_count], b, corner);
	*number = (uint16_t)mesh->vertex_count;
	firsts[mesh->vertex_count] = corner;
	vertex = &mesh->vertices[mesh->vertex_count++];
	*vertex = (struct scenery_vertex){ 0 };
	memcpy(vertex->place, b->all[corner].place, sizeof(vertex->place));
	memcpy(vertex->normal, b->all[corner].normal, sizeof(vertex->normal));
	memcpy(vertex->rgb, b->soup->triangles[corner / 3].corners[corner % 3].rgb,
	       sizeof(vertex->rgb));
	return 0;
}

/* Makes vertices and triangles, and the shapes of these vertices. */
static int share_vertices(struct bending *b)
{
	const size_t count = 3 * (size_t)b->soup->count;
	const uint32_t shapes = b->bend->shape_count;
	struct scenery_mesh *mesh = b->mesh;
	uint32_t *firsts = malloc(count * sizeof(*firsts));
	uint8_t *scratch = malloc(KEY_BYTES + (shapes + 1) * sizeof(*b->all));
	int rc = firsts && scratch ? 0 : -ENOMEM;

	mesh->triangles = malloc(b->soup->count * sizeof(*mesh->triangles));
	if (!mesh->triangles)
		rc = -ENOMEM;
	for (uint32_t i = 0; i < count && rc == 0; i++)
		rc = find_vertex(b, i, firsts, scratch, &mesh->triangles[i / 3][i % 3]);
	mesh->triangle_count = b->soup->count;
	if (rc == 0) {
		mesh->shapes =
			malloc((size_t)shapes * mesh->vertex_count * sizeof(*mesh->shapes) + 1);
		rc = mesh->shapes ? 0 : -ENOMEM;
	}
	for (uint32_t s = 0; s < shapes && rc == 0; s++)
		for (uint32_t v = 0; v < mesh->vertex_count; v++)
			mesh->shapes[(size_t)s * mesh->vertex_count + v] =
				b->all[(s + 1) * count + firsts[v]];
	mesh->shape_count = shapes;
	free(firsts);
	free(scratch);
	return rc;
}

static bool has_points(const struct bending *b)
{
	for (uint32_t i = 0; i < 3 * b->soup->count; i++)
		if (b->soup->sources[i / 3][i % 3] >= b->bend->point_count)
			return false;
	return true;
}

int scenery_bend_mesh(struct scenery_mesh *mesh, const struct soup *soup, float crease_rad,
		      bool has_picture, const struct scenery_bend *bend)
{
	struct bending b = { .soup = soup, .bend = bend, .mesh = mesh, .has_picture = has_picture };
	const uint64_t corners = 3 * (uint64_t)soup->count * (bend->shape_count + 1);
	int rc = has_points(&b) ? 0 : -EBADMSG;

	/* Six corners share a vertex in a closed mesh. */
	if (rc == 0 &&
	    (bend->shape_count > SCENERY_SHAPES_MAX || soup->count > SCENERY_TRIANGLES_MAX ||
	     corners > 8ull * SCENERY_SHAPE_VERTICES_MAX))
		rc = -EFBIG;
	if (rc == 0)
		rc = measure(&b);
	if (rc < 0)
		return rc;
	if (has_picture)
		measure_uvs(&b);
	b.corners = calloc(soup->count, sizeof(*b.corners));
	b.all = malloc(corners * sizeof(*b.all));
	rc = b.corners && b.all ? 0 : -ENOMEM;
	for (uint32_t shape = 0; shape <= bend->shape_count && rc == 0; shape++)
		rc = take_shape(&b, shape, crease_rad);
	if (rc == 0)
		rc = share_vertices(&b);
	free(b.corners);
	free(b.all);
	map_finish(&b.vertices);
	if (rc < 0) {
		free(mesh->vertices);
		free(mesh->triangles);
		free(mesh->shapes);
		free(mesh->uvs);
		mesh->uvs = NULL;
		mesh->vertices = NULL;
		mesh->triangles = NULL;
		mesh->shapes = NULL;
	}
	return rc;
}
