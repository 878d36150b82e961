/* Keeps the bytes of an object while its segments arrive. */
#include "net/segments.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

int segments_create(struct segments **out, uint32_t size, uint32_t bytes_each)
{
	const uint32_t count = size / bytes_each + (size % bytes_each > 0);
	struct segments *segments = calloc(1, sizeof(*segments) + count);

	*out = NULL;
	if (!segments)
		return -ENOMEM;
	segments->bytes = malloc(size);
	if (!segments->bytes) {
		free(segments);
		return -ENOMEM;
	}
	segments->size = size;
	segments->bytes_each = bytes_each;
	segments->count = count;
	*out = segments;
	return 0;
}

void segments_destroy(struct segments *segments)
{
	if (!segments)
		return;
	free(segments->bytes);
	free(segments);
}

uint32_t segments_size(const struct segments *segments, uint32_t n)
{
	return n + 1 < segments->count ? segments->bytes_each
				       : segments->size - n * segments->bytes_each;
}

bool segments_put(struct segments *segments, uint32_t n, struct bytes bytes)
{
	memcpy(segments->bytes + (size_t)n * segments->bytes_each, bytes.data, bytes.size);
	segments->here += segments->states[n] != SEGMENT_HERE;
	segments->states[n] = SEGMENT_HERE;
	return segments->here == segments->count;
}

struct bytes segments_bytes(const struct segments *segments)
{
	return (struct bytes){ segments->bytes, segments->size };
}

void segments_forget(struct segments *segments)
{
	memset(segments->states, SEGMENT_LACKING, segments->count);
	segments->here = 0;
}
