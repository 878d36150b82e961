/* Whether the server answers, and when to try again; shared by all requests. After a failure, only
 * one request at a time is sent, after a pause that doubles and is randomised, so that a hundred
 * terminals do not all return at the same moment. */
#ifndef GOPURA_NET_LINK_H
#define GOPURA_NET_LINK_H

#include <stdbool.h>
#include <stdint.h>

#include "base/metrics_refusal.h"

enum { NO_MEMORY_MS = 1000 }; /* until what failed without memory is tried again */

struct link {
	uint32_t failures; /* in a row, since the last answer */
	int64_t retry_at_ms;
	bool online; /* the last request was answered; false before the first one */
	/* Since when it is offline: clock_now_ms, and what link_offline_since_s said last. */
	int64_t offline_ms;
	uint64_t offline_since_s;
	uint32_t in_flight;              /* number of requests in flight */
	struct metrics_refusal *refusal; /* where refusals are noted; borrowed; NULL: nowhere */
	uint64_t answers, errors;        /* requests that ended this way since link_init */
};

/* Returns the pause in ms after the n-th failure in a row (n from 1): half a second, doubling up to
 * one minute, times a random factor of 0.5 to 1.5. */
int64_t link_pause_ms(uint32_t failures);

/* Initial state: not online, but requests are allowed. */
void link_init(struct link *link);
/* Any answer of the server counts, even a negative one. */
void link_answered(struct link *link);
/* Notes a failed request, as a refusal too. Logs url and why for the first failure in a row. */
void link_failed(struct link *link, const char *url, const char *why);
/* Returns whether a request may be sent now. After a failure only one at a time, after its
 * pause. */
bool link_may_request(const struct link *link);
/* Returns since when the server is offline, by the wall clock of now, which may have been set
 * meanwhile; 0 while online. */
uint64_t link_offline_since_s(struct link *link);
/* Returns true after two failures in a row. A single one may be a server that restarts. */
bool link_is_down(const struct link *link);

#endif
