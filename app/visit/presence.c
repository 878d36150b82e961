#include "app/visit/presence.h"

enum { SECOND_MS = 1000 };

void visit_init(struct visit *visit, int idle_s, int64_t now_ms)
{
	*visit = (struct visit){
		.state = VISIT_SOMEBODY,
		.idle_ms = (int64_t)idle_s * SECOND_MS,
		.touched_ms = now_ms,
	};
}

void visit_touch(struct visit *visit, int64_t now_ms)
{
	visit->state = VISIT_SOMEBODY;
	visit->touched_ms = now_ms;
	visit->touched = true;
}

void visit_keep(struct visit *visit, int64_t now_ms)
{
	if (visit->state == VISIT_SOMEBODY)
		visit->touched_ms = now_ms;
}

static int64_t ask_at_ms(const struct visit *visit)
{
	return visit->touched_ms + visit->idle_ms * (visit->reading ? VISIT_READ_TIMES : 1);
}

static int64_t gone_at_ms(const struct visit *visit)
{
	return ask_at_ms(visit) + (visit->touched ? VISIT_ASK_MS : 0);
}

void visit_step(struct visit *visit, int64_t now_ms, bool reading)
{
	visit->reading = reading;
	if (visit->state == VISIT_NOBODY)
		return;
	if (now_ms >= gone_at_ms(visit)) {
		visit->state = VISIT_NOBODY;
		visit->touched = false;
	} else {
		visit->state = now_ms >= ask_at_ms(visit) ? VISIT_ASKED : VISIT_SOMEBODY;
	}
}

int visit_left_ms(const struct visit *visit, int64_t now_ms)
{
	const int64_t left = gone_at_ms(visit) - now_ms;

	return visit->state != VISIT_NOBODY && left > 0 ? (int)left : 0;
}

int visit_asked_s(const struct visit *visit, int64_t now_ms)
{
	const int left = visit_left_ms(visit, now_ms);

	if (visit->state != VISIT_ASKED)
		return -1;
	return left > SECOND_MS ? (left + SECOND_MS - 1) / SECOND_MS : 1;
}

int visit_wait_ms(const struct visit *visit, int64_t now_ms)
{
	const int64_t ask = ask_at_ms(visit) - now_ms;

	if (visit->state == VISIT_NOBODY)
		return -1;
	if (visit->state == VISIT_ASKED)
		return visit_left_ms(visit, now_ms) % SECOND_MS + 1;
	return ask > 0 ? (int)ask : 0;
}
