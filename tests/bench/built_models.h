/* Two models as the paper simplifies them besides scans, built here: a room with furniture and an
 * aircraft. Parts have colours of their own and stand inside one another, as in CAD models. */
#ifndef GOPURA_TESTS_BENCH_BUILT_MODELS_H
#define GOPURA_TESTS_BENCH_BUILT_MODELS_H

#include <math.h>

#include "tests/pipeline/shapes.h"

static inline void built_colour(struct mesh *mesh, uint32_t first, uint32_t rgb)
{
	for (uint32_t v = first; v < mesh->vertex_count; v++) {
		mesh->colours[v][0] = (uint8_t)(rgb >> 16);
		mesh->colours[v][1] = (uint8_t)(rgb >> 8);
		mesh->colours[v][2] = (uint8_t)rgb;
	}
}

/* A box of n x n squares a side; its sides' vertices become one on the lattice. */
static inline void built_box(struct mesh *mesh, const float low[3], const float high[3], uint32_t n,
			     uint32_t rgb)
{
	uint32_t first = mesh->vertex_count;

	for (uint32_t side = 0; side < 6; side++)
		for (uint32_t i = 0; i < (n + 1) * (n + 1); i++) {
			float u = (float)(i % (n + 1)) / (float)n,
			      v = (float)(i / (n + 1)) / (float)n;
			uint32_t axis = side % 3, a = mesh->vertex_count;
			float at[3];

			at[axis] = side < 3 ? high[axis] : low[axis];
			at[(axis + 1) % 3] = side < 3 ? u : v;
			at[(axis + 2) % 3] = side < 3 ? v : u;
			for (uint32_t k = 1; k < 3; k++)
				at[(axis + k) % 3] = low[(axis + k) % 3] +
						     at[(axis + k) % 3] * (high[(axis + k) % 3] -
									   low[(axis + k) % 3]);
			shape_vertex(mesh, at[0], at[1], at[2]);
			if (i % (n + 1) == n || i / (n + 1) == n)
				continue;
			shape_triangle(mesh, a, a + 1, a + n + 1);
			shape_triangle(mesh, a + n + 1, a + 1, a + n + 2);
		}
	built_colour(mesh, first, rgb);
}

/* A section of a lofted part: a place for a share of the way around and along. */
typedef void (*built_section)(float out[3], float around, float along, const float *numbers);

/* A lofted part, sides times rings squares, open at both ends unless sections close. */
static inline void built_loft(struct mesh *mesh, uint32_t sides, uint32_t rings,
			      built_section section, const float *numbers, uint32_t rgb)
{
	uint32_t first = mesh->vertex_count;

	for (uint32_t r = 0; r <= rings; r++)
		for (uint32_t s = 0; s < sides; s++) {
			uint32_t a = mesh->vertex_count, b = s + 1 < sides ? a + 1 : a + 1 - sides;
			float at[3];

			section(at, (float)s / (float)sides, (float)r / (float)rings, numbers);
			shape_vertex(mesh, at[0], at[1], at[2]);
			if (r == rings)
				continue;
			shape_triangle(mesh, a, b, a + sides);
			shape_triangle(mesh, a + sides, b, b + sides);
		}
	built_colour(mesh, first, rgb);
}

/* numbers: x, y, lowest z, height, radius below, radius above. */
static inline void built_turned(float out[3], float around, float along, const float *numbers)
{
	float turn = 6.2831853f * around;
	float radius = numbers[4] + along * (numbers[5] - numbers[4]);

	out[0] = numbers[0] + radius * cosf(turn);
	out[1] = numbers[1] + radius * sinf(turn);
	out[2] = numbers[2] + along * numbers[3];
}

/* numbers: x, y, z, radius. */
static inline void built_ball(float out[3], float around, float along, const float *numbers)
{
	float turn = 6.2831853f * around, down = 3.14159265f * (1.0f - along);

	out[0] = numbers[0] + numbers[3] * sinf(down) * cosf(turn);
	out[1] = numbers[1] + numbers[3] * sinf(down) * sinf(turn);
	out[2] = numbers[2] + numbers[3] * cosf(down);
}

static inline void built_chair(struct mesh *mesh, float x, float y, float back)
{
	const uint32_t wood = 0xa0703c, cloth = 0x7c2f36;

	built_box(mesh, (float[]){ x, y, 0.42f }, (float[]){ x + 0.44f, y + 0.44f, 0.47f }, 16,
		  cloth);
	for (int leg = 0; leg < 4; leg++) {
		float lx = x + (leg & 1 ? 0.40f : 0.0f), ly = y + (leg & 2 ? 0.40f : 0.0f);

		built_box(mesh, (float[]){ lx, ly, 0 }, (float[]){ lx + 0.04f, ly + 0.04f, 0.42f },
			  8, wood);
	}
	for (int bar = 0; bar < 5; bar++)
		built_box(mesh, (float[]){ x + 0.01f + 0.1f * (float)bar, y + back, 0.47f },
			  (float[]){ x + 0.03f + 0.1f * (float)bar, y + back + 0.03f, 0.9f }, 6,
			  wood);
	built_box(mesh, (float[]){ x, y + back - 0.01f, 0.9f },
		  (float[]){ x + 0.44f, y + back + 0.04f, 0.98f }, 10, wood);
}

static inline void built_cabinet(struct mesh *mesh)
{
	built_box(mesh, (float[]){ 2.2f, 0, 0 }, (float[]){ 2.7f, 1.4f, 1.8f }, 24, 0xc8b48c);
	for (int door = 0; door < 2; door++) {
		float y = 0.04f + 0.68f * (float)door;
		float knob[4] = { 2.17f, door ? 0.78f : 0.62f, 0.95f, 0.025f };

		built_box(mesh, (float[]){ 2.18f, y, 0.1f }, (float[]){ 2.21f, y + 0.64f, 1.7f },
			  20, 0x8a6a40);
		built_box(mesh, (float[]){ 2.17f, y + 0.1f, 0.9f },
			  (float[]){ 2.19f, y + 0.54f, 1.6f }, 12, 0xa88450);
		built_loft(mesh, 20, 12, built_ball, knob, 0xd8c050);
	}
}

/* About 60 000 triangles, 2.7 m long. */
static inline struct mesh built_furniture(void)
{
	struct mesh mesh;

	shape_room(&mesh, 60000, 100000);
	built_box(&mesh, (float[]){ 0, 0, 0.70f }, (float[]){ 1.6f, 0.9f, 0.74f }, 40, 0x9c6b34);
	for (int leg = 0; leg < 4; leg++) {
		float x = leg & 1 ? 1.5f : 0.1f, y = leg & 2 ? 0.8f : 0.1f;

		built_loft(&mesh, 32, 24, built_turned, (float[]){ x, y, 0, 0.7f, 0.025f, 0.045f },
			   0x6e4a22);
	}
	built_chair(&mesh, 0.2f, -0.5f, 0.0f);
	built_chair(&mesh, 0.9f, -0.5f, 0.0f);
	built_chair(&mesh, 0.5f, 1.0f, 0.41f);
	built_cabinet(&mesh);
	built_loft(&mesh, 40, 2, built_turned, (float[]){ 1.9f, -0.3f, 0, 0.03f, 0.16f, 0.14f },
		   0x404040);
	built_loft(&mesh, 20, 40, built_turned,
		   (float[]){ 1.9f, -0.3f, 0.03f, 1.4f, 0.012f, 0.012f }, 0x808080);
	built_loft(&mesh, 48, 24, built_turned, (float[]){ 1.9f, -0.3f, 1.35f, 0.3f, 0.24f, 0.1f },
		   0xe8dcb8);
	built_loft(&mesh, 32, 20, built_ball, (float[]){ 0.8f, 0.45f, 0.84f, 0.1f }, 0x2e6e8e);
	return mesh;
}

/* numbers: length, radius. */
static inline void built_fuselage(float out[3], float around, float along, const float *numbers)
{
	float turn = 6.2831853f * around, radius = numbers[1];

	if (along < 0.15f)
		radius *= sqrtf(fmaxf(1.0f - powf(1.0f - along / 0.15f, 2.0f), 0.0f));
	else if (along > 0.65f)
		radius *= 1.0f - 0.95f * powf((along - 0.65f) / 0.35f, 1.5f);
	out[0] = along * numbers[0];
	out[1] = radius * cosf(turn);
	out[2] = radius * sinf(turn) + (numbers[1] - radius) * (along > 0.65f ? 0.6f : 0.0f);
}

/* A wing with a symmetric profile. numbers: x of its root's front, z, chords of root and tip,
 * sweep, span (negative: to the other side), rise; upright: as a fin. */
static inline void built_wing(float out[3], float around, float along, const float *numbers)
{
	float chord = numbers[2] + along * (numbers[3] - numbers[2]);
	float turn = 6.2831853f * around, x = 0.5f + 0.5f * cosf(turn);
	float thick = 0.6f * (0.2969f * sqrtf(x) - 0.126f * x - 0.3516f * x * x +
			      0.2843f * x * x * x - 0.1036f * x * x * x * x);

	thick *= (along >= 1.0f ? 0.0f : 1.0f) * chord * (sinf(turn) < 0.0f ? -1.0f : 1.0f);
	out[0] = numbers[0] + along * numbers[4] + x * chord;
	out[1] = numbers[7] > 0.0f ? thick : along * numbers[5];
	out[2] = numbers[1] + (numbers[7] > 0.0f ? along * numbers[5] : along * numbers[6] + thick);
}

/* numbers: x, y, z, length, radius: a tube with a lip. */
static inline void built_engine(float out[3], float around, float along, const float *numbers)
{
	float turn = 6.2831853f * around;
	float radius = numbers[4] * (along < 0.5f ? 0.82f : 1.0f);
	float share = along < 0.5f ? 1.0f - 2.0f * along : 2.0f * along - 1.0f;

	out[0] = numbers[0] + share * numbers[3];
	out[1] = numbers[1] + radius * cosf(turn);
	out[2] = numbers[2] + radius * sinf(turn);
}

static inline void built_stripe(struct mesh *mesh, uint32_t first)
{
	for (uint32_t v = first; v < mesh->vertex_count; v++)
		if (fabsf(mesh->positions[v][2] - 0.35f) < 0.25f) {
			mesh->colours[v][0] = 0x20;
			mesh->colours[v][1] = 0x48;
			mesh->colours[v][2] = 0xa0;
		}
}

/* About 80 000 triangles, 34 m long. */
static inline struct mesh built_aircraft(void)
{
	const uint32_t white = 0xe4e4e0, grey = 0x909498;
	struct mesh mesh;

	shape_room(&mesh, 60000, 110000);
	built_loft(&mesh, 96, 180, built_fuselage, (float[]){ 34, 2 }, white);
	built_stripe(&mesh, 0);
	for (int side = -1; side <= 1; side += 2) {
		float y = (float)side;

		built_loft(&mesh, 64, 80, built_wing,
			   (float[]){ 12, -0.8f, 6.5f, 1.6f, 7, 15 * y, 1.2f, 0 }, grey);
		built_loft(&mesh, 48, 40, built_wing,
			   (float[]){ 29.5f, 0.8f, 3.2f, 1.2f, 2.6f, 5.5f * y, 0.4f, 0 }, grey);
		built_loft(&mesh, 48, 40, built_engine,
			   (float[]){ 12.4f, 5.2f * y, -2.0f, 3.6f, 1.05f }, 0x5a6470);
	}
	built_loft(&mesh, 48, 40, built_wing, (float[]){ 27.5f, 1.4f, 5, 1.9f, 4.2f, 5.5f, 0, 1 },
		   0x2048a0);
	return mesh;
}

#endif
