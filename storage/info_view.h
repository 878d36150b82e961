/* Where to stand to see a part well: as the kiosk flies to one, and as a tour's stop has it that
 * names a part and no eye. Pure geometry. */
#ifndef GOPURA_STORAGE_INFO_VIEW_H
#define GOPURA_STORAGE_INFO_VIEW_H

#include "storage/info.h"

/* Radius of a sphere of about the region's size: tells the smaller of two that overlap. */
float info_region_size_m(const struct info_region *region);

/* From where the eye stands, but nearer; from the side rather than from above. A region that is
 * smaller than least_m, or a mere point, is looked at as if it were as large. */
void info_view(const struct info_region *region, const float anchor_m[3], float least_m,
	       const float from_m[3], float eye_m[3], float target_m[3]);

#endif
