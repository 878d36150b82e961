/* Reads what a scanner saw from one place as oriented points: a range image (a PLY with a
 * range_grid, or with as many vertices as num_cols times num_rows), a cloud with normals, or a
 * mesh, whose vertices are the points (paper P1, section 4.2). Its points may be larger than memory
 * (base/spill.h). */
#ifndef GOPURA_PIPELINE_OCTREE_RANGE_SCAN_H
#define GOPURA_PIPELINE_OCTREE_RANGE_SCAN_H

#include <stdbool.h>
#include <stdint.h>

#include "base/diagnostics.h"
#include "pipeline/import/transform.h"

/* Where the scanner stood, in the axes of the file. */
enum range_sight {
	RANGE_SIGHT_AUTO, /* parallel if two coordinates grow evenly along the grid, else origin */
	RANGE_SIGHT_ORIGIN, /* at 0 0 0 of the file */
	RANGE_SIGHT_PLUS_X, /* far away, where x is large: lines of sight are parallel; and so on */
	RANGE_SIGHT_PLUS_Y,
	RANGE_SIGHT_PLUS_Z,
	RANGE_SIGHT_MINUS_X,
	RANGE_SIGHT_MINUS_Y,
	RANGE_SIGHT_MINUS_Z,
};

struct range_point {
	double at[3];      /* in the common axes */
	float normal[3];   /* unit vector, out of the surface */
	float towards[3];  /* unit vector to the scanner; 0: not known where that stood */
	float weight;      /* confidence, above 0 */
	float spacing;     /* distance to the farthest of its neighbours; 0: unknown */
	uint8_t colour[4]; /* the fourth: 255, or 0 if the scan has no colours */
};

struct range_scan {
	uint32_t count;
	struct range_point *points; /* owned */
	bool has_colour;
	double spacing;   /* median distance of neighbouring points; 0: unknown, as of a mesh */
	uint32_t dropped; /* points that were left out: not finite, or without a neighbour */
	uint32_t grid_columns; /* 0: no range image */
	/* Of a mesh: its faces between these points; owned; NULL: no mesh. */
	uint32_t triangle_count;
	uint32_t (*triangles)[3];
};

/* Reads a scan. transform places it; NULL: it stays. *out is owned by the caller; it is zeroed on
 * failure. -EBADMSG: damaged, or not such a scan; diagnostics names the file, the place and the
 * cure. -ENOMEM, and errors of the disk. */
must_check int range_scan_read(struct range_scan *out, const char *path,
			       const struct transform *transform, enum range_sight sight,
			       struct diagnostics *diagnostics);
void range_scan_finish(struct range_scan *scan); /* NULL and zeroed are fine */

/* Checks by the header what range_scan_read would refuse. Errors as there. */
must_check int range_scan_check(const char *path, struct diagnostics *diagnostics);

/* Parses "auto", "origin", "+x" ... "-z". Returns false otherwise; *out is then unchanged. */
bool range_sight_named(const char *name, enum range_sight *out);

#endif
