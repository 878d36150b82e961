/* The time that the GPU takes for frames, by EXT_disjoint_timer_query, without waiting for it.
 * Where the extension is missing, everything here does nothing. */
#ifndef GOPURA_RENDER_DISPLAY_GPU_TIMER_H
#define GOPURA_RENDER_DISPLAY_GPU_TIMER_H

#include "render/display/gl.h"

enum { GPU_TIMER_QUERIES = 4 }; /* frames that may be in flight */

struct gpu_timer {
	bool known;   /* the extension is there */
	bool running; /* between begin and end */
	GLuint queries[GPU_TIMER_QUERIES];
	uint32_t begun, taken; /* queries since the start */
};

/* Looks for the extension in the current context. */
void gpu_timer_init(struct gpu_timer *timer);
void gpu_timer_finish(struct gpu_timer *timer); /* zeroed is fine */
/* Encloses the commands of a frame. Nothing is measured while all queries are in flight. */
void gpu_timer_begin(struct gpu_timer *timer);
void gpu_timer_end(struct gpu_timer *timer);
/* Returns the microseconds of the latest frame that the GPU has finished since the last call; 0:
 * none, the clock was interrupted, or the driver's answer cannot be true. */
int64_t gpu_timer_take_us(struct gpu_timer *timer);

#endif
