/* The last thing that a program refused, kept for those who ask later why nothing changes: a metric
 * of the health page. Reads the wall clock; one thread. */
#ifndef GOPURA_BASE_REFUSAL_H
#define GOPURA_BASE_REFUSAL_H

#include <stdint.h>

enum { REFUSAL_WHAT_BYTES = 96, REFUSAL_WHY_BYTES = 192 };

struct refusal {
	uint64_t count; /* refusals since the start; 0: none */
	int64_t at_s;   /* time of the last one by the wall clock, which may be wrong; seconds since
			   1970 */
	char what[REFUSAL_WHAT_BYTES]; /* what was refused: a file, an object, a server */
	char why[REFUSAL_WHY_BYTES];   /* the reason, in plain words */
};

/* Counts a refusal and records its time. Both texts are copied, cut if they do not fit. refusal may
 * be NULL. */
void refusal_note(struct refusal *refusal, const char *what, const char *why);

#endif
