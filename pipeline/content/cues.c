/* WebVTT is lines: blocks with an empty line between. A block with "-->" in its first or second
 * line is a cue, and all others are skipped. */
#include "pipeline/content/cues.h"

#include <errno.h>
#include <glib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

struct parse {
	struct cues *out;
	const char *file;
	struct diagnostics *diagnostics;
	const char *at, *end;
	unsigned line; /* of what is read next, from 1 */
	bool failed;   /* out of memory */
};

/* A line without its end. */
struct line {
	const char *text;
	size_t size;
	unsigned number;
};

static void complain(const struct parse *parse, unsigned line, const char *sentence)
{
	diagnostics_add(parse->diagnostics, -EINVAL, parse->file, line, "%s", sentence);
}

static bool next_line(struct parse *parse, struct line *out)
{
	const char *from = parse->at, *end = from;

	if (from == parse->end)
		return false;
	while (end < parse->end && *end != '\n' && *end != '\r')
		end++;
	*out = (struct line){ from, (size_t)(end - from), parse->line++ };
	if (end + 1 < parse->end && end[0] == '\r' && end[1] == '\n')
		end++;
	parse->at = end < parse->end ? end + 1 : end;
	return true;
}

/* ---- times */

/* Reads so many digits at least and at most; -1: there are others. */
static long read_digits(const char **at, const char *end, int least, int most)
{
	long value = 0;
	int count = 0;

	while (*at < end && **at >= '0' && **at <= '9' && count < most) {
		value = 10 * value + (*(*at)++ - '0');
		count++;
	}
	return count >= least ? value : -1;
}

/* [HH:]MM:SS.mmm in milliseconds; -1: it is none. */
static int64_t read_time(const char **at, const char *end)
{
	long parts[3], count = 0, thousandths;

	do {
		parts[count] = read_digits(at, end, 2, 4);
		if (parts[count] < 0)
			return -1;
		count++;
	} while (count < 3 && *at < end && **at == ':' && (*at)++);
	if (count < 2 || parts[count - 1] > 59 || parts[count - 2] > 59 || *at == end ||
	    *(*at)++ != '.')
		return -1;
	thousandths = read_digits(at, end, 3, 3);
	if (thousandths < 0)
		return -1;
	return 1000 * (60 * ((count == 3 ? 60 * (int64_t)parts[0] : 0) + parts[count - 2]) +
		       parts[count - 1]) +
	       thousandths;
}

static void skip_spaces(const char **at, const char *end)
{
	while (*at < end && (**at == ' ' || **at == '\t'))
		(*at)++;
}

/* "BEGIN --> END SETTINGS". Returns false after a complaint. */
static bool read_times(const struct parse *parse, const struct line *line, struct info_cue *cue)
{
	const char *at = line->text, *end = line->text + line->size;
	int64_t begin_ms, end_ms = -1;

	skip_spaces(&at, end);
	begin_ms = read_time(&at, end);
	skip_spaces(&at, end);
	if (begin_ms >= 0 && end - at > 3 && memcmp(at, "-->", 3) == 0) {
		at += 3;
		skip_spaces(&at, end);
		end_ms = read_time(&at, end);
	}
	if (end_ms < 0 || (at < end && *at != ' ' && *at != '\t')) {
		complain(parse, line->number,
			 "is no line of times: write it as 00:01.000 --> 00:04.500");
		return false;
	}
	if (end_ms <= begin_ms || end_ms > INFO_SPOKEN_MS_MAX) {
		complain(parse, line->number,
			 "the cue ends before it begins, or after more than ten minutes");
		return false;
	}
	cue->begin_ms = (uint32_t)begin_ms;
	cue->end_ms = (uint32_t)end_ms;
	return true;
}

/* ---- texts */

static size_t put_entity(char *out, const char *at, const char *end, size_t *taken)
{
	static const struct {
		const char *name, *text;
	} entities[] = {
		{ "&amp;", "&" },  { "&lt;", "<" },       { "&gt;", ">" },
		{ "&nbsp;", " " }, { "&lrm;", "\u200e" }, { "&rlm;", "\u200f" },
	};

	for (unsigned n = 0; n < ARRAY_COUNT(entities); n++) {
		const size_t size = strlen(entities[n].name);

		if ((size_t)(end - at) >= size && memcmp(at, entities[n].name, size) == 0) {
			*taken = size;
			memcpy(out, entities[n].text, strlen(entities[n].text));
			return strlen(entities[n].text);
		}
	}
	*taken = 1;
	*out = '&';
	return 1;
}

/* Appends a line's words, one space between; no entity is longer than its name. */
static void append_words(char *text, size_t *size, const struct line *line)
{
	const char *at = line->text, *end = line->text + line->size;
	bool space = *size > 0;

	while (at < end) {
		const char *tag_end = *at == '<' ? memchr(at, '>', (size_t)(end - at)) : NULL;
		size_t taken = 1;

		if (tag_end) {
			at = tag_end + 1;
			continue;
		}
		if (*at == ' ' || *at == '\t') {
			space = *size > 0;
		} else {
			if (space)
				text[(*size)++] = ' ';
			space = false;
			if (*at == '&')
				*size += put_entity(text + *size, at, end, &taken);
			else
				text[(*size)++] = *at;
		}
		at += taken;
	}
}

/* Reads lines up to an empty one. */
static void read_words(struct parse *parse, struct info_cue *cue, unsigned first_line)
{
	char *text = malloc((size_t)(parse->end - parse->at) + 2);
	struct line line;
	size_t size = 0;

	if (!text) {
		parse->failed = true;
		return;
	}
	while (next_line(parse, &line) && line.size > 0)
		append_words(text, &size, &line);
	text[size] = '\0';
	cue->text = realloc(text, size + 1);
	if (!cue->text)
		cue->text = text;
	if (size > INFO_CUE_BYTES_MAX)
		complain(parse, first_line, "a cue of more than 500 bytes: split it");
}

/* ---- cues */

static void add_cue(struct parse *parse, const struct line *times)
{
	struct cues *cues = parse->out;
	struct info_cue cue = { 0 };
	const bool is_good = read_times(parse, times, &cue);

	read_words(parse, &cue, times->number);
	if (parse->failed)
		return;
	if (is_good && cues->count > 0 && cue.begin_ms < cues->all[cues->count - 1].begin_ms)
		complain(parse, times->number, "begins before the cue above it: sort them");
	if (!is_good || !*cue.text) {
		free(cue.text); /* nothing is said: a cue for a pause */
		return;
	}
	if (cues->count == INFO_CUES_MAX)
		complain(parse, times->number, "more than 1000 cues: join some");
	if (cues->count == INFO_CUES_MAX ||
	    ARRAY_RESERVE(cues->all, cues->room, cues->count + 1, INFO_CUES_MAX) < 0) {
		parse->failed |= cues->count < INFO_CUES_MAX;
		free(cue.text);
		return;
	}
	cues->all[cues->count++] = cue;
}

static bool has_arrow(const struct line *line)
{
	return memmem(line->text, line->size, "-->", 3) != NULL;
}

/* line is the first of a block. A cue may have a name before its times. */
static void read_block(struct parse *parse, struct line line)
{
	if (!has_arrow(&line) && (!next_line(parse, &line) || line.size == 0))
		return;
	if (has_arrow(&line)) {
		add_cue(parse, &line);
		return;
	}
	while (next_line(parse, &line) && line.size > 0)
		;
}

static void read_file(struct parse *parse)
{
	static const char mark[] = "\xef\xbb\xbf";
	struct line line;

	if (parse->end - parse->at >= 3 && memcmp(parse->at, mark, 3) == 0)
		parse->at += 3;
	if (!g_utf8_validate(parse->at, parse->end - parse->at, NULL)) {
		complain(parse, 0, "is not UTF-8: save it as UTF-8");
		return;
	}
	if (!next_line(parse, &line) || line.size < 6 || memcmp(line.text, "WEBVTT", 6) != 0) {
		complain(parse, 1, "is no WebVTT file: it must begin with the line WEBVTT");
		return;
	}
	while (next_line(parse, &line) && line.size > 0)
		; /* the rest of the head */
	while (!parse->failed && next_line(parse, &line))
		if (line.size > 0)
			read_block(parse, line);
}

int cues_read(struct cues *out, struct bytes text, const char *file,
	      struct diagnostics *diagnostics)
{
	const uint32_t errors = diagnostics->error_count;
	const char *from = text.size > 0 ? (const char *)text.data : "";
	struct parse parse = { .out = out,
			       .file = file,
			       .diagnostics = diagnostics,
			       .at = from,
			       .end = from + text.size,
			       .line = 1 };

	*out = (struct cues){ 0 };
	read_file(&parse);
	if (!parse.failed && diagnostics->error_count == errors)
		return 0;
	cues_finish(out);
	return parse.failed ? -ENOMEM : -EINVAL;
}

void cues_finish(struct cues *cues)
{
	if (!cues)
		return;
	for (uint32_t n = 0; n < cues->count; n++)
		free(cues->all[n].text);
	free(cues->all);
	*cues = (struct cues){ 0 };
}
