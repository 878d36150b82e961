/* One model of all scans within a number of bytes, for a web page, a viewer of IIIF or a lesson:
 * triangles and pictures together, after Cheng and Boulanger, "Scale-Space 3D TexMesh
 * Simplification" (paper P2). Pictures are cut into fragments, and a fragment has a better JPEG
 * quality the more feature points of the surface lie in it. docs/export.md. */
#ifndef GOPURA_PIPELINE_TEXMESH_TEXMESH_H
#define GOPURA_PIPELINE_TEXMESH_TEXMESH_H

#include <stdbool.h>

#include "base/bytes.h"
#include "pipeline/import/mesh.h"
#include "pipeline/texmesh/reduced_mesh.h"

enum { TEXMESH_BUDGET_LEAST_BYTES = 10000, TEXMESH_BUDGET_MOST_BYTES = 1 << 30 };

struct texmesh_options {
	/* TEXMESH_BUDGET_LEAST_BYTES .. TEXMESH_BUDGET_MOST_BYTES; of the whole file. */
	uint64_t budget_bytes;
	bool uniform; /* all fragments have one quality */
	bool lit;     /* the colours hold no light of their own: a viewer lights them */
	struct reduced_look look;
};

struct texmesh_report {
	uint32_t triangle_count, vertex_count, source_triangles;
	uint64_t mesh_bytes, picture_bytes; /* of the file */
	/* Of pictures that show something, where there are any. */
	uint32_t picture_count, fragment_count;
	uint32_t halvings; /* of the pictures' sides */
	uint32_t scale;    /* whose feature points chose the qualities; 0: uniform */
	double quality;    /* the common one */
	uint8_t quality_least, quality_most;
	/* After -E2BIG: about what the smallest file takes. */
	uint64_t least_bytes;
};

/* Appends a GLB file of at most the budget to out, and mostly of at least 97 % of it, less 2 kB and
 * half a kB for each texture, unless the whole scan at the best quality (95) takes less. The result
 * depends on its arguments alone. Returns -E2BIG if the budget cannot be met (report says what
 * could), -ENOMEM, -ENOSPC, -EINVAL for a mesh without triangles, -EFBIG for one of more than 2^31
 * corners, or an error of a JPEG. */
must_check int texmesh_make(struct buffer *out, const struct mesh *mesh,
			    const struct texmesh_options *options, struct texmesh_report *report);

#endif
