/* Finds the part in a view from what is known of some of its pixels: P0 section 4.1.1, equations 1
 * to 4, first for superpixels, then for the pixels near the border found. */
#ifndef GOPURA_CURATOR_SELECT_PART_CUT_H
#define GOPURA_CURATOR_SELECT_PART_CUT_H

#include "base/compiler.h"
#include "curator/select/strokes.h"
#include "curator/select/superpixels.h"
#include "curator/select/view_image.h"

/* Sets in_part to 1 for the pixels of the part and to 0 for the others; where nothing shows, 0.
 * marks: a mark for each pixel. in_part has room for all pixels and may be marks. -EINVAL if no
 * pixel that shows something is known to be in the part; -ENOMEM. */
must_check int part_cut(uint8_t *in_part, const uint8_t *marks, const struct view_image *image,
			const struct superpixels *superpixels);

#endif
