/* What of a scan's files decides what is made of it, as bytes to be hashed. */
#ifndef GOPURA_PIPELINE_CONTENT_SCAN_KEY_H
#define GOPURA_PIPELINE_CONTENT_SCAN_KEY_H

#include "base/bytes.h"
#include "pipeline/content/content.h"

/* Puts name, size and modification time of a scan and of the files beside it and below that it may
 * refer to (mtl, pictures, buffers), if it may name any and no earlier scan of its folder may; and
 * its transform. Returns a negative errno if its folder cannot be listed, or a file cannot be seen
 * now; errors of the buffer stay in it. */
must_check int scan_key_put(struct buffer *text, const struct content *content, uint32_t scan);

#endif
