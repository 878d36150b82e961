/* Private to input: a file of touches. docs/input.md has its form. */
#ifndef GOPURA_INPUT_TOUCH_REPLAY_H
#define GOPURA_INPUT_TOUCH_REPLAY_H

#include "base/bytes.h"
#include "input/touch_event.h"

struct touch_replay {
	struct touch_event *events; /* owned; in order of time; pixels of the panel */
	size_t count;
};

/* *line (may be NULL) is that of the fault. -EINVAL: malformed; -ENOMEM. width and height are the
 * panel's, to which a file with a "size" line is scaled. */
must_check int touch_replay_parse(struct touch_replay *out, struct bytes text, int width_px,
				  int height_px, unsigned *line);
void touch_replay_finish(struct touch_replay *replay); /* NULL and zeroed are fine */

#endif
