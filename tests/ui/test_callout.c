/* What holds of every layout, tried on a thousand random views; and that small moves stay small. */
#include "ui/callout.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "tests/check.h"

enum { ANCHORS = 200, VIEWS = 1000 };

static uint32_t random_state;

static float random_unit(void)
{
	random_state = random_state * 1664525u + 1013904223u;
	return (float)(random_state >> 8) / (float)(1 << 24);
}

static struct callout_area random_area(void)
{
	struct callout_area area = { .x_px = (int)(random_unit() * 100),
				     .y_px = (int)(random_unit() * 100),
				     .width_px = 300 + (int)(random_unit() * 3000),
				     .height_px = 100 + (int)(random_unit() * 2000),
				     .row_px = 20 + (int)(random_unit() * 60),
				     .gap_px = (int)(random_unit() * 12),
				     .lead_px = (int)(random_unit() * 30) };

	area.column_px = area.width_px / 4;
	return area;
}

static void random_anchors(struct callout_anchor *anchors, uint32_t count,
			   const struct callout_area *area)
{
	bool crowded = random_unit() < 0.3f;

	for (uint32_t i = 0; i < count; i++) {
		float x = crowded ? 0.45f + 0.1f * random_unit() : random_unit() * 1.4f - 0.2f;
		float y = crowded ? 0.45f + 0.1f * random_unit() : random_unit() * 1.4f - 0.2f;

		anchors[i] = (struct callout_anchor){
			.x_px = (float)area->x_px + x * (float)area->width_px,
			.y_px = (float)area->y_px + y * (float)area->height_px,
			.visible = random_unit() < 0.8f,
			.label_px = 20 + (int)(random_unit() * (float)(area->column_px - 20)),
		};
	}
}

static bool overlap(const struct callout *a, const struct callout *b,
		    const struct callout_area *area)
{
	return a->x_px < b->x_px + b->width_px && b->x_px < a->x_px + a->width_px &&
	       a->y_px < b->y_px + area->row_px && b->y_px < a->y_px + area->row_px;
}

/* Some point of the leader lies inside the label. */
static bool runs_over(const struct callout *leader, const struct callout *label,
		      const struct callout_area *area)
{
	for (int i = 1; i < 200; i++) {
		float t = (float)i / 200;
		float x = leader->port_x_px + t * (leader->anchor_x_px - leader->port_x_px);
		float y = leader->port_y_px + t * (leader->anchor_y_px - leader->port_y_px);

		if (x > (float)label->x_px + 0.01f &&
		    x < (float)(label->x_px + label->width_px) - 0.01f && y > (float)label->y_px &&
		    y < (float)(label->y_px + area->row_px))
			return true;
	}
	return false;
}

static void check_layout(const struct callouts *callouts, const struct callout_area *area,
			 const struct callout_anchor *anchors)
{
	for (uint32_t i = 0; i < callouts->count; i++) {
		const struct callout *c = &callouts->list[i];

		CHECK(anchors[c->part].visible);
		CHECK(c->anchor_x_px == anchors[c->part].x_px);
		CHECK(c->width_px == anchors[c->part].label_px);
		CHECK(c->x_px >= area->x_px && c->y_px >= area->y_px);
		CHECK(c->x_px + c->width_px <= area->x_px + area->width_px);
		CHECK(c->y_px + area->row_px <= area->y_px + area->height_px);
		CHECK(c->left == (c->port_x_px < c->anchor_x_px));
		for (uint32_t k = 0; k < callouts->count; k++) {
			if (k == i)
				continue;
			CHECK(callouts->list[k].part != c->part);
			CHECK(!overlap(c, &callouts->list[k], area));
			CHECK(!callouts_cross(c, &callouts->list[k]));
			CHECK(!runs_over(c, &callouts->list[k], area));
		}
	}
}

static void never_overlaps_crosses_or_leaves_the_area(void **state)
{
	struct callout_anchor anchors[ANCHORS];

	(void)state;
	random_state = 1;
	for (int view = 0; view < VIEWS; view++) {
		uint32_t count = 1 + (uint32_t)(random_unit() * (ANCHORS - 1));
		struct callout_area area = random_area();
		struct callouts callouts = { 0 };

		random_anchors(anchors, count, &area);
		callouts_layout(&callouts, &area, anchors, count);
		check_layout(&callouts, &area, anchors);
		/* The same holds when the last layout is what it starts from. */
		random_anchors(anchors, count, &area);
		callouts_layout(&callouts, &area, anchors, count);
		check_layout(&callouts, &area, anchors);
	}
}

/* With few parts and room for all, all are shown. */
static void shows_all_where_there_is_room(void **state)
{
	const struct callout_area area = { 0, 0, 1280, 640, 200, 30, 6, 10, 0, 0 };
	struct callouts callouts = { 0 };
	struct callout_anchor anchors[12];

	(void)state;
	random_state = 2;
	for (int view = 0; view < 200; view++) {
		for (int i = 0; i < 12; i++)
			anchors[i] =
				(struct callout_anchor){ 300 + random_unit() * 680,
							 50 + random_unit() * 540, true, 150, 0 };
		callouts.count = 0;
		callouts_layout(&callouts, &area, anchors, 12);
		CHECK(callouts.count == 12);
	}
}

/* Anchors that move by at most a pixel a frame: the same labels on the same sides in the same
 * order, each moving by no more than two (one, and rounding), unless leaders came to cross. */
static void follows_small_moves_quietly(void **state)
{
	const struct callout_area area = { 0, 0, 1280, 640, 200, 30, 6, 10, 0, 0 };
	struct callout_anchor anchors[14];
	struct callouts callouts = { 0 };
	int frames = 0, jumps = 0;

	(void)state;
	random_state = 3;
	for (int i = 0; i < 14; i++)
		anchors[i] = (struct callout_anchor){ 300 + random_unit() * 680,
						      50 + random_unit() * 540, true, 150, 0 };
	callouts_layout(&callouts, &area, anchors, 14);
	for (int frame = 0; frame < 2000; frame++) {
		struct callouts before = callouts;
		bool same_order = true;

		for (int i = 0; i < 14; i++) { /* turns about the middle, and trembles */
			float dx = anchors[i].x_px - 640, dy = anchors[i].y_px - 320;

			anchors[i].x_px += -dy * 0.001f + random_unit() - 0.5f;
			anchors[i].y_px += dx * 0.001f + random_unit() - 0.5f;
		}
		callouts_layout(&callouts, &area, anchors, 14);
		check_layout(&callouts, &area, anchors);
		frames++;
		if (before.count != callouts.count) {
			jumps++;
			continue;
		}
		for (uint32_t i = 0; i < callouts.count; i++)
			same_order &= callouts.list[i].part == before.list[i].part;
		jumps += !same_order;
		for (uint32_t i = 0; same_order && i < callouts.count; i++)
			CHECK(abs(callouts.list[i].y_px - before.list[i].y_px) <= 2);
	}
	/* A third of a turn about the middle: each pair passes each other about once. */
	CHECK(jumps < frames / 20);
}

/* As seen of a corner tower before the central one: the order of a frame before, kept, would lead
 * one leader through the other's dot. */
static void no_leader_runs_through_a_dot(void **state)
{
	const struct callout_area area = { .x_px = 7,
					   .y_px = 7,
					   .width_px = 1266,
					   .height_px = 640,
					   .column_px = 190,
					   .row_px = 27,
					   .gap_px = 11,
					   .lead_px = 14 };
	struct callout_anchor anchors[2] = { { 900, 120, true, 104, 0 },
					     { 700, 148, true, 136, 0 } };
	struct callouts callouts = { 0 };

	(void)state;
	callouts_layout(&callouts, &area, anchors, 2);
	CHECK(callouts.count == 2 && callouts.list[0].part == 0);
	anchors[0] = (struct callout_anchor){ 958, 163, true, 104, 0 };
	callouts_layout(&callouts, &area, anchors, 2);
	CHECK(callouts.count == 2 && callouts.list[0].part == 1);
	/* And it stays so. */
	callouts_layout(&callouts, &area, anchors, 2);
	CHECK(callouts.list[0].part == 1);
}

static void hides_what_is_hidden(void **state)
{
	const struct callout_area area = { 0, 0, 1280, 640, 200, 30, 6, 10, 0, 0 };
	struct callout_anchor anchors[3] = { { 500, 100, true, 100, 0 },
					     { 500, 200, false, 100, 0 },
					     { 100, 300, true, 100, 0 } /* under the labels */ };
	struct callouts callouts = { 0 };

	(void)state;
	callouts_layout(&callouts, &area, anchors, 3);
	CHECK(callouts.count == 1 && callouts.list[0].part == 0);
	callouts_layout(&callouts, &area, anchors, 0);
	CHECK(callouts.count == 0);
}

/* Few from far, and never none; details from near. A size that wavers changes nothing. */
static void details_wait_until_they_are_near(void **state)
{
	struct callout_area area = { 0, 0, 1280, 640, 200, 30, 6, 10, 0, 40 };
	struct callout_anchor anchors[12];
	struct callouts callouts = { 0 };

	(void)state;
	for (uint32_t i = 0; i < 12; i++)
		anchors[i] = (struct callout_anchor){ 400 + 40 * (float)i, 60 + 40 * (float)i, true,
						      100, i < 8 ? 50 : 10 };
	callouts_layout(&callouts, &area, anchors, 12);
	CHECK(callouts.count == 8);
	for (uint32_t i = 0; i < callouts.count; i++)
		CHECK(callouts.list[i].part < 8);
	for (int turn = 0; turn < 20; turn++) {
		anchors[3].size_px = turn % 2 ? 32 : 42;
		callouts_layout(&callouts, &area, anchors, 12);
		CHECK(callouts.count == 8);
	}
	anchors[3].size_px = 20;
	callouts_layout(&callouts, &area, anchors, 12);
	CHECK(callouts.count == 7);
	for (uint32_t i = 0; i < 12; i++)
		anchors[i].size_px *= 5;
	callouts_layout(&callouts, &area, anchors, 12);
	CHECK(callouts.count == 12);
	for (uint32_t i = 0; i < 12; i++)
		anchors[i].size_px = 1 + (float)i;
	callouts = (struct callouts){ 0 };
	callouts_layout(&callouts, &area, anchors, 12);
	CHECK(callouts.count == CALLOUTS_FEW);
	for (uint32_t i = 0; i < callouts.count; i++)
		CHECK(callouts.list[i].part >= 12 - CALLOUTS_FEW);
	for (uint32_t i = 0; i < 12; i++)
		anchors[i].size_px = 0;
	callouts_layout(&callouts, &area, anchors, 12);
	CHECK(callouts.count == 12);
}

/* More than fit: the important ones (the first) are shown. */
static void prefers_the_important(void **state)
{
	const struct callout_area area = { 0, 0, 1280, 300, 200, 30, 6, 10, 0, 0 };
	struct callout_anchor anchors[ANCHORS];
	struct callouts callouts = { 0 };
	uint32_t worst = 0;

	(void)state;
	random_state = 4;
	for (uint32_t i = 0; i < ANCHORS; i++)
		anchors[i] = (struct callout_anchor){ 300 + random_unit() * 680,
						      20 + random_unit() * 260, true, 150, 0 };
	callouts_layout(&callouts, &area, anchors, ANCHORS);
	CHECK(callouts.count >= 14);
	for (uint32_t i = 0; i < callouts.count; i++)
		if (callouts.list[i].part > worst)
			worst = callouts.list[i].part;
	CHECK(worst < 30); /* of 200, for 16 places in two halves */
}

static void says_how_long_it_takes(void **state)
{
	const struct callout_area area = { 0, 0, 1920, 1000, 300, 38, 8, 16, 0, 0 };
	struct callout_anchor anchors[ANCHORS];
	struct callouts callouts = { 0 };
	int64_t start_us, worst_us = 0, total_us = 0;

	(void)state;
	random_state = 5;
	for (int view = 0; view < 200; view++) {
		random_anchors(anchors, ANCHORS, &area);
		start_us = clock_thread_us();
		callouts_layout(&callouts, &area, anchors, ANCHORS);
		start_us = clock_thread_us() - start_us;
		total_us += start_us;
		if (start_us > worst_us)
			worst_us = start_us;
	}
	printf("200 parts: mean %.0f us, worst %lld us\n", (double)total_us / 200,
	       (long long)worst_us);
	CHECK(callouts.count > 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(never_overlaps_crosses_or_leaves_the_area),
		cmocka_unit_test(shows_all_where_there_is_room),
		cmocka_unit_test(follows_small_moves_quietly),
		cmocka_unit_test(no_leader_runs_through_a_dot),
		cmocka_unit_test(hides_what_is_hidden),
		cmocka_unit_test(details_wait_until_they_are_near),
		cmocka_unit_test(prefers_the_important),
		cmocka_unit_test(says_how_long_it_takes),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
