/* Back-projection (P0 section 4.1.2): which triangles of the scan lie in the part that was found in
 * a view. The paper asks an index image for the patches that are seen and tests their vertices; we
 * ask boxes of successive triangles, because the scan, not a level of the hierarchy, is what
 * regions name. The levels take it from the region when a release is published. */
#ifndef GOPURA_CURATOR_SELECT_FACE_PICK_H
#define GOPURA_CURATOR_SELECT_FACE_PICK_H

#include <stdbool.h>

#include "base/compiler.h"
#include "curator/select/view_image.h"
#include "geometry/camera.h"
#include "pipeline/import/mesh.h"

enum { FACE_BLOCK_TRIANGLES = 4096 };

/* Boxes around every FACE_BLOCK_TRIANGLES triangles of a mesh in its order: 24 bytes for each, so a
 * scan of any size has them in memory. */
struct face_blocks {
	uint32_t count;
	float (*boxes_m)[2][3]; /* owned; low and high corner */
};

must_check int face_blocks_make(struct face_blocks *out, const struct mesh *mesh); /* -ENOMEM */
void face_blocks_finish(struct face_blocks *blocks); /* NULL and zeroed are fine */

/* A part that was found in a view. */
struct face_view {
	const struct camera *camera; /* of the image: the same size */
	const struct view_image *image;
	const uint8_t *in_part; /* for each pixel: 0 or 1 */
	bool through;           /* also what is behind what is seen, or turned away */
};

/* Calls found for every triangle of the part in ascending order: of those whose middle the view
 * shows, or with `through` of all, those that lie mostly in the part. */
void face_pick(const struct face_view *view, const struct mesh *mesh,
	       const struct face_blocks *blocks, void (*found)(void *user, uint32_t triangle),
	       void *user);

#endif
