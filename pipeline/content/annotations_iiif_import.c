/* Gathers the texts of each comment by language, and places its point or polygon. */
#include "pipeline/content/annotations_iiif_import.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <glib.h>
#include <libxml/HTMLparser.h>

#include "base/json_tree.h"
#include "geometry/region.h"
#include "pipeline/import/json.h"
#include "pipeline/import/manifest.h"

enum { TITLE_CHARACTERS = 60, CORNERS_MAX = 4096, BODIES_DEEP = 8 };

/* The texts of a comment in one language. */
struct said {
	const char *language; /* borrowed */
	GString *title, *caption, *page;
	uint32_t count; /* of texts that were taken */
};

struct converter {
	struct annotations_comments *out;
	const struct annotations_import_options *options;
	const struct manifest *manifest;
	const char *language; /* of texts without one */
	bool failed;          /* out of memory */
	/* the comment that is being converted */
	const struct manifest_item *item;
	struct said said[INFO_LANGUAGES_MAX];
	uint32_t said_count;
};

static bool is_type(const cJSON *object, const char *type)
{
	const char *said = json_string(object, "type");

	return said && strcmp(said, type) == 0;
}

static const char *comment_id(const struct manifest_item *item)
{
	const char *id = json_string(item->annotation, "id");

	return id ? id : "without id";
}

#define warn(c, ...)                                                                               \
	diagnostics_add((c)->options->diagnostics, 0, (c)->options->file, (c)->item->line,         \
			__VA_ARGS__)

static void add(struct converter *c, cJSON *object, const char *key, cJSON *value)
{
	if (!json_add(object, key, value))
		c->failed = true;
}

static void append(struct converter *c, cJSON *array, cJSON *value)
{
	if (!json_append(array, value))
		c->failed = true;
}

/* ---- plain text of HTML */

/* Returns what follows the tag at html. Block elements part words. */
static const char *skip_tag(const char *html, GString *text)
{
	static const char *const inside_words[] = { "a",      "b",   "em",  "i", "span",
						    "strong", "sub", "sup", "u" };
	const char *name = html + 1 + (html[1] == '/');
	const size_t size = strcspn(name, " \t\r\n/>");
	const char *end = strchr(html, '>');
	bool parts_words = true;

	for (size_t i = 0; i < G_N_ELEMENTS(inside_words); i++)
		if (size == strlen(inside_words[i]) &&
		    strncasecmp(name, inside_words[i], size) == 0)
			parts_words = false;
	if (parts_words)
		g_string_append_c(text, ' ');
	return end ? end + 1 : html + strlen(html);
}

/* Returns what follows the entity at html; a lone & stands for itself. */
static const char *decode_entity(const char *html, GString *text)
{
	const size_t size = strcspn(html + 1, ";& <");
	char name[16] = "";
	unsigned long code = 0;

	if (html[1 + size] != ';' || size == 0 || size >= sizeof(name)) {
		g_string_append_c(text, '&');
		return html + 1;
	}
	memcpy(name, html + 1, size);
	if (name[0] == '#') {
		const bool is_hex = name[1] == 'x' || name[1] == 'X';

		code = strtoul(name + 1 + is_hex, NULL, is_hex ? 16 : 10);
	} else {
		const htmlEntityDesc *entity = htmlEntityLookup(BAD_CAST name);

		code = entity ? entity->value : 0;
	}
	if (code == 0 || !g_unichar_validate((gunichar)code) || code > 0x10ffff) {
		g_string_append_c(text, '&');
		return html + 1;
	}
	g_string_append_unichar(text, code == 0xa0 ? ' ' : (gunichar)code);
	return html + size + 2;
}

/* Makes white space one space each, with none at the ends. */
static void collapse(GString *text)
{
	gsize size = 0;

	for (gsize i = 0; i < text->len; i++) {
		const bool is_space = isspace((unsigned char)text->str[i]);

		if (!is_space)
			text->str[size++] = text->str[i];
		else if (size > 0 && text->str[size - 1] != ' ')
			text->str[size++] = ' ';
	}
	if (size > 0 && text->str[size - 1] == ' ')
		size--;
	g_string_truncate(text, size);
}

static GString *plain_of(const char *value, bool is_html)
{
	GString *text = g_string_new(NULL);

	while (is_html && *value)
		if (*value == '<' && (isalpha((unsigned char)value[1]) || strchr("/!", value[1])))
			value = skip_tag(value, text);
		else if (*value == '&')
			value = decode_entity(value, text);
		else
			g_string_append_c(text, *value++);
	if (!is_html)
		g_string_append(text, value);
	collapse(text);
	return text;
}

/* Cuts a text to the length of a title, at a word if there is one. Returns whether it was longer.
 */
static bool shorten(GString *text)
{
	const char *end, *space;

	if (g_utf8_strlen(text->str, -1) <= TITLE_CHARACTERS)
		return false;
	end = g_utf8_offset_to_pointer(text->str, TITLE_CHARACTERS - 1);
	space = end;
	while (space > text->str && *space != ' ')
		space--;
	g_string_truncate(text, (gsize)((space > text->str ? space : end) - text->str));
	g_string_append(text, "…");
	return true;
}

/* ---- the texts */

static struct said *said_in(struct converter *c, const char *language)
{
	for (uint32_t i = 0; i < c->said_count; i++)
		if (strcmp(c->said[i].language, language) == 0)
			return &c->said[i];
	if (c->said_count == INFO_LANGUAGES_MAX) {
		warn(c, "comment \"%.80s\": over %d languages: \"%.16s\" is left out",
		     comment_id(c->item), INFO_LANGUAGES_MAX, language);
		return NULL;
	}
	c->said[c->said_count] = (struct said){ .language = language };
	return &c->said[c->said_count++];
}

static void join(GString **to, const char *text, const char *between)
{
	if (!*to)
		*to = g_string_new(text);
	else
		g_string_append_printf(*to, "%s%s", between, text);
}

/* What a text may become: titles are cut to their length, unless other bodies say the rest. */
enum use { TITLE, WHOLE_TITLE, NO_TITLE };

/* The first text in a language is its title. What of it does not fit, and what the others say, is
 * the caption, or the page if it is HTML. */
static void take_text(struct converter *c, const char *value, const char *language, bool is_html,
		      enum use use)
{
	struct said *said = said_in(c, language);
	GString *text;
	bool is_longer;

	if (!said)
		return;
	text = plain_of(value, is_html);
	if (use != NO_TITLE && !said->title && text->len > 0) {
		is_longer = (use == TITLE && shorten(text)) ||
			    (is_html && (strstr(value, "<img") || strstr(value, "<a ")));
		said->title = text;
		text = NULL;
		if (!is_longer)
			value = NULL;
	}
	if (value && is_html)
		join(&said->page, value, "\n");
	else if (value)
		join(&said->caption, value, " ");
	if (text)
		g_string_free(text, TRUE);
	said->count++;
}

static void take_body(struct converter *c, const cJSON *body, enum use use, int depth)
{
	const char *value = json_string(body, "value"), *format = json_string(body, "format");
	const char *language = cJSON_GetStringValue(
		json_first(cJSON_GetObjectItemCaseSensitive(body, "language")));
	const cJSON *inner = NULL;

	if (is_type(body, "Choice"))
		inner = cJSON_GetObjectItemCaseSensitive(body, "items");
	else if (is_type(body, "SpecificResource"))
		inner = cJSON_GetObjectItemCaseSensitive(body, "source");
	if (cJSON_HasObjectItem(body, "position") || cJSON_HasObjectItem(body, "transform"))
		warn(c,
		     "comment \"%.80s\": where its label stands is left out: the kiosk shows it "
		     "beside the part",
		     comment_id(c->item));
	for (const cJSON *one = json_first(inner); one && depth < BODIES_DEEP;
	     one = json_next(inner, one))
		take_body(c, one, use, depth + 1);
	if (value)
		take_text(c, value, language ? language : c->language,
			  format && strcmp(format, "text/html") == 0, use);
	else if (!inner)
		warn(c, "comment \"%.80s\": a body of type \"%.40s\" is left out: texts are kept",
		     comment_id(c->item),
		     json_string(body, "type") ? json_string(body, "type") : "");
}

static void add_body(struct converter *c, cJSON *bodies, const struct said *said, GString **text,
		     const char *purpose, const char *format)
{
	cJSON *body = *text ? cJSON_CreateObject() : NULL;

	if (!*text)
		return;
	append(c, bodies, body);
	if (!c->failed) {
		add(c, body, "type", cJSON_CreateString("TextualBody"));
		add(c, body, "purpose", cJSON_CreateString(purpose));
		add(c, body, "format", cJSON_CreateString(format));
		add(c, body, "language", cJSON_CreateString(said->language));
		add(c, body, "value", cJSON_CreateString((*text)->str));
	}
	g_string_free(*text, TRUE);
	*text = NULL;
}

static void convert_texts(struct converter *c, cJSON *made)
{
	const cJSON *list = cJSON_GetObjectItemCaseSensitive(c->item->annotation, "body");
	const char *value = json_string(c->item->annotation, "bodyValue");
	const cJSON *body = json_first(list);
	cJSON *bodies = cJSON_CreateArray();
	/* a Choice before others has the title in every language */
	enum use use =
		body && is_type(body, "Choice") && json_next(list, body) ? WHOLE_TITLE : TITLE;

	c->said_count = 0;
	for (; body; body = json_next(list, body)) {
		take_body(c, body, use, 0);
		use = use == TITLE ? TITLE : NO_TITLE;
	}
	if (value)
		take_text(c, value, c->language, false, TITLE);
	add(c, made, "body", bodies);
	for (uint32_t i = 0; i < c->said_count; i++) {
		struct said *said = &c->said[i];

		if (c->failed) /* bodies is gone; the texts must go too */
			bodies = NULL;
		add_body(c, bodies, said, &said->title, "identifying", "text/plain");
		add_body(c, bodies, said, &said->caption, "describing", "text/plain");
		add_body(c, bodies, said, &said->page, "describing", "text/html");
	}
}

/* ---- the place */

struct polygon {
	double corners[CORNERS_MAX][3]; /* metres, z up */
	int count;
	double low[3], high[3], middle[3]; /* the middle is the mean of the corners */
};

/* Reads POLYGONZ((x y z, x y z, ...)), of which the last corner may repeat the first. */
static bool read_polygon(const struct converter *c, struct polygon *out, const char *text)
{
	const char *at = text ? strchr(text, '(') : NULL;
	bool is_more = at != NULL;

	out->count = 0;
	if (!at || strncasecmp(text, "POLYGON", 7) != 0)
		return false;
	at += strspn(at, "( \t\r\n");
	for (; is_more && out->count < CORNERS_MAX; out->count++) {
		double *corner = out->corners[out->count];

		for (int k = 0; k < 3; k++) {
			char *end;

			corner[k] = strtod(at, &end);
			if (end == at || !isfinite(corner[k]))
				return false;
			at = end;
		}
		transform_point(&c->item->place, corner, corner);
		manifest_z_up(corner, corner);
		at += strspn(at, " \t\r\n");
		is_more = *at == ',';
		at += is_more;
	}
	if (out->count > 1 &&
	    memcmp(out->corners[0], out->corners[out->count - 1], sizeof(out->corners[0])) == 0)
		out->count--;
	return *at == ')' && out->count >= 3;
}

static void measure(struct polygon *polygon)
{
	for (int k = 0; k < 3; k++) {
		polygon->low[k] = polygon->high[k] = polygon->corners[0][k];
		polygon->middle[k] = 0;
		for (int i = 0; i < polygon->count; i++) {
			polygon->low[k] = fmin(polygon->low[k], polygon->corners[i][k]);
			polygon->high[k] = fmax(polygon->high[k], polygon->corners[i][k]);
			polygon->middle[k] += polygon->corners[i][k] / polygon->count;
		}
	}
}

/* Returns whether the polygon lies rather than stands: its normal (Newell) is within 60 degrees of
 * the vertical. */
static bool lies(const struct polygon *polygon)
{
	double normal[3] = { 0, 0, 0 };

	for (int i = 0; i < polygon->count; i++) {
		const double *a = polygon->corners[i];
		const double *b = polygon->corners[(i + 1) % polygon->count];

		for (int k = 0; k < 3; k++)
			normal[k] += (a[(k + 1) % 3] - b[(k + 1) % 3]) *
				     (a[(k + 2) % 3] + b[(k + 2) % 3]);
	}
	return fabs(normal[2]) > 0 && 4 * normal[2] * normal[2] >= normal[0] * normal[0] +
									   normal[1] * normal[1] +
									   normal[2] * normal[2];
}

static void make_prism(struct converter *c, cJSON *selector, const struct polygon *polygon)
{
	const double height = polygon->high[2] - polygon->low[2];
	const double margin =
		fmax(fmax(polygon->high[0] - polygon->low[0], polygon->high[1] - polygon->low[1]),
		     height) /
		20;
	cJSON *corners = cJSON_CreateArray();

	add(c, selector, "type", cJSON_CreateString("PrismSelector"));
	add(c, selector, "floor", cJSON_CreateNumber(polygon->low[2] - margin));
	add(c, selector, "roof", cJSON_CreateNumber(polygon->high[2] + margin));
	add(c, selector, "corners", corners);
	for (int i = 0; i < polygon->count && !c->failed; i++)
		append(c, corners, cJSON_CreateDoubleArray(polygon->corners[i], 2));
}

static void make_sphere(struct converter *c, cJSON *selector, const struct polygon *polygon)
{
	double centre[3], radius = 0;

	for (int k = 0; k < 3; k++)
		centre[k] = (polygon->low[k] + polygon->high[k]) / 2;
	for (int i = 0; i < polygon->count; i++) {
		const double *p = polygon->corners[i];

		radius = fmax(radius,
			      hypot(hypot(p[0] - centre[0], p[1] - centre[1]), p[2] - centre[2]));
	}
	add(c, selector, "type", cJSON_CreateString("SphereSelector"));
	add(c, selector, "centre", cJSON_CreateDoubleArray(centre, 3));
	add(c, selector, "radius", cJSON_CreateNumber(radius));
}

/* Adds the polygon's region and sets its middle. Returns false if the text is no polygon. */
static bool convert_polygon(struct converter *c, cJSON *selectors, const char *text,
			    double middle[3])
{
	struct polygon *polygon = malloc(sizeof(*polygon));
	cJSON *selector;
	bool is_read;

	if (!polygon) {
		c->failed = true;
		return false;
	}
	is_read = read_polygon(c, polygon, text);
	if (is_read) {
		selector = cJSON_CreateObject();
		append(c, selectors, selector);
		measure(polygon);
		memcpy(middle, polygon->middle, sizeof(polygon->middle));
		if (!c->failed && polygon->count <= REGION_CORNERS_MAX && lies(polygon))
			make_prism(c, selector, polygon);
		else if (!c->failed)
			make_sphere(c, selector, polygon);
	}
	free(polygon);
	return is_read;
}

/* Returns false if the comment has no place on the scene's models. */
static bool convert_place(struct converter *c, cJSON *selectors, double place[3])
{
	static const char *const axes[] = { "x", "y", "z" };
	const cJSON *target =
		json_first(cJSON_GetObjectItemCaseSensitive(c->item->annotation, "target"));
	const cJSON *list = cJSON_GetObjectItemCaseSensitive(target, "selector");
	bool is_found = false;
	cJSON *point;

	for (const cJSON *s = json_first(list); s && !is_found; s = json_next(list, s)) {
		if (is_type(s, "PolygonZSelector")) {
			is_found = convert_polygon(c, selectors, json_string(s, "value"), place);
		} else if (manifest_point(s, place)) {
			transform_point(&c->item->place, place, place);
			manifest_z_up(place, place);
			is_found = true;
		}
	}
	if (!is_found || !isfinite(place[0]) || !isfinite(place[1]) || !isfinite(place[2]))
		return false;
	point = cJSON_CreateObject();
	append(c, selectors, point);
	if (c->failed)
		return true;
	add(c, point, "type", cJSON_CreateString("PointSelector"));
	for (int k = 0; k < 3; k++)
		add(c, point, axes[k], cJSON_CreateNumber(place[k]));
	return true;
}

/* ---- the comment */

/* Other members than these, such as creator and rights, are read as those of any annotation. */
static cJSON *begin_annotation(struct converter *c)
{
	static const char *const converted[] = { "body", "bodyValue", "target" };
	cJSON *made = cJSON_Duplicate(c->item->annotation, true);

	for (size_t i = 0; made && i < G_N_ELEMENTS(converted); i++)
		while (json_member(made, converted[i])) /* a key may be there twice */
			cJSON_DeleteItemFromObjectCaseSensitive(made, converted[i]);
	if (made && !json_string(made, "id")) {
		cJSON_DeleteItemFromObjectCaseSensitive(made, "id");
		add(c, made, "id", cJSON_CreateString("#comment"));
	}
	c->failed |= made == NULL;
	return made;
}

/* Says where the camera stands whose lookAt is the comment, or that is the only one. */
static void tell_camera(struct converter *c, const double place[3])
{
	const struct manifest_item *found = NULL;
	const char *id = json_string(c->item->annotation, "id");
	uint32_t cameras = 0;
	double eye[3], target[3];

	for (uint32_t i = 0; i < c->manifest->count; i++) {
		const struct manifest_item *item = &c->manifest->items[i];
		const char *look_at;

		if (item->kind != MANIFEST_CAMERA)
			continue;
		look_at = json_string(cJSON_GetObjectItemCaseSensitive(item->resource, "lookAt"),
				      "id");
		if (cameras++ == 0 || (id && look_at && strcmp(id, look_at) == 0))
			found = item;
		if (id && look_at && strcmp(id, look_at) == 0) {
			cameras = 1;
			break;
		}
	}
	if (cameras != 1)
		return;
	manifest_view(c->manifest, found, eye, target);
	manifest_z_up(eye, eye);
	warn(c,
	     "comment \"%.80s\": the camera it is read from is left out, as a part has none: write "
	     "'start = eye %g %g %g target %g %g %g' into [view] of temple.ini, or a stop with "
	     "\"eye\" into tours.json",
	     comment_id(c->item), eye[0], eye[1], eye[2], place[0], place[1], place[2]);
}

static void convert_comment(struct converter *c)
{
	cJSON *made = begin_annotation(c), *target = cJSON_CreateObject();
	cJSON *selectors = cJSON_CreateArray();
	double place[3];

	add(c, target, "selector", selectors);
	if (c->failed || !convert_place(c, selectors, place)) {
		if (!c->failed)
			warn(c,
			     "comment \"%.80s\" is left out: its target names no place; give it a "
			     "PointSelector, or a PolygonZSelector with POLYGONZ((x y z, ...))",
			     comment_id(c->item));
		c->out->skipped_count++;
		cJSON_Delete(target);
		cJSON_Delete(made);
		return;
	}
	add(c, made, "target", target);
	convert_texts(c, made);
	if (cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(made, "body")) == 0 && !c->failed) {
		warn(c, "comment \"%.80s\" is left out: it has no text", comment_id(c->item));
		c->out->skipped_count++;
		cJSON_Delete(made);
		return;
	}
	tell_camera(c, place);
	c->out->lines[cJSON_GetArraySize(c->out->items)] = c->item->line;
	append(c, c->out->items, made);
}

static void tell_left_out(const struct converter *c)
{
	const struct diagnostics *list = &c->manifest->left_out;

	for (uint32_t i = 0; i < list->count; i++) {
		const struct diagnostic *one = diagnostics_get(list, i);

		diagnostics_add(c->options->diagnostics, 0, c->options->file, one->line, "%s",
				one->text + one->place_bytes);
	}
}

static int convert(struct converter *c)
{
	const struct manifest *manifest = c->manifest;
	uint32_t comments = 0;

	tell_left_out(c);
	for (uint32_t i = 0; i < manifest->count; i++)
		comments += manifest->items[i].kind == MANIFEST_COMMENT;
	if (comments == 0)
		return diagnostics_add(c->options->diagnostics, -EINVAL, c->options->file, 1,
				       "the manifest has no comments; its models are imported by "
				       "'scans = NAME.json' in temple.ini");
	c->out->items = cJSON_CreateArray();
	c->out->lines = calloc(comments, sizeof(*c->out->lines));
	c->failed = !c->out->items || !c->out->lines;
	for (uint32_t i = 0; i < manifest->count && !c->failed; i++) {
		c->item = &manifest->items[i];
		if (c->item->kind == MANIFEST_COMMENT)
			convert_comment(c);
	}
	return c->failed ? -ENOMEM : 0;
}

int annotations_iiif_convert(struct annotations_comments *out, const struct json_text *json,
			     const struct annotations_import_options *options, const char *language)
{
	struct manifest manifest;
	struct converter *c = calloc(1, sizeof(*c));
	int rc = -ENOMEM;

	*out = (struct annotations_comments){ 0 };
	if (!c)
		return -ENOMEM;
	*c = (struct converter){
		.out = out, .options = options, .manifest = &manifest, .language = language
	};
	rc = manifest_read(&manifest, json, options->file, options->diagnostics);
	if (rc == 0)
		rc = convert(c);
	manifest_finish(&manifest);
	free(c);
	if (rc < 0) {
		cJSON_Delete(out->items);
		free(out->lines);
		*out = (struct annotations_comments){ 0 };
	}
	return rc == 0 || rc == -ENOMEM ? rc : -EINVAL;
}
