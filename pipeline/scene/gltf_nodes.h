/* The nodes of a glTF document (glTF 2.0, 3.5): names, children and places. Private to
 * pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_GLTF_NODES_H
#define GOPURA_PIPELINE_SCENE_GLTF_NODES_H

#include "pipeline/scene/gltf.h"
#include "pipeline/scene/scenery_maker.h"

enum { GLTF_DEPTH_MAX = 200 }; /* of nodes below each other */

/* Returns the name of an object of the document, "" if it has none. */
const char *gltf_name(const struct cJSON *object);
/* Reads an array of numbers; otherwise holds if it is not there. Returns false if it is faulty. */
bool gltf_floats(float *out, const struct cJSON *object, const char *field, int count,
		 const float *otherwise);
/* Returns the scene of that name, or with NULL the one that the file shows first. NULL with a
 * diagnostic: there is none. */
const struct cJSON *gltf_scene(const struct gltf *gltf, const char *name);
/* Returns a node by an item of a list of children, and its number; NULL: it is no node. */
const struct cJSON *gltf_child(const struct gltf *gltf, const struct cJSON *item, uint32_t *number);
/* Gets where a node puts what is below it. -EBADMSG with a diagnostic: it is no place. */
must_check int gltf_place(struct scenery_place *out, const struct gltf *gltf,
			  const struct cJSON *node);
/* Sets out to the column-major matrix of a place below a parent's. A place of glTF has no centre
 * and no stretch. */
void gltf_place_below(float out[16], const float parent[16], const struct scenery_place *place);

#endif
