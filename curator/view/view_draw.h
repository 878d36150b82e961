/* Draws a model for a curator: what the selection tools need of a view (curator/select/
 * view_image.h), from the master or the scan, by the pipeline's own rasteriser. */
#ifndef GOPURA_CURATOR_VIEW_VIEW_DRAW_H
#define GOPURA_CURATOR_VIEW_VIEW_DRAW_H

#include "base/compiler.h"
#include "curator/select/view_image.h"
#include "geometry/camera.h"
#include "pipeline/samples/model.h"

struct view_draw; /* keeps what one size of picture needs; one thread */

/* model is borrowed for the lifetime of *out. width_px and height_px: even, up to VIEW_SIDE_PX_MAX.
 * *out is owned by the caller; NULL on failure. -ENOMEM. */
must_check int view_draw_create(struct view_draw **out, struct model *model, uint32_t width_px,
				uint32_t height_px);
void view_draw_destroy(struct view_draw *draw); /* NULL is fine */

/* Draws the model at a detail of detail_px pixels; 0: the finest. The camera has the size given to
 * view_draw_create and no rotation. *out is borrowed until the next call. Errors of model_load. */
must_check int view_draw_image(struct view_draw *draw, const struct camera *camera, float detail_px,
			       struct view_image *out);

#endif
