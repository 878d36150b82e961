/* Where to stand to see a part well: as the kiosk flies to one, and as a tour's stop has it that
 * names a part and no eye. Pure geometry. */
#ifndef GOPURA_GEOMETRY_VIEWPOINT_H
#define GOPURA_GEOMETRY_VIEWPOINT_H

#include "geometry/region.h"

/* From where the eye stands, but nearer; from the side rather than from above. A region that is
 * smaller than least_m, or a mere point, is looked at as if it were as large. */
void viewpoint_of_region(const struct region *region, const float anchor_m[3], float least_m,
			 const float from_m[3], float eye_m[3], float target_m[3]);

#endif
