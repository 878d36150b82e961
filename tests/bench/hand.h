/* A scripted hand: it traces outlines of what is in a mask and draws strokes through it, as a
 * person would, for the measurement of selection tools. Masks have HAND_WIDTH x HAND_HEIGHT bytes,
 * 0 or not. */
#ifndef GOPURA_TESTS_BENCH_HAND_H
#define GOPURA_TESTS_BENCH_HAND_H

#include <stdbool.h>
#include <stdint.h>

enum {
	HAND_WIDTH = 1280,
	HAND_HEIGHT = 720,
	HAND_PIXELS = HAND_WIDTH * HAND_HEIGHT,
	HAND_POINTS_MAX = 20000
};

struct hand_path {
	float (*points)[2]; /* room for HAND_POINTS_MAX */
	uint32_t count;
};

void hand_seed(uint64_t seed); /* of its chance */

/* Appends a point, if there is room. */
void hand_add_point(struct hand_path *path, float x, float y);
/* Copies the largest connected piece of a mask. Returns its pixels. */
uint32_t hand_largest_piece(uint8_t *out, const uint8_t *mask);
/* The outer border of a mask that is one piece. */
void hand_trace(struct hand_path *out, const uint8_t *mask);
/* A stroke through the middle of a piece: from its deepest pixel both ways along its longer axis,
 * as far as it is half as deep. */
void hand_through_middle(struct hand_path *out, const uint8_t *mask);

/* Makes of a path what a hand that has to stay within width_px makes of it: it cuts corners,
 * trembles and slips. Returns seconds: after a moment it moves by the steering law (Accot and Zhai
 * 1997), the faster the wider the path. */
float hand_draw(struct hand_path *path, bool closed, float width_px);

#endif
