/* The places where a visitor was before each step: what was open, and where the eye stood or was
 * flying to. A step back leads to the last place that differs from the current one. Pure. */
#ifndef GOPURA_APP_VISIT_WAY_BACK_H
#define GOPURA_APP_VISIT_WAY_BACK_H

#include <stdbool.h>
#include <stdint.h>

enum {
	WAY_BACK_MAX = 32, /* most steps that are kept */
	WAY_BACK_QUERY_BYTES = 128,
};

struct place {
	float eye_m[3], target_m[3];
	int card, page; /* open part, or -1 */
	float read;     /* scroll position: share of the page above the visible part */
	bool wide;      /* the page covers the whole panel */
	bool searching;
	char query[WAY_BACK_QUERY_BYTES]; /* what is typed, while searching; else "" */
	bool on_tour;                     /* on a visitor's tour, running or halted */
};

struct way_back {
	struct place places[WAY_BACK_MAX];
	uint32_t count;
};

/* Records the place where a step begins. The oldest place is dropped if there are more than
 * WAY_BACK_MAX. */
void way_back_note(struct way_back *way, const struct place *here);
/* Takes the last place that differs from here, and drops it and those after it. Returns false if
 * there is none. near_m: eyes no farther apart count as in the same place. */
bool way_back_take(struct way_back *way, const struct place *here, float near_m, struct place *out);

#endif
