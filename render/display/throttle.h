/* Keeps a driver that draws on the processor from getting far ahead of what is drawn. Mesa's
 * llvmpipe first sorts triangles into tiles, in hundreds of bytes each, and goes on sorting while
 * it draws: of a large picture everything but the beginning would wait in memory (docs/figures.md,
 * "Footprint"). Where there are no fences (render/display/fences.h), it does nothing. */
#ifndef GOPURA_RENDER_DISPLAY_THROTTLE_H
#define GOPURA_RENDER_DISPLAY_THROTTLE_H

#include <stdint.h>

/* Begins zeroed. */
struct throttle {
	uint64_t fence;     /* after the part before this one */
	uint32_t triangles; /* of this part */
};

/* Tells that so many triangles were drawn. Where they complete a part, waits until the part before
 * it is drawn, so that at most two are under way: one is sorted while the other is drawn. */
void throttle_count(struct throttle *throttle, uint32_t triangles);

#endif
