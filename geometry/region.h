/* The space that a part of the model takes: to describe it, to mark it on the surface, and to tell
 * which part was touched. Metres, z up. */
#ifndef GOPURA_GEOMETRY_REGION_H
#define GOPURA_GEOMETRY_REGION_H

#include <stdbool.h>
#include <stdint.h>

enum region_kind { REGION_POINT, REGION_SPHERE, REGION_BOX, REGION_PRISM };
enum { REGION_CORNERS_MAX = 16 };
/* A point has a centre and contains nothing. */
struct region {
	enum region_kind kind;
	float centre_m[3];
	float radius_m;        /* sphere; a point that stands for a list of faces: theirs */
	float half_m[3];       /* box, before turning */
	float turn_deg;        /* box: about the vertical */
	float floor_m, roof_m; /* prism */
	uint32_t corner_count;
	float corners_m[REGION_CORNERS_MAX][2]; /* prism: x, y, counter-clockwise */
};

/* The boundary belongs to it. */
bool region_contains(const struct region *region, const float point_m[3]);
/* Metres to the region's boundary, negative inside; exact on faces, a bound elsewhere. */
float region_distance(const struct region *region, const float point_m[3]);
/* Radius of a sphere of about the region's size: tells the smaller of two that overlap. */
float region_size_m(const struct region *region);
/* May say so of a sphere that only comes near an edge; never misses one that meets it. */
bool region_meets_sphere(const struct region *region, const float centre_m[3], float radius_m);

#endif
