/* Smooths the border of a region: teeth, notches, specks and holes of about one ring of triangles
 * go; a border that is smooth stays where it is. */
#ifndef GOPURA_CURATOR_REGION_REGION_SMOOTH_H
#define GOPURA_CURATOR_REGION_REGION_SMOOTH_H

#include "curator/region/region_set.h"

enum { REGION_SMOOTH_PASSES = 3 };

/* One change of the region, which can be undone. -ENOMEM; then the region is as it was. */
must_check int region_set_smooth(struct region_set *set, const struct mesh *mesh);

#endif
