/* Where to place the camera to see a part well. The kiosk uses it to fly to a part, and the
 * pipeline for a tour stop that names a part but no eye. Pure geometry. */
#ifndef GOPURA_GEOMETRY_VIEWPOINT_H
#define GOPURA_GEOMETRY_VIEWPOINT_H

#include "geometry/region.h"

/* Writes an eye and a target for looking at a region around anchor_m. The eye lies in the direction
 * of from_m but nearer, and rather from the side than from above. A point, or a region smaller than
 * least_m, is treated as if it were that large. */
void viewpoint_of_region(const struct region *region, const float anchor_m[3], float least_m,
			 const float from_m[3], float eye_m[3], float target_m[3]);

#endif
