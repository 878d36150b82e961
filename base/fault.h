/* What is wrong with somebody's file, in a sentence for who must mend it: file, place, cure.
 * Modules that read what people made take one and fill it; commands print it. */
#ifndef GOPURA_BASE_FAULT_H
#define GOPURA_BASE_FAULT_H

#include "base/compiler.h"

enum { FAULT_BYTES = 768 };

struct fault {
	char text[FAULT_BYTES]; /* "" while nothing is wrong */
};

/* Keeps the first text, which is the cause; later ones are its consequences. Gives error back,
 * so that a caller can say `return fault_set(fault, -EBADMSG, ...)`. fault may be NULL. */
int fault_set(struct fault *fault, int error, const char *text, ...) printf_like(3, 4);

#endif
