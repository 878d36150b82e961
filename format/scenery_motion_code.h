/* The bytes of scenery's motions, touches, tracks and drags, and numbers in the same order both
 * ways. Private to format/scenery_code. A reader that fails says so in itself. */
#ifndef GOPURA_FORMAT_SCENERY_MOTION_CODE_H
#define GOPURA_FORMAT_SCENERY_MOTION_CODE_H

#include "format/scenery.h"

enum { /* the bytes of one */
       SCENERY_MOTION_BYTES = 4 + 1 + 1 + 4,
       SCENERY_TOUCH_BYTES = 4 + 4,
       SCENERY_TRACK_BYTES = 4 + 1 + 4,
       SCENERY_DRAG_BYTES = 4 + 4 + 1 + 1 + 9 * 4,
};

void scenery_put_floats(struct buffer *out, const float *numbers, uint32_t count);
void scenery_get_floats(struct reader *in, float *numbers, uint32_t count);
/* Reads a byte that is 0 or 1. */
bool scenery_get_flag(struct reader *in);

void scenery_put_motions(struct buffer *out, const struct scenery *scenery);
/* The counts are set, and the arrays have room for them. -EBADMSG. */
must_check int scenery_get_motions(struct reader *in, struct scenery *scenery);
void scenery_put_drags(struct buffer *out, const struct scenery *scenery);
void scenery_get_drags(struct reader *in, struct scenery *scenery);

#endif
