/* Reads pages/ID.LANG.html and makes articles of them. libxml2's HTML parser tolerates errors; our
 * own strict rules then refuse, with the line, what the kiosk cannot show or must not load. */
#include "pipeline/content/info_pages.h"

#include <dirent.h>
#include <errno.h>
#include <glib.h>
#include <libxml/HTMLparser.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/array.h"
#include "format/article.h"
#include "format/html_elements.h"
#include "format/html_tags.h"
#include "pipeline/content/page_compile.h"
#include "pipeline/content/spoken_text.h"

struct page_check {
	struct draft *draft;
	struct draft_page *page;
	const char *file;
	uint32_t text_bytes; /* bytes that are not white space */
};

static unsigned node_line(xmlNode *node)
{
	long line = xmlGetLineNo(node);

	return line > 0 ? (unsigned)line : 0;
}

static int note_picture(struct page_check *check, int picture)
{
	struct draft_page *page = check->page;
	int rc;

	for (uint32_t i = 0; i < page->picture_count; i++)
		if (page->pictures[i] == (uint32_t)picture)
			return 0;
	rc = ARRAY_RESERVE(page->pictures, page->picture_room, page->picture_count + 1, UINT32_MAX);
	if (rc == 0)
		page->pictures[page->picture_count++] = (uint32_t)picture;
	return rc;
}

static int check_image(struct page_check *check, xmlNode *node)
{
	char *src = (char *)xmlGetProp(node, BAD_CAST "src");
	unsigned line = node_line(node);
	int picture = -1;

	if (!src)
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, line,
				"<img> without src: write src=\"pictures/NAME\"");
	else
		picture = draft_add_picture(check->draft, src, check->file, line);
	xmlFree(src);
	if (picture == -ENOMEM)
		return -ENOMEM;
	if (picture >= 0 && check->page->picture_count == INFO_PAGE_PICTURES_MAX) {
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, line,
				"more than %d pictures on a page: split it",
				INFO_PAGE_PICTURES_MAX);
		return 0;
	}
	return picture >= 0 ? note_picture(check, picture) : 0;
}

static void check_link(struct page_check *check, xmlNode *node)
{
	char *href = (char *)xmlGetProp(node, BAD_CAST "href");
	bool to_page = href && strncmp(href, "page:", 5) == 0;
	bool to_part = href && strncmp(href, "part:", 5) == 0;
	bool to_tour = href && strncmp(href, "tour:", 5) == 0;
	int part = to_page || to_part ? draft_find_part(check->draft, href + 5) : -1;
	unsigned line = node_line(node);

	if (!href)
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, line,
				"<a> without href: write href=\"part:ID\", or remove it");
	else if (to_tour && draft_find_tour(check->draft, href + 5) < 0)
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, line,
				"link to \"%.80s\": no tour has that id; see tours.json", href);
	else if (!to_page && !to_part && !to_tour)
		diagnostics_add(
			check->draft->diagnostics, -EINVAL, check->file, line,
			"link to \"%.80s\": the kiosk shows nothing outside the release; link to "
			"\"part:ID\", \"page:ID\" or \"tour:ID\", or write the address as "
			"text",
			href);
	else if (!to_tour && part < 0)
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, line,
				"link to \"%.80s\": no part has that id; see parts.json", href);
	else if (to_page && check->draft->parts[part].without_page)
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, line,
				"link to \"%.80s\": that part has no page; write \"part:%.64s\", "
				"which shows it on the model",
				href, href + 5);
	xmlFree(href);
}

static void check_attributes(struct page_check *check, xmlNode *node)
{
	for (xmlAttr *a = node->properties; a; a = a->next) {
		const char *name = (const char *)a->name;

		if (strncmp(name, "on", 2) == 0)
			diagnostics_add(check->draft->diagnostics, -EINVAL, check->file,
					node_line(node),
					"attribute %.40s: pages run no scripts; remove it", name);
		else if (strcmp(name, "style") == 0)
			diagnostics_add(check->draft->diagnostics, 0, check->file, node_line(node),
					"style is ignored: the kiosk has one look for all pages");
	}
}

/* Cells beyond those that an article may have would be lost. */
static void check_row(struct page_check *check, xmlNode *row)
{
	int cells = 0;

	for (const xmlNode *node = row->children; node; node = node->next) {
		const char *name = (const char *)node->name;
		const enum html_role role = node->type == XML_ELEMENT_NODE
						    ? html_element(name, strlen(name))->role
						    : HTML_INLINE;

		cells += role == HTML_CELL || role == HTML_HEADING_CELL;
	}
	if (cells > ARTICLE_COLUMNS_MAX)
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, node_line(row),
				"a row of %d cells: a table has at most %d columns on a terminal; "
				"make two tables of it, or turn its rows into columns",
				cells, ARTICLE_COLUMNS_MAX);
}

static int check_element(struct page_check *check, xmlNode *node)
{
	const char *name = (const char *)node->name;

	if (!html_element(name, strlen(name))->is_allowed)
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, node_line(node),
				"<%.40s> cannot be shown: see docs/information.md for the "
				"elements that can",
				name);
	check_attributes(check, node);
	if (strcmp(name, "a") == 0)
		check_link(check, node);
	if (strcmp(name, "tr") == 0)
		check_row(check, node);
	return strcmp(name, "img") == 0 ? check_image(check, node) : 0;
}

/* Returns the next node of the tree without recursion, so any depth is safe. */
static xmlNode *next_node(xmlNode *node)
{
	if (node->children && node->type == XML_ELEMENT_NODE)
		return node->children;
	while (node && !node->next)
		node = node->parent && node->parent->type == XML_ELEMENT_NODE ? node->parent : NULL;
	return node ? node->next : NULL;
}

static int check_tree(struct page_check *check, xmlDoc *doc)
{
	int rc = 0;

	for (xmlNode *node = doc->children; node && rc == 0; node = next_node(node)) {
		if (node->type == XML_ELEMENT_NODE)
			rc = check_element(check, node);
		else if (node->type == XML_TEXT_NODE && node->content)
			for (const xmlChar *c = node->content; *c; c++)
				check->text_bytes += !strchr(" \t\r\n", *c);
	}
	return rc;
}

static void hear_parser(void *data, xmlError *error)
{
	xmlParserCtxt *parser = data;
	struct page_check *check = parser->_private;
	char text[200];

	/* libxml2 knows only HTML 4; our own list decides about newer elements such as figure. */
	if (error->code == XML_HTML_UNKNOWN_TAG)
		return;
	snprintf(text, sizeof(text), "%s", error->message ? error->message : "malformed HTML");
	text[strcspn(text, "\n")] = 0;
	diagnostics_add(check->draft->diagnostics, 0, check->file, (unsigned)error->line,
			"%s: check that every tag is closed in order", text);
}

/* Checks the number of attributes before the parser runs, which would be slow with many. Returns
 * false after reporting a fault. */
static bool check_tags(struct page_check *check)
{
	const struct bytes html = { (const uint8_t *)check->page->html, check->page->size };
	struct html_tags found = { 0 };
	struct buffer reduced;
	int rc;

	buffer_init(&reduced, HTML_TAGS_GROWTH * html.size + 64);
	rc = html_tags_reduce(&reduced, html, &found);
	buffer_finish(&reduced);
	if (rc == 0 && found.attribute_count > HTML_TAG_ATTRIBUTES_MAX)
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, found.line,
				"a tag with %u attributes: at most %d are read, and only src and "
				"href mean anything; remove the others",
				found.attribute_count, HTML_TAG_ATTRIBUTES_MAX);
	return rc < 0 || found.attribute_count <= HTML_TAG_ATTRIBUTES_MAX;
}

static int parse_page(struct page_check *check)
{
	htmlParserCtxt *parser = htmlNewParserCtxt();
	xmlDoc *doc;
	int rc = 0;

	if (!parser)
		return -ENOMEM;
	parser->_private = check;
	parser->sax->initialized = XML_SAX2_MAGIC;
	parser->sax->serror = hear_parser;
	doc = htmlCtxtReadMemory(parser, check->page->html, (int)check->page->size, NULL, "UTF-8",
				 HTML_PARSE_RECOVER | HTML_PARSE_NONET);
	if (doc)
		rc = check_tree(check, doc);
	if (rc == 0 && check->text_bytes == 0)
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, 1,
				"there is no text on this page: write some, or remove the file");
	xmlFreeDoc(doc);
	htmlFreeParserCtxt(parser);
	return rc;
}

/* Returns false for links and special files. Page contents are published, so a link could expose a
 * private file, and reading a FIFO would block. */
static bool is_plain_file(const char *path)
{
	struct stat status;

	return lstat(path, &status) < 0 || S_ISREG(status.st_mode);
}

/* Reads the file into check->page. If the file is missing, returns 0 and html stays NULL. */
static int read_page_file(struct page_check *check)
{
	struct buffer bytes;
	char path[PATH_MAX];
	int rc = -ENAMETOOLONG;

	buffer_init(&bytes, HTML_BYTES_MAX + 1);
	if (draft_path(check->draft, path, sizeof(path), check->file))
		rc = is_plain_file(path) ? draft_read_text(check->draft, check->file, &bytes)
					 : -ELOOP;
	if (rc == 0) {
		buffer_put_u8(&bytes, 0);
		rc = bytes.error;
	}
	if (rc == -ENOENT || rc == -ENOMEM) {
		buffer_finish(&bytes);
		return rc == -ENOMEM ? rc : 0;
	}
	if (rc == -ELOOP) {
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, 0,
				"is a link or not a regular file: put the page itself there");
	} else if (rc < 0) {
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, 0,
				rc == -EFBIG ? "page is larger than %d KB: split it"
					     : "cannot be read (at most %d KB)",
				HTML_BYTES_MAX >> 10);
	} else if (!g_utf8_validate((char *)bytes.data, (gssize)bytes.size - 1, NULL)) {
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, 0,
				"is not UTF-8: save it as UTF-8");
	} else {
		check->page->html = (char *)bytes.data; /* taken */
		check->page->size = bytes.size - 1;
		return 0;
	}
	buffer_finish(&bytes);
	return 0;
}

static int check_page(struct page_check *check)
{
	return check_tags(check) ? parse_page(check) : 0;
}

/* Makes the article of all texts. What has a fault is not published, so it needs none. */
static int compile_page(struct page_check *check, const struct bytes *texts, uint32_t count)
{
	struct draft_page *page = check->page;
	int rc;

	buffer_init(&page->article, ARTICLE_BYTES_MAX);
	rc = page_compile_all(&page->article, texts, count);
	if (rc == -EFBIG)
		diagnostics_add(
			check->draft->diagnostics, -EINVAL, check->file, 0,
			"more than %d paragraphs, pictures and cells, or links: split the page",
			ARTICLE_BLOCKS_MAX);
	else if (rc == -EBADMSG)
		diagnostics_add(check->draft->diagnostics, -EINVAL, check->file, 1,
				"there is no text on this page: write some, or remove the file");
	return rc == -ENOMEM ? rc : 0;
}

void draft_name_page(const struct draft *draft, const char *name, uint32_t language,
		     char file[DRAFT_PAGE_NAME_BYTES])
{
	snprintf(file, DRAFT_PAGE_NAME_BYTES, "pages/%.64s.%.16s.html", name,
		 draft->options->languages[language]);
}

/* Reads a document that follows a page, which gets its pictures too. */
static int read_document(struct page_check *of, const char *name, uint32_t language,
			 struct draft_page *out)
{
	char file[DRAFT_PAGE_NAME_BYTES];
	struct page_check check = { of->draft, out, file, 0 };
	int rc;

	draft_name_page(of->draft, name, language, file);
	rc = read_page_file(&check);
	if (rc == 0 && out->html)
		rc = check_page(&check);
	if (rc == 0 && of->page->picture_count + out->picture_count > INFO_PAGE_PICTURES_MAX) {
		diagnostics_add(of->draft->diagnostics, -EINVAL, of->file, 0,
				"more than %d pictures with those of its documents: name fewer",
				INFO_PAGE_PICTURES_MAX);
		return 0;
	}
	for (uint32_t n = 0; rc == 0 && n < out->picture_count; n++)
		rc = note_picture(of, (int)out->pictures[n]);
	return rc;
}

/* Reads a part's page in a language: its own, and the documents that follow. found notes those that
 * are there. */
static int read_part_page(struct draft *draft, struct draft_part *part, uint32_t language,
			  bool found[DRAFT_DOCUMENTS_MAX])
{
	const uint32_t errors = draft->diagnostics->error_count;
	struct draft_page further[DRAFT_DOCUMENTS_MAX] = { 0 };
	struct bytes texts[1 + DRAFT_DOCUMENTS_MAX];
	struct draft_page *page = &part->pages[language];
	char file[DRAFT_PAGE_NAME_BYTES];
	struct page_check check = { draft, page, file, 0 };
	uint32_t count = 0;
	int rc;

	draft_name_page(draft, part->id, language, file);
	rc = read_page_file(&check);
	if (rc == 0 && page->html) {
		texts[count++] = (struct bytes){ (const uint8_t *)page->html, page->size };
		rc = check_page(&check);
	}
	for (uint32_t n = 0; rc == 0 && n < part->document_count; n++) {
		rc = read_document(&check, part->documents[n], language, &further[n]);
		found[n] |= further[n].html != NULL;
		if (further[n].html)
			texts[count++] =
				(struct bytes){ (const uint8_t *)further[n].html, further[n].size };
	}
	page->is_there = count > 0;
	if (rc == 0 && page->is_there && draft->diagnostics->error_count == errors)
		rc = compile_page(&check, texts, count);
	else if (rc == 0 && !page->is_there && part->expects_page)
		diagnostics_add(draft->diagnostics, language == 0 ? -EINVAL : 0, file, 0,
				language == 0 ? "is missing: write it, or give the part "
						"\"page\": false in parts.json"
					      : "is missing: the page in another language is "
						"shown instead");
	for (uint32_t n = 0; n < part->document_count; n++) {
		free(further[n].html);
		free(further[n].pictures);
	}
	return rc;
}

static int read_part_pages(struct draft *draft, struct draft_part *part)
{
	bool found[DRAFT_DOCUMENTS_MAX] = { false };

	for (uint32_t i = 0; i < draft->options->language_count; i++) {
		int rc = read_part_page(draft, part, i, found);

		if (rc == 0)
			rc = spoken_text_read(draft, part, i);
		if (rc < 0)
			return rc;
	}
	for (uint32_t n = 0; n < part->document_count; n++)
		if (!found[n])
			diagnostics_add(draft->diagnostics, -EINVAL, "parts.json", part->line,
					"part \"%s\": the document \"%s\" is not there: write "
					"pages/%s.%s.html, or take its name away",
					part->id, part->documents[n], part->documents[n],
					draft->options->languages[0]);
	return 0;
}

int draft_read_document(const struct draft *draft, const char *file, char **html)
{
	struct buffer text;
	int rc;

	*html = NULL;
	buffer_init(&text, HTML_BYTES_MAX + 1);
	rc = draft_read_text(draft, file, &text);
	if (rc == 0) {
		buffer_put_u8(&text, 0);
		rc = text.error;
	}
	if (rc == 0)
		*html = (char *)text.data; /* taken */
	else
		buffer_finish(&text);
	return rc == -ENOENT ? 0 : rc;
}

static bool has_known_ending(const char *ending)
{
	return strcmp(ending, ".html") == 0 || strcmp(ending, ".opus") == 0 ||
	       strcmp(ending, ".vtt") == 0;
}

/* Whether a file is a text in a language of the release, of a page of that name. */
static bool is_of(const struct draft *draft, const char *file, const char *name)
{
	const struct info_build_options *options = draft->options;
	const size_t size = strlen(name);

	if (strncmp(file, name, size) != 0 || file[size] != '.')
		return false;
	for (uint32_t i = 0; i < options->language_count; i++) {
		const size_t n = strlen(options->languages[i]);

		if (strncmp(file + size + 1, options->languages[i], n) == 0 &&
		    has_known_ending(file + size + 1 + n))
			return true;
	}
	return false;
}

static bool is_expected(const struct draft *draft, const char *file)
{
	for (uint32_t p = 0; p < draft->part_count; p++) {
		const struct draft_part *part = &draft->parts[p];

		if (is_of(draft, file, part->id))
			return true;
		for (uint32_t n = 0; n < part->document_count; n++)
			if (is_of(draft, file, part->documents[n]))
				return true;
	}
	return false;
}

/* Warns about pages that no part uses; most often the id is misspelt. */
static void find_stray_pages(struct draft *draft)
{
	struct dirent **entries = NULL;
	char path[PATH_MAX];
	int count;

	if (!draft_path(draft, path, sizeof(path), "pages"))
		return;
	count = scandir(path, &entries, NULL, alphasort);
	for (int i = 0; i < count; i++) {
		const char *name = entries[i]->d_name;
		char file[300];

		if (name[0] != '.' && !is_expected(draft, name)) {
			snprintf(file, sizeof(file), "pages/%s", name);
			diagnostics_add(
				draft->diagnostics, 0, file, 0,
				"belongs to no part and language of this release: name it "
				"ID.LANGUAGE.html (or .opus, .vtt) after a part of parts.json");
		}
		free(entries[i]);
	}
	free(entries);
}

int draft_read_pages(struct draft *draft)
{
	for (uint32_t i = 0; i < draft->part_count; i++) {
		int rc = read_part_pages(draft, &draft->parts[i]);

		if (rc < 0)
			return rc;
	}
	find_stray_pages(draft);
	return 0;
}
