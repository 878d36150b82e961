/* The views of a scene: where it is looked from, at rest or at the moments of a way. Private to
 * pipeline/scene, but for the struct. */
#ifndef GOPURA_PIPELINE_SCENE_SCENE_VIEWS_H
#define GOPURA_PIPELINE_SCENE_SCENE_VIEWS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

enum {
	SCENE_CAMERAS_MAX = 256,
	SCENE_KEYS_MAX = 1 << 14, /* of each thing that moves a camera: 9 minutes at 30 a second */
};

struct scene_view {
	float eye[3], target[3]; /* in the file's axes and unit */
	/* Of a moving camera: since its way began. Ascends; where the camera jumps, the views
	 * before and after have one time. */
	float time_s;
};

/* Zeroed is empty. */
struct scene_views {
	struct scene_view *items; /* owned */
	uint32_t count, room;
	bool moves; /* they are one camera at the times of its keys, and at both ends */
};

/* A moment of a way. Where two keys have one time the value jumps there, and the moment just before
 * is another one. */
struct scene_moment {
	float time;
	bool is_before;
};

/* Sorts moments, drops those that are there twice, and returns how many remain. */
uint32_t scene_moments_sort(struct scene_moment *moments, uint32_t count);
/* Returns whether a moment is at a key's time or after it. */
bool scene_moment_reaches(struct scene_moment moment, float key_time);

/* Adds the view of a camera at `position`, turned by a quaternion, below a place, a column-major
 * matrix. It looks along its own -z, as those of VRML97 and glTF. Returns 0, -EFBIG or -ENOMEM. */
must_check int scene_views_add(struct scene_views *views, float time_s, const float place[16],
			       const float position[3], const float turn[4]);
void scene_views_finish(struct scene_views *views); /* NULL is fine */

#endif
