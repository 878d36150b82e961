/* Formats the message of a fault and keeps the first one. */
#include "base/fault.h"

#include <stdarg.h>
#include <stdio.h>

int fault_set(struct fault *fault, int error, const char *text, ...)
{
	va_list args;

	if (!fault || fault->text[0])
		return error;
	va_start(args, text);
	vsnprintf(fault->text, sizeof(fault->text), text, args);
	va_end(args);
	/* The text may quote bytes of a file and is printed to a terminal, so control characters
	 * are replaced. */
	for (char *c = fault->text; *c; c++)
		if ((unsigned char)*c < 0x20 || *c == 0x7f)
			*c = '?';
	return error;
}
