/* What a browser sends, checked: docs/curator.md has the protocol. */
#ifndef GOPURA_CURATOR_SESSION_MESSAGE_H
#define GOPURA_CURATOR_SESSION_MESSAGE_H

#include <stddef.h>

#include "base/compiler.h"
#include "curator/select/strokes.h"
#include "geometry/camera.h"

enum {
	MESSAGE_BYTES_MAX = 512 << 10,
	MESSAGE_ID_BYTES = 65, /* with its end, as all below */
	MESSAGE_TITLE_BYTES = 256,
	MESSAGE_LANGUAGE_BYTES = 12,
	MESSAGE_PROBLEM_BYTES = 128,
};

enum message_kind {
	MESSAGE_CAMERA,
	MESSAGE_GOT, /* a picture has arrived */
	MESSAGE_STROKE,
	MESSAGE_APPLY, /* the strokes of mark and unmark */
	MESSAGE_CLEAR, /* forgets them */
	MESSAGE_UNDO,
	MESSAGE_REDO,
	MESSAGE_GROW,
	MESSAGE_SHRINK,
	MESSAGE_EMPTY,
	MESSAGE_PICK, /* where is the surface at a pixel? */
	MESSAGE_SAVE,
	MESSAGE_OPEN,
};

enum message_tool { TOOL_LASSO, TOOL_PART, TOOL_REST, TOOL_HEAVY };

struct message {
	enum message_kind kind;
	uint32_t view;        /* camera, stroke, apply, pick: the number of a camera */
	struct camera camera; /* near_m and far_m are not set */
	bool moving;
	enum message_tool tool;
	bool take, through;
	float (*points_px)[2]; /* stroke, and one for pick; owned */
	uint32_t point_count;
	float width_px;
	char id[MESSAGE_ID_BYTES];                                         /* a-z 0-9 - _ */
	char title[MESSAGE_TITLE_BYTES], language[MESSAGE_LANGUAGE_BYTES]; /* UTF-8; "": none */
};

/* Parses a message. Returns 0, or -EINVAL with one sentence in problem; -ENOMEM. The caller
 * finishes *out; it is zeroed on failure. */
must_check int message_parse(struct message *out, const char *text, size_t bytes,
			     char problem[MESSAGE_PROBLEM_BYTES]);
void message_finish(struct message *message); /* NULL and zeroed are fine */

#endif
