/* The views of a VRML97 scene: its Viewpoints in the order of the files, or the way of one that
 * interpolators move. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_VIEWS_H
#define GOPURA_PIPELINE_SCENE_VRML_VIEWS_H

#include "base/diagnostics.h"
#include "pipeline/scene/scene_views.h"
#include "pipeline/scene/vrml.h"

/* Gets the way of the moving Viewpoint with that description (ISO/IEC 14772-1 6.53). With NULL: of
 * the only moving one, or, if none moves, all Viewpoints that stand still. *out is the caller's to
 * finish, also on failure. Returns a negative errno with a diagnostic: -EINVAL: there is no such
 * Viewpoint; -EBADMSG: its way is not valid; -EFBIG: past a limit of scene_views.h; -ENOMEM. */
must_check int vrml_views_read(struct scene_views *out, const struct vrml *scene,
			       const char *description, struct diagnostics *diagnostics);

#endif
