/* Makes triangles of Extrusion. Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_EXTRUSION_H
#define GOPURA_PIPELINE_SCENE_VRML_EXTRUSION_H

#include "pipeline/scene/soup.h"
#include "pipeline/scene/vrml.h"

/* As vrml_shape_add, but for the soup's is_inside_out, which is set, and without diagnostics:
 * -EFBIG, -ENOMEM. */
must_check int vrml_extrusion_add(struct soup *soup, const struct vrml_node *extrusion,
				  const uint8_t rgb[3]);

#endif
