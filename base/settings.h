/* Settings files with [section]s and name = value lines. The whole file is read: every fault is
 * reported with its line and its cure, and valid settings are set even if other lines are wrong.
 * Files as Windows saves them (CRLF, a byte order mark) are accepted.
 *
 *   # or ; at a line's start          a comment; after a value: with a space before it
 *   name = "  as it stands # "        quotes keep spaces and comment signs */
#ifndef GOPURA_BASE_SETTINGS_H
#define GOPURA_BASE_SETTINGS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/bytes.h"
#include "base/compiler.h"
#include "base/diagnostics.h"

enum { SETTINGS_DIAGNOSTICS_MAX = 32, SETTINGS_MAX = 48, SETTINGS_FILE_MAX = 65536 };

struct setting {
	const char *section, *name;
	/* For "NAME must be ..., not 'x'"; NULL: a number from least to most. */
	const char *expects;
	/* Sets the field in target. false: the value is not what the setting expects. */
	bool (*set)(const struct setting *setting, void *target, const char *value);
	size_t offset; /* offset of the field in the target */
	double least, most;
	bool secret;    /* its value is never printed */
	bool free_text; /* its value may contain # or ;: then quotes are required */
};

/* Reads a whole text against a table of `count` settings, at most SETTINGS_MAX, ordered by section.
 * Fields of target whose settings do not appear keep their values. lines, of `count` elements or
 * NULL, receives the line of each setting that appears, even if its value was refused; 0: it does
 * not appear. If a setting appears twice, the first one counts. Faults are added to *diagnostics,
 * usually SETTINGS_DIAGNOSTICS_MAX at most, in the order of lines. */
void settings_read(struct bytes text, const struct setting *settings, size_t count, void *target,
		   unsigned *lines, struct diagnostics *diagnostics);

/* As settings_read, for the file at a path that we or the operator chose. Returns 0; -EINVAL if it
 * has faults; or the error of reading it, which is added too. */
must_check int settings_read_file(const char *path, const struct setting *settings, size_t count,
				  void *target, struct diagnostics *diagnostics);

/* ---- for set functions; each number must lie from the setting's least to its most */

/* Parses exactly `wanted` numbers, separated by spaces or commas. On false, out may have been
 * written to. */
bool settings_numbers(const struct setting *setting, const char *value, double *out, int wanted);
/* A set function for one whole number, stored as int or uint32_t. */
bool settings_whole(const struct setting *setting, void *target, const char *value);
/* A set function for yes or no, in any case of letters, stored as bool. */
bool settings_yes_no(const struct setting *setting, void *target, const char *value);
bool settings_read_yes_no(const char *value, bool *out); /* false: it is neither */

#endif
