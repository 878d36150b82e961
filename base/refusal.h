/* The last thing that a program would not take, kept for who asks later why nothing changes: a
 * figure of the health page. Pure; one thread. */
#ifndef GOPURA_BASE_REFUSAL_H
#define GOPURA_BASE_REFUSAL_H

#include <stdint.h>

enum { REFUSAL_WHAT_BYTES = 96, REFUSAL_WHY_BYTES = 192 };

struct refusal {
	uint64_t count;                /* since start; 0: nothing was refused yet */
	int64_t at_s;                  /* wall clock, which may be wrong */
	char what[REFUSAL_WHAT_BYTES]; /* what it concerned: a file, an object, a server */
	char why[REFUSAL_WHY_BYTES];   /* in plain words */
};

/* Both texts are copied, cut where they do not fit. refusal may be NULL. */
void refusal_note(struct refusal *refusal, const char *what, const char *why);

#endif
