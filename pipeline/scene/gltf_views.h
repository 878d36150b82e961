/* The views of a glTF 2.0 scene: its cameras in the order of its nodes, or the way of one that an
 * animation moves. */
#ifndef GOPURA_PIPELINE_SCENE_GLTF_VIEWS_H
#define GOPURA_PIPELINE_SCENE_GLTF_VIEWS_H

#include "pipeline/scene/gltf.h"
#include "pipeline/scene/scene_views.h"

/* Gets the way of the moving camera of that name, which is its node's or its own (glTF 2.0, 3.10).
 * With NULL: of the only moving one, or, if none moves, all cameras that stand still. scene: the
 * name of one of the file's scenes, NULL: the one that it shows first. *out is the caller's to
 * finish, also on failure. Returns a negative errno with a diagnostic: -EINVAL: there is no such
 * camera or scene; -ENOTSUP: it is orthographic; -EBADMSG: its way is not valid; -EFBIG: past a
 * limit; -ENOMEM. */
must_check int gltf_views_read(struct scene_views *out, const struct gltf *gltf, const char *scene,
			       const char *name);

#endif
