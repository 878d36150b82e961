#include "ui/html.h"

#include <errno.h>
#include <libxml/HTMLparser.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEPTH_MOST = 200 };

/* What the elements around a text say about it. Copied on the way down. */
struct inherited {
	uint32_t flags, indent, row, column;
	int link;
	int list_number; /* of an ol's next item; -1: bullets */
	bool quote, heading_cell;
	enum text_style style;
};

struct parser {
	struct html *html;
	struct html_block *open; /* text is being appended; NULL: none */
	size_t open_bytes, open_room;
	const char *marker_wanted; /* of the list item whose first block has not come */
	char marker[16];
	uint32_t row_count;
	bool space, space_had_newline; /* white space waits for the next word */
	struct inherited space_in;     /* and looks as what it stood in: no link begins with it */
	int error;
};

static void *grow(struct parser *p, void *array, uint32_t count, size_t item_bytes)
{
	void *grown = array;

	if ((count & (count - 1)) == 0)
		grown = realloc(array, (count ? 2 * (size_t)count : 1) * item_bytes);
	if (!grown)
		p->error = -ENOMEM;
	return grown;
}

static char *copy(struct parser *p, const char *text)
{
	char *made = strdup(text);

	if (!made)
		p->error = -ENOMEM;
	return made;
}

/* ---- blocks ---- */

/* Takes a trailing line break or space off; an empty block goes altogether. */
static void close_block(struct parser *p)
{
	struct html_block *block = p->open;

	p->open = NULL;
	p->space = false;
	p->space_had_newline = false;
	if (!block)
		return;
	while (p->open_bytes > 0 && strchr("\n ", block->text[p->open_bytes - 1]))
		block->text[--p->open_bytes] = 0;
	for (uint32_t i = 0; i < block->span_count; i++)
		if (block->spans[i].end > p->open_bytes)
			block->spans[i].end = (uint32_t)p->open_bytes;
	if (p->open_bytes == 0) {
		free(block->text);
		free(block->marker);
		free(block->spans);
		p->html->block_count--;
	}
}

static struct html_block *add_block(struct parser *p, enum html_block_kind kind,
				    const struct inherited *in)
{
	struct html *html = p->html;
	struct html_block *grown, *block;

	close_block(p);
	if (p->error == 0 && html->block_count == HTML_BLOCKS_MOST)
		p->error = -EFBIG;
	if (p->error)
		return NULL;
	grown = grow(p, html->blocks, html->block_count, sizeof(*grown));
	if (!grown)
		return NULL;
	html->blocks = grown;
	block = &grown[html->block_count++];
	*block = (struct html_block){ .kind = kind,
				      .style = in->style,
				      .indent = in->indent,
				      .quote = in->quote,
				      .row = in->row,
				      .column = in->column,
				      .heading_cell = in->heading_cell };
	if (p->marker_wanted) {
		block->marker = copy(p, p->marker_wanted);
		p->marker_wanted = NULL;
	}
	return block;
}

static void open_text(struct parser *p, const struct inherited *in)
{
	p->open = add_block(p, HTML_TEXT, in);
	if (!p->open)
		return;
	p->open_bytes = 0;
	p->open_room = 64;
	p->open->text = calloc(1, p->open_room);
	if (!p->open->text) {
		p->error = -ENOMEM;
		p->open = NULL;
		p->html->block_count--;
	}
}

static void mark_span(struct parser *p, uint32_t start, uint32_t end, const struct inherited *in)
{
	struct html_block *block = p->open;
	struct html_span *last = block->span_count ? &block->spans[block->span_count - 1] : NULL;
	struct html_span *grown;

	if (in->flags == 0 && in->link < 0)
		return;
	if (last && last->end == start && last->flags == in->flags && last->link == in->link) {
		last->end = end;
		return;
	}
	grown = grow(p, block->spans, block->span_count, sizeof(*grown));
	if (!grown)
		return;
	block->spans = grown;
	grown[block->span_count++] = (struct html_span){ start, end, in->flags, in->link };
}

static void append(struct parser *p, const char *text, size_t size, const struct inherited *in)
{
	uint32_t start = (uint32_t)p->open_bytes;

	if (p->error)
		return;
	if (p->open_bytes + size + 1 > p->open_room) {
		size_t room = 2 * (p->open_bytes + size + 1);
		char *grown = realloc(p->open->text, room);

		if (!grown) {
			p->error = -ENOMEM;
			return;
		}
		p->open->text = grown;
		p->open_room = room;
	}
	memcpy(p->open->text + p->open_bytes, text, size);
	p->open_bytes += size;
	p->open->text[p->open_bytes] = 0;
	mark_span(p, start, (uint32_t)p->open_bytes, in);
}

/* ---- text ---- */

static bool is_space(unsigned char c)
{
	return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f';
}

/* Ideographs, kana and their punctuation: three bytes from U+3000 to U+9FFF, or U+F900 to U+FFEF
 * full width. Between two of them a line end of the source is no space. */
static bool is_wide(const unsigned char *c, size_t left)
{
	return left >= 3 && ((c[0] >= 0xe3 && c[0] <= 0xe9) || c[0] == 0xef);
}

static void put_space(struct parser *p, const unsigned char *next, size_t left)
{
	const char *text = p->open->text;
	size_t size = p->open_bytes;
	bool none = size == 0 || text[size - 1] == '\n' || text[size - 1] == ' ';

	if (!none && p->space_had_newline && size >= 3 && is_wide(next, left) &&
	    is_wide((const unsigned char *)text + size - 3, 3))
		none = true;
	if (!none)
		append(p, " ", 1, &p->space_in);
	p->space = false;
	p->space_had_newline = false;
}

static void put_text(struct parser *p, const unsigned char *text, const struct inherited *in)
{
	size_t left = strlen((const char *)text);

	while (left > 0 && !p->error) {
		size_t word = 0;

		while (left > 0 && is_space(*text)) {
			if (!p->space)
				p->space_in = *in;
			p->space = true;
			p->space_had_newline |= *text == '\n';
			text++;
			left--;
		}
		while (word < left && !is_space(text[word]))
			word++;
		if (word == 0)
			break;
		if (!p->open)
			open_text(p, in);
		if (p->open && p->space)
			put_space(p, text, left);
		if (p->open)
			append(p, (const char *)text, word, in);
		text += word;
		left -= word;
	}
}

/* ---- elements ---- */

enum role {
	ROLE_INLINE, /* unknown ones too: their text counts */
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

static void walk(struct parser *p, const xmlNode *node, struct inherited *in, int depth);

static void put_image(struct parser *p, const xmlNode *node, const struct inherited *in)
{
	char *name = (char *)xmlGetProp((xmlNode *)node, BAD_CAST "src");
	struct html_block *block = name ? add_block(p, HTML_IMAGE, in) : NULL;

	if (block)
		block->text = copy(p, name);
	xmlFree(name);
}

static int add_link(struct parser *p, const xmlNode *node)
{
	char *href = (char *)xmlGetProp((xmlNode *)node, BAD_CAST "href");
	struct html *html = p->html;
	int link = -1;

	const bool to_tour = href && strncmp(href, "tour:", 5) == 0;

	if (href && (to_tour || strncmp(href, "part:", 5) == 0 || strncmp(href, "page:", 5) == 0) &&
	    href[5]) {
		char **grown = grow(p, html->links, html->link_count, sizeof(*grown));
		char *id = grown ? copy(p, to_tour ? href : href + 5) : NULL;

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

/* How many cells the row has, before they are walked. */
static uint32_t count_cells(const xmlNode *row)
{
	uint32_t cells = 0;

	for (const xmlNode *n = row->children; n; n = n->next)
		cells += n->type == XML_ELEMENT_NODE && (strcmp((const char *)n->name, "td") == 0 ||
							 strcmp((const char *)n->name, "th") == 0);
	return cells < HTML_COLUMNS_MOST ? cells : HTML_COLUMNS_MOST;
}

static void walk_cell(struct parser *p, const xmlNode *node, struct inherited in, int depth)
{
	close_block(p);
	walk(p, node->children, &in, depth);
	close_block(p);
}

static void walk_row(struct parser *p, const xmlNode *node, struct inherited in, int depth)
{
	uint32_t first, cells = count_cells(node);

	close_block(p);
	first = p->html->block_count;
	if (in.row > 0 || cells == 0) { /* a table in a cell: its text only */
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

static void walk_block(struct parser *p, const xmlNode *node, struct inherited *in, int depth)
{
	close_block(p);
	walk(p, node->children, in, depth);
	close_block(p);
}

static void walk_item(struct parser *p, const xmlNode *node, struct inherited *in,
		      struct inherited *list, int depth)
{
	close_block(p);
	if (list->list_number > 0)
		snprintf(p->marker, sizeof(p->marker), "%d.", list->list_number++);
	else
		snprintf(p->marker, sizeof(p->marker), "•");
	p->marker_wanted = p->marker;
	if (in->indent == 0)
		in->indent = 1;
	walk(p, node->children, in, depth);
	close_block(p);
	p->marker_wanted = NULL;
}

static void walk_element(struct parser *p, const xmlNode *node, struct inherited *parent, int depth)
{
	struct inherited in = *parent;
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
		if (p->open)
			append(p, "\n", 1, &in);
		return;
	case ROLE_RULE:
		add_block(p, HTML_RULE, &in);
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

static void walk(struct parser *p, const xmlNode *node, struct inherited *in, int depth)
{
	if (depth > DEPTH_MOST)
		return;
	for (; node && !p->error; node = node->next) {
		if (node->type == XML_TEXT_NODE && node->content)
			put_text(p, node->content, in);
		else if (node->type == XML_ELEMENT_NODE)
			walk_element(p, node, in, depth + 1);
	}
}

int html_parse(struct html *out, struct bytes source)
{
	struct parser parser = { .html = out };
	struct inherited in = { .link = -1, .list_number = -1, .style = TEXT_BODY };
	xmlDoc *doc;

	memset(out, 0, sizeof(*out));
	if (source.size > HTML_BYTES_MOST)
		return -EFBIG;
	if (source.size == 0 ||
	    !g_utf8_validate((const char *)source.data, (gssize)source.size, NULL))
		return -EBADMSG;
	doc = htmlReadMemory((const char *)source.data, (int)source.size, NULL, "UTF-8",
			     HTML_PARSE_RECOVER | HTML_PARSE_NOERROR | HTML_PARSE_NOWARNING |
				     HTML_PARSE_NONET);
	if (!doc)
		return -EBADMSG;
	walk(&parser, xmlDocGetRootElement(doc), &in, 0);
	close_block(&parser);
	xmlFreeDoc(doc);
	if (parser.error == 0 && out->block_count == 0)
		parser.error = -EBADMSG;
	if (parser.error)
		html_finish(out);
	return parser.error;
}

int html_add_note(struct html *html, const char *text)
{
	const struct inherited in = { .link = -1, .list_number = -1, .style = TEXT_FIGURE };
	struct parser parser = { .html = html };

	add_block(&parser, HTML_RULE, &in);
	put_text(&parser, (const unsigned char *)text, &in);
	close_block(&parser);
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
