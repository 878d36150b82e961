/* One cut of patches turns into the next by and by (pure; no GL).
 *
 * Each group has a share, from 0 to 1, of the pixels in which it is refined, and each pixel a
 * number u of its own: where u lies below the share it shows the group's patches, elsewhere those
 * that it replaces. No group has a larger share than one it depends on, so a patch is drawn where
 * u lies in a range, [what replaces it, its own group), and of the patches that cover one another
 * every pixel shows exactly one. */
#ifndef GOPURA_RENDER_PATCHES_DISSOLVE_H
#define GOPURA_RENDER_PATCHES_DISSOLVE_H

#include "render/patches/cut.h"

enum {
	DISSOLVE_MS = 250,
	DISSOLVE_WAIT_MS = 500 /* at most, for images of what is about to show */
};

struct dissolve {
	const struct cut *cut; /* borrowed */
	float *share;          /* per group; owned, like all below */
	float *waited_ms;      /* of those about to show */
	uint8_t *unready;      /* set from outside since the last step */
	bool moving;           /* some share is on its way */
};

/* Where a patch is drawn: u in [low, high). */
struct dissolve_range {
	float low, high;
};

/* The cut must outlive it. -ENOMEM. */
must_check int dissolve_init(struct dissolve *dissolve, const struct cut *cut);
void dissolve_finish(struct dissolve *dissolve);

/* Towards what the cut shows, after cut_update. A group that would begin to show while it is
 * unready waits, but not for ever. What is not loaded is gone at once. */
void dissolve_step(struct dissolve *dissolve, const uint8_t *loaded, float passed_ms);
/* Some of a group that is about to show lacks what it will be coloured by. */
void dissolve_hold(struct dissolve *dissolve, uint32_t group);

struct dissolve_range dissolve_range(const struct dissolve *dissolve, uint32_t patch);
bool dissolve_draws(struct dissolve_range range);    /* anywhere */
bool dissolve_is_whole(struct dissolve_range range); /* everywhere */

#endif
