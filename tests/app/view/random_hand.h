/* Gestures as a visitor's hand might make them, drawn by chance: drags, pinches, flings, flights.
 */
#ifndef GOPURA_TESTS_APP_VIEW_RANDOM_HAND_H
#define GOPURA_TESTS_APP_VIEW_RANDOM_HAND_H

#include "app/view/navigator.h"

struct random_hand {
	uint32_t seed;
	float low_m[3], high_m[3]; /* where it touches, and where flights go */
	/* Called after each step, and at the end of each gesture. */
	void (*look)(void *data, const struct navigator *nav);
	void *data;
};

enum { RANDOM_HAND_HEIGHT_PX = 720, RANDOM_HAND_STEPS = 40 };

/* Returns a number from 0 up to 1. */
static inline float random_hand_share(struct random_hand *hand)
{
	hand->seed = hand->seed * 1664525 + 1013904223;
	return (float)(hand->seed >> 8) / (1 << 24);
}

/* Makes one gesture, and lets what it began go on for a while. */
static inline void random_hand_play(struct random_hand *hand, struct navigator *nav)
{
	const float height_px = RANDOM_HAND_HEIGHT_PX;
	float at_m[3], middle_m[3];
	const float dx = random_hand_share(hand) * 60 - 30, dy = random_hand_share(hand) * 60 - 30;
	const int kind = (int)(random_hand_share(hand) * 4);

	for (int axis = 0; axis < 3; axis++) {
		at_m[axis] = hand->low_m[axis] +
			     random_hand_share(hand) * (hand->high_m[axis] - hand->low_m[axis]);
		middle_m[axis] = (hand->low_m[axis] + hand->high_m[axis]) / 2;
	}
	navigator_grab(nav, at_m);
	for (int i = 0; kind == 0 && i < 8; i++)
		navigator_turn(nav, dx, dy, height_px);
	for (int i = 0; kind == 1 && i < 8; i++)
		navigator_pinch(nav, 0.8f + random_hand_share(hand) * 0.5f, dx, dy, dx / 300,
				height_px);
	if (kind == 2)
		navigator_fling(nav, 30 * dx, 30 * dy);
	if (kind == 3)
		navigator_fly(nav, at_m, middle_m, 200);
	hand->look(hand->data, nav);
	for (int i = 0; i < RANDOM_HAND_STEPS && navigator_step(nav, 16, height_px); i++)
		hand->look(hand->data, nav);
}

#endif
