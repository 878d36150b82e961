/* Reads the tags that html_tags_reduce leaves, one after the other: a block element ends the
 * paragraph before it, and the styled one that was opened last says how the text looks. */
#include "storage/plain_page.h"

#include <errno.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>

#include "format/article_builder.h"
#include "format/html_elements.h"
#include "format/html_tags.h"

struct plain {
	struct article_builder builder;
	struct article_look look;
	struct buffer text; /* with its entities replaced */
	bool skips;         /* inside an element without words for the reader */
};

/* ---- entities */

/* Those that people write: of HTML's syntax, of Latin-1 from U+00A0 on, and of typography. */
static const char *const latin_1[] = {
	"nbsp",   "iexcl",  "cent",   "pound",  "curren", "yen",    "brvbar", "sect",   "uml",
	"copy",   "ordf",   "laquo",  "not",    "shy",    "reg",    "macr",   "deg",    "plusmn",
	"sup2",   "sup3",   "acute",  "micro",  "para",   "middot", "cedil",  "sup1",   "ordm",
	"raquo",  "frac14", "frac12", "frac34", "iquest", "Agrave", "Aacute", "Acirc",  "Atilde",
	"Auml",   "Aring",  "AElig",  "Ccedil", "Egrave", "Eacute", "Ecirc",  "Euml",   "Igrave",
	"Iacute", "Icirc",  "Iuml",   "ETH",    "Ntilde", "Ograve", "Oacute", "Ocirc",  "Otilde",
	"Ouml",   "times",  "Oslash", "Ugrave", "Uacute", "Ucirc",  "Uuml",   "Yacute", "THORN",
	"szlig",  "agrave", "aacute", "acirc",  "atilde", "auml",   "aring",  "aelig",  "ccedil",
	"egrave", "eacute", "ecirc",  "euml",   "igrave", "iacute", "icirc",  "iuml",   "eth",
	"ntilde", "ograve", "oacute", "ocirc",  "otilde", "ouml",   "divide", "oslash", "ugrave",
	"uacute", "ucirc",  "uuml",   "yacute", "thorn",  "yuml",
};

static const struct {
	const char *name;
	gunichar character;
} others[] = {
	{ "lt", '<' },       { "gt", '>' },       { "amp", '&' },      { "quot", '"' },
	{ "OElig", 0x152 },  { "oelig", 0x153 },  { "ndash", 0x2013 }, { "mdash", 0x2014 },
	{ "lsquo", 0x2018 }, { "rsquo", 0x2019 }, { "sbquo", 0x201a }, { "ldquo", 0x201c },
	{ "rdquo", 0x201d }, { "bdquo", 0x201e }, { "bull", 0x2022 },  { "hellip", 0x2026 },
	{ "euro", 0x20ac },
};

static bool is(const char *text, size_t size, const char *word)
{
	return strlen(word) == size && memcmp(text, word, size) == 0;
}

/* Returns the character that "&name;" or "&#number;" stands for; 0: it is not known. */
static gunichar character_of(const char *name, size_t size)
{
	if (size > 1 && *name == '#') {
		const bool hex = name[1] == 'x' || name[1] == 'X';
		char *end;
		const unsigned long number = strtoul(name + 1 + hex, &end, hex ? 16 : 10);

		return end == name + size && number < 0x110000 &&
				       g_unichar_validate((gunichar)number)
			       ? (gunichar)number
			       : 0;
	}
	for (size_t i = 0; i < ARRAY_COUNT(latin_1); i++)
		if (is(name, size, latin_1[i]))
			return 0xa0 + (gunichar)i;
	for (size_t i = 0; i < ARRAY_COUNT(others); i++)
		if (is(name, size, others[i].name))
			return others[i].character;
	return 0;
}

/* Sets p->text to the text with its entities replaced, ended by a zero byte. What is no entity
 * stays as it is written. */
static void replace_entities(struct plain *p, const char *text, size_t size)
{
	enum { NAME_BYTES_MAX = 10 };
	const char *end = text + size;

	buffer_clear(&p->text);
	while (text < end) {
		const char *mark = memchr(text, '&', (size_t)(end - text));
		const char *stop = mark ? mark : end, *semicolon;
		gunichar character = 0;
		char utf8[6];

		buffer_put(&p->text, text, (size_t)(stop - text));
		text = stop;
		if (!mark)
			break;
		semicolon = memchr(mark, ';', (size_t)(end - mark));
		if (semicolon && semicolon - mark <= NAME_BYTES_MAX)
			character = character_of(mark + 1, (size_t)(semicolon - mark - 1));
		if (character)
			buffer_put(&p->text, utf8, (size_t)g_unichar_to_utf8(character, utf8));
		else
			buffer_put_u8(&p->text, '&');
		text = character ? semicolon + 1 : mark + 1;
	}
	buffer_put_u8(&p->text, 0);
}

/* ---- tags */

static void start(struct plain *p, const struct html_element *element, const char *value)
{
	switch (element->role) {
	case HTML_INLINE:
	case HTML_LINK:
		return;
	case HTML_SKIP:
	case HTML_RAW:
		p->skips = true;
		return;
	case HTML_BREAK:
		article_builder_break(&p->builder, &p->look);
		return;
	case HTML_RULE:
		article_builder_rule(&p->builder, &p->look);
		return;
	case HTML_IMAGE:
		article_builder_image(&p->builder, value, &p->look);
		return;
	default:
		break;
	}
	article_builder_close(&p->builder);
	if (element->role == HTML_BLOCK || element->role == HTML_QUOTE) {
		p->look.quote |= element->role == HTML_QUOTE;
		if (element->style != HTML_STYLE_INHERITED)
			p->look.style = (enum article_style)element->style;
	}
	if (element->role == HTML_ITEM) {
		article_builder_marker(&p->builder, "•");
		p->look.indent = 1;
	}
}

static void end(struct plain *p, const struct html_element *element)
{
	if (element->role == HTML_SKIP || element->role == HTML_RAW)
		p->skips = false;
	if (element->role == HTML_INLINE || element->role == HTML_LINK || p->skips)
		return;
	article_builder_close(&p->builder);
	if (element->style != HTML_STYLE_INHERITED)
		p->look.style = ARTICLE_BODY;
	if (element->role == HTML_QUOTE)
		p->look.quote = false;
	if (element->role == HTML_ITEM || element->role == HTML_LIST ||
	    element->role == HTML_NUMBERED_LIST) {
		article_builder_marker(&p->builder, NULL);
		p->look.indent = 0;
	}
}

/* Reads a tag as html_tags_reduce writes it: a name, and at most one value in double quotes.
 * Returns what follows it. */
static const char *read_tag(struct plain *p, const char *tag, const char *last)
{
	const bool is_end = tag[1] == '/';
	const char *name = tag + 1 + is_end, *at = name, *value = "";
	const struct html_element *element;

	while (at < last && !strchr(" >/", *at))
		at++;
	element = html_element(name, (size_t)(at - name));
	if (at < last && *at == ' ') {
		const char *quote = memchr(at, '"', (size_t)(last - at));
		const char *close =
			quote ? memchr(quote + 1, '"', (size_t)(last - quote - 1)) : NULL;

		at = close ? close : last;
		if (close) {
			replace_entities(p, quote + 1, (size_t)(close - quote - 1));
			value = p->text.error ? "" : (const char *)p->text.data;
		}
	}
	if (is_end)
		end(p, element);
	else if (!p->skips)
		start(p, element, value);
	at = memchr(at, '>', (size_t)(last - at));
	return at ? at + 1 : last;
}

static void read_page(struct plain *p, struct bytes reduced)
{
	const char *at = (const char *)reduced.data, *last = at + reduced.size;

	while (at < last && article_builder_error(&p->builder) == 0 && p->text.error == 0) {
		const char *tag = memchr(at, '<', (size_t)(last - at));
		const char *stop = tag ? tag : last;

		replace_entities(p, at, (size_t)(stop - at));
		if (!p->skips && p->text.error == 0)
			article_builder_text(&p->builder, (const char *)p->text.data,
					     p->text.size - 1, &p->look);
		at = tag ? read_tag(p, tag, last) : last;
	}
}

int plain_page(struct buffer *out, struct bytes html)
{
	struct plain plain = { .look = { .link = -1, .style = ARTICLE_BODY } };
	struct buffer reduced;
	int rc;

	if (html.size == 0 || html.size > HTML_BYTES_MAX ||
	    !g_utf8_validate((const char *)html.data, (gssize)html.size, NULL))
		return -EBADMSG;
	buffer_init(&reduced, HTML_TAGS_GROWTH * html.size + 64);
	buffer_init(&plain.text, HTML_TAGS_GROWTH * html.size + 64);
	article_builder_init(&plain.builder);
	rc = html_tags_reduce(&reduced, html, NULL);
	if (rc == 0) {
		read_page(&plain, buffer_bytes(&reduced));
		rc = plain.text.error;
	}
	if (rc == 0)
		rc = article_builder_encode(&plain.builder, out);
	article_builder_finish(&plain.builder);
	buffer_finish(&plain.text);
	buffer_finish(&reduced);
	return rc == -EFBIG ? -EBADMSG : rc;
}
