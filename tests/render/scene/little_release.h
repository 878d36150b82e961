/* A release small enough to be made in memory by a test: a floor with four pillars, striped finer
 * than its vertices, as hierarchy (coarse group, finer group), samples (a grid of points, ray cast)
 * and pages; and the true picture from any eye. Answers a scene's wants at once. */
#ifndef GOPURA_TESTS_RENDER_SCENE_LITTLE_RELEASE_H
#define GOPURA_TESTS_RENDER_SCENE_LITTLE_RELEASE_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/hierarchy.h"
#include "format/normal.h"
#include "format/patch.h"
#include "format/samples.h"
#include "format/tile.h"
#include "geometry/light.h"
#include "render/scene/scene.h"

#include "tests/check.h"

enum { LITTLE_OBJECTS_MAX = 4096, LITTLE_LEVELS = 2, LITTLE_BOXES = 5 };

struct little_object {
	struct hash hash;
	uint8_t *bytes; /* owned */
	size_t size;
};

struct little_release {
	struct little_object objects[LITTLE_OBJECTS_MAX];
	uint32_t object_count;
	struct hash root;
	uint32_t root_bytes;
	uint32_t points; /* a side */
	uint64_t given_bytes, given_tiles;
	bool has_vantage;
	float vantage_m[3];
};

static const float little_boxes[LITTLE_BOXES][2][3] = {
	{ { -8, -8, -0.5f }, { 8, 8, 0 } }, { { -5, -5, 0 }, { -3, -3, 5 } },
	{ { 3, -5, 0 }, { 5, -3, 5 } },     { { -5, 3, 0 }, { -3, 5, 5 } },
	{ { 3, 3, 0 }, { 5, 5, 5 } },
};
static struct lattice little_lattice = { { -8, -8, -8 }, 1.0 / 4095, 0 };
static int32_t little_base[3]; /* the place of the lattice at (-8, -8, -8) */

/* Puts releases that are made after this on a lattice whose origin is far away. */
static inline void little_move(const int32_t base[3], double step_m)
{
	little_lattice.step_m = step_m;
	for (int i = 0; i < 3; i++) {
		little_base[i] = base[i];
		little_lattice.origin_m[i] = -8 - step_m * base[i];
	}
}

/* ---- the truth */

static void little_colour(const float at[3], float rgb[3])
{
	bool dark = ((int)floorf(at[0] * 2.5f + 100) + (int)floorf(at[1] * 2.5f + 100) +
		     (int)floorf(at[2] * 2.5f + 100)) &
		    1;
	rgb[0] = dark ? 90 : 200;
	rgb[1] = dark ? 80 : 180;
	rgb[2] = 60 + 10 * fminf(fmaxf(at[2], 0), 6);
}

/* false: sky. */
static bool little_cast(const float from[3], const float direction[3], float rgb[3])
{
	float nearest = INFINITY, per_m[3];
	for (int i = 0; i < 3; i++)
		per_m[i] = 1 / (fabsf(direction[i]) > 1e-9f ? direction[i] : 1e-9f);
	for (int b = 0; b < LITTLE_BOXES; b++) {
		float low = 0, high = INFINITY;
		/* Comparisons, because fminf and fmaxf are calls, and millions of rays are cast. */
		for (int i = 0; i < 3 && low <= high; i++) {
			float a = (little_boxes[b][0][i] - from[i]) * per_m[i];
			float c = (little_boxes[b][1][i] - from[i]) * per_m[i];
			float enters = a < c ? a : c, leaves = a < c ? c : a;
			low = enters > low ? enters : low;
			high = leaves < high ? leaves : high;
		}
		if (low <= high && low > 0 && low < nearest)
			nearest = low;
	}
	if (!isfinite(nearest))
		return false;
	float at[3];
	for (int i = 0; i < 3; i++)
		at[i] = from[i] + (nearest - 1e-3f) * direction[i];
	little_colour(at, rgb);
	return true;
}

static bool little_is_inside(const float at[3])
{
	for (int b = 0; b < LITTLE_BOXES; b++)
		if (at[0] > little_boxes[b][0][0] && at[0] < little_boxes[b][1][0] &&
		    at[1] > little_boxes[b][0][1] && at[1] < little_boxes[b][1][1] &&
		    at[2] > little_boxes[b][0][2] && at[2] < little_boxes[b][1][2])
			return true;
	return false;
}

/* ---- objects */

static struct page_child little_add(struct little_release *r, struct buffer *bytes, bool is_page)
{
	CHECK(bytes->error == 0 && r->object_count < LITTLE_OBJECTS_MAX);
	struct little_object *object = &r->objects[r->object_count++];
	object->hash = hash_of(buffer_bytes(bytes));
	object->size = bytes->size;
	object->bytes = malloc(bytes->size);
	memcpy(object->bytes, bytes->data, bytes->size);
	buffer_clear(bytes);
	return (struct page_child){ object->hash, (uint32_t)object->size, is_page };
}

static struct page_child little_page(struct little_release *r, enum page_kind kind,
				     struct page_child *children, uint32_t count,
				     struct buffer *payload)
{
	struct buffer out;
	buffer_init(&out, PAGE_BYTES_MAX);
	const struct page page = { kind, count, children, buffer_bytes(payload) };
	page_encode(&out, &page);
	struct page_child child = little_add(r, &out, true);
	buffer_finish(&out);
	buffer_clear(payload);
	return child;
}

/* ---- geometry */

struct little_mesh {
	struct patch_mesh mesh;
	float min[3], max[3];
};

static uint16_t little_vertex(struct little_mesh *m, const float at[3], const float normal[3])
{
	struct patch_vertex *v = &m->mesh.vertices[m->mesh.vertex_count];
	float inside[3], rgb[3];
	for (int i = 0; i < 3; i++) {
		v->position[i] = little_base[i] +
				 (int32_t)lrintf((at[i] + 8) / (float)little_lattice.step_m);
		inside[i] = at[i] + 1e-3f * normal[i];
		m->min[i] = fminf(m->min[i], at[i]);
		m->max[i] = fmaxf(m->max[i], at[i]);
	}
	normal_encode(v->normal, normal);
	little_colour(inside, rgb);
	for (int i = 0; i < 3; i++)
		v->colour[i] = (uint8_t)rgb[i];
	v->colour[3] = 255;
	return (uint16_t)m->mesh.vertex_count++;
}

/* One side of a box as cells x cells squares. */
static void little_side(struct little_mesh *m, const float box[2][3], int axis, int sign, int cells)
{
	int a = (axis + 1) % 3, b = (axis + 2) % 3;
	float normal[3] = { 0 }, at[3];
	normal[axis] = (float)sign;
	uint16_t first = (uint16_t)m->mesh.vertex_count;
	for (int j = 0; j <= cells; j++) {
		for (int i = 0; i <= cells; i++) {
			at[axis] = box[sign > 0][axis];
			at[a] = box[0][a] + (box[1][a] - box[0][a]) * (float)i / (float)cells;
			at[b] = box[0][b] + (box[1][b] - box[0][b]) * (float)j / (float)cells;
			little_vertex(m, at, normal);
		}
	}
	for (int j = 0; j < cells; j++) {
		for (int i = 0; i < cells; i++) {
			int low = first + j * (cells + 1) + i, high = low + cells + 1;
			int corners[6] = { low, low + 1, high + 1, low, high + 1, high };
			for (int k = 0; k < 6; k++)
				m->mesh.indices[3 * m->mesh.triangle_count + (uint32_t)k] =
					(uint16_t)corners[sign > 0 ? k : k / 3 * 3 + 2 - k % 3];
			m->mesh.triangle_count += 2;
		}
	}
}

static void little_mesh_of(struct little_mesh *m, int box, int cells)
{
	memset(m, 0, sizeof(*m));
	m->mesh.vertices = calloc(PATCH_VERTICES_MAX, sizeof(*m->mesh.vertices));
	m->mesh.indices = calloc(3 * PATCH_TRIANGLES_MAX, sizeof(*m->mesh.indices));
	for (int i = 0; i < 3; i++) {
		m->min[i] = INFINITY;
		m->max[i] = -INFINITY;
	}
	for (int axis = 0; axis < 3; axis++)
		for (int sign = -1; sign <= 1; sign += 2)
			little_side(m, little_boxes[box], axis, sign, cells);
}

static void little_describe(struct hierarchy_patch *p, const struct little_mesh *m, uint32_t group,
			    uint32_t finer)
{
	*p = (struct hierarchy_patch){
		.group = group, .finer = finer, .cone_axis = { 0, 0, 1 }, .cone_cos = -1
	};
	p->triangle_count = (uint16_t)m->mesh.triangle_count;
	p->vertex_count = (uint16_t)m->mesh.vertex_count;
	for (int i = 0; i < 3; i++) {
		p->centre_m[i] = (m->min[i] + m->max[i]) / 2;
		p->radius_m = fmaxf(p->radius_m, m->max[i] - m->min[i]);
	}
	p->radius_m *= 0.9f; /* above half the diagonal */
}

/* Group 0: the boxes coarsely, a patch each. Group 1: the same, finely. */
static struct page_child little_hierarchy(struct little_release *r)
{
	struct hierarchy_patch patches[2 * LITTLE_BOXES];
	struct hierarchy_group groups[2] = {
		{ 0, LITTLE_BOXES, INFINITY, { 0, 0, 2 }, 14 },
		{ LITTLE_BOXES, LITTLE_BOXES, 0.05f, { 0, 0, 2 }, 14 },
	};
	struct page_child children[2];
	struct buffer out;
	buffer_init(&out, OBJECT_BYTES_MAX);
	for (uint32_t g = 0; g < 2; g++) {
		struct patch_mesh meshes[LITTLE_BOXES];
		for (int b = 0; b < LITTLE_BOXES; b++) {
			struct little_mesh m;
			little_mesh_of(&m, b, g == 0 ? 2 : 12);
			meshes[b] = m.mesh;
			little_describe(&patches[g * LITTLE_BOXES + (uint32_t)b], &m, g,
					g == 0 ? 1 : HIERARCHY_NONE);
		}
		CHECK(patch_group_encode(&out, meshes, LITTLE_BOXES) == 0);
		for (int b = 0; b < LITTLE_BOXES; b++)
			patch_mesh_finish(&meshes[b]);
		children[g] = little_add(r, &out, false);
	}
	const struct hierarchy hierarchy = { 2, 2 * LITTLE_BOXES, groups, patches };
	CHECK(hierarchy_encode(&out, &hierarchy) == 0);
	struct page_child page = little_page(r, PAGE_HIERARCHY, children, 2, &out);
	buffer_finish(&out);
	return page;
}

/* ---- samples */

static void little_point(const struct little_release *r, uint32_t x, uint32_t y, uint32_t z,
			 float out[3])
{
	float step = 18.0f / (float)(r->points - 1);
	out[0] = -9 + step * (float)x + 0.3f;
	out[1] = -9 + step * (float)y + 0.2f;
	out[2] = 1.5f + 4 * (float)z;
}

static bool little_tile(const float point[3], const float background[3], int face, uint32_t level,
			uint32_t row, uint32_t column, uint8_t *rgb)
{
	float side = (float)(SAMPLE_TILE_PX << level);
	bool shows = false;
	for (int y = 0; y < SAMPLE_IMAGE_PX; y++) {
		for (int x = 0; x < SAMPLE_IMAGE_PX; x++) {
			float px = (float)(column * SAMPLE_TILE_PX) + (float)(x - SAMPLE_APRON_PX);
			float py = (float)(row * SAMPLE_TILE_PX) + (float)(y - SAMPLE_APRON_PX);
			float direction[3], colour[3];
			memcpy(colour, background, sizeof(colour));
			cube_direction(direction, face, 2 * (px + 0.5f) / side - 1,
				       1 - 2 * (py + 0.5f) / side);
			shows |= little_cast(point, direction, colour);
			for (int i = 0; i < 3; i++)
				*rgb++ = (uint8_t)colour[i];
		}
	}
	return shows;
}

static bool little_face(struct little_release *r, const float point[3], const float background[3],
			int face, struct page_child *out)
{
	static uint8_t rgb[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3];
	struct page_child children[FACE_TILES_MAX];
	struct face_page page = { .level_count = LITTLE_LEVELS };
	struct buffer bytes;
	uint32_t count = 0;
	memset(page.tile_child, 0xff, sizeof(page.tile_child));
	buffer_init(&bytes, OBJECT_BYTES_MAX);
	for (uint32_t level = 0; level < LITTLE_LEVELS; level++) {
		for (uint32_t at = 0; at < 1u << (2 * level); at++) {
			uint32_t row = at >> level, column = at & ((1u << level) - 1);
			if (!little_tile(point, background, face, level, row, column, rgb))
				continue;
			CHECK(tile_encode(&bytes, rgb, SAMPLE_IMAGE_PX, 95, TILE_THOROUGH) == 0);
			page.tile_child[face_tile_index(level, row, column)] = count;
			children[count++] = little_add(r, &bytes, false);
		}
	}
	face_page_encode(&bytes, &page);
	if (count > 0)
		*out = little_page(r, PAGE_FACE, children, count, &bytes);
	buffer_finish(&bytes);
	return count > 0;
}

/* The brick of the vantage point at r->vantage_m. */
static struct page_child little_vantage(struct little_release *r)
{
	static struct brick_page brick;
	static const float sky[3] = { 120, 150, 180 };
	struct page_child children[CUBE_FACES], page;
	struct buffer payload;
	uint32_t count = 0;
	buffer_init(&payload, PAGE_BYTES_MAX);
	memset(&brick, 0, sizeof(brick));
	memset(brick.face_child, 0xff, sizeof(brick.face_child));
	for (int face = 0; face < CUBE_FACES; face++) {
		if (!little_face(r, r->vantage_m, sky, face, &children[count]))
			continue;
		brick.face_child[0][face] = count++;
		brick.coverage[0][face] = 0xffff;
		brick.near_m[0][face] = 0.5f;
		brick.far_m[0][face] = 30;
	}
	brick_page_encode(&payload, &brick);
	page = little_page(r, PAGE_BRICK, children, count, &payload);
	buffer_finish(&payload);
	return page;
}

static struct page_child little_samples(struct little_release *r)
{
	static const float filled[3] = { 150, 140, 120 };
	static struct brick_page brick;
	struct page_child children[BRICK_POINTS * CUBE_FACES], bricks[2];
	struct buffer payload;
	uint32_t count = 0, numbers[2] = { 0, 1 };
	buffer_init(&payload, PAGE_BYTES_MAX);
	memset(&brick, 0, sizeof(brick));
	memset(brick.face_child, 0xff, sizeof(brick.face_child));
	for (uint32_t p = 0; p < r->points * r->points * 2; p++) {
		uint32_t x = p % r->points, y = p / r->points % r->points,
			 z = p / r->points / r->points;
		float point[3];
		little_point(r, x, y, z, point);
		uint32_t at = (z * BRICK_SIDE + y) * BRICK_SIDE + x;
		for (int face = 0; face < CUBE_FACES && !little_is_inside(point); face++) {
			if (!little_face(r, point, filled, face, &children[count]))
				continue;
			brick.face_child[at][face] = count++;
			brick.coverage[at][face] = 0xffff;
			brick.near_m[at][face] = 0.5f;
			brick.far_m[at][face] = 30;
		}
	}
	brick_page_encode(&payload, &brick);
	bricks[0] = little_page(r, PAGE_BRICK, children, count, &payload);
	struct samples_page samples = { .count = { (uint8_t)r->points, (uint8_t)r->points, 2 },
					.level_count = LITTLE_LEVELS,
					.bricks = { 1, 1, 1 },
					.brick_child = numbers,
					.vantage_count = r->has_vantage };
	float next[3];
	little_point(r, 0, 0, 0, samples.origin_m);
	little_point(r, 1, 1, 1, next);
	for (int i = 0; i < 3; i++)
		samples.spacing_m[i] = next[i] - samples.origin_m[i];
	memcpy(samples.vantage_m[0], r->vantage_m, sizeof(r->vantage_m));
	if (r->has_vantage)
		bricks[1] = little_vantage(r);
	samples_page_encode(&payload, &samples);
	struct page_child page =
		little_page(r, PAGE_SAMPLES, bricks, r->has_vantage ? 2 : 1, &payload);
	buffer_finish(&payload);
	return page;
}

/* ---- the whole */

/* points: sampling points along x and y, 2 .. BRICK_SIDE; two layers. vantage_m: of a vantage
 * point; NULL: there is none. */
static inline struct little_release *little_release_from(uint32_t points, const float *vantage_m)
{
	struct little_release *r = calloc(1, sizeof(*r));
	struct page_child children[ROOT_CHILD_COUNT];
	struct buffer payload;
	r->points = points;
	r->has_vantage = vantage_m != NULL;
	if (vantage_m)
		memcpy(r->vantage_m, vantage_m, sizeof(r->vantage_m));
	children[ROOT_CHILD_HIERARCHY] = little_hierarchy(r);
	children[ROOT_CHILD_SAMPLES] = little_samples(r);
	children[ROOT_CHILD_INFO] = children[ROOT_CHILD_SAMPLES];
	struct root_page root = { .name = "little",
				  .lattice = little_lattice,
				  .box_min_m = { -8, -8, -0.5f },
				  .box_max_m = { 8, 8, 5 },
				  .start_eye_m = { 12, -14, 6 },
				  .start_target_m = { 0, 0, 2 },
				  .sun = { 0, 0, 1 },
				  .background = { 120, 150, 180 },
				  .source_triangles = 100000,
				  .published_triangles = 4320 };
	buffer_init(&payload, PAGE_BYTES_MAX);
	root_page_encode(&payload, &root);
	struct page_child page = little_page(r, PAGE_ROOT, children, ROOT_CHILD_COUNT, &payload);
	r->root = page.hash;
	r->root_bytes = page.size;
	buffer_finish(&payload);
	return r;
}

static inline struct little_release *little_release_make(uint32_t points)
{
	return little_release_from(points, NULL);
}

static inline void little_release_free(struct little_release *r)
{
	for (uint32_t i = 0; i < r->object_count; i++)
		free(r->objects[i].bytes);
	free(r);
}

/* Gives the scene everything it wants, at most `most` objects. */
static inline uint32_t little_release_serve(struct little_release *r, struct scene *scene,
					    size_t most)
{
	struct message_want wants[256];
	size_t count = scene_wants(scene, wants, most < 256 ? most : 256);
	for (size_t i = 0; i < count; i++) {
		for (uint32_t k = 0; k < r->object_count; k++) {
			if (!hash_equal(r->objects[k].hash, wants[i].hash))
				continue;
			CHECK(r->objects[k].size == wants[i].size);
			r->given_bytes += r->objects[k].size;
			scene_give(scene, wants[i].hash,
				   (struct bytes){ r->objects[k].bytes, r->objects[k].size });
			break;
		}
	}
	return (uint32_t)count;
}

/* rgb: width x height x 3, row 0 on top; alpha-less, sky as the root page says. */
static inline void little_truth(const struct camera *camera, uint8_t *rgb)
{
	static const float sky[3] = { 120, 150, 180 };
	for (int y = 0; y < camera->height_px; y++) {
		for (int x = 0; x < camera->width_px; x++) {
			float sum[3] = { 0 };
			for (int s = 0; s < 4; s++) {
				float direction[3], colour[3] = { sky[0], sky[1], sky[2] };
				camera_ray(camera, (float)x + 0.25f + 0.5f * (float)(s & 1),
					   (float)y + 0.25f + 0.5f * (float)(s >> 1), direction);
				little_cast(camera->eye_m, direction, colour);
				for (int i = 0; i < 3; i++)
					sum[i] += colour[i] / 4;
			}
			for (int i = 0; i < 3; i++)
				*rgb++ = (uint8_t)sum[i];
		}
	}
}

#endif
