/* The volume that a part of the model occupies. It is used to describe the part, to mark it on the
 * surface, and to tell which part was touched. Metres, z up. */
#ifndef GOPURA_GEOMETRY_REGION_H
#define GOPURA_GEOMETRY_REGION_H

#include <stdbool.h>
#include <stdint.h>

enum region_kind { REGION_POINT, REGION_SPHERE, REGION_BOX, REGION_PRISM };
enum { REGION_CORNERS_MAX = 16 };
/* A point (REGION_POINT) has a centre and contains nothing. */
struct region {
	enum region_kind kind;
	float centre_m[3];
	/* of the sphere; for a point that stands for a list of faces: their radius */
	float radius_m;
	float half_m[3];       /* box: half its size, before the rotation */
	float turn_deg;        /* box: rotation about the vertical axis */
	float floor_m, roof_m; /* prism */
	uint32_t corner_count;
	float corners_m[REGION_CORNERS_MAX][2]; /* prism: x, y, counter-clockwise */
};

/* Returns whether the region contains the point; its boundary counts as inside. */
bool region_contains(const struct region *region, const float point_m[3]);
/* Returns the distance to the region's boundary in metres, negative inside. It is exact towards
 * faces and a lower bound elsewhere. INFINITY for a point or an invalid prism. */
float region_distance(const struct region *region, const float point_m[3]);
/* Returns the radius of a sphere of about the region's size, to choose the smaller of two regions
 * that overlap. */
float region_size_m(const struct region *region);
/* Returns whether the region and the sphere may intersect. It may return true for a sphere that is
 * only near an edge; it never misses one that intersects. */
bool region_meets_sphere(const struct region *region, const float centre_m[3], float radius_m);

#endif
