/* The pictures of a scan within a number of bytes: fragments of a quality each, and sides that are
 * halved where no quality is low enough. */
#ifndef GOPURA_PIPELINE_TEXMESH_TEXTURE_BUDGET_H
#define GOPURA_PIPELINE_TEXMESH_TEXTURE_BUDGET_H

#include "base/bytes.h"
#include "pipeline/texmesh/reduced_mesh.h"

struct texture_options {
	const struct mesh *scan;         /* borrowed, as all here */
	const struct reduced_mesh *copy; /* of the scan: where its pictures are used */
	const uint8_t *scales; /* of the copy's vertices (vertex_scales.h); NULL: uniform */
	uint64_t budget_bytes; /* of all files together */
};

struct texture_result {
	uint64_t bytes; /* of all files; the least possible after -E2BIG */
	uint32_t picture_count, fragment_count, halvings, scale;
	double quality;
	uint8_t least, most;
	bool is_best; /* no quality can be better, and nothing was halved */
};

/* Sets jpegs, one for each texture of the scan, owned by the caller, zeroed before: empty for those
 * of one pixel, and those that no triangle shows. Returns -E2BIG, -ENOMEM, or an error of a JPEG.
 */
must_check int texture_budget_meet(struct buffer *jpegs, struct texture_result *out,
				   const struct texture_options *options);

#endif
