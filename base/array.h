/* An array that grows: a typed pointer, a count and a room, side by side in the struct that owns
 * them. A zeroed pointer and room are an empty array; free() releases the pointer. Arrays that may
 * be larger than memory are base/spill.
 *
 *   rc = ARRAY_RESERVE(list->items, list->room, list->count + 1, ITEMS_MAX);
 *   if (rc == 0)
 *           list->items[list->count++] = item; */
#ifndef GOPURA_BASE_ARRAY_H
#define GOPURA_BASE_ARRAY_H

#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"

/* Ensures that items, a pointer, has room for `needed` items of its type, at most `most`; room, a
 * uint32_t, is how many fit. Returns 0; -EFBIG if more than `most` are needed; -ENOMEM. On failure
 * nothing changed. New items have undefined contents. Each argument is evaluated once. */
#define ARRAY_RESERVE(items, room, needed, most)                                                   \
	array_reserve(&(items), &(room), (needed), (most), sizeof(*(items)))

/* For ARRAY_RESERVE alone: items is the address of a pointer to items of item_bytes each. */
must_check int array_reserve(void *items, uint32_t *room, uint64_t needed, uint32_t most,
			     size_t item_bytes);

#endif
