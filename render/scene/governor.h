/* The frame-time governor: a feedback controller that holds the frames of a moving eye at the
 * panel's rate, or at the highest divisor of it that the board can hold down to 30 a second. It
 * takes what harms least first: the picture's scale, then faces per piece, then the number of
 * triangles, then the time for uploads and planning, then how much of a picture is drawn in a
 * frame. A board needs no description for that; bounds are optional.
 *
 * It gives way at once and comes back slowly, and there is a dead band between the two loads
 * (hysteresis), so that the picture does not breathe. Pure: no GL, no clock. */
#ifndef GOPURA_RENDER_SCENE_GOVERNOR_H
#define GOPURA_RENDER_SCENE_GOVERNOR_H

#include "render/scene/scene.h"

struct governor_bounds {
	/* Least scale of pictures that are drawn in one frame while the eye moves, 0 to 1;
	 * reference pictures may become smaller (docs/picture.md). 1: nothing is governed. */
	float scale_least;
	uint32_t refresh_us; /* the panel's period; 0: 60 Hz */
};

struct governor {
	struct governor_bounds bounds;
	/* 1: everything at full effort, 0: the least with which each frame is drawn whole; below 0
	 * frames show the last picture while the next one is drawn */
	float level;
	uint32_t divisor;    /* refreshes of the panel for each frame */
	uint32_t whole;      /* triangles of the last frame in which they were not limited */
	float over;          /* load of the last frame, if it was too much; else 0 */
	int64_t quiet_us;    /* of frames in time, since the level changed or two loads were high */
	float most[2];       /* the two largest loads since then, of late frames too */
	int64_t patience_us; /* how long it must be quiet before the level rises */
	int64_t risen_us;    /* time of moving frames since the level last rose */
	int64_t held_us;     /* since it last fell */
	bool has_moved;      /* a frame of a moving eye was noted */
};

/* Starts at full effort and at the panel's rate. */
void governor_init(struct governor *governor, const struct governor_bounds *bounds);
/* Takes the time that a frame of a moving eye took, in microseconds, and the triangles in it. */
void governor_note(struct governor *governor, int64_t spent_us, uint32_t triangles);
/* Takes the time that a frame at rest took, which is drawn at full effort, and the triangles in it.
 * Until the eye moves for the first time, the level is the one that the last of them lets expect.
 */
void governor_expect(struct governor *governor, int64_t spent_us, uint32_t triangles);
/* Returns whether its bounds leave nothing to govern. */
bool governor_is_fixed(const struct governor *governor);
/* Returns the time that a frame may take now. */
int64_t governor_target_us(const struct governor *governor);
/* Returns what the next frame of a moving eye may cost. */
struct scene_effort governor_effort(const struct governor *governor);

#endif
