/* A metric: how often a program refused something, and the last one with its reason, for those who
 * ask later why nothing changes. Reads the wall clock; one thread. */
#ifndef GOPURA_BASE_METRICS_REFUSAL_H
#define GOPURA_BASE_METRICS_REFUSAL_H

#include <stdint.h>

enum { METRICS_REFUSAL_WHAT_BYTES = 96, METRICS_REFUSAL_WHY_BYTES = 192 };

struct metrics_refusal {
	uint64_t count; /* refusals since the start; 0: none */
	int64_t at_s;   /* time of the last one by the wall clock, which may be wrong; seconds since
			   1970 */
	char what[METRICS_REFUSAL_WHAT_BYTES]; /* what was refused: a file, an object, a server */
	char why[METRICS_REFUSAL_WHY_BYTES];   /* the reason, in plain words */
};

/* Counts a refusal and records its time. Both texts are copied, cut if they do not fit. refusal may
 * be NULL. */
void metrics_refusal_note(struct metrics_refusal *refusal, const char *what, const char *why);

#endif
