/* Takes samples of what is received while the line is busy, and keeps the running estimate. */
#include "net/line_rate.h"

#include "base/clock.h"

enum {
	SAMPLE_MS = 250,
	SHORT_MS = 20, /* a sample that the end of all requests cuts short has at least so much */
	/* A sample has at least so much: of a small answer most is round trips. */
	SAMPLE_BYTES = 4096,
	/* A line is not silent for longer than it takes to carry some packets: what is longer are
	 * round trips, in which nothing was on it. */
	SILENCE_MS = 50,
	SILENCE_BYTES = 4 * 1448,
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

/* Returns how much of the time between two arrivals was the line's. */
static int64_t line_ms(const struct line_rate *rate, int64_t passed_ms)
{
	const int64_t packets_ms = (int64_t)(SILENCE_BYTES * 1000 / rate->bytes_per_s);
	const int64_t most_ms = packets_ms > SILENCE_MS ? packets_ms : SILENCE_MS;

	return rate->is_measured && passed_ms > most_ms ? most_ms : passed_ms;
}

static void begin_sample(struct line_rate *rate)
{
	rate->from_bytes = rate->received_bytes;
	rate->sample_ms = 0;
}

void line_rate_note(struct line_rate *rate, uint64_t received_bytes, bool is_busy)
{
	const int64_t now_ms = clock_now_ms();
	const bool came = received_bytes > rate->received_bytes;
	const bool ends = rate->is_busy && !is_busy;
	const uint64_t bytes = received_bytes - rate->from_bytes;

	rate->received_bytes = received_bytes;
	if (rate->is_receiving && came)
		rate->sample_ms += line_ms(rate, now_ms - rate->came_ms);
	if (came)
		rate->came_ms = now_ms;
	if (rate->is_receiving && bytes >= SAMPLE_BYTES &&
	    rate->sample_ms >= (ends ? SHORT_MS : SAMPLE_MS)) {
		take_sample(rate, bytes, (uint64_t)rate->sample_ms);
		begin_sample(rate);
	} else if (rate->is_busy && !rate->is_receiving && came) {
		rate->is_receiving = true;
		begin_sample(rate);
	}
	if (is_busy != rate->is_busy) {
		rate->is_busy = is_busy;
		rate->is_receiving = false;
	}
}

uint64_t line_rate_carries(const struct line_rate *rate, uint32_t ms)
{
	return rate->bytes_per_s * ms / 1000;
}
