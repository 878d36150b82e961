/* Makes one closed surface of any mesh: of thousands of shells that overlap, are inside out or have
 * holes. The sign at a corner of the leaf cubes is that of the generalised winding number less a
 * half, the distance that to the nearest triangle, and marching cubes draws the surface between.
 * docs/octree.md has what it costs and gives. */
#ifndef GOPURA_PIPELINE_OCTREE_CLOSED_SURFACE_H
#define GOPURA_PIPELINE_OCTREE_CLOSED_SURFACE_H

#include "base/diagnostics.h"
#include "pipeline/import/mesh.h"

struct closed_surface_report {
	uint32_t triangles, shells; /* of the scan, without copies of triangles */
	uint32_t copies;            /* triangles that were there more than once */
	uint32_t turned_shells;     /* that were inside out */
	double cell_m;              /* as used */
	double inner_share;     /* of the scan's area: inside matter on both sides, so left out */
	double sheet_share;     /* of the scan's area: encloses nothing: a sheet */
	uint32_t parts;         /* of the surface */
	uint32_t dropped_parts; /* small bodies and all cavities, left out */
};

/* A surface has about so many triangles for each square of a cube's side. */
enum { CLOSED_SURFACE_TRIANGLES = 3 };

/* Returns the side of a leaf cube in metres: as asked, or for 0 such that a scan of this area and
 * number of triangles gets as many again, but from 256 to 4096 cubes along its longest side. */
double closed_surface_cell(double asked_m, double area, uint32_t triangles, double longest_m);

/* Replaces a mesh, in metres, by the closed surface with leaf cubes of cell_m, or of a size that
 * gives about as many triangles if that is 0. Every edge of the result has two triangles, which run
 * through it in opposite directions. It takes over colours and numbers of faces as scan_transfer
 * says, and has no textures.
 * -EINVAL: the mesh has no area, or the cubes are too small; diagnostics has the cure. -ENOMEM,
 * -ENOSPC, -EFBIG likewise. On failure the mesh is only to be finished. */
must_check int closed_surface_make(struct mesh *mesh, double cell_m,
				   struct closed_surface_report *report,
				   struct diagnostics *diagnostics);

#endif
