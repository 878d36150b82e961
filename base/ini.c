/* Reads an INI file with inih against a table of known keys, counts lines for error messages, and
 * parses common kinds of values. */
#include "base/ini.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include <ini.h>

#include "base/safe_open.h"

enum { KEYS_MAX = 128, LINE_BYTES_MAX = 196 /* limit of Debian's inih, less its own bytes */ };

struct reading {
	const char *path;
	FILE *file;
	unsigned line;
	const struct ini_key *keys;
	size_t key_count;
	unsigned seen_line[KEYS_MAX]; /* line of each key; 0: not seen yet */
	void *target;
	struct fault *fault;
	int rc;
};

/* Reads the next line for inih. Counts lines, because inih does not report them, and refuses lines
 * that inih would cut. */
static char *next_line(char *text, int size, void *data)
{
	struct reading *reading = data;
	char *line;

	if (reading->rc < 0)
		return NULL;
	line = fgets(text, size, reading->file);
	if (!line)
		return NULL;
	reading->line++;
	if (strlen(line) > LINE_BYTES_MAX || (!strchr(line, '\n') && !feof(reading->file))) {
		reading->rc =
			fault_set(reading->fault, -EBADMSG,
				  "%s:%u: the line is too long; keep it under %d bytes (spread "
				  "a list over fewer or shorter names)",
				  reading->path, reading->line, LINE_BYTES_MAX);
		return NULL;
	}
	return line;
}

/* Writes the keys of a section to out, such as "points, face_px, quality". */
static void list_keys(const struct reading *reading, const char *section, char *out, size_t size)
{
	size_t length = 0;

	out[0] = '\0';
	for (size_t i = 0; i < reading->key_count; i++) {
		if (strcmp(reading->keys[i].section, section) != 0)
			continue;
		length += (size_t)snprintf(out + length, size - length, "%s%s", length ? ", " : "",
					   reading->keys[i].name);
		if (length >= size)
			return;
	}
}

static void list_sections(const struct reading *reading, char *out, size_t size)
{
	size_t length = 0;

	out[0] = '\0';
	for (size_t i = 0; i < reading->key_count; i++) {
		const char *section = reading->keys[i].section;

		if (i > 0 && strcmp(reading->keys[i - 1].section, section) == 0)
			continue;
		length += (size_t)snprintf(out + length, size - length, "%s[%s]",
					   length ? ", " : "", section);
		if (length >= size)
			return;
	}
}

static int unknown(struct reading *reading, const char *section, const char *name)
{
	char known[256];

	list_keys(reading, section, known, sizeof(known));
	if (known[0])
		return fault_set(reading->fault, -EBADMSG,
				 "%s:%u: '%s' is not a key of [%s]; its keys are: %s",
				 reading->path, reading->line, name, section, known);
	list_sections(reading, known, sizeof(known));
	return fault_set(
		reading->fault, -EBADMSG,
		"%s:%u: '%s' is in [%s], which is not a section of this file; its sections are: %s",
		reading->path, reading->line, name, section, known);
}

static int take(struct reading *reading, size_t index, const char *value)
{
	const struct ini_key *key = &reading->keys[index];

	if (reading->seen_line[index])
		return fault_set(reading->fault, -EBADMSG,
				 "%s:%u: '%s' is set in line %u already; remove one (and begin no "
				 "line with a space)",
				 reading->path, reading->line, key->name,
				 reading->seen_line[index]);
	reading->seen_line[index] = reading->line;
	if (!key->set(reading->target, value))
		return fault_set(reading->fault, -EBADMSG, "%s:%u: %s = %s: it must be %s",
				 reading->path, reading->line, key->name, value, key->expects);
	return 0;
}

/* Handles one entry. Returns 1 for success, as inih expects. Only the first fault counts. */
static int handle(void *data, const char *section, const char *name, const char *value)
{
	struct reading *reading = data;

	if (reading->rc < 0)
		return 0;
	for (size_t i = 0; i < reading->key_count; i++)
		if (strcmp(reading->keys[i].section, section) == 0 &&
		    strcmp(reading->keys[i].name, name) == 0) {
			reading->rc = take(reading, i, value);
			return reading->rc == 0;
		}
	reading->rc = unknown(reading, section, name);
	return 0;
}

int ini_read(const char *path, const struct ini_key *keys, size_t key_count, void *target,
	     struct fault *fault)
{
	struct reading reading = {
		.path = path,
		.keys = keys,
		.key_count = key_count < KEYS_MAX ? key_count : KEYS_MAX,
		.target = target,
		.fault = fault,
	};
	const int fd = open_regular(path);
	int bad_line;

	if (fd < 0)
		return fault_set(fault, fd, "%s: %s", path, open_problem(fd));
	reading.file = fdopen(fd, "r");
	if (!reading.file) {
		close(fd);
		return fault_set(fault, -ENOMEM, "%s: %s", path, strerror(ENOMEM));
	}
	bad_line = ini_parse_stream(next_line, &reading, handle, &reading);
	if (ferror(reading.file) && reading.rc == 0)
		reading.rc = fault_set(fault, -EIO, "%s: it cannot be read", path);
	fclose(reading.file);
	if (reading.rc == 0 && bad_line != 0)
		reading.rc = fault_set(fault, -EBADMSG,
				       "%s:%d: this is neither a [section] nor a key = value", path,
				       bad_line);
	return reading.rc;
}

/* ---- values */

bool ini_number(const char *value, double least, double most, double *out)
{
	char *end;
	double number = strtod(value, &end);

	if (end == value || *end || !isfinite(number) || number < least || number > most)
		return false;
	*out = number;
	return true;
}

bool ini_numbers(const char *value, double *out, size_t most, size_t *count)
{
	size_t n = 0;

	for (;;) {
		char *end;
		double number;

		value += strspn(value, " \t,");
		if (!*value)
			break;
		number = strtod(value, &end);
		if (end == value || !isfinite(number) || n == most ||
		    (*end && !strchr(" \t,", *end)))
			return false;
		out[n++] = number;
		value = end;
	}
	if (n == 0)
		return false;
	*count = n;
	return true;
}

bool ini_whole(const char *value, long least, long most, long *out)
{
	char *end;
	long number;

	errno = 0;
	number = strtol(value, &end, 10);
	if (errno || end == value || *end || number < least || number > most)
		return false;
	*out = number;
	return true;
}

bool ini_yes_no(const char *value, bool *out)
{
	static const char *const names[] = { "no", "yes", "false", "true", "off", "on", NULL };
	int which;

	if (!ini_choice(value, names, &which))
		return false;
	*out = which % 2;
	return true;
}

bool ini_choice(const char *value, const char *const *names, int *out)
{
	for (int i = 0; names[i]; i++)
		if (strcasecmp(names[i], value) == 0) {
			*out = i;
			return true;
		}
	return false;
}

bool ini_colour(const char *value, unsigned char rgb[3])
{
	unsigned char read[3];
	int length = 0;

	if (*value == '"')
		value++;
	if (sscanf(value, "#%2hhx%2hhx%2hhx%n", &read[0], &read[1], &read[2], &length) != 3 ||
	    length != 7 || (value[7] && strcmp(value + 7, "\"") != 0))
		return false;
	memcpy(rgb, read, 3);
	return true;
}
