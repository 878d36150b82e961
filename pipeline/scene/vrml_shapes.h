/* Makes triangles of VRML97's geometry nodes (ISO/IEC 14772-1, 6.5 to 6.23). */
#ifndef GOPURA_PIPELINE_SCENE_VRML_SHAPES_H
#define GOPURA_PIPELINE_SCENE_VRML_SHAPES_H

#include "base/diagnostics.h"
#include "pipeline/scene/soup.h"
#include "pipeline/scene/vrml.h"

/* Adds a geometry node to the soup, whose place and texture are set; rgb is the material's
 * colour. is_inside_out says that the place mirrors. Returns 1 if it was added, 0 if the node
 * is no geometry, or a negative errno with a diagnostic: -EBADMSG: an index without what it names,
 * a wrong count, a text that is none; -EFBIG, -ENOMEM. */
must_check int vrml_shape_add(struct soup *soup, const struct vrml_node *geometry,
			      const uint8_t rgb[3], bool is_mirrored,
			      struct diagnostics *diagnostics);

#endif
