/* Makes drags of a scene's PlaneSensors, CylinderSensors and SphereSensors. Private to
 * pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_DRAGS_H
#define GOPURA_PIPELINE_SCENE_VRML_DRAGS_H

#include "base/diagnostics.h"
#include "pipeline/scene/scenery_maker.h"
#include "pipeline/scene/vrml_motions.h"

/* Returns whether a finger can drag what is beside the node. */
bool vrml_is_drag_sensor(const struct vrml_node *node);

/* Adds the drag of a route from such a sensor to a Transform. Returns 1; 0: the route leads
 * elsewhere; -EBADMSG with a diagnostic: the sensor is not valid; -EFBIG, -ENOMEM. A sensor that is
 * not enabled is a diagnostic in warnings. */
must_check int vrml_drags_add(struct scenery_maker *maker, const struct vrml_route *route,
			      const struct vrml_instances *instances,
			      struct diagnostics *diagnostics, struct diagnostics *warnings);

#endif
