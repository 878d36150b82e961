/* An object that is requested in segments, because it would fill the line for too long: what is
 * more urgent would wait, or share the line with it. Segments may arrive in any order; those that
 * are here are kept when others fail. */
#ifndef GOPURA_NET_SEGMENTS_H
#define GOPURA_NET_SEGMENTS_H

#include "base/bytes.h"

enum segment_state {
	SEGMENT_LACKING,
	SEGMENT_IN_FLIGHT,
	SEGMENT_HERE,
};

struct segments {
	uint8_t *bytes;      /* owned; of the whole object */
	uint32_t size;       /* of the object, bytes */
	uint32_t bytes_each; /* of each but the last */
	uint32_t count, here;
	uint8_t states[]; /* enum segment_state of each */
};

/* *out is owned by the caller; it is NULL on failure. All segments are lacking. size and bytes_each
 * are not 0. -ENOMEM. */
must_check int segments_create(struct segments **out, uint32_t size, uint32_t bytes_each);
void segments_destroy(struct segments *segments); /* NULL is fine */

/* Returns the bytes of segment n (0 .. count - 1); it begins at n * bytes_each. */
uint32_t segments_size(const struct segments *segments, uint32_t n);
/* Copies the bytes of segment n, which are segments_size many, and marks it here. Returns whether
 * all are here now. */
bool segments_put(struct segments *segments, uint32_t n, struct bytes bytes);
/* Returns the object when all segments are here; borrowed. */
struct bytes segments_bytes(const struct segments *segments);
/* Marks all segments lacking: together they were not the object. None may be in flight. */
void segments_forget(struct segments *segments);

#endif
