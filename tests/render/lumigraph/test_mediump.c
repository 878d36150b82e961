/* What fragments compute where they have mediump alone, as twins in C of the shaders' formulas
 * (render/lumigraph/surface.c, render/lumigraph/depth.c) that round every step to ten bits of
 * mantissa, against doubles: over random points, pieces and places of a temple 60 m wide. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "format/samples.h"
#include "geometry/vec.h"
#include "render/display/gl.h"
#include "render/lumigraph/aim.h"
#include "tests/check.h"

enum {
	CASES = 200000,
	SLOTS_BEFORE = GL_LIMIT_MEDIUMP_PX / 2 / SAMPLE_IMAGE_PX,
	SPAN_PX = 192, /* of a face, from the middle of a piece: a piece of 256 triangles is smaller
			*/
};

static const float box_m[3] = { 60, 60, 35 };

static float far_m(void)
{
	return 2.2f * sqrtf(vec_dot(box_m, box_m));
}

static double slack_m(double depth_m)
{
	return (double)far_m() / 6800 + 0.001 * depth_m; /* depth_slack_m, and the shader's share */
}

/* To the nearest that 16 bits hold. */
static double half(double value)
{
	int exponent;
	if (value == 0 || !isfinite(value))
		return value;
	frexp(value, &exponent);
	exponent = exponent < -13 ? -13 : exponent; /* denormals */
	double quantum = ldexp(1, exponent - 11);
	double rounded = rint(value / quantum) * quantum;
	return fabs(rounded) > 65504 ? copysign(INFINITY, value) : rounded;
}

static double times(double a, double b)
{
	return half(half(a) * half(b));
}

static double plus(double a, double b)
{
	return half(half(a) + half(b));
}

static double over(double a, double b)
{
	return half(half(a) / half(b));
}

static double random_within(double low, double high)
{
	return low + (high - low) * rand() / RAND_MAX;
}

/* A place on a piece that a face sees. */
struct place {
	struct aim aim;
	double q[3];    /* what the vertices hand over: cells times depth, depth, from the aim's */
	double cell[2]; /* exact: columns and rows of the face */
	double depth_m; /* exact */
	double way[2];  /* exact: cells from the aim's */
};

static void random_point(float out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = (float)random_within(0, (double)box_m[i]);
}

/* false: it does not see that. */
static bool place_from(struct place *out, const struct cube_axes *axes, const float point[3],
		       const float at[3])
{
	double right = 0, up = 0;
	out->depth_m = 0;
	for (int i = 0; i < 3; i++) {
		double to = (double)at[i] - (double)point[i];
		right += to * (double)axes->right[i];
		up += to * (double)axes->up[i];
		out->depth_m += to * (double)axes->forward[i];
	}
	if (out->depth_m < 0.0004 * (double)far_m() || fabs(right) > out->depth_m ||
	    fabs(up) > out->depth_m)
		return false;
	out->cell[0] = 16 + 16 * right / out->depth_m;
	out->cell[1] = 16 - 16 * up / out->depth_m;
	for (int k = 0; k < 2; k++)
		out->way[k] = out->cell[k] - (double)out->aim.cell[k];
	return true;
}

/* In metres from the eye, as the kiosk draws: floats. */
static void random_place(struct place *out)
{
	float eye[3], point[3], centre[3], at[3];
	do {
		float radius = (float)random_within(
			0.05, (double)vec_distance(box_m, (float[3]){ 0 }) / 16);
		const struct cube_axes *axes = &cube_axes[rand() % CUBE_FACES];
		random_point(eye);
		random_point(point);
		random_point(centre);
		vec_sub(point, point, eye);
		vec_sub(centre, centre, eye);
		for (int i = 0; i < 3; i++)
			at[i] = centre[i] + radius * (float)random_within(-0.57, 0.57);
		aim_at(&out->aim, axes, point, centre, radius, far_m());
		for (int r = 0; r < 3; r++)
			out->q[r] = (double)(vec_dot(out->aim.rows[r], at) + out->aim.rows[r][3]);
		if (place_from(out, axes, point, at))
			return;
	} while (true);
}

/* ---- where in the atlas */

/* Twin: the coordinate in the atlas along k, for a tile of that level in that slot. *exact_px:
 * where in that tile's image the place is. */
static double place_in_atlas(const struct place *p, int k, int level, int slot, double *exact_px)
{
	const double atlas = GL_LIMIT_MEDIUMP_PX, first = (double)p->aim.cell[k];
	double z = plus(p->q[2], (double)p->aim.depth_m);
	double way = over(p->q[k], z);
	double cell = plus(first, floor(way));
	double share = ldexp(1, level) / AIM_CELLS;
	double corner = floor(times(plus(cell, 0.5), share));
	double local = plus(times(way, share), plus(times(first, share), -corner));
	double inner = plus(times(local, SAMPLE_TILE_PX / atlas), SAMPLE_APRON_PX / atlas);
	*exact_px = SAMPLE_APRON_PX + (p->cell[k] * share - corner) * SAMPLE_TILE_PX;
	return plus(times(slot, SAMPLE_IMAGE_PX / atlas), inner);
}

static double pixels_a_cell(int level)
{
	return ldexp(SAMPLE_TILE_PX, level) / AIM_CELLS;
}

static void an_image_is_met_within_half_a_pixel(void **state)
{
	(void)state;
	double worst = 0;
	for (int n = 0; n < CASES; n++) {
		struct place p;
		int level = rand() % 6, slot = rand() % (2 * SLOTS_BEFORE) - SLOTS_BEFORE;
		double exact_px;
		random_place(&p);
		for (int k = 0; k < 2; k++) {
			if (fabs(p.way[k]) * pixels_a_cell(level) > SPAN_PX)
				continue;
			double at = place_in_atlas(&p, k, level, slot, &exact_px);
			double off = at * GL_LIMIT_MEDIUMP_PX - slot * SAMPLE_IMAGE_PX - exact_px;
			worst = fmax(worst, fabs(off));
		}
	}
	print_message("images: %.3f px\n", worst);
	CHECK(worst < 0.5);
}

/* Far from the piece's middle the error grows with the way there, and with nothing else. */
static void far_from_the_middle_the_error_is_a_share_of_the_way(void **state)
{
	(void)state;
	for (int n = 0; n < CASES; n++) {
		struct place p;
		double exact_px;
		random_place(&p);
		double at = place_in_atlas(&p, 0, 5, 0, &exact_px) * GL_LIMIT_MEDIUMP_PX;
		double way_px = fabs(p.way[0]) * pixels_a_cell(5);
		CHECK(fabs(at - exact_px) < 0.5 + way_px * 4 / 2048);
	}
}

/* ---- what is hidden */

/* Twin: how far behind the face's depths; those are 5, 6 and 5 bits as a texture gives them. */
static double behind_m(const struct place *p, int steps)
{
	double high = floor(plus(times(half((steps >> 11) / 31.0), 31), 0.5));
	double middle = floor(plus(times(half((steps >> 5 & 63) / 63.0), 63), 0.5));
	double low = floor(plus(times(half((steps & 31) / 31.0), 31), 0.5));
	double first = floor((double)p->aim.units / 64);
	double units = plus(times(plus(high, -first), 64),
			    plus(middle, -((double)p->aim.units - 64 * first)));
	units = plus(units, times(low, 1.0 / 32));
	return plus(p->q[2], -times(units, (double)aim_unit_m(far_m())));
}

static double seen(const struct place *p, int steps, double slack)
{
	double z = plus(p->q[2], (double)p->aim.depth_m);
	double soft = plus(slack, times(0.001, z));
	return fmin(fmax(plus(2, -over(behind_m(p, steps), soft)), 0), 1);
}

static void what_is_hidden_is_told_within_half_the_slack(void **state)
{
	(void)state;
	const double step_m = (double)far_m() / 65535;
	double worst = 0;
	for (int n = 0; n < CASES; n++) {
		struct place p;
		random_place(&p);
		double slack = slack_m(p.depth_m), front = p.depth_m + random_within(-4, 4) * slack;
		int steps = (int)fmin(fmax(front / step_m, 0), 65535);
		double exact = p.depth_m - steps * step_m;
		worst = fmax(worst, fabs(behind_m(&p, steps) - exact) / slack);
		double weight = seen(&p, steps, (double)far_m() / 6800);
		CHECK(exact > 0.5 * slack || weight == 1);
		CHECK(exact < 2.5 * slack || weight == 0);
		CHECK(fabs(weight - fmin(fmax(2 - exact / slack, 0), 1)) < 0.5);
	}
	print_message("depths: %.3f of the slack\n", worst);
	CHECK(worst < 0.5);
}

static void nothing_behind_a_point_hides_nothing(void **state)
{
	(void)state;
	for (int n = 0; n < CASES / 10; n++) {
		struct place p;
		random_place(&p);
		CHECK(seen(&p, 65535, (double)far_m() / 6800) == 1);
	}
}

/* Twin of depth.c: a depth as two bytes, by way of a patch's own base. */
static void depths_are_drawn_within_three_steps(void **state)
{
	(void)state;
	const double unit_m = (double)aim_unit_m(far_m());
	int worst = 0;
	for (int n = 0; n < CASES; n++) {
		double centre = random_within(0, (double)far_m() / 2.2);
		double depth = fmax(centre + random_within(-8, 8), 0); /* of a patch's radius */
		double base = floor(centre / unit_m / 8);
		double units = half((double)(float)(depth / unit_m - 8 * base));
		double high = floor(over(units, 8));
		double low = floor(times(plus(units, -times(8, high)), 32));
		int drawn = (int)(256 * plus(base, high) + low), steps = (int)(depth / unit_m * 32);
		worst = abs(drawn - steps) > worst ? abs(drawn - steps) : worst;
	}
	print_message("depths drawn: %d steps\n", worst);
	CHECK(worst <= 3);
}

/* Twin: two bytes into 5, 6 and 5 bits, none lost. */
static void depths_are_packed_without_loss(void **state)
{
	(void)state;
	for (int steps = 0; steps < 65536; steps++) {
		double x = floor(plus(times(half((steps >> 8) / 255.0), 255), 0.5));
		double y = floor(plus(times(half((steps & 255) / 255.0), 255), 0.5));
		double high = floor(over(x, 8)), middle = floor(over(y, 32));
		double six = plus(times(plus(x, -times(8, high)), 8), middle);
		double five = plus(y, -times(32, middle));
		/* What a target of 5, 6 and 5 bits keeps. */
		int r = (int)rint(31 * over(high, 31)), g = (int)rint(63 * over(six, 63));
		CHECK((r << 11 | g << 5 | (int)rint(31 * over(five, 31))) == steps);
	}
}

/* ---- the blend */

struct blended {
	double colour[4][3], weight[4], own[3], own_weight;
	int faces;
};

static void random_blend(struct blended *out)
{
	out->faces = 1 + rand() % 4;
	out->own_weight = 0.0005 + 0.05 * random_within(0, 1);
	for (int k = 0; k < 3; k++)
		out->own[k] = random_within(0, 1);
	for (int i = 0; i < out->faces; i++) {
		out->weight[i] = pow(random_within(0, 1), 4);
		for (int k = 0; k < 3; k++)
			out->colour[i][k] = (rand() % 256) / 255.0;
	}
	out->weight[0] = 1; /* the best */
}

static double as_double(double value)
{
	return value;
}

/* The shader's sum, with every step rounded by that. */
static void blend(const struct blended *b, double (*as)(double), double out[3])
{
	double sum[3] = { 0 }, weights = 0;
	for (int i = 0; i < b->faces; i++) {
		double off = 0, w = as(b->weight[i]);
		for (int k = 0; k < 3; k++) {
			double d = as(as(b->colour[i][k]) - as(b->own[k]));
			off = as(off + as(d * d));
		}
		w = as(w / as(1 + as(20 * off)));
		weights = as(weights + w);
		for (int k = 0; k < 3; k++)
			sum[k] = as(sum[k] + as(as(b->colour[i][k]) * w));
	}
	double own = as(b->own_weight), all = as(weights + own);
	for (int k = 0; k < 3; k++)
		out[k] = as(as(sum[k] + as(own * as(b->own[k]))) / all);
}

static void colours_are_right_to_two_of_255(void **state)
{
	(void)state;
	double worst = 0;
	for (int n = 0; n < CASES; n++) {
		struct blended b;
		double exact[3], rounded[3];
		random_blend(&b);
		blend(&b, as_double, exact);
		blend(&b, half, rounded);
		for (int k = 0; k < 3; k++)
			worst = fmax(worst, 255 * fabs(exact[k] - rounded[k]));
	}
	print_message("colours: %.2f of 255\n", worst);
	CHECK(worst < 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_image_is_met_within_half_a_pixel),
		cmocka_unit_test(far_from_the_middle_the_error_is_a_share_of_the_way),
		cmocka_unit_test(what_is_hidden_is_told_within_half_the_slack),
		cmocka_unit_test(nothing_behind_a_point_hides_nothing),
		cmocka_unit_test(depths_are_drawn_within_three_steps),
		cmocka_unit_test(depths_are_packed_without_loss),
		cmocka_unit_test(colours_are_right_to_two_of_255),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
