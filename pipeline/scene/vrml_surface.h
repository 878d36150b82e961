/* The surface of a whole scene at rest: every shape that is seen, in its place. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_SURFACE_H
#define GOPURA_PIPELINE_SCENE_VRML_SURFACE_H

#include "base/diagnostics.h"
#include "pipeline/scene/soup.h"
#include "pipeline/scene/vrml.h"

enum { VRML_TEXTURES_MAX = 4096 };

struct vrml_surface {
	struct soup soup; /* in the scene's unit and axes */
	/* ImageTexture nodes, which the triangles' textures count; owned, the nodes borrowed */
	const struct vrml_node **textures;
	uint32_t texture_count, texture_room;
	uint32_t left_out; /* shapes whose geometry is none */
	bool has_colours;  /* some material or colour is given */
};

/* Of a Switch the chosen node is taken, of an LOD the finest. The caller finishes *out, whose nodes
 * are those of the scene. Returns a negative errno with a diagnostic, as vrml_shape_add; -EFBIG
 * also: USE repeats nodes too often. */
must_check int vrml_surface_make(struct vrml_surface *out, const struct vrml *scene,
				 struct diagnostics *diagnostics);
void vrml_surface_finish(struct vrml_surface *surface); /* NULL is fine */

#endif
