/* Makes a mesh with shapes. Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_SCENERY_BEND_H
#define GOPURA_PIPELINE_SCENE_SCENERY_BEND_H

#include "pipeline/scene/scenery_maker.h"

/* Sets all of *mesh but node and material, as scenery_add_bent says. has_picture: uv counts. On
 * success its arrays are the caller's. -EFBIG: past a limit of format/scenery.h; -EBADMSG: a
 * corner's point is none, or nothing has a size; -ENOMEM. */
must_check int scenery_bend_mesh(struct scenery_mesh *mesh, const struct soup *soup,
				 float crease_rad, bool has_picture,
				 const struct scenery_bend *bend);

#endif
