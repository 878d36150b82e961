/* Dissolves one cut of patches into the next gradually. Pure; no GL.
 *
 * Each group has a share, from 0 to 1, of the pixels in which it is refined, and each pixel has a
 * fixed number u. Where u is below the share, the pixel shows the group's patches, elsewhere those
 * that the group replaces. No group has a larger share than one it depends on. So a patch is drawn
 * where u lies in the range [share of the group that replaces it, share of its own group), and of
 * the patches that cover one another every pixel shows exactly one. */
#ifndef GOPURA_RENDER_PATCHES_DISSOLVE_H
#define GOPURA_RENDER_PATCHES_DISSOLVE_H

#include "render/patches/cut.h"

enum {
	DISSOLVE_MS = 250,
	DISSOLVE_WAIT_MS = 500 /* longest wait for the images of a group about to appear */
};

/* How the root group appears, which replaces no patches. */
enum dissolve_root {
	ROOT_AT_ONCE, /* nothing else is shown */
	ROOT_HELD,    /* not: something else is shown in its place */
	ROOT_APPEARS, /* in the pixels of what is shown in its place, as any group */
};

struct dissolve {
	const struct cut *cut;   /* borrowed */
	enum dissolve_root root; /* set by the owner before a step */
	float *share;            /* per group; owned, like all below */
	float *waited_ms;        /* how long a group about to appear has waited */
	uint8_t *unready;        /* set by dissolve_hold since the last step */
	bool moving;             /* some share is still changing */
};

/* The pixels in which a patch is drawn: those with u in [low, high). */
struct dissolve_range {
	float low, high;
};

/* Initialises it with all shares 0. The cut is borrowed and must outlive it. Returns 0 or
 * -ENOMEM. */
must_check int dissolve_init(struct dissolve *dissolve, const struct cut *cut);
/* Frees what it owns. */
void dissolve_finish(struct dissolve *dissolve);

/* Moves the shares towards what the cut shows; call it after cut_update. passed_ms is the time
 * since the last step. A group that would begin to appear while it is held waits, at most
 * DISSOLVE_WAIT_MS. The share of a group that is not loaded becomes 0 at once. */
void dissolve_step(struct dissolve *dissolve, const uint8_t *loaded, float passed_ms);
/* Holds a group that is about to appear, because images for it are missing. It applies to the next
 * step. */
void dissolve_hold(struct dissolve *dissolve, uint32_t group);

/* Returns the range of a patch. */
struct dissolve_range dissolve_range(const struct dissolve *dissolve, uint32_t patch);
bool dissolve_draws(struct dissolve_range range);    /* drawn in some pixels */
bool dissolve_is_whole(struct dissolve_range range); /* drawn in all pixels */

#endif
