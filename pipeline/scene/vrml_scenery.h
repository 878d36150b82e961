/* Adds a VRML97 scene to scenery: what a touch or a timer moves becomes nodes and motions, and all
 * else meshes. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_SCENERY_H
#define GOPURA_PIPELINE_SCENE_VRML_SCENERY_H

#include "base/diagnostics.h"
#include "pipeline/scene/scenery_maker.h"
#include "pipeline/scene/vrml.h"

/* Adds the scene below a node; options open its pictures. What is left out is a diagnostic in
 * warnings, with file and line. Returns a negative errno with a diagnostic: -EBADMSG: a shape or an
 * interpolator is not valid; -EFBIG: past a limit of format/scenery.h; -ENOMEM. The maker is then
 * only good for scenery_maker_finish. */
must_check int vrml_scenery_add(struct scenery_maker *maker, const struct vrml *scene,
				uint32_t node, const struct vrml_options *options,
				struct diagnostics *diagnostics, struct diagnostics *warnings);

#endif
