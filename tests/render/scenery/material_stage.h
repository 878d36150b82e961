/* Small sceneries with a material each, for pictures of materials: balls, panes, a bowl. */
#ifndef GOPURA_TESTS_RENDER_SCENERY_MATERIAL_STAGE_H
#define GOPURA_TESTS_RENDER_SCENERY_MATERIAL_STAGE_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/normal.h"
#include "format/root_page.h"
#include "format/scenery.h"
#include "geometry/vec.h"
#include "tests/check.h"

enum { STAGE_MESHES_MAX = 32, STAGE_LATTICE = 65534 };

/* Ends with scenery_finish. */
static inline void stage_init(struct scenery *s)
{
	*s = (struct scenery){ .node_count = 1, .fog = { .layer = SCENERY_NONE } };
	s->nodes = calloc(1, sizeof(*s->nodes));
	s->materials = calloc(STAGE_MESHES_MAX, sizeof(*s->materials));
	s->meshes = calloc(STAGE_MESHES_MAX, sizeof(*s->meshes));
	CHECK(s->nodes && s->materials && s->meshes);
	s->nodes[0] = (struct scenery_node){
		.parent = SCENERY_NONE,
		.layer = SCENERY_NONE,
		.place = { .turn = { 0, 0, 0, 1 }, .scale = { 1, 1, 1 }, .stretch = { 0, 0, 0, 1 } }
	};
}

/* A mesh whose lattice is a cube of side_m around centre. */
static inline struct scenery_mesh *stage_mesh(struct scenery *s,
					      const struct scenery_material *material,
					      const float centre[3], float side_m,
					      uint32_t vertices, uint32_t triangles)
{
	struct scenery_mesh *mesh = &s->meshes[s->mesh_count++];

	CHECK(s->mesh_count <= STAGE_MESHES_MAX);
	s->materials[s->material_count] = *material;
	if (vec_length(material->grain) < 0.5f)
		s->materials[s->material_count].grain[2] = 1;
	mesh->material = s->material_count++;
	mesh->step_m = side_m / STAGE_LATTICE;
	for (int k = 0; k < 3; k++)
		mesh->origin_m[k] = centre[k] - side_m / 2;
	mesh->vertices = calloc(vertices, sizeof(*mesh->vertices));
	mesh->triangles = calloc(triangles, sizeof(*mesh->triangles));
	CHECK(mesh->vertices && mesh->triangles);
	return mesh;
}

static inline uint16_t stage_vertex(struct scenery_mesh *mesh, const float at[3],
				    const float normal[3], const uint8_t rgb[3])
{
	struct scenery_vertex *vertex = &mesh->vertices[mesh->vertex_count];

	for (int k = 0; k < 3; k++)
		vertex->place[k] = (uint16_t)lrintf((at[k] - mesh->origin_m[k]) / mesh->step_m);
	normal_encode(vertex->normal, normal);
	memcpy(vertex->rgb, rgb, 3);
	return (uint16_t)mesh->vertex_count++;
}

static inline void stage_triangle(struct scenery_mesh *mesh, const float corners[3][3],
				  const float normals[3][3], const uint8_t rgb[3])
{
	uint16_t *triangle = mesh->triangles[mesh->triangle_count++];

	for (int k = 0; k < 3; k++)
		triangle[k] = stage_vertex(mesh, corners[k], normals[k], rgb);
}

/* The point of a ball at shares of a turn around z and of the way from the lower pole. */
static inline void stage_ball_point(float out[3], float turn, float height)
{
	const float a = turn * 6.2831853f, b = (height - 0.5f) * 3.14159265f;

	out[0] = cosf(a) * cosf(b);
	out[1] = sinf(a) * cosf(b);
	out[2] = sinf(b);
}

static inline void stage_ball_triangle(struct scenery_mesh *mesh, const float centre[3],
				       float radius, const float at[3][2], bool is_flat,
				       const uint8_t rgb[3])
{
	float corners[3][3], normals[3][3], a[3], b[3];

	for (int k = 0; k < 3; k++) {
		stage_ball_point(normals[k], at[k][0], at[k][1]);
		vec_scale(corners[k], radius, normals[k]);
		vec_add(corners[k], corners[k], centre);
	}
	vec_sub(a, corners[1], corners[0]);
	vec_sub(b, corners[2], corners[0]);
	for (int k = 0; k < 3 && is_flat; k++) {
		vec_cross(normals[k], a, b);
		vec_normalise(normals[k]);
	}
	stage_triangle(mesh, (const float(*)[3])corners, (const float(*)[3])normals, rgb);
}

/* Bands from the lower pole; top: 1 is a ball, 0.5 a bowl. */
static inline struct scenery_mesh *stage_ball(struct scenery *s,
					      const struct scenery_material *material,
					      const float centre[3], float radius, int bands,
					      float top, bool is_flat, const uint8_t rgb[3])
{
	const int around = 2 * bands;
	struct scenery_mesh *mesh =
		stage_mesh(s, material, centre, 2.01f * radius, (uint32_t)(6 * bands * around),
			   (uint32_t)(2 * bands * around));

	for (int i = 0; i < bands; i++)
		for (int k = 0; k < around; k++) {
			const float low = top * (float)i / (float)bands,
				    high = top * (float)(i + 1) / (float)bands;
			const float left = (float)k / (float)around,
				    right = (float)(k + 1) / (float)around;

			if (i > 0)
				stage_ball_triangle(mesh, centre, radius,
						    (const float[3][2]){ { left, low },
									 { right, low },
									 { right, high } },
						    is_flat, rgb);
			if (i + 1 < bands || top < 1)
				stage_ball_triangle(mesh, centre, radius,
						    (const float[3][2]){ { left, low },
									 { right, high },
									 { left, high } },
						    is_flat, rgb);
		}
	return mesh;
}

/* A rectangle of across x along around centre, cut into n x n. */
static inline struct scenery_mesh *stage_pane(struct scenery *s,
					      const struct scenery_material *material,
					      const float centre[3], const float across[3],
					      const float along[3], int n, const uint8_t rgb[3])
{
	const float side = 1.01f * (vec_length(across) + vec_length(along));
	struct scenery_mesh *mesh =
		stage_mesh(s, material, centre, side, (uint32_t)(6 * n * n), (uint32_t)(2 * n * n));
	float normal[3];

	vec_cross(normal, across, along);
	vec_normalise(normal);
	for (int t = 0; t < 2 * n * n; t++) {
		static const int8_t corner[2][3][2] = { { { 0, 0 }, { 1, 0 }, { 1, 1 } },
							{ { 0, 0 }, { 1, 1 }, { 0, 1 } } };
		float corners[3][3], normals[3][3];

		for (int k = 0; k < 3; k++) {
			const float x = (float)(t / 2 % n + corner[t % 2][k][0]) / (float)n,
				    y = (float)(t / 2 / n + corner[t % 2][k][1]) / (float)n;

			vec_add_scaled(corners[k], centre, x - 0.5f, across);
			vec_add_scaled(corners[k], corners[k], y - 0.5f, along);
			vec_copy(normals[k], normal);
		}
		stage_triangle(mesh, (const float(*)[3])corners, (const float(*)[3])normals, rgb);
	}
	return mesh;
}

/* Lays pictures on a mesh, straight from the front, seen `times` over. */
static inline void stage_lay(struct scenery_mesh *mesh, float times)
{
	if (!mesh->uvs)
		mesh->uvs = calloc(mesh->vertex_count, sizeof(*mesh->uvs));
	CHECK(mesh->uvs);
	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		const uint16_t *place = mesh->vertices[v].place;

		mesh->uvs[v][0] = place[0];
		mesh->uvs[v][1] = (uint16_t)(STAGE_LATTICE - place[2]);
	}
	for (int k = 0; k < 2; k++) {
		mesh->uv_step[k] = times / STAGE_LATTICE;
		mesh->uv_origin[k] = 0.05f;
	}
}

/* Adds a picture of a side of 2^n pixels, whose pixels are undefined; *number counts from 1. */
static inline struct scenery_texture *stage_texture(struct scenery *s, int side, float times,
						    uint16_t *number)
{
	struct scenery_texture *texture;

	s->textures = realloc(s->textures, (s->texture_count + 1) * sizeof(*s->textures));
	CHECK(s->textures);
	texture = &s->textures[s->texture_count++];
	*number = (uint16_t)s->texture_count;
	*texture = (struct scenery_texture){ .width = (uint16_t)side,
					     .height = (uint16_t)side,
					     .repeats = times > 1,
					     .jpeg_bytes = 1,
					     .rgba = malloc((size_t)(4 * side * side)) };
	CHECK(texture->rgba);
	return texture;
}

/* Puts a picture on a mesh: stripes and discs in three colours. */
static inline void stage_paint(struct scenery *s, struct scenery_mesh *mesh, int side, float times)
{
	struct scenery_texture *texture =
		stage_texture(s, side, times, &s->materials[mesh->material].texture);

	stage_lay(mesh, times);
	for (int i = 0; i < side * side; i++) {
		const float x = (float)(i % side) / (float)side,
			    y = (float)(i / side) / (float)side;
		const bool is_disc = hypotf(x - 0.35f, y - 0.4f) < 0.2f;

		texture->rgba[4 * i] = is_disc ? 220 : (uint8_t)(120 + 60 * sinf(40 * x));
		texture->rgba[4 * i + 1] = y > 0.75f ? 200 : 90;
		texture->rgba[4 * i + 2] = (uint8_t)(255 * y);
		texture->rgba[4 * i + 3] = 255;
	}
}

/* Puts a normal map on a mesh: four domes, and a groove below them. */
static inline void stage_emboss(struct scenery *s, struct scenery_mesh *mesh, int side, float times)
{
	struct scenery_texture *texture =
		stage_texture(s, side, times, &s->materials[mesh->material].normals);

	stage_lay(mesh, times);
	for (int i = 0; i < side * side; i++) {
		const float x = ((float)(i % side) + 0.5f) / (float)side,
			    y = ((float)(i / side) + 0.5f) / (float)side; /* from the top */
		const float right = fmodf(x, 0.5f) - 0.25f, up = 0.2f - fmodf(y, 0.4f);
		float normal[3] = { 0, 0, 1 };

		if (y < 0.8f && hypotf(right, up) < 0.17f) {
			normal[0] = right / 0.2f;
			normal[1] = up / 0.2f;
		} else if (y > 0.85f && y < 0.95f) {
			normal[1] = y < 0.9f ? -0.7f : 0.7f;
		}
		vec_normalise(normal);
		for (int k = 0; k < 3; k++)
			texture->rgba[4 * i + k] = (uint8_t)lrintf((normal[k] + 1) / 2 * 255);
		texture->rgba[4 * i + 3] = 255;
	}
}

/* A lit model under a sun from the upper left of an eye that looks along y. */
static inline struct root_page stage_root(void)
{
	struct root_page root = { .lit = 1, .background = { 150, 170, 190 } };
	const float sun[3] = { -0.5f, -0.6f, 0.62f };

	vec_copy(root.sun, sun);
	vec_normalise(root.sun);
	return root;
}

#endif
