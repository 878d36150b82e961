/* The state machine that decides from touches and elapsed time whether a visitor is there. */
#include "app/visit/presence.h"

enum { SECOND_MS = 1000 };

void presence_init(struct presence *presence, int idle_s, int64_t now_ms)
{
	*presence = (struct presence){
		.state = PRESENCE_SOMEBODY,
		.idle_ms = (int64_t)idle_s * SECOND_MS,
		.touched_ms = now_ms,
	};
}

void presence_touch(struct presence *presence, int64_t now_ms)
{
	presence->state = PRESENCE_SOMEBODY;
	presence->touched_ms = now_ms;
	presence->touched = true;
}

void presence_keep(struct presence *presence, int64_t now_ms)
{
	if (presence->state == PRESENCE_SOMEBODY)
		presence->touched_ms = now_ms;
}

static int64_t ask_at_ms(const struct presence *presence)
{
	return presence->touched_ms +
	       presence->idle_ms * (presence->reading ? PRESENCE_READ_TIMES : 1);
}

static int64_t gone_at_ms(const struct presence *presence)
{
	return ask_at_ms(presence) + (presence->touched ? PRESENCE_ASK_MS : 0);
}

void presence_step(struct presence *presence, int64_t now_ms, bool reading)
{
	presence->reading = reading;
	if (presence->state == PRESENCE_NOBODY)
		return;
	if (now_ms >= gone_at_ms(presence)) {
		presence->state = PRESENCE_NOBODY;
		presence->touched = false;
	} else {
		presence->state =
			now_ms >= ask_at_ms(presence) ? PRESENCE_ASKED : PRESENCE_SOMEBODY;
	}
}

int presence_left_ms(const struct presence *presence, int64_t now_ms)
{
	const int64_t left = gone_at_ms(presence) - now_ms;

	return presence->state != PRESENCE_NOBODY && left > 0 ? (int)left : 0;
}

int presence_asked_s(const struct presence *presence, int64_t now_ms)
{
	const int left = presence_left_ms(presence, now_ms);

	if (presence->state != PRESENCE_ASKED)
		return -1;
	return left > SECOND_MS ? (left + SECOND_MS - 1) / SECOND_MS : 1;
}

int presence_wait_ms(const struct presence *presence, int64_t now_ms)
{
	const int64_t ask = ask_at_ms(presence) - now_ms;

	if (presence->state == PRESENCE_NOBODY)
		return -1;
	if (presence->state == PRESENCE_ASKED)
		return presence_left_ms(presence, now_ms) % SECOND_MS + 1;
	return ask > 0 ? (int)ask : 0;
}
