/* The surface that is made of scans which have none: aligned range images and clouds of points. It
 * stands for them in the joint mesh. It is kept in .work/surface.ply, in metres with z up, and its
 * key in .work/surface; docs/octree.md. */
#ifndef GOPURA_PIPELINE_CONTENT_SCAN_SURFACE_H
#define GOPURA_PIPELINE_CONTENT_SCAN_SURFACE_H

#include "pipeline/content/content.h"

/* Which scans become the surface. */
struct surface_plan {
	uint32_t count; /* 0: no surface is made */
	uint32_t first; /* the lowest of them; valid if count > 0 */
	uint64_t points;
	bool is_points[CONTENT_SCANS_MAX]; /* a range image or a cloud: part of the surface */
};

/* Looks at the headers of the scans. One that cannot be read is taken for a mesh. */
void surface_plan(struct surface_plan *out, const struct content *content);

/* Hashes everything the surface is made from. Negative errno: a folder cannot be listed. */
must_check int surface_key(struct hash *out, const struct surface_plan *plan,
			   const struct content *content);

/* Makes the surface unless that of this key is there. *made: it was not. path is where it lies.
 * Negative errno; diagnostics names the file, the place and the cure. */
must_check int surface_make(char path[CONTENT_PATH_BYTES], bool *made,
			    const struct surface_plan *plan, struct hash key,
			    const struct content *content, struct diagnostics *diagnostics);
/* Returns whether the surface of this key is there. */
bool surface_is_made(struct hash key, const struct content *content);

#endif
