/* Whether a visitor is there: pure but for the times it is told. Nobody -> a touch -> somebody, who
 * after a while without a touch is asked, and is gone where no answer comes. From each state the
 * next one is reached by time alone, so a terminal never stays where somebody left it. */
#ifndef GOPURA_APP_VISIT_PRESENCE_H
#define GOPURA_APP_VISIT_PRESENCE_H

#include <stdbool.h>
#include <stdint.h>

enum {
	VISIT_IDLE_LEAST_S = 5,
	VISIT_IDLE_MOST_S = 3600,
	VISIT_READ_TIMES = 3, /* who reads touches less often: idle times this */
	VISIT_ASK_MS = 15000,
};

enum visit_state {
	VISIT_NOBODY, /* the model is shown as it shows itself best */
	VISIT_SOMEBODY,
	VISIT_ASKED, /* "are you still there?" */
};

struct visit {
	enum visit_state state;
	int64_t idle_ms;
	int64_t touched_ms; /* or when it began */
	bool reading;       /* as last told */
	bool touched;       /* by this visitor; nobody is asked who never was there */
};

/* As if somebody had come a moment ago. */
void visit_init(struct visit *visit, int idle_s, int64_t now_ms);
/* Something was done with a finger. */
void visit_touch(struct visit *visit, int64_t now_ms);
/* Somebody is led about, and needs not touch anything: as if it were touched now. */
void visit_keep(struct visit *visit, int64_t now_ms);
/* Lets time pass. reading: a card, page or search is open, or a finger lies still on the glass. */
void visit_step(struct visit *visit, int64_t now_ms, bool reading);
/* Milliseconds until visit_step changes something, or the count-down's next second; -1: never. */
int visit_wait_ms(const struct visit *visit, int64_t now_ms);
/* Until nobody is there, without a touch; 0: so it is. */
int visit_left_ms(const struct visit *visit, int64_t now_ms);
/* Seconds that are left for an answer, 1 or more; -1: nothing is asked. */
int visit_asked_s(const struct visit *visit, int64_t now_ms);

#endif
