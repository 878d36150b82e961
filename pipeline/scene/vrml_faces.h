/* Makes triangles of IndexedFaceSet, and reads colours. Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_FACES_H
#define GOPURA_PIPELINE_SCENE_VRML_FACES_H

#include "base/diagnostics.h"
#include "pipeline/scene/soup.h"
#include "pipeline/scene/vrml.h"

/* As vrml_shape_add, but for the soup's is_inside_out, which is set, and for the diagnostics of
 * -EFBIG and -ENOMEM. */
must_check int vrml_faces_add(struct soup *soup, const struct vrml_node *faces,
			      const uint8_t rgb[3], struct diagnostics *diagnostics);

/* Returns a field of a node if that is of a type; NULL: it is not, or node is NULL. */
const struct vrml_value *vrml_member(const struct vrml_node *node, const char *type,
				     const char *field);
/* Converts a colour from 0 to 1 to bytes. */
void vrml_colour(uint8_t rgb[3], const float colour[3]);

#endif
