/* Grows arrays by half, so that appending n items moves each a constant number of times. */
#include "base/array.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_ROOM = 16 };

int array_reserve(void *items, uint32_t *room, uint64_t needed, uint32_t most, size_t item_bytes)
{
	uint64_t larger = (uint64_t)*room + *room / 2;
	void *old, *grown;

	if (needed <= *room)
		return 0;
	if (needed > most)
		return -EFBIG;
	if (larger < FIRST_ROOM)
		larger = FIRST_ROOM;
	if (larger < needed)
		larger = needed;
	if (larger > most)
		larger = most;
	if (larger > SIZE_MAX / item_bytes)
		return -ENOMEM;
	memcpy(&old, items, sizeof(old)); /* pointers to whatever type are kept alike */
	grown = realloc(old, (size_t)larger * item_bytes);
	if (!grown)
		return -ENOMEM;
	memcpy(items, &grown, sizeof(grown));
	*room = (uint32_t)larger;
	return 0;
}
