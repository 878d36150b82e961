/* What is wrong with files that people wrote or made: a list of diagnostics, each one sentence that
 * names the file, the place and the cure. Modules that read such files add to it; commands print it
 * and programs log it.
 *
 * In a full list an error takes the place of a warning at its end. So a zeroed list keeps the first
 * error, or the first warning while there is none: that is the cause of a failure, and what callers
 * add on the way up are its consequences. The first one lies in the list itself and needs no
 * memory, so that even a lack of memory can be told; with max 0, diagnostics_finish may be left
 * out. One thread. */
#ifndef GOPURA_BASE_DIAGNOSTICS_H
#define GOPURA_BASE_DIAGNOSTICS_H

#include <stdint.h>
#include <stdio.h>

#include "base/compiler.h"

enum { DIAGNOSTIC_BYTES = 768 };

struct diagnostic {
	int error;            /* negative errno; 0: a warning */
	unsigned line;        /* 0: none */
	uint32_t place_bytes; /* length of the place that text begins with; 0: it names none */
	/* Printable UTF-8: "FILE:7: SENTENCE", "FILE: SENTENCE", "line 7: SENTENCE" or SENTENCE. */
	char text[DIAGNOSTIC_BYTES];
};

struct diagnostics {
	uint32_t max;         /* how many are kept; 0: one */
	uint32_t count;       /* how many are in the list */
	uint32_t dropped;     /* how many did not fit */
	uint32_t error_count; /* how many of all are errors */
	struct diagnostic first;
	/* Private: the others. */
	struct diagnostic *more; /* owned */
	uint32_t more_room;
};

/* Adds a diagnostic to the end. file is NULL, and line 0, where there is none. What cannot be
 * printed becomes '?', and a text too long is cut. Returns error, so that a caller can write
 * `return diagnostics_add(diagnostics, -EBADMSG, ...)`. diagnostics may be NULL. */
int diagnostics_add(struct diagnostics *diagnostics, int error, const char *file, unsigned line,
		    const char *sentence, ...) printf_like(5, 6);

/* Returns a diagnostic, borrowed until the next change of the list. i is less than count. */
const struct diagnostic *diagnostics_get(const struct diagnostics *diagnostics, uint32_t i);
/* Returns the text of the first error, or else warning, borrowed likewise; of `error` if there is
 * none. */
const char *diagnostics_cause(const struct diagnostics *diagnostics, int error);
/* Returns the number of all, with those that did not fit. */
uint32_t diagnostics_total(const struct diagnostics *diagnostics);
/* Orders the list by lines; what has no line goes to the end. Otherwise the order stays. */
void diagnostics_sort(struct diagnostics *diagnostics);
/* Prints each on a line of its own after `before`, and how many did not fit. */
void diagnostics_print(const struct diagnostics *diagnostics, FILE *to, const char *before);
/* Frees the list and empties it; max stays. NULL is fine. */
void diagnostics_finish(struct diagnostics *diagnostics);

#endif
