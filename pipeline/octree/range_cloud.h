/* How far the points of a cloud, which has no grid of neighbours, are apart. Private to
 * pipeline/octree. */
#ifndef GOPURA_PIPELINE_OCTREE_RANGE_CLOUD_H
#define GOPURA_PIPELINE_OCTREE_RANGE_CLOUD_H

#include "pipeline/octree/range_scan.h"

/* Finds the distance of neighbouring points where half of them lie at least as close: that of as
 * many points spread evenly over a surface. Sets `spacing` of every point to what its farthest
 * neighbour may be away, as no cloud is even. 0: they are all at one place. -ENOMEM. */
must_check int range_cloud_spacing(double *out, struct range_point *points, uint32_t count);

#endif
