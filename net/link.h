/* Whether the server answers, and when to try again: what all requests have in common. After a
 * failure one request at a time goes out, after a pause that doubles and is never the same twice,
 * so that a hundred terminals do not return at one instant. */
#ifndef GOPURA_NET_LINK_H
#define GOPURA_NET_LINK_H

#include <stdbool.h>
#include <stdint.h>

#include "base/refusal.h"

struct link {
	uint32_t failures; /* since the last answer */
	int64_t retry_at_ms;
	bool online;              /* the last request was answered; false before the first */
	uint64_t offline_since_s; /* wall clock; 0 while online */
	uint32_t in_flight;       /* requests */
	struct refusal *refusal;  /* what was not taken of the server; borrowed, NULL: untold */
	uint64_t answers, errors; /* requests that ended so, since link_init */
};

/* Of the n-th failure in a row (from 1): half a second doubling to a minute, times 0.5 .. 1.5. */
int64_t link_pause_ms(uint32_t failures);

/* Before the first answer: not online, and free to ask. */
void link_init(struct link *link);
/* Any answer of the server counts, also one that says no. */
void link_answered(struct link *link);
/* Logs the first failure, with why. */
void link_failed(struct link *link, const char *url, const char *why);
/* After a failure only one request at a time, and not before its pause is over. */
bool link_may_ask(const struct link *link);
/* False until it failed twice: a server that starts anew is not worth telling. */
bool link_is_down(const struct link *link);

#endif
