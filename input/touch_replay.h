/* Private to input: parses a file of recorded touches. docs/input.md has its format. */
#ifndef GOPURA_INPUT_TOUCH_REPLAY_H
#define GOPURA_INPUT_TOUCH_REPLAY_H

#include "base/bytes.h"
#include "input/touch_event.h"

struct touch_replay {
	struct touch_event *events; /* owned; in order of time; in pixels of the panel */
	uint32_t count, room;
};

/* Parses a replay file. width_px and height_px are the panel's, to which a file with a "size" line
 * is scaled. -EINVAL: malformed, and *line (may be NULL) is the number of the faulty line; -ENOMEM.
 * The caller finishes *out. */
must_check int touch_replay_parse(struct touch_replay *out, struct bytes text, int width_px,
				  int height_px, unsigned *line);
/* Frees the events. NULL and a zeroed replay are fine. */
void touch_replay_finish(struct touch_replay *replay);

#endif
