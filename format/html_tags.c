/* Reduces a page's HTML in one pass over the bytes: keeps text, tag names and the attributes that
 * the table of elements names, and drops everything else. */
#include "format/html_tags.h"

#include <string.h>
#include <strings.h>

#include "format/html_elements.h"

struct scanner {
	const char *at, *end;
	struct buffer *out;
	struct html_tags found;
	unsigned line;
};

/* A name or a value: a part of the page, not copied. */
struct piece {
	const char *text;
	size_t size;
};

static bool is_space(char c)
{
	return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f';
}

static bool is_letter(char c)
{
	return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static bool is_of_a_name(char c)
{
	return is_letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == ':' ||
	       c == '.';
}

static bool is(struct piece piece, const char *word)
{
	return strlen(word) == piece.size && strncasecmp(piece.text, word, piece.size) == 0;
}

static char look(const struct scanner *s, size_t ahead)
{
	return (size_t)(s->end - s->at) > ahead ? s->at[ahead] : '\0';
}

static void step(struct scanner *s)
{
	s->line += *s->at++ == '\n';
}

static void skip_to(struct scanner *s, const char *where)
{
	while (s->at < where)
		step(s);
}

static void skip_spaces(struct scanner *s)
{
	while (s->at < s->end && is_space(*s->at))
		step(s);
}

/* Skips past the next mark, or to the end. */
static void skip_past(struct scanner *s, const char *mark)
{
	const size_t size = strlen(mark);
	const char *found = memmem(s->at, (size_t)(s->end - s->at), mark, size);

	skip_to(s, found ? found + size : s->end);
}

static struct piece read_name(struct scanner *s)
{
	struct piece name = { s->at, 0 };

	while (s->at < s->end && is_of_a_name(*s->at))
		s->at++;
	name.size = (size_t)(s->at - name.text);
	return name;
}

/* ---- attributes */

static struct piece read_value(struct scanner *s)
{
	struct piece value = { s->at, 0 };
	char quote = look(s, 0);

	if (quote == '"' || quote == '\'') {
		const char *end = memchr(s->at + 1, quote, (size_t)(s->end - s->at - 1));

		value.text++;
		value.size = (size_t)((end ? end : s->end) - value.text);
		skip_to(s, end ? end + 1 : s->end);
		return value;
	}
	while (s->at < s->end && !is_space(*s->at) && *s->at != '>')
		s->at++;
	value.size = (size_t)(s->at - value.text);
	return value;
}

/* Reads one attribute. The scanner stands in a tag, at a character that is neither white space nor
 * the tag's end. */
static void read_attribute(struct scanner *s, struct piece *name, struct piece *value)
{
	*name = (struct piece){ s->at, 0 };
	*value = (struct piece){ s->at, 0 };
	do /* the first character may be anything, even '=' */
		s->at++;
	while (s->at < s->end && !is_space(*s->at) && !strchr("/>=", *s->at));
	name->size = (size_t)(s->at - name->text);
	skip_spaces(s);
	if (look(s, 0) != '=')
		return;
	step(s);
	skip_spaces(s);
	*value = read_value(s);
}

static void put_attribute(struct scanner *s, const char *name, struct piece value)
{
	buffer_put_text(s->out, " ");
	buffer_put_text(s->out, name);
	buffer_put_text(s->out, "=\"");
	for (size_t i = 0; i < value.size; i++)
		if (value.text[i] == '"')
			buffer_put_text(s->out, "&quot;");
		else if (value.text[i] == '<')
			buffer_put_text(s->out, "&lt;");
		else
			buffer_put_u8(s->out, (uint8_t)value.text[i]);
	buffer_put_text(s->out, "\"");
}

/* ---- tags */

/* Reads to the end of the tag. Returns true if it ends with "/>". */
static bool read_attributes(struct scanner *s, const char *wanted, struct piece *kept)
{
	const unsigned line = s->line;
	uint32_t count = 0;
	bool is_empty = false;

	for (;;) {
		struct piece name, value;

		skip_spaces(s);
		if (s->at == s->end || *s->at == '>')
			break;
		if (*s->at == '/') {
			is_empty = look(s, 1) == '>';
			s->at++;
			continue;
		}
		read_attribute(s, &name, &value);
		count++;
		if (wanted && !kept->text && is(name, wanted))
			*kept = value;
	}
	if (s->at < s->end)
		s->at++;
	if (count > s->found.attribute_count)
		s->found = (struct html_tags){ count, line };
	return is_empty;
}

/* Skips the contents of a script or style, which are not HTML, up to its end tag. */
static void skip_raw(struct scanner *s, struct piece name)
{
	while (s->at < s->end) {
		if (look(s, 0) == '<' && look(s, 1) == '/' &&
		    (size_t)(s->end - s->at) >= name.size + 2 &&
		    strncasecmp(s->at + 2, name.text, name.size) == 0) {
			skip_past(s, ">");
			return;
		}
		step(s);
	}
}

static void read_start_tag(struct scanner *s)
{
	struct piece kept = { NULL, 0 }, name;
	const struct html_element *element;
	bool is_empty;

	s->at++;
	name = read_name(s);
	element = html_element(name.text, name.size);
	is_empty = read_attributes(s, element->attribute, &kept);
	if (element->role == HTML_RAW) {
		if (!is_empty)
			skip_raw(s, name);
		return;
	}
	buffer_put_text(s->out, "<");
	buffer_put(s->out, name.text, name.size);
	if (kept.text)
		put_attribute(s, element->attribute, kept);
	buffer_put_text(s->out, is_empty ? "/>" : ">");
}

static void read_end_tag(struct scanner *s)
{
	struct piece name;

	s->at += 2;
	name = read_name(s);
	skip_past(s, ">");
	buffer_put_text(s->out, "</");
	buffer_put(s->out, name.text, name.size);
	buffer_put_text(s->out, ">");
}

static void read_markup(struct scanner *s)
{
	if (is_letter(look(s, 1))) {
		read_start_tag(s);
	} else if (look(s, 1) == '/' && is_letter(look(s, 2))) {
		read_end_tag(s);
	} else if (look(s, 1) == '!' && look(s, 2) == '-' && look(s, 3) == '-') {
		s->at += 4;
		skip_past(s, "-->");
	} else if (look(s, 1) == '!' || look(s, 1) == '?' || look(s, 1) == '/') {
		skip_past(s, ">");
	} else {
		buffer_put_text(s->out, "&lt;");
		s->at++;
	}
}

int html_tags_reduce(struct buffer *out, struct bytes html, struct html_tags *found)
{
	struct scanner s = { .at = (const char *)html.data,
			     .end = (const char *)html.data + html.size,
			     .out = out,
			     .line = 1 };

	while (s.at < s.end && !out->error) {
		const char *tag = memchr(s.at, '<', (size_t)(s.end - s.at));
		const char *text = s.at;

		skip_to(&s, tag ? tag : s.end);
		buffer_put(out, text, (size_t)(s.at - text));
		if (tag)
			read_markup(&s);
	}
	if (found)
		*found = s.found;
	return out->error;
}
