/* Takes samples of what is received while the line is busy, and keeps the running estimate. */
#include "net/line_rate.h"

#include "base/clock.h"

enum {
	SAMPLE_MS = 250,
	/* A shorter sample is used only if the line became idle after that much. */
	SHORT_MS = 20,
	SHORT_BYTES = 4096,
	PAST_MS = 3000, /* what came before weighs at most as much as so long a sample */
	ODD_FACTOR = 3, /* so many times more or less is set aside */
	ODD_MOST = 2,   /* so many in a row are no noise: the line has changed */
};

void line_rate_init(struct line_rate *rate, uint64_t bytes_per_s)
{
	*rate = (struct line_rate){ .bytes_per_s = bytes_per_s };
}

static void take_sample(struct line_rate *rate, uint64_t bytes, uint64_t ms)
{
	const uint64_t now = bytes * 1000 / ms, was = rate->bytes_per_s;
	const bool odd = now > ODD_FACTOR * was || now < was / ODD_FACTOR;

	if (bytes == 0)
		return; /* a line that carries nothing has no rate; the link notices it */
	if (rate->is_measured && odd && ++rate->odd_count < ODD_MOST)
		return;
	if (!rate->is_measured || odd)
		rate->bytes_per_s = now;
	else
		rate->bytes_per_s = (was * PAST_MS / 1000 + bytes) * 1000 / (PAST_MS + ms);
	if (rate->bytes_per_s == 0)
		rate->bytes_per_s = 1;
	rate->is_measured = true;
	rate->odd_count = 0;
}

void line_rate_note(struct line_rate *rate, uint64_t received_bytes, bool is_busy)
{
	const int64_t now_ms = clock_now_ms(), ms = now_ms - rate->from_ms;
	const uint64_t bytes = received_bytes - rate->from_bytes;
	const bool ends = rate->is_busy && !is_busy;

	if (rate->is_receiving &&
	    (ms >= SAMPLE_MS || (ends && ms >= SHORT_MS && bytes >= SHORT_BYTES))) {
		take_sample(rate, bytes, (uint64_t)ms);
		rate->from_bytes = received_bytes;
		rate->from_ms = now_ms;
	} else if (rate->is_busy && !rate->is_receiving && bytes > 0) {
		rate->is_receiving = true;
		rate->from_bytes = received_bytes;
		rate->from_ms = now_ms;
	}
	if (is_busy != rate->is_busy) {
		rate->is_busy = is_busy;
		rate->is_receiving = false;
		rate->from_bytes = received_bytes;
	}
}

uint64_t line_rate_carries(const struct line_rate *rate, uint32_t ms)
{
	return rate->bytes_per_s * ms / 1000;
}
