/* Memory for many small things that are released together, with a ceiling. One thread. */
#ifndef GOPURA_BASE_ARENA_H
#define GOPURA_BASE_ARENA_H

#include <stddef.h>
#include <stdint.h>

/* A plain value; zeroed but for the ceiling is empty. */
struct arena {
	struct arena_block *blocks; /* owned */
	size_t used, room;          /* bytes in the newest block */
	uint64_t total_bytes, ceiling_bytes;
};

/* Returns zeroed memory, aligned for any type, which the arena owns. NULL: no memory, or past the
 * ceiling. */
void *arena_alloc(struct arena *arena, size_t size);
/* Returns a copy of the text, terminated, which the arena owns; NULL as above. */
char *arena_text(struct arena *arena, const char *text, size_t length);
void arena_finish(struct arena *arena); /* frees all; NULL and zeroed are fine */

#endif
