/* Blocks of memory in a list, each filled from its start. */
#include "base/arena.h"

#include <stdalign.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK_BYTES = 64 << 10 };

struct arena_block {
	struct arena_block *next;
	alignas(max_align_t) uint8_t bytes[];
};

void *arena_alloc(struct arena *arena, size_t size)
{
	const size_t align = alignof(max_align_t);
	struct arena_block *block;
	void *result;

	if (size > arena->ceiling_bytes)
		return NULL;
	size = (size + align - 1) / align * align;
	if (!arena->blocks || size > arena->room - arena->used) {
		size_t room = size > BLOCK_BYTES ? size : BLOCK_BYTES;

		if (room > arena->ceiling_bytes - arena->total_bytes)
			return NULL;
		block = calloc(1, sizeof(*block) + room);
		if (!block)
			return NULL;
		block->next = arena->blocks;
		arena->blocks = block;
		arena->total_bytes += room;
		arena->room = room;
		arena->used = 0;
	}
	result = arena->blocks->bytes + arena->used;
	arena->used += size;
	return result;
}

char *arena_text(struct arena *arena, const char *text, size_t length)
{
	char *copy = arena_alloc(arena, length + 1);

	if (copy)
		memcpy(copy, text, length);
	return copy;
}

void arena_finish(struct arena *arena)
{
	if (!arena)
		return;
	while (arena->blocks) {
		struct arena_block *block = arena->blocks;

		arena->blocks = block->next;
		free(block);
	}
	*arena = (struct arena){ .ceiling_bytes = arena->ceiling_bytes };
}
