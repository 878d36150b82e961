/* What a browser sends, checked: docs/curator.md has the protocol. */
#ifndef GOPURA_CURATOR_SESSION_REQUEST_H
#define GOPURA_CURATOR_SESSION_REQUEST_H

#include <stddef.h>

#include "base/compiler.h"
#include "curator/select/strokes.h"
#include "geometry/camera.h"

enum {
	REQUEST_BYTES_MAX = 512 << 10,
	REQUEST_ID_BYTES = 65,     /* with its end, as all below */
	REQUEST_TITLE_BYTES = 801, /* 200 characters, as everywhere in the pages */
	REQUEST_LANGUAGE_BYTES = 12,
	REQUEST_PROBLEM_BYTES = 128,
};

enum request_kind {
	REQUEST_CAMERA,
	REQUEST_GOT, /* a picture has arrived */
	REQUEST_STROKE,
	REQUEST_APPLY, /* the strokes of mark and unmark */
	REQUEST_CLEAR, /* forgets them */
	REQUEST_UNDO,
	REQUEST_REDO,
	REQUEST_GROW,
	REQUEST_SHRINK,
	REQUEST_SMOOTH, /* its border */
	REQUEST_EMPTY,
	REQUEST_PICK, /* where is the surface at a pixel? */
	REQUEST_SAVE,
	REQUEST_OPEN,
};

enum request_tool { TOOL_LASSO, TOOL_PART, TOOL_REST, TOOL_HEAVY };

struct request {
	enum request_kind kind;
	uint32_t view;        /* camera, stroke, apply, pick: the number of a camera */
	struct camera camera; /* near_m and far_m are not set */
	bool moving;
	enum request_tool tool;
	bool take, through;    /* takes away from the region; through the whole depth */
	float (*points_px)[2]; /* stroke, and one for pick; owned */
	uint32_t point_count;
	float width_px;
	char id[REQUEST_ID_BYTES]; /* a-z 0-9 - _ */
	/* save, in UTF-8, "": none. from: the title that this one replaces */
	char title[REQUEST_TITLE_BYTES], from[REQUEST_TITLE_BYTES];
	char language[REQUEST_LANGUAGE_BYTES];
	bool is_new, replaces; /* save: as a new part; whatever others have saved meanwhile */
};

/* Returns the type of a message of that kind. */
const char *request_type(enum request_kind kind);

/* Parses a message. Returns 0, or -EINVAL with one sentence in problem; -ENOMEM. The caller
 * finishes *out; it is zeroed on failure. */
must_check int request_parse(struct request *out, const char *text, size_t bytes,
			     char problem[REQUEST_PROBLEM_BYTES]);
void request_finish(struct request *request); /* NULL and zeroed are fine */

#endif
