/* Scenery drawn pixel by pixel in software: each pixel's ray meets the triangles, and
 * geometry/appearance.c colours what it meets. It is the truth that the GLES2 programs are compared
 * with; slow and plain on purpose. */
#ifndef GOPURA_TESTS_RENDER_SCENERY_SOFTWARE_SCENERY_H
#define GOPURA_TESTS_RENDER_SCENERY_SOFTWARE_SCENERY_H

#include <math.h>
#include <stdlib.h>

#include "format/normal.h"
#include "format/root_page.h"
#include "geometry/appearance.h"
#include "geometry/vec.h"
#include "geometry/view.h"
#include "render/scenery/pose.h"
#include "tests/check.h"

enum { SOFTWARE_HITS_MAX = 64 };

/* A triangle in metres from the eye. */
struct software_triangle {
	const struct scenery_material *material;
	const struct scenery_texture *texture, *map; /* NULL: none */
	float uvs[3][3];                             /* two each */
	struct appearance_solid solid;
	float corners[3][3], normals[3][3], colours[3][3], places[3][3]; /* places: in the node */
};

struct software_hit {
	const struct software_triangle *of;
	float distance, share[3]; /* of each corner */
	bool is_back;
};

struct software_picture {
	const struct scenery *scenery; /* borrowed, as the next two */
	const struct view *view;
	const struct root_page *root;
	struct appearance_light light;
	struct software_triangle *triangles; /* owned */
	uint32_t count;
};

static inline void software_place(float out[3], const float m[16], const float at[3], bool is_point)
{
	for (int row = 0; row < 3; row++)
		out[row] = m[row] * at[0] + m[4 + row] * at[1] + m[8 + row] * at[2] +
			   (is_point ? m[12 + row] : 0);
}

/* By the cofactors, for any scale. */
static inline void software_turn(float out[3], const float m[16], const float normal[3])
{
	float turned[16] = { 0 };

	vec_cross(&turned[0], &m[4], &m[8]);
	vec_cross(&turned[4], &m[8], &m[0]);
	vec_cross(&turned[8], &m[0], &m[4]);
	software_place(out, turned, normal, false);
	vec_normalise(out);
}

static inline void software_add(struct software_picture *p, const struct pose *pose,
				const struct scenery_mesh *mesh, uint32_t triangle)
{
	struct software_triangle *out = &p->triangles[p->count++];
	const float *m = pose->nodes[mesh->node].matrix;

	out->material = &p->scenery->materials[mesh->material];
	if (out->material->texture)
		out->texture = &p->scenery->textures[out->material->texture - 1];
	if (out->material->normals)
		out->map = &p->scenery->textures[out->material->normals - 1];
	appearance_solid_init(&out->solid, out->material, m);
	for (int k = 0; k < 3; k++) {
		const struct scenery_vertex *v = &mesh->vertices[mesh->triangles[triangle][k]];
		struct appearance_place place = { .footprint_m = 0 };
		float normal[3], *at = out->places[k], *n = place.normal, *surface = place.surface;

		for (int i = 0; i < 2 && mesh->uvs; i++)
			out->uvs[k][i] =
				mesh->uv_origin[i] +
				mesh->uv_step[i] * mesh->uvs[mesh->triangles[triangle][k]][i];
		for (int i = 0; i < 3; i++) {
			at[i] = mesh->origin_m[i] + mesh->step_m * v->place[i];
			surface[i] = (float)v->rgb[i] / 255;
		}
		software_place(out->corners[k], m, at, true);
		vec_sub(out->corners[k], out->corners[k], p->view->eye_m);
		normal_decode(normal, v->normal);
		software_turn(out->normals[k], m, normal);
		vec_copy(out->colours[k], surface);
		if (out->material->by_pixel)
			continue;
		vec_scale(place.to_eye, -1, out->corners[k]);
		vec_normalise(place.to_eye);
		vec_copy(n, out->normals[k]);
		if (out->material->has_two_sides && vec_dot(n, place.to_eye) < 0)
			vec_scale(n, -1, n);
		appearance_colour(out->colours[k], out->material, NULL, &place, &p->light);
	}
}

/* Everything is borrowed for the lifetime; ends with software_finish. */
static inline void software_init(struct software_picture *p, const struct pose *pose,
				 const struct view *view, const struct root_page *root,
				 const struct appearance_cube *around)
{
	const struct scenery *scenery = pose->scenery;

	*p = (struct software_picture){ .scenery = scenery, .view = view, .root = root };
	vec_copy(p->light.sun, root->sun);
	p->light.is_lit = root->lit;
	p->light.around = around;
	p->triangles = calloc(scenery_triangles(scenery), sizeof(*p->triangles));
	CHECK(p->triangles);
	for (uint32_t i = 0; i < scenery->mesh_count; i++)
		for (uint32_t t = 0; t < scenery->meshes[i].triangle_count; t++)
			software_add(p, pose, &scenery->meshes[i], t);
}

static inline void software_finish(struct software_picture *p)
{
	free(p->triangles);
}

/* The test of Moeller and Trumbore 1997. */
static inline bool software_meets(struct software_hit *out, const struct software_triangle *t,
				  const float direction[3])
{
	float ab[3], ac[3], p[3], q[3], to[3], det, u, v;

	vec_sub(ab, t->corners[1], t->corners[0]);
	vec_sub(ac, t->corners[2], t->corners[0]);
	vec_cross(p, direction, ac);
	det = vec_dot(ab, p);
	if (fabsf(det) < 1e-12f || (det < 0 && !t->material->has_two_sides))
		return false;
	vec_scale(to, -1, t->corners[0]);
	u = vec_dot(to, p) / det;
	vec_cross(q, to, ab);
	v = vec_dot(direction, q) / det;
	*out = (struct software_hit){ .of = t,
				      .distance = vec_dot(ac, q) / det,
				      .share = { 1 - u - v, u, v },
				      .is_back = det < 0 };
	return u >= 0 && v >= 0 && u + v <= 1 && out->distance > 0;
}

static inline void software_mix(float out[3], const float of[3][3], const float share[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = of[0][k] * share[0] + of[1][k] * share[1] + of[2][k] * share[2];
}

/* A pixel of a picture that was halved `level` times: the mean of those that it covers. */
static inline float software_texel(const struct scenery_texture *t, int level, int x, int y, int k)
{
	const int width = t->width >> level > 1 ? t->width >> level : 1;
	const int height = t->height >> level > 1 ? t->height >> level : 1;
	const int across = t->width / width, down = t->height / height;
	float sum = 0;

	if (t->repeats) {
		x = (x % width + width) % width;
		y = (y % height + height) % height;
	}
	x = x < 0 ? 0 : x >= width ? width - 1 : x;
	y = y < 0 ? 0 : y >= height ? height - 1 : y;
	for (int i = 0; i < across * down; i++)
		sum += t->rgba[4 * ((y * down + i / across) * t->width + x * across + i % across) +
			       k];
	return sum / (float)(across * down * 255);
}

static inline void software_bilinear(float rgb[3], const struct scenery_texture *t, int level,
				     const float uv[2])
{
	const int width = t->width >> level > 1 ? t->width >> level : 1;
	const int height = t->height >> level > 1 ? t->height >> level : 1;
	const float x = uv[0] * (float)width - 0.5f, y = uv[1] * (float)height - 0.5f;
	const int left = (int)floorf(x), top = (int)floorf(y);
	const float right = x - (float)left, low = y - (float)top;

	for (int k = 0; k < 3; k++) {
		const float above = software_texel(t, level, left, top, k) * (1 - right) +
				    software_texel(t, level, left + 1, top, k) * right;
		const float below = software_texel(t, level, left, top + 1, k) * (1 - right) +
				    software_texel(t, level, left + 1, top + 1, k) * right;

		rgb[k] = above * (1 - low) + below * low;
	}
}

/* A picture where a ray meets a triangle: trilinear, by how far the places of the next pixels are
 * (OpenGL ES 2.0, 3.7.7). */
static inline void software_look_up(float rgb[3], const struct software_picture *p,
				    const struct scenery_texture *t, const struct software_hit *hit,
				    const float direction[3])
{
	const float forward = vec_dot(direction, p->view->forward);
	const int levels = (int)log2f((float)(t->width > t->height ? t->width : t->height));
	float uv[3], most = 0, lod, coarse[3], fine[3];

	software_mix(uv, hit->of->uvs, hit->share);
	for (int way = 0; way < 2; way++) {
		struct software_hit beside;
		float to[3], there[3];

		vec_add_scaled(to, direction,
			       forward * 2 *
				       (way == 0 ? p->view->tan_x / (float)p->view->width_px
						 : p->view->tan_y / (float)p->view->height_px),
			       way == 0 ? p->view->right : p->view->up);
		(void)software_meets(&beside, hit->of, to);
		software_mix(there, hit->of->uvs, beside.share);
		most = vec_most(most, fabsf(there[0] - uv[0]) * t->width);
		most = vec_most(most, fabsf(there[1] - uv[1]) * t->height);
	}
	lod = vec_least(vec_most(log2f(most), 0), (float)levels);
	software_bilinear(fine, t, (int)lod, uv);
	software_bilinear(coarse, t, (int)lod < levels ? (int)lod + 1 : levels, uv);
	vec_mix(rgb, fine, coarse, lod - floorf(lod));
}

/* How the place goes where the picture goes right and up, all over a triangle. */
static inline void software_ways(float right[3], float top[3], const struct software_triangle *t)
{
	const float u1 = t->uvs[1][0] - t->uvs[0][0], v1 = t->uvs[1][1] - t->uvs[0][1];
	const float u2 = t->uvs[2][0] - t->uvs[0][0], v2 = t->uvs[2][1] - t->uvs[0][1];
	const float area = u1 * v2 - u2 * v1;
	float ab[3], ac[3];

	vec_sub(ab, t->corners[1], t->corners[0]);
	vec_sub(ac, t->corners[2], t->corners[0]);
	for (int k = 0; k < 3; k++) {
		right[k] = (ab[k] * v2 - ac[k] * v1) / area;
		top[k] = (ab[k] * u2 - ac[k] * u1) / area; /* v grows downwards */
	}
}

static inline void software_shade(float rgb[3], const struct software_picture *p,
				  const struct software_hit *hit, const float direction[3])
{
	const struct software_triangle *t = hit->of;
	const struct scenery_fog *fog = &p->scenery->fog;
	struct appearance_place place = { .footprint_m = hit->distance / p->view->focal_px };
	float colour[3];

	software_mix(place.surface, t->colours, hit->share);
	if (t->texture) {
		software_look_up(colour, p, t->texture, hit, direction);
		for (int k = 0; k < 3; k++)
			place.surface[k] *= colour[k];
	}
	if (t->map) {
		software_look_up(place.map, p, t->map, hit, direction);
		software_ways(place.right, place.top, t);
		place.is_back = hit->is_back;
	}
	vec_copy(rgb, place.surface);
	if (t->material->by_pixel) {
		software_mix(place.normal, t->normals, hit->share);
		vec_scale(place.normal, hit->is_back ? -1 : 1, place.normal);
		vec_normalise(place.normal);
		software_mix(place.in_node, t->places, hit->share);
		vec_scale(place.to_eye, -1, direction);
		appearance_colour(rgb, t->material, &t->solid, &place, &p->light);
	}
	if (!(fog->range_m > 0))
		return;
	for (int k = 0; k < 3; k++)
		colour[k] = (float)fog->rgb[k] / 255;
	vec_mix(rgb, rgb, colour, appearance_fog(hit->distance, fog->range_m, fog->is_exponential));
}

static inline int software_from_far(const void *left, const void *right)
{
	const struct software_hit *a = left, *b = right;

	return (a->distance < b->distance) - (a->distance > b->distance);
}

/* Sets the colour that a ray sees: what is solid, and what is transparent over it, from far to
 * near. */
static inline void software_ray(float rgb[3], const struct software_picture *p,
				const float direction[3])
{
	struct software_hit clear[SOFTWARE_HITS_MAX], hit, solid = { .distance = INFINITY };
	int count = 0;

	for (uint32_t i = 0; i < p->count; i++) {
		if (!software_meets(&hit, &p->triangles[i], direction))
			continue;
		if (hit.of->material->opacity < 1) {
			CHECK(count < SOFTWARE_HITS_MAX);
			clear[count++] = hit;
		} else if (hit.distance < solid.distance) {
			solid = hit;
		}
	}
	for (int k = 0; k < 3; k++)
		rgb[k] = (float)p->root->background[k] / 255;
	if (solid.of)
		software_shade(rgb, p, &solid, direction);
	qsort(clear, (size_t)count, sizeof(*clear), software_from_far);
	for (int i = 0; i < count; i++) {
		float over[3];

		if (clear[i].distance >= solid.distance)
			continue;
		software_shade(over, p, &clear[i], direction);
		vec_mix(rgb, rgb, over, clear[i].of->material->opacity);
	}
}

/* rgba: 4 bytes a pixel, row 0 on top. */
static inline void software_draw(const struct software_picture *p, uint8_t *rgba)
{
	const struct view *view = p->view;

	for (int i = 0; i < view->width_px * view->height_px; i++) {
		const float x =
			((float)(i % view->width_px) + 0.5f) * 2 / (float)view->width_px - 1;
		const float y =
			1 - ((float)(i / view->width_px) + 0.5f) * 2 / (float)view->height_px;
		float direction[3], rgb[3];

		vec_copy(direction, view->forward);
		vec_add_scaled(direction, direction, x * view->tan_x, view->right);
		vec_add_scaled(direction, direction, y * view->tan_y, view->up);
		vec_normalise(direction);
		software_ray(rgb, p, direction);
		for (int k = 0; k < 3; k++)
			rgba[4 * i + k] = (uint8_t)lrintf(rgb[k] * 255);
		rgba[4 * i + 3] = 255;
	}
}

#endif
