/* The signed distance at corners of leaf cubes around the surface of a mesh: at all eight corners
 * of each cube that a triangle may cross, and of each cube where the sign changes beside these,
 * which are those in holes. A triangle that encloses nothing, as the ground or a roof without an
 * underside, becomes a sheet one and a half cubes thick, so that no stone that was scanned is lost.
 */
#ifndef GOPURA_PIPELINE_OCTREE_CLOSED_FIELD_H
#define GOPURA_PIPELINE_OCTREE_CLOSED_FIELD_H

#include "pipeline/octree/corner_field.h"
#include "pipeline/octree/triangle_tree.h"

/* Fills a zeroed field with origin and cell set. Wherever two neighbours along an edge have
 * different signs, all corners of the four cubes around it are known; so what cube_surface_draw
 * makes of the field, even without is_closed, is closed. All cores work; the result does not depend
 * on their number. Errors as corner_field_add; the field is then only to be finished. */
must_check int closed_field_fill(struct corner_field *field, const struct triangle_tree *tree);

#endif
