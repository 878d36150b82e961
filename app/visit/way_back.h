/* Where a visitor was before each step: what was open, and where the eye stood or was going. A step
 * back leads to the last such place that is another than here. Pure. */
#ifndef GOPURA_APP_VISIT_WAY_BACK_H
#define GOPURA_APP_VISIT_WAY_BACK_H

#include <stdbool.h>
#include <stdint.h>

enum { WAY_BACK_MAX = 32 }; /* steps that are remembered */

struct place {
	float eye_m[3], target_m[3];
	int card, page; /* parts, or -1 */
	float read;     /* of the page: the share of it above what is seen */
	bool wide;      /* the page has the whole panel */
	bool searching;
	bool on_tour; /* a visitor's: flown, or halted */
};

struct way_back {
	struct place places[WAY_BACK_MAX];
	uint32_t count;
};

/* A step begins here. The oldest place is forgotten where there are too many. */
void way_back_note(struct way_back *way, const struct place *here);
/* The last place that is not here, which is forgotten with what came after it. false: there is
 * none. near_m: eyes no farther apart stand in the same place. */
bool way_back_take(struct way_back *way, const struct place *here, float near_m, struct place *out);

#endif
