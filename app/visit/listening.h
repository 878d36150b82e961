/* Listening to the spoken text of a page: begins and ends it, and gives the overlay its words as
 * they are said. It ends by itself, when its page closes or changes, when the visitor leaves, and
 * by any touch of a control or the model; the eye may be turned meanwhile. docs/sound.md. */
#ifndef GOPURA_APP_VISIT_LISTENING_H
#define GOPURA_APP_VISIT_LISTENING_H

#include "app/view/exhibit.h"
#include "app/view/redraw.h"
#include "sound/speaker.h"

/* What it works with; borrowed. */
struct listening_env {
	const struct exhibit *shown;
	struct redraw *redraw;
};

struct listening {
	struct listening_env env;
	struct speaker *speaker; /* owned; NULL: there is no sound */
	bool on;                 /* a text is spoken, or on its way */
	bool speaks;             /* the speaker has it */
	int part;                /* whose page it is */
	struct hash hash;        /* of the text */
	uint32_t cue;            /* what the overlay shows: 1 + its number; 0: none */
	int64_t shown_ms;        /* when the overlay was told */
};

/* loudness: 1 to SPEAKER_LOUDNESS_MAX; 0: no sound. Returns 0 or -ENOMEM. */
must_check int listening_init(struct listening *listening, const struct listening_env *env,
			      uint32_t loudness);
void listening_finish(struct listening *listening); /* zeroed is fine */

/* The button of the page: begins its text, or ends it. */
void listening_press(struct listening *listening);
/* Ends it, if there is anything to end. */
void listening_end(struct listening *listening);

/* Returns in how many milliseconds listening_turn has something to do; -1: never. */
int listening_wait_ms(const struct listening *listening);
/* Follows the speaker, and requests a frame where the words change. */
void listening_turn(struct listening *listening);
/* Another release is shown: ends it. data is the listening. */
void listening_on_release(void *data, const struct exhibit_change *change);

#endif
