/* Puts a fence after each part of the triangles, and waits for the one before. */
#include "render/display/throttle.h"

#include "render/display/fences.h"

enum { PART_TRIANGLES = 2000 };

void throttle_count(struct throttle *throttle, uint32_t triangles)
{
	const uint64_t before = throttle->fence;

	throttle->triangles += triangles;
	if (throttle->triangles < PART_TRIANGLES)
		return;
	throttle->triangles = 0;
	throttle->fence = fences_add();
	fences_wait(before);
}
