/* Settings of glibc's malloc. */
#include "app/settings/heap.h"

#include <malloc.h>

enum {
	FREED_BYTES_MAX = 64 << 20,   /* that malloc keeps while the eye moves */
	MAPPED_BYTES_LEAST = 1 << 20, /* of an allocation that is a mapping of its own */
};

void heap_prepare(void)
{
	/* One arena: those of the worker threads would hold 2 MB unused. */
	mallopt(M_ARENA_MAX, 1);
	/* A driver that draws on the processor frees megabytes in each frame, and would fault them
	 * in again in the next. app/frame.c gives them back when the picture has settled. */
	mallopt(M_TRIM_THRESHOLD, FREED_BYTES_MAX);
	mallopt(M_MMAP_THRESHOLD, MAPPED_BYTES_LEAST);
}
