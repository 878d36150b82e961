/* Formats diagnostics, and keeps them in a list whose first element needs no memory. */
#include "base/diagnostics.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/utf8.h"

/* Formats the place with the colon and the space after it. Returns its length. */
static size_t format_place(char *out, size_t bytes, const char *file, unsigned line)
{
	int length = 0;

	if (file && line > 0)
		length = snprintf(out, bytes, "%s:%u: ", file, line);
	else if (file)
		length = snprintf(out, bytes, "%s: ", file);
	else if (line > 0)
		length = snprintf(out, bytes, "line %u: ", line);
	return (size_t)length < bytes ? (size_t)length : bytes - 1;
}

static struct diagnostic *get(struct diagnostics *diagnostics, uint32_t i)
{
	return i == 0 ? &diagnostics->first : &diagnostics->more[i - 1];
}

/* Returns the element for a new one: the next; where that is none, the last, if an error takes the
 * place of a warning there; or NULL. */
static struct diagnostic *place_for(struct diagnostics *diagnostics, int error)
{
	const uint32_t n = diagnostics->count;

	if (n == 0 ||
	    (n < diagnostics->max && ARRAY_RESERVE(diagnostics->more, diagnostics->more_room, n,
						   diagnostics->max - 1) == 0)) {
		diagnostics->count++;
		return get(diagnostics, n);
	}
	diagnostics->dropped++;
	return error < 0 && get(diagnostics, n - 1)->error == 0 ? get(diagnostics, n - 1) : NULL;
}

int diagnostics_add(struct diagnostics *diagnostics, int error, const char *file, unsigned line,
		    const char *sentence, ...)
{
	char text[2 * DIAGNOSTIC_BYTES];
	struct diagnostic *added;
	va_list args;

	if (!diagnostics)
		return error;
	diagnostics->error_count += error < 0;
	added = place_for(diagnostics, error);
	if (!added)
		return error;
	added->error = error;
	added->line = line;
	added->place_bytes = (uint32_t)format_place(text, DIAGNOSTIC_BYTES, file, line);
	va_start(args, sentence);
	vsnprintf(text + added->place_bytes, sizeof(text) - added->place_bytes, sentence, args);
	va_end(args);
	utf8_make_printable(text); /* it may quote bytes of a file */
	utf8_cut(text, DIAGNOSTIC_BYTES - 1);
	memcpy(added->text, text, strlen(text) + 1);
	return error;
}

const struct diagnostic *diagnostics_get(const struct diagnostics *diagnostics, uint32_t i)
{
	return i == 0 ? &diagnostics->first : &diagnostics->more[i - 1];
}

const char *diagnostics_cause(const struct diagnostics *diagnostics, int error)
{
	for (uint32_t i = 0; i < diagnostics->count; i++)
		if (diagnostics_get(diagnostics, i)->error < 0)
			return diagnostics_get(diagnostics, i)->text;
	return diagnostics->count > 0 ? diagnostics->first.text : strerror(-error);
}

uint32_t diagnostics_total(const struct diagnostics *diagnostics)
{
	return diagnostics->count + diagnostics->dropped;
}

static bool comes_before(const struct diagnostic *a, const struct diagnostic *b)
{
	return a->line > 0 && (b->line == 0 || a->line < b->line);
}

void diagnostics_sort(struct diagnostics *diagnostics)
{
	for (uint32_t i = 1; i < diagnostics->count; i++)
		for (uint32_t k = i; k > 0; k--) {
			struct diagnostic *a = get(diagnostics, k - 1), *b = get(diagnostics, k);
			struct diagnostic was = *a;

			if (!comes_before(b, a))
				break;
			*a = *b;
			*b = was;
		}
}

void diagnostics_print(const struct diagnostics *diagnostics, FILE *to, const char *before)
{
	for (uint32_t i = 0; i < diagnostics->count; i++)
		fprintf(to, "%s%s\n", before, diagnostics_get(diagnostics, i)->text);
	if (diagnostics->dropped > 0)
		fprintf(to, "%sand %" PRIu32 " more\n", before, diagnostics->dropped);
}

void diagnostics_finish(struct diagnostics *diagnostics)
{
	if (!diagnostics)
		return;
	free(diagnostics->more);
	*diagnostics = (struct diagnostics){ .max = diagnostics->max };
}
