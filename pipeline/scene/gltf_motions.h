/* Makes motions of a glTF file's animations. Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_GLTF_MOTIONS_H
#define GOPURA_PIPELINE_SCENE_GLTF_MOTIONS_H

#include "pipeline/scene/gltf.h"
#include "pipeline/scene/scenery_maker.h"

/* Sets moves[i] for each node of the file that an animation moves. */
void gltf_mark_animated(const struct gltf *gltf, bool *moves);
/* Adds the animations. nodes has the scenery's node for each of the file; SCENERY_NONE: it is not
 * in the scene. Errors as gltf_scenery_add. */
must_check int gltf_motions_add(struct scenery_maker *maker, const struct gltf *gltf,
				const uint32_t *nodes, bool plays_always,
				struct diagnostics *warnings);

#endif
