/* Makes thin bodies of PointSet and IndexedLineSet (ISO/IEC 14772-1, 6.24 and 6.36), which have no
 * surface: a picture of the site from near and far needs a width in metres, and not in pixels.
 * Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_LINES_H
#define GOPURA_PIPELINE_SCENE_VRML_LINES_H

#include "base/diagnostics.h"
#include "pipeline/scene/soup.h"
#include "pipeline/scene/vrml.h"

/* Adds an octahedron for each point. As vrml_faces_add. */
must_check int vrml_points_add(struct soup *soup, const struct vrml_node *points,
			       const uint8_t rgb[3], struct diagnostics *diagnostics);
/* Adds a bar of three sides for each piece of a line. As vrml_faces_add. */
must_check int vrml_lines_add(struct soup *soup, const struct vrml_node *lines,
			      const uint8_t rgb[3], struct diagnostics *diagnostics);

#endif
