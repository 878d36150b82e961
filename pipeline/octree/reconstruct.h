/* Makes one surface of aligned scans (paper P1, chapter 4): range images, clouds with normals, or
 * meshes. The scans are read twice, one at a time: for the box, and for the distances. Memory: what
 * base/spill.h keeps resident of a scan and of the distances. docs/octree.md has figures. */
#ifndef GOPURA_PIPELINE_OCTREE_RECONSTRUCT_H
#define GOPURA_PIPELINE_OCTREE_RECONSTRUCT_H

#include "pipeline/import/mesh.h"
#include "pipeline/octree/cube_table.h"
#include "pipeline/octree/range_scan.h"

enum { RECONSTRUCT_DEPTH_MAX = 16 };

/* One scan. Both borrowed; transform NULL: it stays where it is. */
struct reconstruct_scan {
	const char *path;
	const struct transform *transform;
};

struct reconstruct_options {
	double cell;     /* side of a leaf cube in the unit of the files; 0: see depth */
	uint32_t depth;  /* 2^depth leaf cubes along the longest side; 0: 1.5 times the spacing of
			    the points, or 2^8 if that is unknown, as of meshes alone */
	bool is_closed;  /* no open edge: holes are closed by a membrane */
	bool keep_small; /* parts of less than a thousandth of the largest one's triangles too */
	enum range_sight sight;
	/* As in struct cube_surface_options; NULL: not wanted. */
	int (*leaf)(void *data, const int32_t cube[3], uint8_t inside,
		    const uint32_t vertices[CUBE_EDGES]);
	void *data; /* for leaf */
};

struct reconstruct_report {
	uint64_t points, dropped; /* of all scans */
	uint32_t range_images;    /* scans with a grid */
	double spacing;           /* median of the scans' spacings; 0: unknown */
	double cell;              /* as used */
	double low[3], high[3];   /* box of the points */
	uint32_t blocks;          /* of 8 x 8 x 8 corners that were seen */
	uint32_t parts;           /* connected parts of the surface */
	uint32_t dropped_parts;   /* parts that were too small and left out */
	uint32_t border_edges;    /* of one triangle only */
	uint32_t crowded_edges;   /* of more than two */
};

/* *out is owned by the caller (mesh_finish), in the unit and axes of the files; it is zeroed on
 * failure. Returns 0 or a negative errno; diagnostics then names the file, the place and the cure.
 * -ENODATA: no surface. */
must_check int reconstruct(struct mesh *out, const struct reconstruct_scan *scans, uint32_t count,
			   const struct reconstruct_options *options,
			   struct reconstruct_report *report, struct diagnostics *diagnostics);

/* Counts the connected parts, border and crowded edges of a mesh. -ENOMEM, -ENOSPC. */
must_check int reconstruct_judge(const struct mesh *mesh, struct reconstruct_report *report);

#endif
