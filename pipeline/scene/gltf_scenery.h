/* Adds a glTF scene to scenery: nodes that animations move become nodes and motions, and all else
 * meshes. */
#ifndef GOPURA_PIPELINE_SCENE_GLTF_SCENERY_H
#define GOPURA_PIPELINE_SCENE_GLTF_SCENERY_H

#include "pipeline/scene/gltf.h"
#include "pipeline/scene/scenery_maker.h"

struct gltf_choice {
	const char *scene; /* its name; NULL: the one that the file shows first */
	/* Animations run always and begin again; else each when what it moves is touched. */
	bool plays_always;
};

/* Adds the scene below a node. What is left out is a diagnostic in warnings. Returns a negative
 * errno with a diagnostic in those of gltf: -EINVAL: no scene has that name; -ENOTSUP: skins;
 * -EBADMSG: not valid; -EFBIG: past a limit of format/scenery.h; -ENOMEM. The maker
 * is then only good for scenery_maker_finish. */
must_check int gltf_scenery_add(struct scenery_maker *maker, const struct gltf *gltf, uint32_t node,
				const struct gltf_choice *choice, struct diagnostics *warnings);

#endif
