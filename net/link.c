/* Tracks whether the server answers, and computes randomised exponential pauses between
 * attempts. */
#include "net/link.h"

#include <stdlib.h>

#include "base/clock.h"
#include "base/log.h"

enum { PAUSE_MS = 500, PAUSE_MAX_MS = 60000 };

int64_t link_pause_ms(uint32_t failures)
{
	int64_t pause_ms = PAUSE_MS;

	for (uint32_t i = 1; i < failures && pause_ms < PAUSE_MAX_MS; i++)
		pause_ms *= 2;
	if (pause_ms > PAUSE_MAX_MS)
		pause_ms = PAUSE_MAX_MS;
	return pause_ms / 2 + random() % (pause_ms + 1);
}

void link_init(struct link *link)
{
	*link = (struct link){ .offline_ms = clock_now_ms() };
}

void link_answered(struct link *link)
{
	if (!link->online)
		log_info("net", "online");
	link->answers++;
	link->online = true;
	link->failures = 0;
	link->retry_at_ms = 0;
}

void link_failed(struct link *link, const char *url, const char *why)
{
	link->errors++;
	/* Requests that were already in flight when the connection broke give no new
	 * information. */
	if (link->failures > 0 && clock_now_ms() < link->retry_at_ms)
		return;
	if (link->online || link->failures == 0)
		log_warn("net", "offline: %s: %s", url, why);
	metrics_refusal_note(link->refusal, url, why); /* the last one is the one to be cured */
	if (link->online)
		link->offline_ms = clock_now_ms();
	link->online = false;
	link->failures++;
	link->retry_at_ms = clock_now_ms() + link_pause_ms(link->failures);
}

uint64_t link_offline_since_s(struct link *link)
{
	const int64_t since_s = clock_wall_s() - (clock_now_ms() - link->offline_ms) / 1000;

	if (link->online)
		return 0;
	/* Both clocks are rounded, which is no reason to tell another second. */
	if (llabs(since_s - (int64_t)link->offline_since_s) > 1)
		link->offline_since_s = since_s > 0 ? (uint64_t)since_s : 1;
	return link->offline_since_s;
}

bool link_may_request(const struct link *link)
{
	if (link->failures == 0)
		return true;
	return link->in_flight == 0 && clock_now_ms() >= link->retry_at_ms;
}

bool link_is_down(const struct link *link)
{
	return link->failures >= 2;
}
