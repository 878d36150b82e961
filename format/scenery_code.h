/* Scenery as bytes: docs/scenery.md. */
#ifndef GOPURA_FORMAT_SCENERY_CODE_H
#define GOPURA_FORMAT_SCENERY_CODE_H

#include "format/scenery.h"

/* Appends the object. Returns -EINVAL if the scenery breaks a rule of format/scenery.h, -EFBIG or
 * -ENOMEM. */
must_check int scenery_encode(struct buffer *out, const struct scenery *scenery);
/* The caller ends *out with scenery_finish(); it is zeroed on failure. Returns -EBADMSG for
 * anything that the encoder cannot have written, or -ENOMEM. */
must_check int scenery_decode(struct scenery *out, struct bytes object);

#endif
