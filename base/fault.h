/* What is wrong with a user's file, in one sentence that names the file, the place and the cure.
 * Modules that read files written by people fill it in; commands print it. */
#ifndef GOPURA_BASE_FAULT_H
#define GOPURA_BASE_FAULT_H

#include "base/compiler.h"

enum { FAULT_BYTES = 768 };

struct fault {
	char text[FAULT_BYTES]; /* "" if nothing is wrong */
};

/* Sets the text, unless one is set: the first is the cause, later ones are consequences. Returns
 * error, so that a caller can write `return fault_set(fault, -EBADMSG, ...)`. fault may be NULL. */
int fault_set(struct fault *fault, int error, const char *text, ...) printf_like(3, 4);

#endif
