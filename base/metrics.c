/* Writes metrics in Prometheus's text format, and validates and searches such text with a small
 * parser. */
#include "base/metrics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"

/* ---- writing */

static void put_head(struct buffer *out, const char *name, const char *kind, const char *help)
{
	buffer_print(out, "# HELP %s %s\n# TYPE %s %s\n%s", name, help, name, kind, name);
}

/* Whole numbers are written in full, because byte counts need more than six digits. */
static void put_value(struct buffer *out, double value)
{
	if (value == floor(value) && fabs(value) < 9e15)
		buffer_print(out, " %.0f\n", value);
	else
		buffer_print(out, " %.6g\n", value);
}

static void put_escaped(struct buffer *out, const char *value)
{
	size_t left = strlen(value);

	while (left > 0) {
		const size_t size = utf8_bytes(value, left);

		if (*value == '"' || *value == '\\')
			buffer_put_text(out, "\\");
		buffer_put(out, size > 0 ? value : "?", size > 0 ? size : 1);
		value += size > 0 ? size : 1;
		left -= size > 0 ? size : 1;
	}
}

void metrics_gauge(struct buffer *out, const char *name, const char *help, double value)
{
	put_head(out, name, "gauge", help);
	put_value(out, value);
}

void metrics_counter(struct buffer *out, const char *name, const char *help, double value)
{
	put_head(out, name, "counter", help);
	put_value(out, value);
}

void metrics_info(struct buffer *out, const char *name, const char *help,
		  const struct figure_label *labels, size_t count)
{
	put_head(out, name, "gauge", help);
	for (size_t i = 0; i < count; i++) {
		buffer_print(out, "%s%s=\"", i == 0 ? "{" : ",", labels[i].name);
		put_escaped(out, labels[i].value);
		buffer_put_text(out, "\"");
	}
	buffer_put_text(out, count > 0 ? "} 1\n" : " 1\n");
}

/* ---- reading: a cursor moves over one line; each take_ function moves it past what it read */

struct cursor {
	const uint8_t *at, *end;
};

struct sample {
	struct bytes name, labels; /* labels: the text between the braces */
	double value;
};

static bool take_line(struct bytes *rest, struct cursor *line)
{
	const uint8_t *end = rest->size ? memchr(rest->data, '\n', rest->size) : NULL;

	if (!end)
		return false;
	*line = (struct cursor){ rest->data, end };
	rest->size -= (size_t)(end + 1 - rest->data);
	rest->data = end + 1;
	return true;
}

static bool take_literal(struct cursor *line, const char *text)
{
	const size_t size = strlen(text);

	if ((size_t)(line->end - line->at) < size || memcmp(line->at, text, size) != 0)
		return false;
	line->at += size;
	return true;
}

static bool is_name_byte(uint8_t byte, bool first)
{
	return (byte >= 'a' && byte <= 'z') || (byte >= 'A' && byte <= 'Z') || byte == '_' ||
	       (!first && byte >= '0' && byte <= '9');
}

static bool take_name(struct cursor *line, struct bytes *out)
{
	out->data = line->at;
	while (line->at < line->end && is_name_byte(*line->at, line->at == out->data))
		line->at++;
	out->size = (size_t)(line->at - out->data);
	return out->size > 0 && out->size < METRICS_NAME_MAX;
}

/* Takes a quoted text; escapes stay in *out. */
static bool take_quoted(struct cursor *line, struct bytes *out)
{
	if (!take_literal(line, "\""))
		return false;
	out->data = line->at;
	while (line->at < line->end && *line->at != '"') {
		size_t size = utf8_bytes((const char *)line->at, (size_t)(line->end - line->at));

		if (*line->at == '\\') {
			if (line->end - line->at < 2 || !strchr("\\\"n", line->at[1]) ||
			    line->at[1] == '\0')
				return false;
			size = 2;
		}
		if (size == 0)
			return false;
		line->at += size;
	}
	out->size = (size_t)(line->at - out->data);
	return take_literal(line, "\"");
}

static bool take_label(struct cursor *line, struct bytes *name, struct bytes *value)
{
	return take_name(line, name) && take_literal(line, "=") && take_quoted(line, value);
}

static bool take_value(struct cursor *line, double *out)
{
	char text[40], *end;
	const size_t size = (size_t)(line->end - line->at);

	if (size == 0 || size >= sizeof(text))
		return false;
	memcpy(text, line->at, size);
	text[size] = '\0';
	if (!strchr("-0123456789", text[0])) /* strtod would skip spaces and accept more */
		return false;
	*out = strtod(text, &end);
	return end == text + size && isfinite(*out);
}

static bool take_sample(struct cursor line, struct sample *out)
{
	struct bytes name, value;

	if (!take_name(&line, &out->name))
		return false;
	out->labels = (struct bytes){ line.at, 0 };
	if (take_literal(&line, "{")) {
		out->labels.data = line.at;
		do {
			if (!take_label(&line, &name, &value))
				return false;
		} while (take_literal(&line, ","));
		out->labels.size = (size_t)(line.at - out->labels.data);
		if (!take_literal(&line, "}"))
			return false;
	}
	return take_literal(&line, " ") && take_value(&line, &out->value);
}

static bool is_text(struct cursor line)
{
	while (line.at < line.end) {
		const size_t size = utf8_bytes((const char *)line.at, (size_t)(line.end - line.at));

		if (size == 0)
			return false;
		line.at += size;
	}
	return true;
}

static bool begins_with(struct bytes name, const char *prefix)
{
	const size_t size = strlen(prefix);

	return name.size > size && memcmp(name.data, prefix, size) == 0;
}

static bool is_comment(struct cursor line, const char *prefix)
{
	struct bytes name;

	if (take_literal(&line, "# HELP "))
		return take_name(&line, &name) && begins_with(name, prefix) &&
		       take_literal(&line, " ") && is_text(line);
	if (!take_literal(&line, "# TYPE ") || !take_name(&line, &name) ||
	    !begins_with(name, prefix))
		return false;
	return (take_literal(&line, " gauge") || take_literal(&line, " counter")) &&
	       line.at == line.end;
}

bool metrics_valid(struct bytes text, const char *prefix)
{
	struct cursor line;
	bool any = false;

	while (take_line(&text, &line)) {
		struct sample sample;

		if (is_comment(line, prefix))
			continue;
		if (!take_sample(line, &sample) || !begins_with(sample.name, prefix))
			return false;
		any = true;
	}
	return any && text.size == 0;
}

static bool find(struct bytes text, const char *name, struct sample *out)
{
	struct cursor line;

	while (take_line(&text, &line))
		if (take_sample(line, out) && out->name.size == strlen(name) &&
		    memcmp(out->name.data, name, out->name.size) == 0)
			return true;
	return false;
}

bool metrics_find(struct bytes text, const char *name, double *out)
{
	struct sample sample;

	if (!find(text, name, &sample))
		return false;
	*out = sample.value;
	return true;
}

static void unescape(struct bytes value, char *out, size_t out_bytes)
{
	size_t used = 0;

	for (size_t i = 0; i < value.size && used + 1 < out_bytes; i++) {
		if (value.data[i] != '\\')
			out[used++] = (char)value.data[i];
		else
			out[used++] = value.data[++i] == 'n' ? '\n' : (char)value.data[i];
	}
	out[used] = '\0';
}

bool metrics_label(struct bytes text, const char *name, const char *label, char *out,
		   size_t out_bytes)
{
	struct sample sample;
	struct cursor line;
	struct bytes found, value;

	out[0] = '\0';
	if (!find(text, name, &sample))
		return false;
	line = (struct cursor){ sample.labels.data, sample.labels.data + sample.labels.size };
	while (take_label(&line, &found, &value)) {
		if (found.size == strlen(label) && memcmp(found.data, label, found.size) == 0) {
			unescape(value, out, out_bytes);
			return true;
		}
		if (!take_literal(&line, ","))
			break;
	}
	return false;
}
