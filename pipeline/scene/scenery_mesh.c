/* Normals by crease angle, and vertices that triangles share. */
#include "pipeline/scene/scenery_mesh.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/map.h"
#include "format/normal.h"
#include "geometry/vec.h"

/* ---- normals */

/* A corner of a triangle, ordered by its place. */
struct place {
	float position[3];
	uint32_t triangle, corner;
};

static int by_position(const void *left, const void *right)
{
	const struct place *a = left, *b = right;
	int order = memcmp(a->position, b->position, sizeof(a->position));

	if (order != 0)
		return order;
	return a->triangle != b->triangle ? (a->triangle > b->triangle ? 1 : -1)
					  : (int)a->corner - (int)b->corner;
}

/* Returns the normal with the length of twice the area. */
static void face_normal(float out[3], const struct scenery_corner corners[3])
{
	float along[3], beside[3];

	vec_sub(along, corners[1].position, corners[0].position);
	vec_sub(beside, corners[2].position, corners[0].position);
	vec_cross(out, along, beside);
}

/* Sums for each corner of a run, all at one place, the normals of those faces that meet its own at
 * no more than the crease angle. */
static void smooth_run(struct scenery_corner (*triangles)[3], const float (*faces)[3],
		       const struct place *run, uint32_t count, float least_cosine)
{
	for (uint32_t i = 0; i < count; i++) {
		const float *own = faces[run[i].triangle];
		float *normal = triangles[run[i].triangle][run[i].corner].normal;
		float unit[3] = { own[0], own[1], own[2] };

		if (triangles[run[i].triangle][run[i].corner].has_normal)
			continue;
		vec_normalise(unit);
		vec_copy(normal, own);
		for (uint32_t k = 0; k < count; k++) {
			const float *other = faces[run[k].triangle];

			if (run[k].triangle != run[i].triangle &&
			    vec_dot(unit, other) >= least_cosine * vec_length(other))
				vec_add(normal, normal, other);
		}
		vec_normalise(normal);
	}
}

enum { RUN_MAX = 256 /* corners at one place that are compared with each other */ };

int scenery_smooth(struct scenery_corner (*triangles)[3], uint32_t count, float crease_rad)
{
	struct place *places = malloc(3 * (size_t)count * sizeof(*places));
	float(*faces)[3] = malloc((size_t)count * sizeof(*faces));
	uint32_t first = 0, after;

	for (uint32_t i = 0; places && faces && i < 3 * count; i++) {
		const struct scenery_corner *corner = &triangles[i / 3][i % 3];

		places[i] = (struct place){ .triangle = i / 3, .corner = i % 3 };
		for (int k = 0; k < 3; k++) /* + 0: no two zeros */
			places[i].position[k] = corner->position[k] + 0.0f;
		face_normal(faces[i / 3], triangles[i / 3]);
	}
	if (places && faces)
		qsort(places, 3 * (size_t)count, sizeof(*places), by_position);
	for (; places && faces && first < 3 * count; first = after) {
		for (after = first + 1;
		     after < 3 * count && after < first + RUN_MAX &&
		     memcmp(places[after].position, places[first].position, 12) == 0;)
			after++;
		smooth_run(triangles, (const float(*)[3])faces, &places[first], after - first,
			   cosf(crease_rad));
	}
	free(faces);
	free(places);
	return places && faces ? 0 : -ENOMEM;
}

static bool has_area(const struct scenery_corner corners[3])
{
	float normal[3];

	face_normal(normal, corners);
	return vec_dot(normal, normal) > 0;
}

int scenery_sheet_add(struct scenery_sheet *sheet, const struct soup_triangle *triangles,
		      uint32_t count, float crease_rad)
{
	uint32_t before = sheet->count;
	int rc = ARRAY_RESERVE(sheet->triangles, sheet->room, (uint64_t)sheet->count + count,
			       SCENERY_ALL_TRIANGLES_MAX);

	for (uint32_t i = 0; rc == 0 && i < count; i++) {
		struct scenery_corner *to = sheet->triangles[sheet->count];

		for (int k = 0; k < 3; k++) {
			const struct soup_corner *from = &triangles[i].corners[k];

			memcpy(to[k].position, from->position, sizeof(to[k].position));
			scenery_uv(to[k].uv, from);
			vec_copy(to[k].normal, from->normal);
			to[k].has_normal = vec_dot(from->normal, from->normal) > 0.5f;
			memcpy(to[k].rgb, from->rgb, sizeof(to[k].rgb));
		}
		sheet->count += has_area(to);
	}
	if (rc == 0 && sheet->count > before)
		rc = scenery_smooth(&sheet->triangles[before], sheet->count - before, crease_rad);
	return rc;
}

/* ---- where pictures lie */

/* Where a picture lies that repeats more often than this, no number says well. */
static const float most_uv = 10000;

void scenery_uv(float out[2], const struct soup_corner *corner)
{
	for (int k = 0; k < 2; k++)
		out[k] = fabsf(corner->uv[k]) <= most_uv ? corner->uv[k] : 0;
	out[1] = 1 - out[1]; /* the format counts from the top */
}

void scenery_uv_lattice(struct scenery_mesh *mesh, const float low[2], const float high[2])
{
	for (int k = 0; k < 2; k++) {
		mesh->uv_origin[k] = low[k];
		mesh->uv_step[k] = (high[k] - low[k]) / SCENERY_PLACE_MAX;
	}
}

void scenery_uv_encode(uint16_t out[2], const struct scenery_mesh *mesh, const float uv[2])
{
	for (int k = 0; k < 2; k++) {
		const float step = mesh->uv_step[k];

		out[k] = step > 0 ? (uint16_t)vec_least(roundf((uv[k] - mesh->uv_origin[k]) / step),
							SCENERY_PLACE_MAX)
				  : 0;
	}
}

/* ---- meshes */

/* The mesh that is being filled, and its vertices by their bytes. */
struct filling {
	struct scenery_mesh mesh; /* what it points to is owned */
	uint32_t vertex_room, triangle_room, uv_room;
	bool has_picture;
	struct map vertices;
};

static void measure(struct scenery_mesh *mesh, const struct scenery_sheet *sheet)
{
	float high[3], longest = 0;

	vec_copy(mesh->origin_m, sheet->triangles[0][0].position);
	vec_copy(high, mesh->origin_m);
	for (uint32_t i = 0; i < 3 * sheet->count; i++)
		for (int k = 0; k < 3; k++) {
			float value = sheet->triangles[i / 3][i % 3].position[k];

			mesh->origin_m[k] = vec_least(mesh->origin_m[k], value);
			high[k] = vec_most(high[k], value);
		}
	for (int k = 0; k < 3; k++)
		longest = vec_most(longest, high[k] - mesh->origin_m[k]);
	/* The last place must not round past its 16 bits. */
	mesh->step_m = longest / (SCENERY_PLACE_MAX - 1);
}

/* The same for where the picture lies. */
static void measure_uvs(struct scenery_mesh *mesh, const struct scenery_sheet *sheet)
{
	float low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };

	for (uint32_t i = 0; i < 6 * sheet->count; i++) {
		const float at = sheet->triangles[i / 6][i % 6 / 2].uv[i % 2];

		low[i % 2] = vec_least(low[i % 2], at);
		high[i % 2] = vec_most(high[i % 2], at);
	}
	scenery_uv_lattice(mesh, low, high);
}

static struct scenery_vertex vertex_of(const struct scenery_mesh *mesh,
				       const struct scenery_corner *corner)
{
	struct scenery_vertex vertex = { .rgb = { corner->rgb[0], corner->rgb[1],
						  corner->rgb[2] } };

	for (int k = 0; k < 3; k++)
		vertex.place[k] =
			(uint16_t)lrintf((corner->position[k] - mesh->origin_m[k]) / mesh->step_m);
	normal_encode(vertex.normal, corner->normal);
	return vertex;
}

static map_key key_of(const struct scenery_vertex *vertex, const uint16_t uv[2])
{
	map_key key = (map_key)uv[0] << 16 | uv[1];

	for (int k = 0; k < 3; k++)
		key = key << 16 | vertex->place[k];
	for (int k = 0; k < 2; k++)
		key = key << 8 | (uint8_t)vertex->normal[k];
	for (int k = 0; k < 3; k++)
		key = key << 8 | vertex->rgb[k];
	return key;
}

static int find_vertex(struct filling *filling, const struct scenery_corner *corner,
		       uint16_t *number)
{
	struct scenery_mesh *mesh = &filling->mesh;
	struct scenery_vertex vertex = vertex_of(mesh, corner);
	uint16_t uv[2] = { 0 };
	uint64_t found;
	int rc;

	if (filling->has_picture)
		scenery_uv_encode(uv, mesh, corner->uv);
	found = map_get(&filling->vertices, key_of(&vertex, uv));

	if (found != MAP_NONE) {
		*number = (uint16_t)found;
		return 0;
	}
	rc = ARRAY_RESERVE(mesh->vertices, filling->vertex_room, (uint64_t)mesh->vertex_count + 1,
			   SCENERY_VERTICES_MAX);
	if (rc == 0 && filling->has_picture)
		rc = ARRAY_RESERVE(mesh->uvs, filling->uv_room, (uint64_t)mesh->vertex_count + 1,
				   SCENERY_VERTICES_MAX);
	if (rc == 0)
		rc = map_set(&filling->vertices, key_of(&vertex, uv), mesh->vertex_count);
	if (rc < 0)
		return rc;
	if (filling->has_picture)
		memcpy(mesh->uvs[mesh->vertex_count], uv, sizeof(uv));
	*number = (uint16_t)mesh->vertex_count;
	mesh->vertices[mesh->vertex_count++] = vertex;
	return 0;
}

/* Moves the filled mesh to the scenery; the filling stays as an empty one of the same node. */
static int end_mesh(struct filling *filling, struct scenery *out, uint32_t *mesh_room)
{
	struct scenery_mesh *mesh = &filling->mesh;
	int rc;

	if (mesh->triangle_count == 0)
		return 0;
	rc = ARRAY_RESERVE(out->meshes, *mesh_room, (uint64_t)out->mesh_count + 1,
			   SCENERY_MESHES_MAX);
	if (rc < 0)
		return rc;
	out->meshes[out->mesh_count++] = *mesh;
	mesh->vertices = NULL;
	mesh->triangles = NULL;
	mesh->uvs = NULL;
	mesh->vertex_count = mesh->triangle_count = 0;
	filling->vertex_room = filling->triangle_room = filling->uv_room = 0;
	map_clear(&filling->vertices);
	return 0;
}

static int add_triangle(struct filling *filling, const struct scenery_corner corners[3])
{
	struct scenery_mesh *mesh = &filling->mesh;
	uint16_t numbers[3] = { 0 };
	int rc = ARRAY_RESERVE(mesh->triangles, filling->triangle_room,
			       (uint64_t)mesh->triangle_count + 1, SCENERY_TRIANGLES_MAX);

	for (int k = 0; k < 3 && rc == 0; k++)
		rc = find_vertex(filling, &corners[k], &numbers[k]);
	if (rc < 0)
		return rc;
	memcpy(mesh->triangles[mesh->triangle_count++], numbers, sizeof(numbers));
	return 0;
}

int scenery_sheet_meshes(const struct scenery_sheet *sheet, struct scenery *out,
			 uint32_t *mesh_room)
{
	struct filling filling = { .mesh = { .node = sheet->node, .material = sheet->material },
				   .has_picture = sheet->has_picture };
	int rc = 0;

	if (sheet->count == 0)
		return 0;
	measure(&filling.mesh, sheet);
	if (sheet->has_picture)
		measure_uvs(&filling.mesh, sheet);
	for (uint32_t i = 0; i < sheet->count && rc == 0; i++) {
		if (filling.mesh.vertex_count > SCENERY_VERTICES_MAX - 3 ||
		    filling.mesh.triangle_count == SCENERY_TRIANGLES_MAX)
			rc = end_mesh(&filling, out, mesh_room);
		if (rc == 0)
			rc = add_triangle(&filling, sheet->triangles[i]);
	}
	if (rc == 0)
		rc = end_mesh(&filling, out, mesh_room);
	free(filling.mesh.vertices);
	free(filling.mesh.triangles);
	free(filling.mesh.uvs);
	map_finish(&filling.vertices);
	return rc;
}

void scenery_sheet_finish(struct scenery_sheet *sheet)
{
	free(sheet->triangles);
	*sheet = (struct scenery_sheet){ 0 };
}
