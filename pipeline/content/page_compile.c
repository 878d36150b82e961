/* Walks libxml2's tree of a page and turns elements and text into the blocks of an article. */
#include "pipeline/content/page_compile.h"

#include <errno.h>
#include <glib.h>
#include <libxml/HTMLparser.h>
#include <stdio.h>
#include <string.h>

#include "format/article_builder.h"
#include "format/html_elements.h"
#include "format/html_tags.h"

enum { DEPTH_MAX = 200 };

struct compiler {
	struct article_builder builder;
	uint32_t row_count;
};

/* What an element's contents inherit. Copied on the way down the tree. */
struct inherited {
	struct article_look look;
	int list_number; /* number of the next item of an ol; -1: bullets */
};

static void walk(struct compiler *c, const xmlNode *node, struct inherited *in, int depth);

static const struct html_element *element_of(const xmlNode *node)
{
	return html_element((const char *)node->name, strlen((const char *)node->name));
}

static void put_image(struct compiler *c, const xmlNode *node, const struct inherited *in)
{
	char *name = (char *)xmlGetProp((xmlNode *)node, BAD_CAST "src");

	if (name)
		article_builder_image(&c->builder, name, &in->look);
	xmlFree(name);
}

static int add_link(struct compiler *c, const xmlNode *node)
{
	char *href = (char *)xmlGetProp((xmlNode *)node, BAD_CAST "href");
	int link = -1;

	if (href && (strncmp(href, "part:", 5) == 0 || strncmp(href, "page:", 5) == 0))
		link = article_builder_link(&c->builder, href + 5);
	else if (href && strncmp(href, "tour:", 5) == 0 && href[5])
		link = article_builder_link(&c->builder, href);
	xmlFree(href);
	return link;
}

/* ---- tables */

static bool is_cell(const xmlNode *node, bool *is_heading)
{
	const enum html_role role =
		node->type == XML_ELEMENT_NODE ? element_of(node)->role : HTML_INLINE;

	*is_heading = role == HTML_HEADING_CELL;
	return role == HTML_CELL || *is_heading;
}

/* Counts the cells of a row, before they are walked. */
static uint32_t count_cells(const xmlNode *row)
{
	uint32_t cells = 0;
	bool is_heading;

	for (const xmlNode *n = row->children; n; n = n->next)
		cells += is_cell(n, &is_heading);
	return cells < ARTICLE_COLUMNS_MAX ? cells : ARTICLE_COLUMNS_MAX;
}

static void walk_block(struct compiler *c, const xmlNode *node, struct inherited *in, int depth)
{
	article_builder_close(&c->builder);
	walk(c, node->children, in, depth);
	article_builder_close(&c->builder);
}

static void walk_row(struct compiler *c, const xmlNode *node, struct inherited in, int depth)
{
	uint32_t first, cells = count_cells(node);

	article_builder_close(&c->builder);
	first = article_builder_count(&c->builder);
	if (in.look.row > 0 || cells == 0) { /* a table inside a cell: only its text is kept */
		walk(c, node->children, &in, depth);
		return;
	}
	in.look.row = ++c->row_count;
	in.look.column = 0;
	for (const xmlNode *n = node->children; n && in.look.column < cells; n = n->next) {
		struct inherited cell = in;

		if (!is_cell(n, &cell.look.heading_cell))
			continue;
		cell.look.flags = cell.look.heading_cell ? ARTICLE_STRONG : 0;
		walk_block(c, n, &cell, depth);
		in.look.column++;
	}
	article_builder_columns(&c->builder, first, cells);
}

/* ---- elements */

static void walk_item(struct compiler *c, const xmlNode *node, struct inherited *in,
		      struct inherited *list, int depth)
{
	char marker[ARTICLE_MARKER_BYTES_MAX + 1];

	article_builder_close(&c->builder);
	if (list->list_number > 0)
		snprintf(marker, sizeof(marker), "%d.", list->list_number++);
	else
		snprintf(marker, sizeof(marker), "•");
	article_builder_marker(&c->builder, marker);
	if (in->look.indent == 0)
		in->look.indent = 1;
	walk(c, node->children, in, depth);
	article_builder_close(&c->builder);
	article_builder_marker(&c->builder, NULL);
}

static void walk_element(struct compiler *c, const xmlNode *node, struct inherited *parent,
			 int depth)
{
	const struct html_element *element = element_of(node);
	struct inherited in = *parent;

	in.look.flags |= element->flags;
	if (element->style != HTML_STYLE_INHERITED)
		in.look.style = (enum article_style)element->style;
	switch (element->role) {
	case HTML_SKIP:
	case HTML_RAW:
		return;
	case HTML_BREAK:
		article_builder_break(&c->builder, &in.look);
		return;
	case HTML_RULE:
		article_builder_rule(&c->builder, &in.look);
		return;
	case HTML_IMAGE:
		put_image(c, node, &in);
		return;
	case HTML_ROW:
		walk_row(c, node, in, depth);
		return;
	case HTML_ITEM:
		walk_item(c, node, &in, parent, depth);
		return;
	case HTML_LIST:
	case HTML_NUMBERED_LIST:
		in.list_number = element->role == HTML_LIST ? -1 : 1;
		in.look.indent++;
		break;
	case HTML_QUOTE:
		in.look.quote = true;
		break;
	case HTML_LINK:
		in.look.link = add_link(c, node);
		walk(c, node->children, &in, depth);
		return;
	case HTML_BLOCK:
		break;
	case HTML_INLINE:
	case HTML_CELL: /* outside a row */
	case HTML_HEADING_CELL:
		walk(c, node->children, &in, depth);
		return;
	}
	walk_block(c, node, &in, depth);
}

static void walk(struct compiler *c, const xmlNode *node, struct inherited *in, int depth)
{
	if (depth > DEPTH_MAX)
		return;
	for (; node && article_builder_error(&c->builder) == 0; node = node->next) {
		const char *text = (const char *)node->content;

		if (node->type == XML_TEXT_NODE && text)
			article_builder_text(&c->builder, text, strlen(text), &in->look);
		else if (node->type == XML_ELEMENT_NODE)
			walk_element(c, node, in, depth + 1);
	}
}

/* ---- the page */

/* Parses the reduced page. *out: NULL if the page is empty. */
static int read_tree(xmlDoc **out, struct bytes html)
{
	struct buffer reduced;
	int rc;

	*out = NULL;
	buffer_init(&reduced, HTML_TAGS_GROWTH * html.size + 64);
	rc = html_tags_reduce(&reduced, html, NULL);
	if (rc == 0 && reduced.size > 0)
		*out = htmlReadMemory((const char *)reduced.data, (int)reduced.size, NULL, "UTF-8",
				      HTML_PARSE_RECOVER | HTML_PARSE_NOERROR |
					      HTML_PARSE_NOWARNING | HTML_PARSE_NONET);
	buffer_finish(&reduced);
	return rc;
}

static int add_text(struct compiler *compiler, struct bytes html)
{
	struct inherited in = { .look = { .link = -1, .style = ARTICLE_BODY }, .list_number = -1 };
	xmlDoc *doc;
	int rc;

	if (html.size > HTML_BYTES_MAX)
		return -EFBIG;
	if (html.size == 0 || !g_utf8_validate((const char *)html.data, (gssize)html.size, NULL))
		return -EBADMSG;
	rc = read_tree(&doc, html);
	if (rc < 0)
		return rc;
	article_builder_close(&compiler->builder);
	if (article_builder_count(&compiler->builder) > 0)
		article_builder_rule(&compiler->builder, &in.look);
	if (doc)
		walk(compiler, xmlDocGetRootElement(doc), &in, 0);
	xmlFreeDoc(doc);
	return 0;
}

int page_compile_all(struct buffer *out, const struct bytes *texts, uint32_t count)
{
	struct compiler compiler = { .row_count = 0 };
	int rc = 0;

	article_builder_init(&compiler.builder);
	for (uint32_t n = 0; rc == 0 && n < count; n++)
		rc = add_text(&compiler, texts[n]);
	if (rc == 0)
		rc = article_builder_encode(&compiler.builder, out);
	article_builder_finish(&compiler.builder);
	return rc;
}

int page_compile(struct buffer *out, struct bytes html)
{
	return page_compile_all(out, &html, 1);
}
