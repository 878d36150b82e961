/* Files for people, of [section]s and name = value lines, read as a whole: every fault is gathered
 * with its line and what mends it, and what is right is set although other lines are wrong. Files
 * as Windows saves them (CRLF, a byte order mark) do as well.
 *
 *   # or ; at a line's start          a remark; behind a value: after a space
 *   name = "  as it stands # "        quotes keep spaces, and signs of a remark
 */
#ifndef GOPURA_BASE_SETTINGS_H
#define GOPURA_BASE_SETTINGS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/bytes.h"
#include "base/compiler.h"

enum { FAULTS_MAX = 32, FAULT_TEXT_BYTES = 280, SETTINGS_MAX = 48, SETTINGS_FILE_MAX = 65536 };

/* In the order of their lines; what is of no line in particular comes last. */
struct faults {
	struct {
		unsigned line;               /* 0: of the file as a whole */
		char text[FAULT_TEXT_BYTES]; /* "line 7: ...": a sentence, printable UTF-8 */
	} list[FAULTS_MAX];
	unsigned count;   /* in the list */
	unsigned dropped; /* more there would be */
};

/* line 0: no line is named. Bytes that cannot be printed become '?'. */
void faults_add(struct faults *faults, unsigned line, const char *text, ...) printf_like(3, 4);

struct setting {
	const char *section, *name;
	const char *expects; /* "name must be ..., not 'x'"; NULL: a number least .. most */
	/* false: value is not what the setting expects, and nothing is set. */
	bool (*set)(const struct setting *setting, void *target, const char *value);
	size_t offset; /* of the field in the target */
	double least, most;
	bool secret;    /* its value is never told */
	bool free_text; /* a # in it may belong to it: then quotes must say so */
};

/* lines (of `count`, or NULL) gets the line of each setting that the text names, also where its
 * value was refused; 0: it is not there. Of a setting that stands twice the first one counts. */
void settings_read(struct bytes text, const struct setting *settings, size_t count, void *target,
		   unsigned *lines, struct faults *faults);

/* ---- for set functions; numbers lie within the setting's least and most */

/* As many numbers as wanted, with spaces or commas between, and nothing else. */
bool settings_numbers(const struct setting *setting, const char *value, double *out, int wanted);
/* A set function: one whole number, into an int or uint32_t. */
bool settings_whole(const struct setting *setting, void *target, const char *value);

#endif
