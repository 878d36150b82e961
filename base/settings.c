/* Parses a settings file line by line against a table of settings. Reports all faults, and
 * suggests the nearest known name for a misspelt one. */
#include "base/settings.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/safe_open.h"
#include "base/utf8.h"

enum { LINE_BYTES_MAX = 1000, NAME_MAX = 32, QUOTED_MAX = 60 };

struct reading {
	const struct setting *settings;
	size_t count;
	void *target;
	struct diagnostics *diagnostics;
	unsigned line;
	char section[NAME_MAX]; /* as written in the table; "": none yet */
	bool skipping;          /* the section is unknown, which was reported */
	unsigned seen[SETTINGS_MAX];
};

/* ---- suggestions for unknown names */

static int smaller(int a, int b)
{
	return a < b ? a : b;
}

/* Returns the edit distance of two words: letters to add, drop or change. Case is ignored. */
static int distance(const char *a, const char *b)
{
	int row[NAME_MAX + 1];
	const int width = (int)strlen(b);

	for (int i = 0; i <= width; i++)
		row[i] = i;
	for (int y = 1; a[y - 1]; y++) {
		int corner = row[0];

		row[0] = y;
		for (int x = 1; x <= width; x++) {
			int changed = corner + (strncasecmp(&a[y - 1], &b[x - 1], 1) != 0);

			corner = row[x];
			row[x] = smaller(smaller(row[x], row[x - 1]) + 1, changed);
		}
	}
	return row[width];
}

static bool is_near(int letters, const char *word)
{
	return letters <= 1 + (int)strlen(word) / 4;
}

static bool section_begins(const struct reading *reading, size_t i)
{
	return i == 0 ||
	       strcmp(reading->settings[i - 1].section, reading->settings[i].section) != 0;
}

static void unknown_section(struct reading *reading, const char *name)
{
	char known[LINE_BYTES_MAX] = "";
	const char *best = NULL;
	int nearest = INT32_MAX;

	for (size_t i = 0; i < reading->count; i++) {
		const char *section = reading->settings[i].section;
		const size_t length = strlen(known);

		if (!section_begins(reading, i))
			continue;
		snprintf(known + length, sizeof(known) - length, "%s[%s]", length ? ", " : "",
			 section);
		if (distance(name, section) < nearest) {
			nearest = distance(name, section);
			best = section;
		}
	}
	if (best && is_near(nearest, name))
		diagnostics_add(reading->diagnostics, -EINVAL, NULL, reading->line,
				"there is no section [%s]; did you mean [%s]?", name, best);
	else
		diagnostics_add(reading->diagnostics, -EINVAL, NULL, reading->line,
				"there is no section [%s]; the sections are %s", name, known);
}

static void unknown_name(struct reading *reading, const char *name)
{
	char known[LINE_BYTES_MAX] = "";
	const char *best = NULL;
	int nearest = INT32_MAX;

	for (size_t i = 0; i < reading->count; i++) {
		const struct setting *setting = &reading->settings[i];
		const size_t length = strlen(known);
		const int letters = distance(name, setting->name);

		if (letters == 0) {
			diagnostics_add(reading->diagnostics, -EINVAL, NULL, reading->line,
					"%s belongs under [%s]; move it there", setting->name,
					setting->section);
			return;
		}
		if (strcmp(setting->section, reading->section) != 0)
			continue;
		snprintf(known + length, sizeof(known) - length, "%s%s", length ? ", " : "",
			 setting->name);
		if (letters < nearest) {
			nearest = letters;
			best = setting->name;
		}
	}
	if (best && is_near(nearest, name))
		diagnostics_add(reading->diagnostics, -EINVAL, NULL, reading->line,
				"[%s] has no '%s'; did you mean '%s'?", reading->section, name,
				best);
	else if (best)
		diagnostics_add(reading->diagnostics, -EINVAL, NULL, reading->line,
				"[%s] has no '%s'; it has %s", reading->section, name, known);
	else
		diagnostics_add(reading->diagnostics, -EINVAL, NULL, reading->line,
				"'%s' comes before the first [section]; write its section above it",
				name);
}

/* ---- lines */

static char *skip_space(char *text)
{
	return text + strspn(text, " \t");
}

static void cut_space(char *text)
{
	size_t length = strlen(text);

	while (length > 0 && strchr(" \t\r", text[length - 1]))
		text[--length] = '\0';
}

/* Returns where a comment after a value begins, with the space before it; NULL if there is none. */
static char *find_remark(char *text)
{
	for (char *at = text; (at = strpbrk(at, "#;")); at++)
		if (at > text && (at[-1] == ' ' || at[-1] == '\t'))
			return at - 1;
	return NULL;
}

/* Returns the value without quotes and comment; NULL after adding a diagnostic. */
static char *bare_value(struct reading *reading, const struct setting *setting, char *text)
{
	char *remark;

	if (*text == '"') {
		for (char *end = text + 1; (end = strchr(end, '"')); end++) {
			char *rest = skip_space(end + 1);

			if (*rest && (rest == end + 1 || !strchr("#;", *rest)))
				continue;
			*end = '\0';
			return text + 1;
		}
		diagnostics_add(reading->diagnostics, -EINVAL, NULL, reading->line,
				"%s has no closing quote; write \" after the value too",
				setting->name);
		return NULL;
	}
	remark = find_remark(text);
	if (remark && setting->free_text) {
		diagnostics_add(
			reading->diagnostics, -EINVAL, NULL, reading->line,
			"%s contains '%.2s': if that is part of the value, put the value in "
			"double quotes; if it begins a comment, move that to a line of its own",
			setting->name, remark);
		return NULL;
	}
	if (remark)
		*remark = '\0';
	cut_space(text);
	return text;
}

static void refuse(struct reading *reading, const struct setting *setting, char *value)
{
	char expects[128];

	if (setting->expects)
		snprintf(expects, sizeof(expects), "%s", setting->expects);
	else
		snprintf(expects, sizeof(expects), "a %snumber from %.10g to %.10g",
			 setting->set == settings_whole ? "whole " : "", setting->least,
			 setting->most);
	utf8_cut(value, QUOTED_MAX);
	if (!*value)
		diagnostics_add(reading->diagnostics, -EINVAL, NULL, reading->line,
				"%s has no value; it must be %s; otherwise remove the line",
				setting->name, expects);
	else if (setting->secret)
		diagnostics_add(reading->diagnostics, -EINVAL, NULL, reading->line, "%s must be %s",
				setting->name, expects);
	else
		diagnostics_add(reading->diagnostics, -EINVAL, NULL, reading->line,
				"%s must be %s, not '%s'", setting->name, expects, value);
}

static void take(struct reading *reading, size_t index, char *text)
{
	const struct setting *setting = &reading->settings[index];
	char *value;

	if (reading->seen[index]) {
		diagnostics_add(reading->diagnostics, -EINVAL, NULL, reading->line,
				"%s is set in line %u already; remove one of the two",
				setting->name, reading->seen[index]);
		return;
	}
	reading->seen[index] = reading->line;
	value = bare_value(reading, setting, text);
	if (value && (!*value || !setting->set(setting, reading->target, value)))
		refuse(reading, setting, value);
}

static void on_entry(struct reading *reading, char *name, char *value)
{
	cut_space(name);
	if (strlen(name) >= NAME_MAX)
		utf8_cut(name, NAME_MAX - 1);
	for (size_t i = 0; i < reading->count; i++)
		if (strcmp(reading->settings[i].section, reading->section) == 0 &&
		    strcasecmp(reading->settings[i].name, name) == 0) {
			take(reading, i, skip_space(value));
			return;
		}
	unknown_name(reading, name);
}

static void on_section(struct reading *reading, char *text)
{
	char *end = strchr(text, ']');

	reading->skipping = true;
	if (!end) {
		diagnostics_add(reading->diagnostics, -EINVAL, NULL, reading->line,
				"the section name is not closed; write ] after it");
		return;
	}
	*end = '\0';
	text = skip_space(text);
	cut_space(text);
	utf8_cut(text, NAME_MAX - 1);
	for (size_t i = 0; i < reading->count; i++)
		if (strcasecmp(reading->settings[i].section, text) == 0) {
			snprintf(reading->section, NAME_MAX, "%s", reading->settings[i].section);
			reading->skipping = false;
			return;
		}
	unknown_section(reading, text);
}

static bool is_utf8(const char *text)
{
	while (*text) {
		const size_t n = *text == '\t' ? 1 : utf8_bytes(text, SIZE_MAX);

		if (n == 0)
			return false;
		text += n;
	}
	return true;
}

static void on_line(struct reading *reading, char *line)
{
	char *equals;

	line = skip_space(line);
	cut_space(line);
	if (!*line || *line == '#' || *line == ';')
		return;
	equals = strchr(line, '=');
	if (!is_utf8(line)) {
		diagnostics_add(
			reading->diagnostics, -EINVAL, NULL, reading->line,
			"the line is not valid UTF-8; save the file as UTF-8 (in Notepad: Save "
			"as, Encoding: UTF-8)");
	} else if (*line == '[') {
		on_section(reading, line + 1);
	} else if (reading->skipping) {
		return;
	} else if (!equals) {
		utf8_cut(line, QUOTED_MAX);
		diagnostics_add(reading->diagnostics, -EINVAL, NULL, reading->line,
				"'%s' is neither a [section] nor name = value; if it is a comment, "
				"write # before it",
				line);
	} else {
		*equals = '\0';
		on_entry(reading, line, equals + 1);
	}
}

/* Returns whether the file can be read: not too large, not UTF-16 (which old versions of Notepad
 * call Unicode), and without zero bytes. */
static bool is_text(struct bytes text, struct diagnostics *diagnostics)
{
	if (text.size > SETTINGS_FILE_MAX)
		diagnostics_add(diagnostics, -EINVAL, NULL, 0,
				"the file is larger than %d bytes, so it is some other file",
				SETTINGS_FILE_MAX);
	else if (text.size >= 2 &&
		 (memcmp(text.data, "\xff\xfe", 2) == 0 || memcmp(text.data, "\xfe\xff", 2) == 0))
		diagnostics_add(
			diagnostics, -EINVAL, NULL, 0,
			"the file is saved as UTF-16; save it as UTF-8 (in Notepad: Save as, "
			"Encoding: UTF-8)");
	else if (text.size > 0 && memchr(text.data, 0, text.size))
		diagnostics_add(diagnostics, -EINVAL, NULL, 0,
				"the file contains zero bytes; save it as plain text in UTF-8");
	else
		return true;
	return false;
}

void settings_read(struct bytes text, const struct setting *settings, size_t count, void *target,
		   unsigned *lines, struct diagnostics *diagnostics)
{
	struct reading reading = {
		.settings = settings, .count = count, .target = target, .diagnostics = diagnostics
	};
	size_t at = 0;

	if (is_text(text, diagnostics)) {
		if (text.size >= 3 && memcmp(text.data, "\xef\xbb\xbf", 3) == 0)
			at = 3;
		while (at < text.size) {
			const uint8_t *end = memchr(text.data + at, '\n', text.size - at);
			const size_t size = end ? (size_t)(end - text.data) - at : text.size - at;
			char line[LINE_BYTES_MAX + 1];

			reading.line++;
			if (size > LINE_BYTES_MAX) {
				diagnostics_add(diagnostics, -EINVAL, NULL, reading.line,
						"the line is longer than %d bytes; shorten it",
						LINE_BYTES_MAX);
			} else {
				memcpy(line, text.data + at, size);
				line[size] = '\0';
				on_line(&reading, line);
			}
			at += size + 1;
		}
	}
	if (lines)
		memcpy(lines, reading.seen, count * sizeof(*lines));
}

int settings_read_file(const char *path, const struct setting *settings, size_t count, void *target,
		       struct diagnostics *diagnostics)
{
	const uint32_t before = diagnostics->error_count;
	struct buffer file;
	int rc;

	buffer_init(&file, SETTINGS_FILE_MAX);
	rc = buffer_read_file(&file, path);
	if (rc == 0)
		settings_read(buffer_bytes(&file), settings, count, target, NULL, diagnostics);
	else
		diagnostics_add(diagnostics, rc, NULL, 0, "%s", open_problem(rc));
	buffer_finish(&file);
	return rc == 0 && diagnostics->error_count > before ? -EINVAL : rc;
}

/* ---- values */

bool settings_numbers(const struct setting *setting, const char *value, double *out, int wanted)
{
	for (int i = 0; i < wanted; i++) {
		char *end;

		out[i] = strtod(value, &end);
		if (end == value || !(out[i] >= setting->least && out[i] <= setting->most))
			return false;
		value = end + strspn(end, " \t,");
	}
	return *value == '\0';
}

bool settings_whole(const struct setting *setting, void *target, const char *value)
{
	double number;

	if (!settings_numbers(setting, value, &number, 1) || number != floor(number))
		return false;
	*(int *)((char *)target + setting->offset) = (int)number;
	return true;
}

bool settings_read_yes_no(const char *value, bool *out)
{
	const bool yes = strcasecmp(value, "yes") == 0;

	if (!yes && strcasecmp(value, "no") != 0)
		return false;
	*out = yes;
	return true;
}

bool settings_yes_no(const struct setting *setting, void *target, const char *value)
{
	return settings_read_yes_no(value, (bool *)((char *)target + setting->offset));
}
