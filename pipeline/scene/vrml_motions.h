/* Makes motions of a scene's sensors, timers, interpolators and the routes between them. Private to
 * pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_MOTIONS_H
#define GOPURA_PIPELINE_SCENE_VRML_MOTIONS_H

#include "base/diagnostics.h"
#include "pipeline/scene/scenery_maker.h"
#include "pipeline/scene/vrml.h"

/* A node of the scene, and one of the scenery that stands for it; USE makes several. */
struct vrml_instance {
	const struct vrml_node *of;
	uint32_t node;
	/* Of a Material: its surface has colours of its own, or is points and lines, which have the
	 * colour in which they shine. */
	bool has_own_colours, is_lines;
	const struct vrml_node *bender; /* of a Coordinate: vrml_bender_of; else NULL */
};

/* Zeroed is empty. */
struct vrml_instances {
	struct vrml_instance *items; /* owned */
	uint32_t count, room;
};

/* Returns 0, -EFBIG or -ENOMEM. */
must_check int vrml_instances_add(struct vrml_instances *instances,
				  const struct vrml_instance *instance);
void vrml_instances_finish(struct vrml_instances *instances);

/* A route that is not kept is a diagnostic in warnings. Errors as vrml_scenery_add. */
must_check int vrml_motions_add(struct scenery_maker *maker, const struct vrml *scene,
				const struct vrml_instances *instances,
				struct diagnostics *diagnostics, struct diagnostics *warnings);

#endif
