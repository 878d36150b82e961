/* What VRML97's ColorInterpolator and CoordinateInterpolator set: colours of Materials, and the
 * points of an IndexedFaceSet. Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_BENDS_H
#define GOPURA_PIPELINE_SCENE_VRML_BENDS_H

#include "base/diagnostics.h"
#include "pipeline/scene/scenery_maker.h"
#include "pipeline/scene/vrml.h"

/* Returns the CoordinateInterpolator whose route sets the points of a geometry's Coordinate: the
 * first of several. NULL: none does. */
const struct vrml_node *vrml_bender_of(const struct vrml *scene, const struct vrml_node *geometry);

/* Adds a surface that an interpolator bends: a shape for each of its keys. soup has its triangles
 * and their points. -EBADMSG with a diagnostic: the interpolator is not valid. Else as
 * scenery_add_bent. */
must_check int vrml_bent_add(struct scenery_maker *maker, uint32_t node,
			     const struct scenery_material *material, const struct soup *soup,
			     float crease_rad, const struct scenery_paint *paint,
			     const struct vrml_node *geometry, const struct vrml_node *interpolator,
			     struct diagnostics *diagnostics);
/* Adds the track that goes from each shape of such a surface to the next. */
must_check int vrml_bent_track(struct scenery_maker *maker, uint32_t node,
			       const struct vrml_node *interpolator,
			       struct diagnostics *diagnostics);
/* Adds the track of a ColorInterpolator. Between two keys a colour goes by hue, saturation and
 * value (6.10), the shorter way round, in straight pieces. Errors as vrml_bent_add. */
must_check int vrml_colour_track(struct scenery_maker *maker, uint32_t node,
				 enum scenery_target target, const struct vrml_node *interpolator,
				 struct diagnostics *diagnostics);

#endif
