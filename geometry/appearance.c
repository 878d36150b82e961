/* The formulas of appearance.h twice, in GLSL and in C. Both must stay equal. */
#include "geometry/appearance.h"

#include <math.h>

#include "geometry/light.h"
#include "geometry/noise.h"
#include "geometry/substance.h"
#include "geometry/vec.h"

_Static_assert((int)SCENERY_SUBSTANCES == (int)SUBSTANCE_KINDS, "the format names them all");

const char appearance_glsl[] =
	"float highlight(vec3 n, vec3 to_eye, vec3 sun, float shininess) {\n"
	"	float facing = clamp(4.0 * dot(n, sun), 0.0, 1.0);\n"
	"	float along = max(dot(n, normalize(sun + to_eye)), 0.0001);\n"
	"	return facing * pow(along, shininess);\n"
	"}\n";

const char appearance_fog_glsl[] =
	"float fog_share(float d, bool is_exponential) {\n"
	"	float share = min(d, 1.0);\n"
	"	return is_exponential ? 1.0 - exp(-share / max(1.0 - share, 0.0001)) : share;\n"
	"}\n";

/* Hollows of about four centimetres, and half of that. */
const char appearance_pattern_glsl[] =
	"vec3 pattern_at(vec3 p, float footprint_m) {\n"
	"#ifdef SOLID\n"
	"	return SOLID(p.x, p.y, p.z, footprint_m);\n"
	"#else\n"
	"	float hollow = mix(0.5, noise_at(p.x * 25.0, p.y * 25.0, p.z * 25.0),\n"
	"			   noise_kept(25.0, footprint_m));\n"
	"	float mark = mix(0.5, noise_at(p.x * 51.0, p.y * 51.0, p.z * 51.0),\n"
	"			 noise_kept(51.0, footprint_m));\n"
	"	return vec3(0.7 * hollow + 0.3 * mark);\n"
	"#endif\n"
	"}\n";

static float height(const struct scenery_material *material, const float p[3], float footprint_m)
{
	float rgb[3], hollow, mark;

	if (material->substance) {
		substance_colour(rgb, (enum substance_kind)material->substance, p, footprint_m);
		return 0.3f * rgb[0] + 0.6f * rgb[1] + 0.1f * rgb[2];
	}
	hollow = noise_blend(0.5f, noise_value(p, 25, 25, 25), noise_kept(25, footprint_m));
	mark = noise_blend(0.5f, noise_value(p, 51, 51, 51), noise_kept(51, footprint_m));
	return 0.7f * hollow + 0.3f * mark;
}

static float highlight(const float normal[3], const float to_eye[3], const float sun[3],
		       float shininess)
{
	const float facing = vec_least(vec_most(4 * vec_dot(normal, sun), 0), 1);
	float half[3];

	vec_add(half, sun, to_eye);
	vec_normalise(half);
	return facing * powf(vec_most(vec_dot(normal, half), 0.0001f), shininess);
}

/* ---- substance and relief */

static void turn(float out[3], const float m[9], const float by[3])
{
	for (int row = 0; row < 3; row++)
		out[row] = m[row] * by[0] + m[3 + row] * by[1] + m[6 + row] * by[2];
}

void appearance_solid_init(struct appearance_solid *out, const struct scenery_material *material,
			   const float m[16])
{
	static const float nowhere[3], far_m = 1e6f;
	float axes[3][3], cofactors[9], aside[3] = { 0 }, mean[3], det, scale;
	int least = 0;

	matrix_cofactors(cofactors, m);
	det = vec_dot(&m[0], &cofactors[0]);
	scale = cbrtf(fabsf(det));
	for (int k = 1; k < 3; k++)
		if (fabsf(material->grain[k]) < fabsf(material->grain[least]))
			least = k;
	aside[least] = 1;
	vec_copy(axes[2], material->grain);
	vec_cross(axes[0], aside, axes[2]);
	vec_normalise(axes[0]);
	vec_cross(axes[1], axes[2], axes[0]);
	for (int column = 0; column < 3; column++)
		for (int row = 0; row < 3; row++) {
			float sum = 0;

			out->place[3 * column + row] = scale * axes[row][column];
			for (int k = 0; k < 3; k++)
				sum += cofactors[3 * k + row] * scale * axes[column][k];
			out->slope[3 * column + row] = fabsf(det) > 1e-12f ? sum / det : 0;
		}
	for (int k = 0; k < 3; k++)
		out->tint[k] = 1;
	if (!material->substance)
		return;
	substance_colour(mean, (enum substance_kind)material->substance, nowhere, far_m);
	for (int k = 0; k < 3; k++)
		out->tint[k] = 1 / mean[k];
}

/* Turns the normal of a place as the relief does. */
static void add_relief(float normal[3], const struct scenery_material *material,
		       const struct appearance_solid *solid, const float at[3], float footprint_m)
{
	const float step = vec_most(footprint_m, 0.001f);
	const float here = height(material, at, footprint_m);
	float gradient[3], slope[3];

	for (int k = 0; k < 3; k++) {
		float beside[3] = { at[0], at[1], at[2] };

		beside[k] += step;
		gradient[k] = (height(material, beside, footprint_m) - here) / step;
	}
	turn(slope, solid->slope, gradient);
	vec_add_scaled(slope, slope, -vec_dot(slope, normal), normal);
	vec_add_scaled(normal, normal, -material->relief_m, slope);
	vec_normalise(normal);
}

/* Turns the normal of a place as its normal map does. The map is that of the front: a dent in it is
 * a bump of the back. */
static void add_map(float normal[3], const struct appearance_place *place)
{
	const float side = place->is_back ? -1 : 1;
	float right[3], top[3], sum[3];

	vec_add_scaled(right, place->right, -vec_dot(place->right, normal), normal);
	vec_normalise(right);
	vec_cross(top, normal, right);
	if (vec_dot(top, place->top) < 0)
		vec_scale(top, -1, top);
	vec_scale(sum, place->map[2] * 2 - 1, normal);
	vec_add_scaled(sum, sum, (place->map[0] * 2 - 1) * side, right);
	vec_add_scaled(sum, sum, (place->map[1] * 2 - 1) * side, top);
	vec_copy(normal, sum);
	vec_normalise(normal);
}

/* ---- what is around */

/* Sets where a direction meets the cube: a face, and coordinates from 0 to 1 (OpenGL ES 2.0, table
 * 3.21). */
static int cube_face(float at[2], const float d[3])
{
	static const int8_t ways[6][2] = { { -3, -2 }, { 3, -2 }, { 1, 3 },
					   { 1, -3 },  { 1, -2 }, { -1, -2 } };
	int axis = 0, face;

	for (int k = 1; k < 3; k++)
		if (fabsf(d[k]) > fabsf(d[axis]))
			axis = k;
	face = 2 * axis + (d[axis] < 0);
	for (int k = 0; k < 2; k++) {
		const int way = ways[face][k];
		const float along = way > 0 ? d[way - 1] : -d[-way - 1];

		at[k] = (along / fabsf(d[axis]) + 1) / 2;
	}
	return face;
}

/* The mean of the four nearest pixels of a face. */
static void look_around(float rgb[3], const struct appearance_cube *cube, const float direction[3])
{
	float at[2], share[2];
	const uint8_t *pixels = cube->faces[cube_face(at, direction)];
	int low[2], high[2];

	for (int k = 0; k < 2; k++) {
		const float px = at[k] * (float)cube->side_px - 0.5f;

		share[k] = px - floorf(px);
		low[k] = (int)vec_most(floorf(px), 0);
		high[k] = (int)vec_least(floorf(px) + 1, (float)cube->side_px - 1);
	}
	for (int k = 0; k < 3; k++) {
		const uint8_t *c = pixels + k;
		const int side = cube->side_px;
		const float top = noise_blend(c[4 * (low[1] * side + low[0])],
					      c[4 * (low[1] * side + high[0])], share[0]);
		const float bottom = noise_blend(c[4 * (high[1] * side + low[0])],
						 c[4 * (high[1] * side + high[0])], share[0]);

		rgb[k] = noise_blend(top, bottom, share[1]) / 255;
	}
}

/* ---- the whole */

void appearance_colour(float rgb[3], const struct scenery_material *material,
		       const struct appearance_solid *solid, const struct appearance_place *place,
		       const struct appearance_light *light)
{
	float n[3], at[3], around[3], surface[3], shade = 1, mirror = 0, shine;

	vec_copy(n, place->normal);
	vec_copy(surface, place->surface);
	if (material->substance || material->relief_m > 0)
		turn(at, solid->place, place->in_node);
	if (material->substance) {
		substance_colour(surface, (enum substance_kind)material->substance, at,
				 place->footprint_m);
		for (int k = 0; k < 3; k++)
			surface[k] *= place->surface[k] * solid->tint[k];
	}
	if (material->normals)
		add_map(n, place);
	if (material->relief_m > 0)
		add_relief(n, material, solid, at, place->footprint_m);
	if (light->is_lit)
		shade = light_at(n, 1, light->sun);
	else if (material->relief_m > 0 || material->normals)
		shade = light_at(n, 1, light->sun) / light_at(place->normal, 1, light->sun);
	shine = highlight(n, place->to_eye, light->sun, material->shininess);
	if (material->mirror > 0 && light->around) {
		float away[3];

		vec_scale(away, 2 * vec_dot(n, place->to_eye), n);
		vec_sub(away, away, place->to_eye);
		look_around(around, light->around, away);
		mirror = material->mirror;
	}
	for (int k = 0; k < 3; k++) {
		rgb[k] = surface[k] * shade + (float)material->emissive[k] / 255;
		if (mirror > 0)
			rgb[k] = noise_blend(rgb[k], around[k], mirror);
		rgb[k] = vec_least(rgb[k] + (float)material->specular[k] / 255 * shine, 1);
	}
}

float appearance_fog(float distance_m, float range_m, bool is_exponential)
{
	const float share = vec_least(distance_m / range_m, 1);

	return is_exponential ? 1 - expf(-share / vec_most(1 - share, 0.0001f)) : share;
}
