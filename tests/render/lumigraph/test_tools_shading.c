/* The raking light and the section: their geometry by itself, and the shaders against their twins.
 */
#include <string.h>

#include "geometry/light.h"
#include "geometry/section.h"
#include "geometry/vec.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "render/lumigraph/raking_light.h"
#include "tests/check.h"

static const float right[3] = { 1, 0, 0 }, up[3] = { 0, 0, 1 }, forward[3] = { 0, 1, 0 };

static void the_light_comes_from_where_the_finger_is(void **state)
{
	struct rake rake = { .on = true };
	float to[3];
	(void)state;

	rake_place(&rake, 1, 0); /* on the ring, at its right */
	rake_direction(&rake, right, up, forward, to);
	CHECK(to[0] > 0.99f && fabsf(to[2]) < 1e-6f);
	CHECK(fabsf(asinf(-to[1]) * 180 / (float)M_PI - RAKE_LOW_DEG) < 0.01f);
	rake_place(&rake, 0, -1); /* below */
	rake_direction(&rake, right, up, forward, to);
	CHECK(to[2] < -0.99f && fabsf(to[0]) < 1e-6f);
	rake_place(&rake, 0, 0);
	rake_direction(&rake, right, up, forward, to);
	CHECK(fabsf(asinf(-to[1]) * 180 / (float)M_PI - RAKE_HIGH_DEG) < 0.01f);
	rake_place(&rake, 300, 400); /* a finger that slid out of the ring */
	CHECK(fabsf(rake.at[0] - 0.6f) < 1e-6f && fabsf(rake.at[1] - 0.8f) < 1e-6f);
}

static void the_light_sinks_towards_the_ring_and_goes_nowhere_else(void **state)
{
	float before = 1;
	(void)state;

	for (int step = 0; step <= 100; step++) {
		struct rake rake = { .on = true };
		float to[3], turn = (float)step;

		rake_place(&rake, (float)step / 100 * cosf(turn), (float)step / 100 * sinf(turn));
		rake_direction(&rake, right, up, forward, to);
		CHECK(fabsf(vec_length(to) - 1) < 1e-5f);
		CHECK(-to[1] < before); /* its height over the picture */
		before = -to[1];
	}
}

static void relief_stands_out_in_the_light_of_the_ring(void **state)
{
	static const float flat[3] = { 0, -1, 0 }, sun[3] = { 0.6f, -0.64f, 0.48f };
	const float slope = 0.3f; /* of a relief's flank */
	const float left[3] = { -sinf(slope), -cosf(slope), 0 };
	const float facing[3] = { sinf(slope), -cosf(slope), 0 };
	struct rake low = { .on = true, .at = { 1, 0 } }, high = { .on = true };
	float to_low[3], to_high[3], contrast_low, contrast_high;
	(void)state;

	rake_direction(&low, right, up, forward, to_low);
	rake_direction(&high, right, up, forward, to_high);
	contrast_low = rake_light_at(facing, 1, sun, false, to_low) /
		       rake_light_at(left, 1, sun, false, to_low);
	contrast_high = rake_light_at(facing, 1, sun, false, to_high) /
			rake_light_at(left, 1, sun, false, to_high);
	CHECK(contrast_low > 2.5f && contrast_low > 2 * contrast_high);
	/* A wall that the eye faces is to be seen wherever the lamp is. */
	CHECK(rake_light_at(flat, 1, sun, false, to_low) > 0.3f);
	CHECK(rake_light_at(flat, 1, sun, false, to_high) < 1.5f);
}

static void what_was_baked_goes_out_again(void **state)
{
	static const float sun[3] = { 0, 0, 1 };
	const float a[3] = { 0, -1, 0 }, b[3] = { 0, -0.6f, 0.8f }; /* the sun is on the second */
	struct rake rake = { .on = true, .at = { 1, 0 } };
	float to[3], shown_a, shown_b;
	(void)state;

	rake_direction(&rake, right, up, forward, to);
	shown_a = light_at(a, 1, sun) * rake_light_at(a, 1, sun, true, to);
	shown_b = light_at(b, 1, sun) * rake_light_at(b, 1, sun, true, to);
	CHECK(fabsf(shown_a - rake_light_at(a, 1, sun, false, to)) < 1e-5f);
	CHECK(fabsf(shown_b - rake_light_at(b, 1, sun, false, to)) < 1e-5f);
}

/* ---- the shaders */

enum { CASES = 256 };

static void the_shader_and_its_twin_agree(void **state)
{
	static const char vertex[] = "attribute vec4 a_at;\n"
				     "attribute vec4 a_normal;\n" /* open share */
				     "uniform vec4 u_sun;\n"
				     "varying vec4 v_of;\n"
				     "void main() {\n"
				     "	v_of = rake_of(a_normal.xyz, a_normal.w, u_sun);\n"
				     "	gl_Position = a_at;\n"
				     "	gl_PointSize = 1.0;\n"
				     "}\n";
	static const char fragment[] =
		"uniform vec3 u_rake;\n"
		"varying vec4 v_of;\n"
		"void main() {\n"
		"	gl_FragColor = vec4(rake_light(v_of, u_rake) / 4.0);\n"
		"}\n";
	static const char *const precisions[] = { "precision highp float;\n",
						  "precision mediump float;\n" };
	static const float sun[3] = { 0.6f, -0.64f, 0.48f };
	struct rake rake = { .on = true, .at = { 0.5f, 0.4f } };
	float at[CASES][4], normals[CASES][4], to[3];
	uint8_t seen[4 * CASES];
	struct headless *headless;
	struct gl_target target;
	(void)state;

	CHECK(headless_create(&headless) == 0);
	CHECK(gl_target_create(&target, CASES, 1) == 0);
	rake_direction(&rake, right, up, forward, to);
	for (int i = 0; i < CASES; i++) {
		const float z = 1 - 2 * ((float)i + 0.5f) / CASES, turn = 2.4f * (float)i;
		const float flat = sqrtf(1 - z * z);

		memcpy(normals[i],
		       ((float[4]){ flat * cosf(turn), flat * sinf(turn), z,
				    (float)(i % 16) / 15 }),
		       sizeof(normals[i]));
		memcpy(at[i], ((float[4]){ 2 * ((float)i + 0.5f) / CASES - 1, 0, 0, 1 }),
		       sizeof(at[i]));
	}
	for (int k = 0; k < 4; k++) {
		const bool lit = k & 1;
		const struct gl_program_source source = {
			.name = "twin",
			.vertex =
				(const char *const[]){ light_glsl, rake_vertex_glsl, vertex, NULL },
			.fragment = (const char *const[]){ precisions[k / 2], rake_fragment_glsl,
							   fragment, NULL },
			.attributes = (const char *const[]){ "a_at", "a_normal", NULL },
		};
		GLuint program;

		CHECK(gl_program_build(&program, &source) == 0);
		gl_target_bind(&target);
		glDisable(GL_DEPTH_TEST);
		glUseProgram(program);
		glUniform4f(glGetUniformLocation(program, "u_sun"), sun[0], sun[1], sun[2], lit);
		glUniform3fv(glGetUniformLocation(program, "u_rake"), 1, to);
		glBindBuffer(GL_ARRAY_BUFFER, 0);
		glEnableVertexAttribArray(0);
		glEnableVertexAttribArray(1);
		glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 0, at);
		glVertexAttribPointer(1, 4, GL_FLOAT, GL_FALSE, 0, normals);
		glDrawArrays(GL_POINTS, 0, CASES);
		CHECK(gl_target_read(&target, seen) == 0);
		for (int i = 0; i < CASES; i++) {
			const float want =
				rake_light_at(normals[i], normals[i][3], sun, lit, to) / 4 * 255;

			if (fabsf((float)seen[4 * i] - fminf(want, 255)) > (k < 2 ? 1 : 3))
				fail_msg("%s case %d: %d, not %.1f", k < 2 ? "highp" : "mediump", i,
					 seen[4 * i], (double)want);
		}
		glDeleteProgram(program);
	}
	gl_target_destroy(&target);
	headless_destroy(headless);
}

/* ---- the section */

static const float box_min[3] = { -10, -20, 0 }, box_max[3] = { 30, 20, 15 };

static void a_section_faces_the_eye_and_opens_the_middle(void **state)
{
	static const float eye[3] = { 10, -60, 8 };
	struct section section;
	float cut[4];
	(void)state;

	section_init(&section, box_min, box_max);
	section_cut(&section, eye, cut);
	CHECK(!section.on && cut[0] == 0 && cut[1] == 0 && cut[2] == 0 && cut[3] == 1);
	CHECK(section_keeps(&section, (float[3]){ 10, -15, 3 }));
	section_face(&section, eye, forward);
	CHECK(section.on && section_keeps(&section, (float[3]){ 10, 0.1f, 3 }));
	CHECK(!section_keeps(&section, (float[3]){ 10, -0.1f, 3 }));
	CHECK(!section_keeps(&section, eye)); /* so the cut is to be seen */
	section_cut(&section, eye, cut);
	CHECK(fabsf(cut[0]) < 1e-5f && fabsf(cut[1] + 1) < 1e-5f && cut[2] == 0);
	CHECK(fabsf(cut[3] + 60) < 1e-3f);
}

static void an_eye_within_has_the_section_before_it(void **state)
{
	static const float within[3] = { 10, 12, 3 };
	static const float down[3] = { 0, 0, -1 }, outside[3] = { 80, 0, 8 };
	struct section section;
	(void)state;

	section_init(&section, box_min, box_max);
	section_face(&section, within, forward);
	CHECK(!section_keeps(&section, within));
	CHECK(section_keeps(&section, (float[3]){ 10, 19, 3 }));
	section_face(&section, outside, down); /* looks down: it has no front of its own */
	CHECK(fabsf(section.turn_rad) < 1e-5f && section.push_m == 0);
}

static void a_push_moves_it_along_its_normal_and_not_out_of_the_model(void **state)
{
	struct section section;
	float reach;
	(void)state;

	section_init(&section, box_min, box_max);
	reach = section.reach_m;
	CHECK(fabsf(reach - hypotf(20, 20)) < 1e-3f);
	section_face(&section, (float[3]){ 10, -60, 8 }, forward);
	section_push(&section, 5);
	CHECK(section_keeps(&section, (float[3]){ 10, -4.9f, 3 }));
	CHECK(!section_keeps(&section, (float[3]){ 10, -5.1f, 3 }));
	section_push(&section, 1000);
	CHECK(section.push_m == reach);
	section_push(&section, -1e6f);
	CHECK(section.push_m == -reach);
	section_push(&section, reach);
	section_turn(&section, 0); /* what is cut away is towards x now */
	CHECK(section_keeps(&section, (float[3]){ 9.9f, -19, 3 }));
	CHECK(!section_keeps(&section, (float[3]){ 10.1f, 19, 3 }));
}

static void a_ray_begins_and_ends_where_the_section_keeps(void **state)
{
	static const float eye[3] = { 10, -60, 8 }, side[3] = { 1, 0, 0 }, back[3] = { 0, -1, 0 };
	struct section section;
	float least = 0.1f, most = INFINITY;
	(void)state;

	section_init(&section, box_min, box_max);
	CHECK(section_clip(&section, eye, forward, &least, &most) && least == 0.1f && isinf(most));
	section_face(&section, eye, forward);
	CHECK(section_clip(&section, eye, forward, &least, &most));
	CHECK(fabsf(least - 60) < 1e-3f && isinf(most));
	least = 0.1f;
	most = 50; /* nothing kept is so near */
	CHECK(!section_clip(&section, eye, forward, &least, &most));
	least = 0;
	most = INFINITY;
	CHECK(!section_clip(&section, eye, side, &least, &most));
	CHECK(section_clip(&section, (float[3]){ 10, 30, 8 }, back, &least, &most));
	CHECK(least == 0 && fabsf(most - 30) < 1e-3f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_light_comes_from_where_the_finger_is),
		cmocka_unit_test(the_light_sinks_towards_the_ring_and_goes_nowhere_else),
		cmocka_unit_test(relief_stands_out_in_the_light_of_the_ring),
		cmocka_unit_test(what_was_baked_goes_out_again),
		cmocka_unit_test(the_shader_and_its_twin_agree),
		cmocka_unit_test(a_section_faces_the_eye_and_opens_the_middle),
		cmocka_unit_test(an_eye_within_has_the_section_before_it),
		cmocka_unit_test(a_push_moves_it_along_its_normal_and_not_out_of_the_model),
		cmocka_unit_test(a_ray_begins_and_ends_where_the_section_keeps),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
