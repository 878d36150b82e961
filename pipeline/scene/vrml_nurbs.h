/* Makes triangles of NurbsSurface and TrimmedSurface (VRML97, amendment 1). An edge is divided
 * where the surface leaves it by more than a fiftieth of its length; that depends on the edge
 * alone, so neighbouring triangles agree, and so do surfaces that share a border. Private to
 * pipeline/scene.
 */
#ifndef GOPURA_PIPELINE_SCENE_VRML_NURBS_H
#define GOPURA_PIPELINE_SCENE_VRML_NURBS_H

#include "base/diagnostics.h"
#include "pipeline/scene/soup.h"
#include "pipeline/scene/vrml.h"

/* As vrml_shape_add, but for the soup's is_inside_out, which is set for a surface that says nothing
 * of ccw, and for the diagnostics of -EFBIG and -ENOMEM. */
must_check int vrml_nurbs_add(struct soup *soup, const struct vrml_node *geometry,
			      const uint8_t rgb[3], struct diagnostics *diagnostics);

#endif
