/* The building element of the demo temple: a sheet, which is one profile swept along one outline.
 *
 * A terrace is a moulding swept round a square, a column a moulding swept round a circle, a roof an
 * arch swept along a line, and a relief a flat upright sheet with a displaced surface. Each sheet
 * is a grid of vertices shared by its triangles. The rows and columns of the grid follow from the
 * density, so the same sheets give ten thousand triangles or a hundred million: parts with relief
 * are divided, plain ones never are, and edges too short for the density are left out.
 *
 * Local axes: an outline runs counter-clockwise, with its outside to the right; a line runs along
 * +x and faces -y (south). Metres, z up. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_SHEET_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_SHEET_H

#include "base/compiler.h"
#include "pipeline/temple/temple_relief.h"

#include <stdbool.h>
#include <stdint.h>

enum outline_kind { OUTLINE_LINE, OUTLINE_CLOSED, OUTLINE_ROUND };
enum { OUTLINE_CORNERS_MAX = 28 };

/* Its half size is 1 (a line runs from -0.5 to 0.5); sheets scale it. */
struct temple_outline {
	enum outline_kind kind;
	uint32_t count; /* number of corners; 1 for a round one */
	float corners[OUTLINE_CORNERS_MAX][2];
};

/* A point of a profile, and the relief between it and the next one. */
struct profile_point {
	float out, z; /* in units of the sheet's reach_m and height_m */
	enum relief relief;
	float depth_m;
	float period_m; /* width of one motif */
};

struct temple_profile {
	uint32_t count;
	const struct profile_point *points; /* borrowed */
};

/* How the width of a sheet on a line changes with its height. */
enum sheet_shape { SHAPE_FULL, SHAPE_PEDIMENT, SHAPE_LEAF, SHAPE_HOOD };

struct sheet {
	const struct temple_outline *outline; /* borrowed; must outlive the plan */
	const struct temple_profile *profile; /* borrowed likewise */
	float origin_m[3];
	float turn[2];           /* cosine and sine of the rotation about the vertical */
	float size_m;            /* scale of the outline */
	float stretch;           /* scale of the outline's y relative to its x */
	float reach_m, height_m; /* scales of the profile */
	float lean;              /* metres that the sheet leans outwards per metre of height */
	float rim_m;             /* > 0: the edges of a sheet on a line are bent back this far */
	enum sheet_shape shape;
	struct relief_style relief; /* for profile segments with RELIEF_SHEET */
	float interest;             /* divisions per metre relative to the temple's density */
	bool optional;              /* left out where the density is too low to show it */
};

/* A row or column of the grid. */
struct station {
	uint16_t segment;
	int8_t rim;   /* -1, 1: bent back at the low or high end */
	float at;     /* 0..1 in the segment */
	float step_m; /* distance to the next one: finer carving fades out */
};

/* Computes the stations of a sheet at a density (divisions per metre at interest 1): *columns along
 * the outline and *rows along the profile. Lists that are not NULL are filled, with at most `most`
 * entries each; the counts may be larger. A sheet that is left out has no columns. */
void sheet_stations(const struct sheet *sheet, float density, struct station *across,
		    uint32_t *columns, struct station *up, uint32_t *rows, uint32_t most);
/* Returns whether the columns form a closed ring. */
bool sheet_wraps(const struct sheet *sheet);
/* Returns the number of vertices of a grid of this size. */
uint64_t sheet_vertices(const struct sheet *sheet, uint32_t columns, uint32_t rows);
/* Returns the number of its triangles. */
uint64_t sheet_triangles(const struct sheet *sheet, uint32_t columns, uint32_t rows);

/* Writes the position of a grid vertex in metres. *hollow: 0 on the crests of the relief, 1 at its
 * bottom. */
void sheet_at(const struct sheet *sheet, const struct station *across, const struct station *up,
	      float position_m[3], float *hollow);

#endif
