#include <math.h>

#include "format/cube.h"
#include "tests/check.h"

static void has_right_handed_axes(void **state)
{
	(void)state;
	for (int f = 0; f < CUBE_FACES; f++) {
		const float *d = cube_axes[f].forward, *r = cube_axes[f].right,
			    *u = cube_axes[f].up;

		CHECK(d[f / 2] == (f % 2 ? -1.0f : 1.0f));
		for (int i = 0; i < 3; i++) {
			int j = (i + 1) % 3, k = (i + 2) % 3;

			CHECK(r[i] == d[j] * u[k] - d[k] * u[j]); /* right = forward x up */
		}
	}
}

static void projects_what_it_directs(void **state)
{
	(void)state;
	for (int f = 0; f < CUBE_FACES; f++) {
		for (float u = -0.95f; u < 1; u += 0.19f) {
			for (float v = -0.95f; v < 1; v += 0.19f) {
				float direction[3], back_u, back_v;

				cube_direction(direction, f, u, v);
				for (int i = 0; i < 3; i++)
					direction[i] *= 7.5f;
				CHECK(cube_project(direction, &back_u, &back_v) == f);
				CHECK(fabsf(back_u - u) < 1e-5f && fabsf(back_v - v) < 1e-5f);
			}
		}
	}
}

static void puts_every_direction_on_a_face(void **state)
{
	(void)state;
	for (int i = 0; i < 1000; i++) {
		float a = (float)i * 0.618f, z = (float)i / 500 - 1, u, v;
		float r = sqrtf(fmaxf(0, 1 - z * z));
		float direction[3] = { r * cosf(a), r * sinf(a), z };
		int face = cube_project(direction, &u, &v);

		CHECK(face >= 0 && face < CUBE_FACES);
		CHECK(fabsf(u) <= 1 && fabsf(v) <= 1);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(has_right_handed_axes),
		cmocka_unit_test(projects_what_it_directs),
		cmocka_unit_test(puts_every_direction_on_a_face),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
