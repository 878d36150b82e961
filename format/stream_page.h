/* Payload of PAGE_STREAM: the beginning of the release's streaming mesh (format/stream.h). The
 * children of the page are its blocks of records, in order, an object each: the payload's stream
 * and the children, one after the other, are the whole stream.
 *
 *   u32 group_count
 *   f32 error_m, once before each child and once after the last
 *   the stream's header and its base
 *
 * All integers are little endian. The whole mesh is the surface of the cut in which the first
 * group_count groups of the hierarchy are refined. So a kiosk shows it until it has these groups
 * (docs/stream.md). */
#ifndef GOPURA_FORMAT_STREAM_PAGE_H
#define GOPURA_FORMAT_STREAM_PAGE_H

#include "base/bytes.h"

enum { STREAM_PAGE_VERTICES_MAX = 1 << 16 /* of the whole mesh: a GPU's index has 16 bits */ };

struct stream_page {
	uint32_t group_count; /* at least 1 */
	uint32_t block_count; /* children of the page */
	struct bytes start;   /* header and base; borrowed from the payload */
	struct bytes errors;  /* borrowed; see stream_page_error_m */
};

/* Appends the payload. errors_m: block_count + 1 distances, none negative and none above the one
 * before. Failures are out->error. */
void stream_page_encode(struct buffer *out, uint32_t group_count, const float *errors_m,
			uint32_t block_count, struct bytes start);
/* Returns -EBADMSG if the payload is too short, group_count is 0, or an error is not finite,
 * negative, or above the one before. *out is then zeroed. The stream is not decoded. */
must_check int stream_page_decode(struct stream_page *out, struct bytes payload,
				  uint32_t block_count);
/* Returns the mean distance (root of the mean square, metres) between the whole mesh and the mesh
 * after `blocks` blocks, 0 to block_count. */
float stream_page_error_m(const struct stream_page *page, uint32_t blocks);

#endif
