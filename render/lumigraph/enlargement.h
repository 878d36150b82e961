/* Dynamic resolution scaling: while the eye moves the scene may be drawn smaller than the panel and
 * enlarged with bilinear filtering. The small picture shows exactly the frustum of the large one,
 * so nothing shifts when the scale changes (the projection is the same; only the viewport differs).
 */
#ifndef GOPURA_RENDER_LUMIGRAPH_ENLARGEMENT_H
#define GOPURA_RENDER_LUMIGRAPH_ENLARGEMENT_H

#include "geometry/view.h"
#include "render/display/gl.h"

struct enlargement {
	struct gl_target small;
	GLuint program;
};

/* Sets *small to the view drawn at that scale (0 to 1) of its sides. Pure. */
void enlargement_view(struct view *small, const struct view *view, float scale);
/* Binds the target for a picture of view->width_px x view->height_px; cheap where it exists. On
 * failure (as gl_target_create) nothing is allocated, and the caller draws at full size. */
must_check int enlargement_begin(struct enlargement *enlargement, const struct view *small);
/* Draws the small picture at the given place, enlarged to that size. Depth is not drawn. */
void enlargement_end(const struct enlargement *enlargement, const struct gl_place *place,
		     int width_px, int height_px);
/* Frees the target, which the next enlargement_begin creates again. */
void enlargement_let_go(struct enlargement *enlargement);
/* Frees all GL objects; zeroed is fine. */
void enlargement_finish(struct enlargement *enlargement);

#endif
