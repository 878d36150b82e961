/* What nodes of a scene's graph mean: places, children, looks. Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_GRAPH_H
#define GOPURA_PIPELINE_SCENE_VRML_GRAPH_H

#include <stdbool.h>

#include "pipeline/scene/vrml.h"

/* USE can nest nodes deeper than the text does. */
enum { VRML_VISITS_MAX = 1 << 20, VRML_DEPTH_MAX = 1000 };

extern const float vrml_identity[16];

/* Sets out to the place of what is below a Transform whose own place is `parent`. Column-major. */
void vrml_transform(float out[16], const float parent[16], const struct vrml_node *node);
/* Moves a place of a picture as a TextureTransform says. */
void vrml_transform_uv(float uv[2], const struct vrml_node *node);
/* Returns whether a place turns left into right. */
bool vrml_mirrors(const float place[16]);

/* Returns the nodes below a node that are seen; *count is 0 where there are none. Of a Switch it is
 * the chosen node, of an LOD the finest. */
struct vrml_node *const *vrml_children(const struct vrml_node *node, uint32_t *count);
/* The same with all levels of an LOD. */
struct vrml_node *const *vrml_levels(const struct vrml_node *node, uint32_t *count);
/* Returns whether the node is of that type. */
bool vrml_is(const struct vrml_node *node, const char *type);
/* Returns whether an event sets a field: it has its name, with or without set_ before it. */
bool vrml_event_sets(const char *event, const char *field);
/* Returns the node in a field if it is of that type, else NULL. node may be NULL. */
const struct vrml_node *vrml_node_of(const struct vrml_node *node, const char *field,
				     const char *type);
/* The colour of a Material. What shines by itself alone is as bright as it shines. */
void vrml_material_colour(uint8_t rgb[3], const struct vrml_node *material);

#endif
