/* Whether a visitor is there: pure but for the times it is told. Nobody -> a touch -> somebody, who
 * after a while without a touch is asked, and is gone where no answer comes. From each state the
 * next one is reached by time alone, so a terminal never stays where somebody left it. */
#ifndef GOPURA_APP_VISIT_PRESENCE_H
#define GOPURA_APP_VISIT_PRESENCE_H

#include <stdbool.h>
#include <stdint.h>

enum {
	PRESENCE_IDLE_LEAST_S = 5,
	PRESENCE_IDLE_MOST_S = 3600,
	PRESENCE_READ_TIMES = 3, /* who reads touches less often: idle times this */
	PRESENCE_ASK_MS = 15000,
};

enum presence_state {
	PRESENCE_NOBODY, /* the model is shown as it shows itself best */
	PRESENCE_SOMEBODY,
	PRESENCE_ASKED, /* "are you still there?" */
};

struct presence {
	enum presence_state state;
	int64_t idle_ms;
	int64_t touched_ms; /* or when it began */
	bool reading;       /* as last told */
	bool touched;       /* by this visitor; nobody is asked who never was there */
};

/* As if somebody had come a moment ago. */
void presence_init(struct presence *presence, int idle_s, int64_t now_ms);
/* Something was done with a finger. */
void presence_touch(struct presence *presence, int64_t now_ms);
/* Somebody is led about, and needs not touch anything: as if it were touched now. */
void presence_keep(struct presence *presence, int64_t now_ms);
/* Lets time pass. reading: a card, page or search is open, or a finger lies still on the glass. */
void presence_step(struct presence *presence, int64_t now_ms, bool reading);
/* Milliseconds until presence_step changes something, or the count-down's next second; -1: never.
 */
int presence_wait_ms(const struct presence *presence, int64_t now_ms);
/* Until nobody is there, without a touch; 0: so it is. */
int presence_left_ms(const struct presence *presence, int64_t now_ms);
/* Seconds that are left for an answer, 1 or more; -1: nothing is asked. */
int presence_asked_s(const struct presence *presence, int64_t now_ms);

#endif
