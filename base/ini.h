/* INI files with [section]s and key = value lines, read by inih. Every key must be in a table, so
 * that a misspelt one is an error with its line, not a setting that silently has no effect. */
#ifndef GOPURA_BASE_INI_H
#define GOPURA_BASE_INI_H

#include <stdbool.h>
#include <stddef.h>

#include "base/compiler.h"
#include "base/fault.h"

struct ini_key {
	const char *section; /* "": before the first section */
	const char *name;
	const char *expects; /* for the error message: "a number from 8 to 32" */
	/* Sets the value in target; false: the value is not what the key expects. value is
	 * borrowed. */
	bool (*set)(void *target, const char *value);
};

/* Reads a file and passes each known key to its set function, in the file's order. Comments begin
 * with # or ; at the start of a line, or with ; after a value. Returns 0; -EBADMSG, with a fault
 * "PATH:LINE: ...", for a malformed line, an unknown or repeated key, or a value that set refuses;
 * other errors are those of the file. Values set before the fault stay set. */
must_check int ini_read(const char *path, const struct ini_key *keys, size_t key_count,
			void *target, struct fault *fault);

/* ---- parsing values, for set functions; on false *out is unchanged */

/* Parses one finite number from least to most, with nothing after it. */
bool ini_number(const char *value, double least, double most, double *out);
/* Parses 1 to most numbers separated by spaces or commas; *count is how many. On false, out may
 * have been written to. */
bool ini_numbers(const char *value, double *out, size_t most, size_t *count);
/* Parses one whole number from least to most. */
bool ini_whole(const char *value, long least, long most, long *out);
bool ini_yes_no(const char *value, bool *out); /* parses yes, no, true, false, on, off */
/* Writes the index of value in names, a table that ends with NULL. Case is ignored. */
bool ini_choice(const char *value, const char *const *names, int *out);
/* Parses #rrggbb, also in double quotes. */
bool ini_colour(const char *value, unsigned char rgb[3]);

#endif
