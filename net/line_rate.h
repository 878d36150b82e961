/* The rate of the line, as a running estimate (paper P3, section 3.6.2): W' = (S + s) / (S / W + t)
 * after s bytes more in time t. What came before counts for the last seconds only, so that the
 * estimate follows a line that changes. A sample that is much less or more than the estimate is set
 * aside as noise, unless the next one says the same. */
#ifndef GOPURA_NET_LINE_RATE_H
#define GOPURA_NET_LINE_RATE_H

#include <stdbool.h>
#include <stdint.h>

struct line_rate {
	uint64_t bytes_per_s;                /* W; positive */
	bool is_measured;                    /* W is more than an assumption */
	bool is_busy;                        /* a request is in flight */
	bool is_receiving;                   /* its first bytes came: the sample runs */
	uint32_t odd_count;                  /* samples in a row that were set aside */
	uint64_t received_bytes, from_bytes; /* in all; of these when the sample began */
	int64_t came_ms;                     /* when the last of them came */
	int64_t sample_ms;                   /* of the line since the sample began */
};

/* Until there is a sample, bytes_per_s is assumed. */
void line_rate_init(struct line_rate *rate, uint64_t bytes_per_s);
/* Notes how much has been received in all so far, and whether anything is in flight. Call it
 * whenever something may have arrived. The time until the first byte after a pause is the server's,
 * and does not count; nor do round trips in between, in which the line was silent. */
void line_rate_note(struct line_rate *rate, uint64_t received_bytes, bool is_busy);
/* Returns how many bytes the line carries in that time. */
uint64_t line_rate_carries(const struct line_rate *rate, uint32_t ms);

#endif
