/* Converts parts.json, tours.json and pages/ to one annotation collection. Values are copied as
 * written in the folder (numbers keep their digits); info_build's own readers check them. */
#include "pipeline/content/annotations_export.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_tree.h"
#include "pipeline/content/annotations_iiif_export.h"
#include "pipeline/content/annotations_private.h"
#include "pipeline/content/draft.h"
#include "pipeline/content/info_pages.h"
#include "pipeline/content/info_parts.h"
#include "pipeline/content/info_tours.h"

/* Defines the terms that the W3C context lacks; see docs/annotations.md. */
static const char context[] =
	"[\"http://www.w3.org/ns/anno.jsonld\", {\"gopura\": \"https://gopura.example/ns#\","
	"\"Model\": \"gopura:Model\", \"reading\": \"gopura:reading\","
	"\"PointSelector\": \"gopura:PointSelector\","
	"\"SphereSelector\": \"gopura:SphereSelector\", \"BoxSelector\": \"gopura:BoxSelector\","
	"\"PrismSelector\": \"gopura:PrismSelector\","
	"\"FaceListSelector\": \"gopura:FaceListSelector\","
	"\"x\": \"gopura:x\", \"y\": \"gopura:y\", \"z\": \"gopura:z\","
	"\"centre\": {\"@id\": \"gopura:centre\", \"@container\": \"@list\"},"
	"\"half\": {\"@id\": \"gopura:half\", \"@container\": \"@list\"},"
	"\"corners\": {\"@id\": \"gopura:corners\", \"@container\": \"@list\"},"
	"\"radius\": \"gopura:radius\", \"turn\": \"gopura:turn\", \"floor\": \"gopura:floor\","
	"\"roof\": \"gopura:roof\", \"file\": \"gopura:file\", \"scan\": \"gopura:scan\","
	"\"tours\": {\"@id\": \"gopura:tours\", \"@type\": \"@json\"}}]";

/* cJSON's functions return NULL without memory. The failure is noted here and checked once. */
struct exporter {
	const struct draft *draft;
	bool failed;
};

static void add(struct exporter *e, cJSON *object, const char *key, cJSON *value)
{
	if (!json_add(object, key, value))
		e->failed = true;
}

static void append(struct exporter *e, cJSON *array, cJSON *value)
{
	if (!json_append(array, value))
		e->failed = true;
}

static void add_text(struct exporter *e, cJSON *object, const char *key, const char *text)
{
	add(e, object, key, cJSON_CreateString(text));
}

/* Adds an empty object, owned by its parent. Returns NULL after a failure; the functions here
 * accept that. */
static cJSON *add_object(struct exporter *e, cJSON *parent, const char *key)
{
	cJSON *made = cJSON_CreateObject();

	if (key)
		add(e, parent, key, made);
	else
		append(e, parent, made);
	return e->failed ? NULL : made;
}

/* ---- credits */

/* Texts by language become language-tagged strings. Where there are no parts, nobody has checked
 * that they are texts. */
static cJSON *tagged(struct exporter *e, const cJSON *said)
{
	cJSON *array;

	if (!cJSON_IsObject(said))
		return cJSON_Duplicate(said, true);
	array = cJSON_CreateArray();
	for (const cJSON *one = said->child; one && array; one = one->next) {
		cJSON *value = cJSON_IsString(one) ? add_object(e, array, NULL) : NULL;

		if (value) {
			add_text(e, value, "@value", one->valuestring);
			add_text(e, value, "@language", one->string);
		}
	}
	return array;
}

static void add_credits(struct exporter *e, cJSON *to, const cJSON *from)
{
	const cJSON *credits = cJSON_GetObjectItemCaseSensitive(from, "credits");

	for (size_t i = 0; i < ANNOTATION_ELEMENTS; i++) {
		const cJSON *said =
			cJSON_GetObjectItemCaseSensitive(credits, annotation_elements[i]);
		char term[40] = "dcterms:";

		strncat(term, annotation_elements[i], sizeof(term) - strlen(term) - 1);
		if (said)
			add(e, to, term, tagged(e, said));
	}
}

/* ---- the body */

/* id is NULL for what only this part says. */
static void add_body(struct exporter *e, cJSON *bodies, const char *id, const char *purpose,
		     const char *format, const char *language, const char *text)
{
	cJSON *body = add_object(e, bodies, NULL);

	if (!body)
		return;
	if (id)
		add_text(e, body, "id", id);
	add_text(e, body, "type", "TextualBody");
	add_text(e, body, "purpose", purpose);
	add_text(e, body, "format", format);
	add_text(e, body, "language", language);
	add_text(e, body, "value", text);
}

/* Adds a document in each language that it is in, after the part's own texts. */
static void add_document(struct exporter *e, cJSON *bodies, const char *name)
{
	const struct info_build_options *options = e->draft->options;

	for (uint32_t i = 0; i < options->language_count && !e->failed; i++) {
		char file[DRAFT_PAGE_NAME_BYTES];
		char *html;

		draft_name_page(e->draft, name, i, file);
		if (draft_read_document(e->draft, file, &html) < 0)
			e->failed = true;
		else if (html)
			add_body(e, bodies, file, "describing", "text/html", options->languages[i],
				 html);
		free(html);
	}
}

static void add_bodies(struct exporter *e, cJSON *item, const cJSON *part, uint32_t index)
{
	const struct info_build_options *options = e->draft->options;
	const struct draft_part *read = &e->draft->parts[index];
	cJSON *bodies = cJSON_CreateArray();

	add(e, item, "body", bodies);
	for (uint32_t i = 0; i < options->language_count && !e->failed; i++) {
		const char *language = options->languages[i];

		for (size_t t = 0; t < ANNOTATION_TEXTS; t++) {
			const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(
				cJSON_GetObjectItemCaseSensitive(part, annotation_texts[t].key),
				language));

			if (text)
				add_body(e, bodies, NULL, annotation_texts[t].purpose, "text/plain",
					 language, text);
		}
		if (read->pages[i].html)
			add_body(e, bodies, NULL, "describing", "text/html", language,
				 read->pages[i].html);
	}
	for (uint32_t n = 0; n < read->document_count && !e->failed; n++)
		add_document(e, bodies, read->documents[n]);
}

/* ---- the target */

static void add_point(struct exporter *e, cJSON *selectors, const cJSON *xyz)
{
	static const char *const axes[] = { "x", "y", "z" };
	cJSON *selector = add_object(e, selectors, NULL);

	if (!selector)
		return;
	add_text(e, selector, "type", "PointSelector");
	for (int i = 0; i < 3; i++)
		add(e, selector, axes[i], cJSON_Duplicate(cJSON_GetArrayItem(xyz, i), true));
}

/* Adds the region's selector. Returns false if no selector can express this kind of region. */
static bool add_region(struct exporter *e, cJSON *selectors, const cJSON *region)
{
	const char *kind = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(region, "kind"));
	cJSON *selector;

	if (!region)
		return true;
	if (kind && strcmp(kind, "point") == 0) {
		add_point(e, selectors, cJSON_GetObjectItemCaseSensitive(region, "centre"));
		return true;
	}
	for (size_t i = 0; kind && i < ANNOTATION_SELECTORS; i++) {
		const struct annotation_selector *ours = &annotation_selectors[i];

		if (strcmp(kind, ours->kind) != 0)
			continue;
		selector = add_object(e, selectors, NULL);
		if (selector)
			add_text(e, selector, "type", ours->type);
		for (size_t m = 0; selector && m < ANNOTATION_MEMBERS_MAX && ours->members[m];
		     m++) {
			const cJSON *member =
				cJSON_GetObjectItemCaseSensitive(region, ours->members[m]);

			if (member)
				add(e, selector, ours->members[m], cJSON_Duplicate(member, true));
		}
		return true;
	}
	return false;
}

static bool add_target(struct exporter *e, cJSON *item, const cJSON *part)
{
	const cJSON *anchor = cJSON_GetObjectItemCaseSensitive(part, "anchor");
	cJSON *target = add_object(e, item, "target"), *source, *selectors;
	bool known;

	if (!target)
		return true;
	add_text(e, target, "type", "SpecificResource");
	source = add_object(e, target, "source");
	if (source) {
		add_text(e, source, "id", "#model");
		add_text(e, source, "type", "Model");
	}
	selectors = cJSON_CreateArray();
	add(e, target, "selector", selectors);
	if (e->failed)
		return true;
	known = add_region(e, selectors, cJSON_GetObjectItemCaseSensitive(part, "region"));
	if (anchor)
		add_point(e, selectors, anchor);
	return known;
}

/* ---- the collection */

static void add_part(struct exporter *e, cJSON *items, const cJSON *part, uint32_t index)
{
	const struct draft_part *read = &e->draft->parts[index];
	cJSON *item = add_object(e, items, NULL), *thumbnail;
	char id[INFO_ID_BYTES_MAX + 2] = "#";

	if (!item)
		return;
	strncat(id, read->id, sizeof(id) - 2);
	add_text(e, item, "id", id);
	add_text(e, item, "type", "Annotation");
	add_text(e, item, "motivation", "describing");
	add_credits(e, item, part);
	if (read->thumbnail) {
		thumbnail = add_object(e, item, "schema:thumbnailUrl");
		if (thumbnail)
			add_text(e, thumbnail, "id", read->thumbnail);
	}
	add_bodies(e, item, part, index);
	if (!e->failed && !add_target(e, item, part))
		diagnostics_add(e->draft->diagnostics, -EINVAL, "parts.json", read->line,
				"part \"%s\": no selector says a region of its kind, see "
				"docs/annotations.md; give it a box, sphere or prism",
				read->id);
}

/* tours is the array of tours.json, which no other tool reads; NULL: none. */
static cJSON *make_collection(struct exporter *e, const cJSON *json, const cJSON *tours)
{
	cJSON *collection = cJSON_CreateObject(), *page, *items;
	const cJSON *part;
	uint32_t index = 0;

	if (!collection)
		return NULL;
	add(e, collection, "@context", cJSON_Parse(context));
	add_text(e, collection, "id", "#parts");
	add_text(e, collection, "type", "AnnotationCollection");
	add(e, collection, "total", cJSON_CreateNumber(e->draft->part_count));
	add_credits(e, collection, json);
	if (e->draft->tour_count > 0)
		add(e, collection, "tours", cJSON_Duplicate(tours, true));
	page = add_object(e, collection, "first");
	items = cJSON_CreateArray();
	if (page) {
		add_text(e, page, "id", "#page");
		add_text(e, page, "type", "AnnotationPage");
		add(e, page, "startIndex", cJSON_CreateNumber(0));
		add(e, page, "items", items);
	} else {
		cJSON_Delete(items);
	}
	cJSON_ArrayForEach(part, cJSON_GetObjectItemCaseSensitive(json, "parts"))
	{
		if (e->failed)
			break;
		add_part(e, items, part, index++);
	}
	if (e->failed) {
		cJSON_Delete(collection);
		return NULL;
	}
	return collection;
}

static int list_pictures(struct annotations *out, const struct draft *draft)
{
	out->pictures = calloc((size_t)draft->picture_count + 1, sizeof(*out->pictures));
	if (!out->pictures)
		return -ENOMEM;
	for (uint32_t i = 0; i < draft->picture_count; i++) {
		out->pictures[i] = strdup(draft->pictures[i].name);
		if (!out->pictures[i])
			return -ENOMEM;
		out->picture_count++;
	}
	return 0;
}

static int write_json(struct annotations *out, struct draft *draft, const cJSON *json,
		      const cJSON *tours, const struct annotations_export_options *options)
{
	struct exporter exporter = { .draft = draft };
	cJSON *made = NULL;
	int rc = 0;

	if (options->manifest_base)
		rc = annotations_iiif_make(&made, draft, json, options->manifest_base,
					   options->manifest_model);
	else
		made = make_collection(&exporter, json, tours);
	if (rc == 0)
		rc = made ? json_print(made, &out->json) : -ENOMEM;
	cJSON_Delete(made);
	out->count = draft->part_count;
	return rc;
}

/* Parses a file of the folder as JSON. The folder's own readers check its contents. */
static int read_json(cJSON **out, struct draft *draft, const char *name)
{
	struct buffer text;
	char path[PATH_MAX];
	int rc = -ENAMETOOLONG;

	*out = NULL;
	buffer_init(&text, INFO_PARTS_FILE_BYTES_MAX);
	if (draft_path(draft, path, sizeof(path), name))
		rc = buffer_read_file(&text, path);
	if (rc == 0)
		rc = json_parse(out, buffer_bytes(&text));
	buffer_finish(&text);
	return rc == -EBADMSG ? 0 : rc;
}

int annotations_export(struct annotations *out, const struct annotations_export_options *options)
{
	const char *languages[INFO_LANGUAGES_MAX] = { "en" };
	struct info_build_options build = { .folder = options->folder,
					    .languages = options->languages,
					    .language_count = options->language_count,
					    .diagnostics = options->diagnostics };
	struct draft draft = { .options = &build, .diagnostics = build.diagnostics };
	const uint32_t errors = build.diagnostics->error_count;
	cJSON *json, *tours = NULL;
	int rc = read_json(&json, &draft, "parts.json");

	*out = (struct annotations){ 0 };
	buffer_init(&out->json, ANNOTATIONS_BYTES_MAX);
	if (rc == 0 && !build.languages) {
		build.languages = languages;
		build.language_count = annotation_languages(json, languages);
		if (build.language_count == 0) /* there are only faults or no parts */
			build.language_count = 1;
	}
	if (rc == 0 && !draft_languages_are_sane(&build)) {
		diagnostics_add(
			draft.diagnostics, -EINVAL, "parts.json", 0,
			"titles are in more than %d languages, or in something that is not a "
			"language code: name those to take",
			INFO_LANGUAGES_MAX);
		rc = -EINVAL;
	}
	if (rc == 0)
		rc = draft_read_parts(&draft);
	if (rc == 0)
		rc = draft_read_tours(&draft);
	if (rc == 0 && draft.tour_count > 0)
		rc = read_json(&tours, &draft, "tours.json");
	if (rc == 0 && draft.part_count > 0)
		rc = draft_read_pages(&draft);
	if (rc == 0 && draft.diagnostics->error_count > errors)
		rc = -EINVAL;
	if (rc == 0)
		rc = write_json(out, &draft, json, cJSON_GetObjectItemCaseSensitive(tours, "tours"),
				options);
	if (rc == 0 && draft.diagnostics->error_count > errors)
		rc = -EINVAL;
	if (rc == 0)
		rc = list_pictures(out, &draft);
	if (rc < 0)
		annotations_finish(out);
	cJSON_Delete(json);
	cJSON_Delete(tours);
	draft_finish(&draft);
	return rc;
}
