/* Converts a file of annotations, ours or that of another tool, to parts.json, pages/ and
 * pictures/. Everything is read and checked before anything is written. info_build's own readers
 * then check the result; if they refuse it, it is removed again. */
#include "pipeline/content/annotations_import.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/json_tree.h"
#include "pipeline/content/annotations_iiif_import.h"
#include "pipeline/content/annotations_private.h"
#include "pipeline/content/annotations_write.h"
#include "pipeline/content/draft.h"
#include "pipeline/content/info_parts.h"
#include "pipeline/import/json.h"
#include "pipeline/import/manifest.h"

/* Of an annotation: every text, the page and all documents in all languages. */
enum { BODIES_MAX = (ANNOTATION_TEXTS + 1 + DRAFT_DOCUMENTS_MAX) * INFO_LANGUAGES_MAX };

static const char *item_id(const struct importer *im)
{
	const char *id = json_string(im->item, "id");

	return id ? id : "without id";
}

static void add(struct importer *im, cJSON *object, const char *key, cJSON *value)
{
	if (!json_add(object, key, value))
		im->failed = true;
}

/* Returns the object with that key; creates it if missing. NULL: no memory. */
static cJSON *object_of(struct importer *im, cJSON *parent, const char *key)
{
	cJSON *found = cJSON_GetObjectItemCaseSensitive(parent, key);

	if (found)
		return found;
	add(im, parent, key, cJSON_CreateObject());
	return cJSON_GetObjectItemCaseSensitive(parent, key);
}

/* ---- the id */

static bool is_taken(const struct importer *im, const char *id)
{
	for (const cJSON *other = im->parts->child; other; other = other->next)
		if (other != im->part && strcmp(json_string(other, "id"), id) == 0)
			return true;
	return false;
}

/* Appends the first of -2, -3, ... that no other part has. */
static void make_differ(const struct importer *im, char id[INFO_ID_BYTES_MAX + 1])
{
	const size_t size = strlen(id), room = INFO_ID_BYTES_MAX - 12;
	const size_t kept = size < room ? size : room;
	bool used[INFO_PARTS_MAX + 2] = { false };
	uint32_t n = 2;

	if (!is_taken(im, id))
		return;
	for (const cJSON *other = im->parts->child; other; other = other->next) {
		const char *taken = json_string(other, "id");

		if (other != im->part && strncmp(taken, id, kept) == 0 && taken[kept] == '-') {
			const long number = strtol(taken + kept + 1, NULL, 10);

			if (number >= 0 && number < (long)ARRAY_COUNT(used))
				used[number] = true;
		}
	}
	while (used[n]) /* there are fewer parts than numbers */
		n++;
	snprintf(id + kept, 13, "-%u", n);
}

/* Makes the part's id from the end of the IRI, after the last '#', '/' or ':', using only
 * characters that an id may contain. */
static void read_id(struct importer *im)
{
	const char *iri = json_string(im->item, "id");
	char id[INFO_ID_BYTES_MAX + 1];
	size_t size = 0;

	for (const char *p = iri; p && *p; p++) {
		if (*p == '#' || *p == '/' || *p == ':')
			size = 0;
		else if (size < INFO_ID_BYTES_MAX)
			id[size++] = *p >= 'A' && *p <= 'Z' ? (char)(*p + 32) : *p;
	}
	id[size] = 0;
	for (size_t i = 0; i < size; i++)
		if (!strchr("abcdefghijklmnopqrstuvwxyz0123456789-_", id[i]))
			id[i] = '-';
	if (size == 0)
		diagnostics_add(
			im->diagnostics, -EINVAL, im->options->file, im->line,
			"annotation without an id that can name a part: give it an \"id\" such as "
			"\"#gate\"");
	if (im->makes_ids && size > 0)
		make_differ(im, id);
	if (size > 0 && is_taken(im, id))
		diagnostics_add(im->diagnostics, -EINVAL, im->options->file, im->line,
				"annotation \"%.80s\": another one is part \"%s\" already: give it "
				"another \"id\"",
				iri, id);
	add(im, im->part, "id", cJSON_CreateString(id));
}

/* ---- credits */

static bool is_tagged(const cJSON *value)
{
	return json_string(value, "@value") && json_string(value, "@language");
}

/* Converts {"@value": ..., "@language": ...}, or a list of them, to texts by language. */
static cJSON *untagged(struct importer *im, const cJSON *said)
{
	cJSON *texts = cJSON_CreateObject();

	for (const cJSON *one = json_first(said); one && texts; one = json_next(said, one))
		if (is_tagged(one))
			add(im, texts, json_string(one, "@language"),
			    cJSON_CreateString(json_string(one, "@value")));
	return texts;
}

static cJSON *credit_of(struct importer *im, const cJSON *said)
{
	const cJSON *first = json_first(said);
	const char *name = json_string(first, "name"); /* of an agent, such as the W3C creator */

	if (first && is_tagged(first))
		return untagged(im, said);
	if (name)
		return cJSON_CreateString(name);
	if (json_string(first, "id"))
		return cJSON_CreateString(json_string(first, "id"));
	return cJSON_Duplicate(said, true);
}

/* Looks for dcterms:..., then dc:..., then the W3C's own creator and rights. */
static void read_credits(struct importer *im, const cJSON *from, cJSON *to)
{
	static const char *const prefixes[] = { "dcterms:", "dc:", "" };

	for (size_t i = 0; i < ANNOTATION_ELEMENTS; i++) {
		const char *element = annotation_elements[i];
		const cJSON *said = NULL;

		for (size_t p = 0; p < ARRAY_COUNT(prefixes) && !said; p++) {
			char term[40];

			if (p == 2 && strcmp(element, "creator") != 0 &&
			    strcmp(element, "rights") != 0)
				continue;
			snprintf(term, sizeof(term), "%s%s", prefixes[p], element);
			said = cJSON_GetObjectItemCaseSensitive(from, term);
		}
		if (said)
			add(im, object_of(im, to, "credits"), element, credit_of(im, said));
	}
}

/* ---- the body */

static void add_page(struct importer *im, const char *name, const char *language, const char *html,
		     bool is_document)
{
	struct page_file *page;

	if (ARRAY_RESERVE(im->pages, im->page_room, im->page_count + 1, UINT32_MAX) < 0) {
		im->failed = true;
		return;
	}
	page = &im->pages[im->page_count];
	*page = (struct page_file){ .html = html,
				    .item_id = item_id(im),
				    .line = im->line,
				    .position = im->page_count++,
				    .is_document = is_document };
	snprintf(page->name, sizeof(page->name), "pages/%s.%.16s.html", name, language);
}

static int compare_pages(const void *a, const void *b)
{
	const struct page_file *x = a, *y = b;
	const int order = strcmp(x->name, y->name);

	return order != 0 ? order : (x->position > y->position) - (x->position < y->position);
}

/* Leaves one page of each name. A document may come with each part that has it; its text is the
 * same then. */
static void settle_pages(struct importer *im)
{
	uint32_t kept = 0;

	if (im->page_count > 0)
		qsort(im->pages, im->page_count, sizeof(*im->pages), compare_pages);
	for (uint32_t i = 0; i < im->page_count; i++) {
		const struct page_file *page = &im->pages[i];
		const struct page_file *first = kept > 0 ? &im->pages[kept - 1] : NULL;

		if (!first || strcmp(first->name, page->name) != 0)
			im->pages[kept++] = *page;
		else if (strcmp(first->html, page->html) != 0 ||
			 !(page->is_document || first->is_document))
			diagnostics_add(im->diagnostics, -EINVAL, im->options->file, page->line,
					"annotation \"%.80s\": two texts for %s: leave one",
					page->item_id, page->name);
	}
	im->page_count = kept;
}

/* Takes "pages/NAME.LANGUAGE.html" apart. Returns false for other ids, of bodies that are the
 * part's own page. */
static bool is_document(const char *id, const char *language, char name[INFO_ID_BYTES_MAX + 1])
{
	char expected[DRAFT_PAGE_NAME_BYTES];
	const char *dot;

	if (!id || strncmp(id, "pages/", 6) != 0)
		return false;
	dot = strchr(id + 6, '.');
	if (!dot || dot - (id + 6) > INFO_ID_BYTES_MAX)
		return false;
	snprintf(name, INFO_ID_BYTES_MAX + 1, "%.*s", (int)(dot - (id + 6)), id + 6);
	snprintf(expected, sizeof(expected), "pages/%s.%.16s.html", name, language);
	return draft_is_id(name) && strcmp(id, expected) == 0;
}

/* Notes that the part has the document. */
static void name_document(struct importer *im, const char *name)
{
	cJSON *list = cJSON_GetObjectItemCaseSensitive(im->part, "documents");

	if (!list) {
		add(im, im->part, "documents", cJSON_CreateArray());
		list = cJSON_GetObjectItemCaseSensitive(im->part, "documents");
	}
	for (const cJSON *one = list ? list->child : NULL; one; one = one->next)
		if (strcmp(one->valuestring, name) == 0)
			return;
	if (list && !json_append(list, cJSON_CreateString(name)))
		im->failed = true;
}

static const char *key_of_purpose(const char *purpose)
{
	for (size_t i = 0; i < ANNOTATION_TEXTS; i++)
		if (strcmp(purpose, annotation_texts[i].purpose) == 0)
			return annotation_texts[i].key;
	if (strcmp(purpose, "tagging") == 0)
		return "title";
	return strcmp(purpose, "commenting") == 0 ? "caption" : NULL;
}

static bool is_language(const char *code)
{
	const struct info_build_options one = { .languages = &code, .language_count = 1 };

	return draft_languages_are_sane(&one);
}

static void read_body(struct importer *im, const cJSON *body)
{
	const char *value = cJSON_IsString(body) ? NULL : json_string(body, "value");
	const char *language = cJSON_GetStringValue(
		json_first(cJSON_GetObjectItemCaseSensitive(body, "language")));
	const char *purpose =
		cJSON_GetStringValue(json_first(cJSON_GetObjectItemCaseSensitive(body, "purpose")));
	const char *format = json_string(body, "format");
	const char *key = key_of_purpose(purpose ? purpose : "describing");
	char document[INFO_ID_BYTES_MAX + 1];

	if (!language)
		language = im->language;
	if (!value || !key) {
		diagnostics_add(
			im->diagnostics, 0, im->options->file, im->line,
			"annotation \"%.80s\": a body %s is left out: what is kept are "
			"TextualBody with purpose identifying, describing, commenting or tagging",
			item_id(im), value ? "of another purpose" : "without \"value\"");
		return;
	}
	if (!is_language(language)) {
		diagnostics_add(
			im->diagnostics, -EINVAL, im->options->file, im->line,
			"annotation \"%.80s\": \"%.40s\" is not a language code: write one such as \"en\"",
			item_id(im), language);
		return;
	}
	if (format && strcmp(format, "text/html") == 0) {
		if (is_document(json_string(body, "id"), language, document)) {
			add_page(im, document, language, value, true);
			name_document(im, document);
		} else {
			add_page(im, json_string(im->part, "id"), language, value, false);
			im->has_page = true;
		}
		return;
	}
	if (cJSON_HasObjectItem(object_of(im, im->part, key), language))
		diagnostics_add(im->diagnostics, -EINVAL, im->options->file, im->line,
				"annotation \"%.80s\": two %ss in \"%.16s\": leave one",
				item_id(im), key, language);
	else
		add(im, object_of(im, im->part, key), language, cJSON_CreateString(value));
}

static void read_bodies(struct importer *im)
{
	const cJSON *bodies = cJSON_GetObjectItemCaseSensitive(im->item, "body");
	const cJSON *body = json_first(bodies);

	im->has_page = false;
	for (uint32_t n = 0; n < BODIES_MAX && body && !im->failed; n++) {
		read_body(im, body);
		body = json_next(bodies, body);
	}
	if (body && !im->failed)
		diagnostics_add(im->diagnostics, -EINVAL, im->options->file, im->line,
				"annotation \"%.80s\" has over %d bodies, which are more than a "
				"part's texts and documents in %d languages: leave some out",
				item_id(im), BODIES_MAX, INFO_LANGUAGES_MAX);
	if (json_string(im->item, "bodyValue") && !bodies)
		diagnostics_add(im->diagnostics, 0, im->options->file, im->line,
				"annotation \"%.80s\": bodyValue is left out: write a TextualBody",
				item_id(im));
	if (!cJSON_HasObjectItem(im->part, "title"))
		diagnostics_add(
			im->diagnostics, -EINVAL, im->options->file, im->line,
			"annotation \"%.80s\" has no title: add a TextualBody with \"purpose\": "
			"\"identifying\"",
			item_id(im));
	if (!im->has_page)
		add(im, im->part, "page", cJSON_CreateFalse());
}

static void read_thumbnail(struct importer *im)
{
	const cJSON *said = cJSON_GetObjectItemCaseSensitive(im->item, "schema:thumbnailUrl");
	const char *name = cJSON_IsObject(said) ? json_string(said, "id") : NULL;

	if (name)
		add(im, im->part, "thumbnail", cJSON_CreateString(name));
	else if (said)
		diagnostics_add(im->diagnostics, 0, im->options->file, im->line,
				"annotation \"%.80s\": its thumbnail is left out: "
				"write {\"id\": \"pictures/NAME\"}",
				item_id(im));
}

/* ---- the target */

static cJSON *point_of(const struct importer *im, const cJSON *selector)
{
	const cJSON *x = cJSON_GetObjectItemCaseSensitive(selector, "x");
	const cJSON *y = cJSON_GetObjectItemCaseSensitive(selector, "y");
	const cJSON *z = cJSON_GetObjectItemCaseSensitive(selector, "z");
	double values[3];

	if (!cJSON_IsNumber(x) || !cJSON_IsNumber(y) || !cJSON_IsNumber(z))
		return NULL;
	values[0] = x->valuedouble;
	values[1] = im->y_is_up ? -z->valuedouble : y->valuedouble;
	values[2] = im->y_is_up ? y->valuedouble : z->valuedouble;
	return cJSON_CreateDoubleArray(values, 3);
}

static cJSON *region_of(struct importer *im, const cJSON *selector)
{
	const char *type = json_string(selector, "type");

	for (size_t i = 0; type && i < ANNOTATION_SELECTORS; i++) {
		const struct annotation_selector *ours = &annotation_selectors[i];
		cJSON *region;

		if (strcmp(type, ours->type) != 0)
			continue;
		region = cJSON_CreateObject();
		if (!region)
			return NULL;
		add(im, region, "kind", cJSON_CreateString(ours->kind));
		for (size_t m = 0; m < ANNOTATION_MEMBERS_MAX && ours->members[m]; m++) {
			const cJSON *member =
				cJSON_GetObjectItemCaseSensitive(selector, ours->members[m]);

			if (member)
				add(im, region, ours->members[m], cJSON_Duplicate(member, true));
		}
		return region;
	}
	return NULL;
}

/* Stores a point. If there are two, the first is the region and the last the anchor. */
static void take_point(struct importer *im, cJSON *point)
{
	cJSON *anchor = cJSON_DetachItemFromObjectCaseSensitive(im->part, "anchor");

	if (anchor && !cJSON_HasObjectItem(im->part, "region")) {
		cJSON *region = object_of(im, im->part, "region");

		add(im, region, "kind", cJSON_CreateString("point"));
		add(im, region, "centre", anchor);
	} else {
		cJSON_Delete(anchor);
	}
	add(im, im->part, "anchor", point);
}

static void read_selector(struct importer *im, const cJSON *selector)
{
	const char *type = json_string(selector, "type");
	cJSON *found;

	if (type && strcmp(type, "PointSelector") == 0) {
		found = point_of(im, selector);
		if (found)
			take_point(im, found);
		return;
	}
	found = region_of(im, selector);
	if (found && !cJSON_HasObjectItem(im->part, "region"))
		add(im, im->part, "region", found);
	else
		cJSON_Delete(found);
}

/* Returns false if the target does not say where on a model the part is. */
static bool read_target(struct importer *im)
{
	const cJSON *target = json_first(cJSON_GetObjectItemCaseSensitive(im->item, "target"));
	const cJSON *selectors = cJSON_GetObjectItemCaseSensitive(target, "selector");

	for (const cJSON *s = json_first(selectors); s && !im->failed; s = json_next(selectors, s))
		read_selector(im, s);
	if (cJSON_HasObjectItem(im->part, "region") || cJSON_HasObjectItem(im->part, "anchor"))
		return true;
	selectors = json_first(selectors);
	im->report->skipped_count += im->options->skip_unknown;
	diagnostics_add(
		im->diagnostics, !im->options->skip_unknown ? -EINVAL : 0, im->options->file,
		im->line,
		"annotation \"%.80s\": %s%.40s%s says no place on a model%s: use PointSelector with "
		"x, y and z, SphereSelector, BoxSelector, PrismSelector or FaceListSelector",
		item_id(im), selectors ? "selector \"" : "a target without selector",
		selectors && json_string(selectors, "type") ? json_string(selectors, "type") : "",
		selectors ? "\"" : "", im->options->skip_unknown ? ", left out" : "");
	return false;
}

/* ---- annotations */

/* Returns false if a release cannot have that many. */
static bool read_item(struct importer *im, const cJSON *item, unsigned line)
{
	im->item = item;
	im->line = line;
	if (im->report->part_count == INFO_PARTS_MAX) {
		diagnostics_add(im->diagnostics, -EINVAL, im->options->file, line,
				"from here on there are over %d annotations, and a release has at "
				"most as many parts: leave some out",
				INFO_PARTS_MAX);
		return false;
	}
	im->part = cJSON_CreateObject();
	if (!json_append(im->parts, im->part)) {
		im->failed = true;
		return false;
	}
	read_id(im);
	if (im->failed || !read_target(im)) {
		cJSON_DetachItemViaPointer(im->parts, im->part);
		cJSON_Delete(im->part);
		return true;
	}
	read_bodies(im);
	read_thumbnail(im);
	read_credits(im, item, im->part);
	im->report->part_count++;
	return true;
}

/* Finds the annotations in a collection, a page, a list, or a single annotation. Returns NULL after
 * reporting it. */
static const cJSON *find_items(struct importer *im, const cJSON *json)
{
	const cJSON *page = cJSON_GetObjectItemCaseSensitive(json, "first");

	if (cJSON_IsArray(json))
		return json;
	if (cJSON_IsString(page)) {
		diagnostics_add(
			im->diagnostics, -EINVAL, im->options->file, 1,
			"the collection's first page is elsewhere (\"%.80s\"): fetch it and import "
			"that file",
			page->valuestring);
		return NULL;
	}
	page = page ? page : json;
	if (cJSON_HasObjectItem(page, "next")) {
		diagnostics_add(im->diagnostics, -EINVAL, im->options->file, 1,
				"there are more pages than the first: put all \"items\" into one");
		return NULL;
	}
	if (cJSON_IsArray(cJSON_GetObjectItemCaseSensitive(page, "items")))
		return cJSON_GetObjectItemCaseSensitive(page, "items");
	if (cJSON_HasObjectItem(json, "target"))
		return json;
	diagnostics_add(
		im->diagnostics, -EINVAL, im->options->file, 1,
		"holds no annotations: write an AnnotationCollection whose \"first\" page has "
		"\"items\"");
	return NULL;
}

/* The texts of a page are borrowed from the annotations, which the importer owns therefore. */
static int read_comments(struct importer *im, const struct json_text *json)
{
	struct annotations_comments comments;
	int rc = annotations_iiif_convert(&comments, json, im->options, im->language);
	const cJSON *item;
	uint32_t i = 0;

	im->comments = comments.items;
	im->report->skipped_count += comments.skipped_count;
	im->y_is_up = false;
	im->makes_ids = true;
	cJSON_ArrayForEach(item, comments.items)
	{
		if (rc < 0 || im->failed || !read_item(im, item, comments.lines[i++]))
			break;
	}
	free(comments.lines);
	return rc;
}

static void read_items(struct importer *im, const struct json_text *json)
{
	const cJSON *items = find_items(im, json->root);

	if (!items)
		return;
	read_credits(im, json->root, im->parts_file);
	for (const cJSON *item = json_first(items); item && !im->failed;
	     item = json_next(items, item))
		if (!read_item(im, item, json_text_line(json, item)))
			return;
}

/* ---- the whole */

static int read_file(struct importer *im, struct json_text *json, struct buffer *text)
{
	const char *file = im->options->file;
	int rc = buffer_read_file(text, file);

	if (rc == 0)
		rc = json_text_parse(json, text, file, im->diagnostics);
	if (rc == 0 || rc == -ENOMEM)
		return rc;
	if (rc != -EBADMSG) /* which was reported */
		diagnostics_add(im->diagnostics, -EINVAL, file, 0, "cannot be read: %s",
				strerror(-rc));
	return -EINVAL;
}

static int import(struct importer *im)
{
	struct json_text json = { 0 };
	const uint32_t errors = im->diagnostics->error_count;
	struct buffer text;
	int rc;

	buffer_init(&text, ANNOTATIONS_BYTES_MAX);
	rc = read_file(im, &json, &text);
	if (rc == 0 && importer_has_room(im)) {
		im->parts_file = cJSON_CreateObject();
		add(im, im->parts_file, "parts", cJSON_CreateArray());
		im->parts = cJSON_GetObjectItemCaseSensitive(im->parts_file, "parts");
		if (im->parts && manifest_is(json.root))
			rc = read_comments(im, &json);
		else if (im->parts)
			read_items(im, &json);
		settle_pages(im);
		im->tours = cJSON_GetObjectItemCaseSensitive(json.root, "tours");
		if (im->failed)
			rc = -ENOMEM;
	}
	if (rc == 0 && im->diagnostics->error_count > errors)
		rc = -EINVAL;
	if (rc == 0)
		rc = importer_write(im);
	buffer_finish(&text);
	json_text_finish(&json);
	return rc;
}

int annotations_import(struct annotations_imported *out,
		       const struct annotations_import_options *options)
{
	struct importer im = { .options = options,
			       .diagnostics = options->diagnostics,
			       .report = out,
			       .language = options->language ? options->language : "en",
			       .y_is_up = options->y_is_up };
	int rc;

	*out = (struct annotations_imported){ 0 };
	rc = import(&im);
	cJSON_Delete(im.parts_file);
	cJSON_Delete(im.comments);
	free(im.pages);
	for (uint32_t i = 0; i < im.written_count; i++)
		free(im.written[i]);
	free(im.written);
	return rc;
}
