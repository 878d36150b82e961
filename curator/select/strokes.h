/* What a curator draws on a view, as marks of its pixels: the three tools of P0 section 4. */
#ifndef GOPURA_CURATOR_SELECT_STROKES_H
#define GOPURA_CURATOR_SELECT_STROKES_H

#include "base/compiler.h"
#include "curator/select/view_image.h"

enum { STROKE_POINTS_MAX = 20000 };

/* A stroke of a pen, in pixels of the view; points may lie outside it. */
struct stroke {
	const float (*points_px)[2]; /* borrowed */
	uint32_t count;              /* 1 to STROKE_POINTS_MAX */
	float width_px;
};

/* What is known of a pixel. Seeds are known too, and show how the part and what is around it
 * look. */
enum mark { MARK_UNKNOWN, MARK_PART, MARK_REST, MARK_PART_SEED, MARK_REST_SEED };

/* Sets the mark of all pixels under a stroke. marks has one for each pixel of the view. */
void strokes_paint(uint8_t *marks, uint32_t width_px, uint32_t height_px,
		   const struct stroke *stroke, enum mark mark);

/* The lasso: sets all pixels inside the stroke, which is closed by a straight line, to MARK_PART,
 * and the others to MARK_REST. -EINVAL if there is none inside; -ENOMEM. */
must_check int strokes_lasso(uint8_t *marks, uint32_t width_px, uint32_t height_px,
			     const struct stroke *stroke);

/* The heavy lasso: the border of the part is somewhere under the stroke, which is closed by a
 * straight line. Pixels under it become unknown, those inside the part, those outside the rest; the
 * ones nearest to it, within its width, become seeds. Where it leaves nothing inside, it is drawn
 * thinner. -EINVAL if the stroke goes around nothing; -ENOMEM. */
must_check int strokes_heavy_lasso(uint8_t *marks, uint32_t width_px, uint32_t height_px,
				   const struct stroke *stroke);

#endif
