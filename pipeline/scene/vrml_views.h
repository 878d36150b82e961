/* The views of a VRML97 scene: its Viewpoints in the order of the files, or the way of one that
 * interpolators move. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_VIEWS_H
#define GOPURA_PIPELINE_SCENE_VRML_VIEWS_H

#include "base/diagnostics.h"
#include "pipeline/scene/vrml.h"

enum { VRML_VIEWPOINTS_MAX = 256, VRML_VIEW_KEYS_MAX = 1024 };

struct vrml_view {
	float eye[3], target[3]; /* in the file's axes and unit */
	/* Of a moving Viewpoint: since its way began. Ascends; where the Viewpoint jumps, the
	 * views before and after have one time. */
	float time_s;
};

/* Zeroed is empty. */
struct vrml_views {
	struct vrml_view *items; /* owned */
	uint32_t count, room;
	bool moves; /* they are one Viewpoint at the times of its keys, and at both ends */
};

/* Gets the way of the moving Viewpoint with that description (ISO/IEC 14772-1 6.53). With NULL: of
 * the only moving one, or, if none moves, all Viewpoints that stand still. *out is the caller's to
 * finish, also on failure. Returns a negative errno with a diagnostic: -EINVAL: there is no such
 * Viewpoint; -EBADMSG: its way is not valid; -EFBIG: past a limit above; -ENOMEM. */
must_check int vrml_views_read(struct vrml_views *out, const struct vrml *scene,
			       const char *description, struct diagnostics *diagnostics);
void vrml_views_finish(struct vrml_views *views); /* NULL is fine */

#endif
