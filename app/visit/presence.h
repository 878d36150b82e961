/* Decides whether a visitor is there: nobody -> somebody (at a touch) -> asked (after some time
 * without a touch) -> nobody (if no answer comes). Time alone leads from each state back to nobody,
 * so a terminal never stays as somebody left it. Pure: all times are passed in, in milliseconds of
 * clock_now_ms. */
#ifndef GOPURA_APP_VISIT_PRESENCE_H
#define GOPURA_APP_VISIT_PRESENCE_H

#include <stdbool.h>
#include <stdint.h>

enum {
	PRESENCE_IDLE_LEAST_S = 5,
	PRESENCE_IDLE_MOST_S = 3600,
	PRESENCE_READ_TIMES = 3, /* factor of the idle time while reading */
	PRESENCE_ASK_MS = 15000,
};

enum presence_state {
	PRESENCE_NOBODY, /* nobody is there: the model is presented by a tour or the attract camera
			  */
	PRESENCE_SOMEBODY,
	PRESENCE_ASKED, /* "are you still there?" */
};

struct presence {
	enum presence_state state;
	int64_t idle_ms;
	int64_t touched_ms; /* last touch; at first, when presence_init was called */
	bool reading;       /* as given to presence_step last */
	bool touched; /* this visitor has touched the panel; without a touch nobody is asked */
};

/* Starts in the state somebody. idle_s: seconds without a touch until the visitor is asked,
 * PRESENCE_IDLE_LEAST_S to PRESENCE_IDLE_MOST_S. */
void presence_init(struct presence *presence, int idle_s, int64_t now_ms);
/* Records a touch: somebody is there. */
void presence_touch(struct presence *presence, int64_t now_ms);
/* Restarts the idle time without a touch, in the state somebody only: a visitor who watches a tour
 * need not touch anything. */
void presence_keep(struct presence *presence, int64_t now_ms);
/* Updates the state. reading: the visitor is busy with something that needs few touches, such as an
 * open page, and gets more time. */
void presence_step(struct presence *presence, int64_t now_ms, bool reading);
/* Returns the milliseconds until presence_step changes the state, or until the next second of the
 * countdown; -1: never. */
int presence_wait_ms(const struct presence *presence, int64_t now_ms);
/* Returns the milliseconds until the state is nobody if no touch comes; 0: it is. */
int presence_left_ms(const struct presence *presence, int64_t now_ms);
/* Returns the seconds left for an answer, 1 or more; -1: nothing is asked. */
int presence_asked_s(const struct presence *presence, int64_t now_ms);

#endif
