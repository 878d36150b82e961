/* Walks libxml2's tree of a page and turns elements and text into blocks. */
#include "ui/html.h"

#include <errno.h>
#include <libxml/HTMLparser.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/html_tags.h"
#include "ui/html_parts.h"

/* The layout breaks lines one paragraph at a time, and its cost grows faster than the paragraph:
 * 256 KiB without a space took 20 s. So a block holds at most a few book pages of text. */
enum { DEPTH_MAX = 200, BLOCK_TEXT_BYTES_MAX = 8192 };

/* ---- text ---- */

static bool is_space(unsigned char c)
{
	return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f';
}

/* Ideographs, kana and their punctuation: three bytes, U+3000 to U+9FFF, or full-width forms in
 * U+F900 to U+FFEF. A line break between two of them in the source is not a space. */
static bool is_wide(const unsigned char *c, size_t left)
{
	return left >= 3 && ((c[0] >= 0xe3 && c[0] <= 0xe9) || c[0] == 0xef);
}

static void put_space(struct html_parser *p, const unsigned char *next, size_t left)
{
	const char *text = p->open->text;
	size_t size = p->open_bytes;
	bool none = size == 0 || text[size - 1] == '\n' || text[size - 1] == ' ';

	if (!none && p->space_had_newline && size >= 3 && is_wide(next, left) &&
	    is_wide((const unsigned char *)text + size - 3, 3))
		none = true;
	if (!none)
		html_append(p, " ", 1, &p->space_in);
	p->space = false;
	p->space_had_newline = false;
}

/* Returns the length of the word up to the next white space. A very long word is cut between
 * characters. */
static size_t word_bytes(const unsigned char *text, size_t left)
{
	size_t size = 0;

	while (size < left && !is_space(text[size]))
		size++;
	if (size < BLOCK_TEXT_BYTES_MAX / 2)
		return size;
	size = BLOCK_TEXT_BYTES_MAX / 2;
	while ((text[size] & 0xc0) == 0x80)
		size--;
	return size;
}

static void put_text(struct html_parser *p, const unsigned char *text,
		     const struct html_inherited *in)
{
	size_t left = strlen((const char *)text);

	while (left > 0 && !p->error) {
		size_t word;

		while (left > 0 && is_space(*text)) {
			if (!p->space)
				p->space_in = *in;
			p->space = true;
			p->space_had_newline |= *text == '\n';
			text++;
			left--;
		}
		word = word_bytes(text, left);
		if (word == 0)
			break;
		if (p->open_bytes + word + 1 > BLOCK_TEXT_BYTES_MAX)
			html_close_block(p);
		if (!p->open)
			html_open_text(p, in);
		if (p->open && p->space)
			put_space(p, text, left);
		if (p->open)
			html_append(p, (const char *)text, word, in);
		text += word;
		left -= word;
	}
}

/* ---- elements ---- */

enum role {
	ROLE_INLINE, /* also unknown elements: their text is kept */
	ROLE_BLOCK,
	ROLE_SKIP,
	ROLE_BREAK,
	ROLE_RULE,
	ROLE_IMAGE,
	ROLE_LINK,
	ROLE_LIST,
	ROLE_NUMBERED_LIST,
	ROLE_ITEM,
	ROLE_QUOTE,
	ROLE_ROW,
};

static const struct {
	const char *name;
	enum role role;
	int style; /* enum text_style, or -1: inherited */
	uint32_t flags;
} elements[] = {
	{ "h1", ROLE_BLOCK, TEXT_HEADING_1, 0 },
	{ "h2", ROLE_BLOCK, TEXT_HEADING_2, 0 },
	{ "h3", ROLE_BLOCK, TEXT_HEADING_3, 0 },
	{ "h4", ROLE_BLOCK, TEXT_HEADING_3, 0 },
	{ "h5", ROLE_BLOCK, TEXT_HEADING_3, 0 },
	{ "h6", ROLE_BLOCK, TEXT_HEADING_3, 0 },
	{ "p", ROLE_BLOCK, -1, 0 },
	{ "div", ROLE_BLOCK, -1, 0 },
	{ "section", ROLE_BLOCK, -1, 0 },
	{ "article", ROLE_BLOCK, -1, 0 },
	{ "main", ROLE_BLOCK, -1, 0 },
	{ "header", ROLE_BLOCK, -1, 0 },
	{ "footer", ROLE_BLOCK, -1, 0 },
	{ "figure", ROLE_BLOCK, TEXT_FIGURE, 0 },
	{ "figcaption", ROLE_BLOCK, TEXT_FIGURE, 0 },
	{ "caption", ROLE_BLOCK, TEXT_FIGURE, 0 },
	{ "table", ROLE_BLOCK, -1, 0 },
	{ "blockquote", ROLE_QUOTE, TEXT_QUOTE, 0 },
	{ "ul", ROLE_LIST, -1, 0 },
	{ "ol", ROLE_NUMBERED_LIST, -1, 0 },
	{ "li", ROLE_ITEM, -1, 0 },
	{ "tr", ROLE_ROW, TEXT_CELL, 0 },
	{ "em", ROLE_INLINE, -1, HTML_EMPHASIS },
	{ "i", ROLE_INLINE, -1, HTML_EMPHASIS },
	{ "cite", ROLE_INLINE, -1, HTML_EMPHASIS },
	{ "dfn", ROLE_INLINE, -1, HTML_EMPHASIS },
	{ "strong", ROLE_INLINE, -1, HTML_STRONG },
	{ "b", ROLE_INLINE, -1, HTML_STRONG },
	{ "small", ROLE_INLINE, -1, HTML_SMALL },
	{ "sub", ROLE_INLINE, -1, HTML_SUBSCRIPT },
	{ "sup", ROLE_INLINE, -1, HTML_SUPERSCRIPT },
	{ "a", ROLE_LINK, -1, 0 },
	{ "br", ROLE_BREAK, -1, 0 },
	{ "hr", ROLE_RULE, -1, 0 },
	{ "img", ROLE_IMAGE, -1, 0 },
	{ "head", ROLE_SKIP, -1, 0 },
	{ "script", ROLE_SKIP, -1, 0 },
	{ "style", ROLE_SKIP, -1, 0 },
	{ "template", ROLE_SKIP, -1, 0 },
};

static void walk(struct html_parser *p, const xmlNode *node, struct html_inherited *in, int depth);

static void put_image(struct html_parser *p, const xmlNode *node, const struct html_inherited *in)
{
	char *name = (char *)xmlGetProp((xmlNode *)node, BAD_CAST "src");
	struct html_block *block = name ? html_add_block(p, HTML_IMAGE, in) : NULL;

	if (block)
		block->text = html_copy(p, name);
	xmlFree(name);
}

static int add_link(struct html_parser *p, const xmlNode *node)
{
	char *href = (char *)xmlGetProp((xmlNode *)node, BAD_CAST "href");
	struct html *html = p->html;
	int link = -1;

	const bool to_tour = href && strncmp(href, "tour:", 5) == 0;

	if (href && (to_tour || strncmp(href, "part:", 5) == 0 || strncmp(href, "page:", 5) == 0) &&
	    href[5]) {
		char **grown = html_grow(p, html->links, html->link_count, sizeof(*grown));
		char *id = grown ? html_copy(p, to_tour ? href : href + 5) : NULL;

		if (grown)
			html->links = grown;
		if (id) {
			link = (int)html->link_count;
			html->links[html->link_count++] = id;
		}
	}
	xmlFree(href);
	return link;
}

/* Counts the cells of a row, before they are walked. */
static uint32_t count_cells(const xmlNode *row)
{
	uint32_t cells = 0;

	for (const xmlNode *n = row->children; n; n = n->next)
		cells += n->type == XML_ELEMENT_NODE && (strcmp((const char *)n->name, "td") == 0 ||
							 strcmp((const char *)n->name, "th") == 0);
	return cells < HTML_COLUMNS_MAX ? cells : HTML_COLUMNS_MAX;
}

static void walk_cell(struct html_parser *p, const xmlNode *node, struct html_inherited in,
		      int depth)
{
	html_close_block(p);
	walk(p, node->children, &in, depth);
	html_close_block(p);
}

static void walk_row(struct html_parser *p, const xmlNode *node, struct html_inherited in,
		     int depth)
{
	uint32_t first, cells = count_cells(node);

	html_close_block(p);
	first = p->html->block_count;
	if (in.row > 0 || cells == 0) { /* a table inside a cell: only its text is kept */
		walk(p, node->children, &in, depth);
		return;
	}
	in.row = ++p->row_count;
	in.column = 0;
	for (const xmlNode *n = node->children; n && in.column < cells; n = n->next) {
		bool heading;

		if (n->type != XML_ELEMENT_NODE)
			continue;
		heading = strcmp((const char *)n->name, "th") == 0;
		if (!heading && strcmp((const char *)n->name, "td") != 0)
			continue;
		in.flags = heading ? HTML_STRONG : 0;
		in.heading_cell = heading;
		walk_cell(p, n, in, depth);
		in.column++;
	}
	for (uint32_t i = first; i < p->html->block_count; i++)
		p->html->blocks[i].column_count = cells;
}

static void walk_block(struct html_parser *p, const xmlNode *node, struct html_inherited *in,
		       int depth)
{
	html_close_block(p);
	walk(p, node->children, in, depth);
	html_close_block(p);
}

static void walk_item(struct html_parser *p, const xmlNode *node, struct html_inherited *in,
		      struct html_inherited *list, int depth)
{
	html_close_block(p);
	if (list->list_number > 0)
		snprintf(p->marker, sizeof(p->marker), "%d.", list->list_number++);
	else
		snprintf(p->marker, sizeof(p->marker), "•");
	p->marker_wanted = p->marker;
	if (in->indent == 0)
		in->indent = 1;
	walk(p, node->children, in, depth);
	html_close_block(p);
	p->marker_wanted = NULL;
}

static void walk_element(struct html_parser *p, const xmlNode *node, struct html_inherited *parent,
			 int depth)
{
	struct html_inherited in = *parent;
	enum role role = ROLE_INLINE;

	for (size_t i = 0; i < ARRAY_COUNT(elements); i++) {
		if (strcmp((const char *)node->name, elements[i].name) != 0)
			continue;
		role = elements[i].role;
		in.flags |= elements[i].flags;
		if (elements[i].style >= 0)
			in.style = (enum text_style)elements[i].style;
	}
	switch (role) {
	case ROLE_SKIP:
		return;
	case ROLE_BREAK:
		if (p->open_bytes >= BLOCK_TEXT_BYTES_MAX)
			html_close_block(p);
		if (p->open)
			html_append(p, "\n", 1, &in);
		return;
	case ROLE_RULE:
		html_add_block(p, HTML_RULE, &in);
		return;
	case ROLE_IMAGE:
		put_image(p, node, &in);
		return;
	case ROLE_ROW:
		walk_row(p, node, in, depth);
		return;
	case ROLE_ITEM:
		walk_item(p, node, &in, parent, depth);
		return;
	case ROLE_LIST:
	case ROLE_NUMBERED_LIST:
		in.list_number = role == ROLE_LIST ? -1 : 1;
		in.indent++;
		walk_block(p, node, &in, depth);
		return;
	case ROLE_QUOTE:
		in.quote = true;
		walk_block(p, node, &in, depth);
		return;
	case ROLE_LINK:
		in.link = add_link(p, node);
		walk(p, node->children, &in, depth);
		return;
	case ROLE_INLINE:
		walk(p, node->children, &in, depth);
		return;
	default:
		walk_block(p, node, &in, depth);
	}
}

static void walk(struct html_parser *p, const xmlNode *node, struct html_inherited *in, int depth)
{
	if (depth > DEPTH_MAX)
		return;
	for (; node && !p->error; node = node->next) {
		if (node->type == XML_TEXT_NODE && node->content)
			put_text(p, node->content, in);
		else if (node->type == XML_ELEMENT_NODE)
			walk_element(p, node, in, depth + 1);
	}
}

/* Parses the reduced page. NULL: no memory, or the page is empty. */
static xmlDoc *read_tree(struct bytes source)
{
	struct buffer reduced;
	xmlDoc *doc = NULL;

	buffer_init(&reduced, HTML_TAGS_GROWTH * source.size + 64);
	if (html_tags_reduce(&reduced, source, NULL) == 0 && reduced.size > 0)
		doc = htmlReadMemory((const char *)reduced.data, (int)reduced.size, NULL, "UTF-8",
				     HTML_PARSE_RECOVER | HTML_PARSE_NOERROR |
					     HTML_PARSE_NOWARNING | HTML_PARSE_NONET);
	buffer_finish(&reduced);
	return doc;
}

int html_parse(struct html *out, struct bytes source)
{
	struct html_parser parser = { .html = out };
	struct html_inherited in = { .link = -1, .list_number = -1, .style = TEXT_BODY };
	xmlDoc *doc;

	memset(out, 0, sizeof(*out));
	if (source.size > HTML_BYTES_MAX)
		return -EFBIG;
	if (source.size == 0 ||
	    !g_utf8_validate((const char *)source.data, (gssize)source.size, NULL))
		return -EBADMSG;
	doc = read_tree(source);
	if (!doc)
		return -EBADMSG;
	walk(&parser, xmlDocGetRootElement(doc), &in, 0);
	html_close_block(&parser);
	xmlFreeDoc(doc);
	if (parser.error == 0 && out->block_count == 0)
		parser.error = -EBADMSG;
	if (parser.error)
		html_finish(out);
	return parser.error;
}

int html_add_note(struct html *html, const char *text)
{
	const struct html_inherited in = { .link = -1, .list_number = -1, .style = TEXT_FIGURE };
	struct html_parser parser = { .html = html };

	html_add_block(&parser, HTML_RULE, &in);
	put_text(&parser, (const unsigned char *)text, &in);
	html_close_block(&parser);
	return parser.error;
}

void html_finish(struct html *html)
{
	if (!html)
		return;
	for (uint32_t i = 0; i < html->block_count; i++) {
		free(html->blocks[i].text);
		free(html->blocks[i].marker);
		free(html->blocks[i].spans);
	}
	for (uint32_t i = 0; i < html->link_count; i++)
		free(html->links[i]);
	free(html->blocks);
	free(html->links);
	memset(html, 0, sizeof(*html));
}
