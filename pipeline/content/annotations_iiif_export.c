/* Takes the place of each scan apart into a position, rotations and scales, and writes each part's
 * texts as a Choice of languages. */
#include "pipeline/content/annotations_iiif_export.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <glib.h>

#include "base/json_tree.h"
#include "pipeline/content/content.h"
#include "pipeline/content/info_pages.h"

struct maker {
	const struct draft *draft;
	const struct content *content;
	const char *base;  /* ends with a slash */
	const char *model; /* NULL: the scans */
	bool failed;       /* out of memory */
};

static void add(struct maker *m, cJSON *object, const char *key, cJSON *value)
{
	if (!(key ? json_add(object, key, value) : json_append(object, value)))
		m->failed = true;
}

static void add_text(struct maker *m, cJSON *object, const char *key, const char *text)
{
	add(m, object, key, cJSON_CreateString(text));
}

/* Adds an object, to an array if key is NULL. Returns NULL after a failure, which all here accept.
 */
static cJSON *add_object(struct maker *m, cJSON *parent, const char *key)
{
	cJSON *made = cJSON_CreateObject();

	add(m, parent, key, made);
	return m->failed ? NULL : made;
}

static cJSON *add_array(struct maker *m, cJSON *parent, const char *key)
{
	cJSON *made = cJSON_CreateArray();

	add(m, parent, key, made);
	return m->failed ? NULL : made;
}

/* Adds an object with that type, and the address base/folder/name as id. */
static cJSON *add_thing(struct maker *m, cJSON *parent, const char *key, const char *type,
			const char *folder, const char *name)
{
	cJSON *made = add_object(m, parent, key);
	char *escaped = g_uri_escape_string(name, "/", FALSE);
	char *id = g_strconcat(m->base, folder, escaped, NULL);

	add_text(m, made, "id", id);
	add_text(m, made, "type", type);
	g_free(id);
	g_free(escaped);
	return made;
}

static void add_point(struct maker *m, cJSON *list, const char *type, const double xyz[3])
{
	static const char *const axes[] = { "x", "y", "z" };
	cJSON *made = add_object(m, list, NULL);

	add_text(m, made, "type", type);
	for (int k = 0; k < 3; k++)
		add(m, made, axes[k], cJSON_CreateNumber(xyz[k] + 0.0)); /* no -0 */
}

/* Adds a target in the scene; xyz is NULL for the scene itself. */
static void add_target(struct maker *m, cJSON *annotation, const double xyz[3])
{
	cJSON *target = add_object(m, annotation, "target");

	add_text(m, target, "type", "SpecificResource");
	add_thing(m, add_array(m, target, "source"), NULL, "Scene", "", "scene");
	if (xyz)
		add_point(m, add_array(m, target, "selector"), "PointSelector", xyz);
}

static cJSON *add_annotation(struct maker *m, cJSON *items, const char *folder, const char *name,
			     const char *motivation)
{
	cJSON *made = add_thing(m, items, NULL, "Annotation", folder, name);

	add_text(m, add_array(m, made, "motivation"), NULL, motivation);
	return made;
}

static void add_label(struct maker *m, cJSON *to)
{
	cJSON *label = add_object(m, to, "label");

	add_text(m, add_array(m, label, m->draft->options->languages[0]), NULL, m->content->name);
}

/* ---- scans */

struct parts_of_place {
	double position[3], degrees[3], scale[3];
};

/* Computes the matrix from a scan's own axes and unit to metres with y up. */
static void place_of(const struct content *content, uint32_t scan, double out[3][4])
{
	/* the file's axis and its sign for each axis of the scene, by the file's up axis */
	static const struct {
		int axis, sign;
	} turns[3][3] = {
		[IMPORT_Z_UP] = { { 0, 1 }, { 2, 1 }, { 1, -1 } },
		[IMPORT_Y_UP] = { { 0, 1 }, { 1, 1 }, { 2, 1 } },
		[IMPORT_X_UP] = { { 1, 1 }, { 0, 1 }, { 2, -1 } },
	};
	static const double unmoved[3][4] = { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } };
	const struct transform *transform = content->transforms[scan];

	for (int r = 0; r < 3; r++) {
		const int axis = turns[content->import.up][r].axis;
		const double factor =
			turns[content->import.up][r].sign * content->import.metres_per_unit;

		for (int c = 0; c < 4; c++)
			out[r][c] =
				factor * (transform ? transform->rows[axis][c] : unmoved[axis][c]);
	}
}

static double degrees_of(double radians)
{
	const double degrees = radians * 180 / M_PI, whole = round(degrees);

	return fabs(degrees - whole) < 1e-9 ? whole : degrees;
}

/* Takes a matrix apart into T * Rx * Ry * Rz * S. Returns false if it shears. */
static bool take_apart(const double m[3][4], struct parts_of_place *out)
{
	double r[3][3], sign;

	for (int c = 0; c < 3; c++) {
		out->position[c] = m[c][3];
		out->scale[c] = sqrt(m[0][c] * m[0][c] + m[1][c] * m[1][c] + m[2][c] * m[2][c]);
		if (fabs(out->scale[c] - 1) < 1e-12)
			out->scale[c] = 1;
	}
	sign = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
	       m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
	       m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
	out->scale[0] = sign < 0 ? -out->scale[0] : out->scale[0];
	for (int i = 0; i < 3; i++)
		for (int c = 0; c < 3; c++)
			r[i][c] = m[i][c] / out->scale[c];
	for (int a = 0; a < 3; a++) {
		const int b = (a + 1) % 3;

		if (!(fabs(r[0][a] * r[0][b] + r[1][a] * r[1][b] + r[2][a] * r[2][b]) < 1e-6))
			return false;
	}
	out->degrees[1] = degrees_of(asin(fmax(-1, fmin(1, r[0][2]))));
	if (fabs(r[0][2]) < 1 - 1e-12) {
		out->degrees[0] = degrees_of(atan2(-r[1][2], r[2][2]));
		out->degrees[2] = degrees_of(atan2(-r[0][1], r[0][0]));
	} else { /* x and z turn about one axis */
		out->degrees[0] = degrees_of(atan2(r[2][1], r[1][1]));
		out->degrees[2] = 0;
	}
	return true;
}

static bool differs(const double xyz[3], double usual)
{
	return xyz[0] != usual || xyz[1] != usual || xyz[2] != usual;
}

static const char *format_of(const char *name)
{
	static const char *const formats[][2] = {
		{ ".glb", "model/gltf-binary" },
		{ ".gltf", "model/gltf+json" },
		{ ".obj", "model/obj" },
		{ ".stl", "model/stl" },
	};
	const char *dot = strrchr(name, '.');

	for (size_t i = 0; dot && i < G_N_ELEMENTS(formats); i++)
		if (g_ascii_strcasecmp(dot, formats[i][0]) == 0)
			return formats[i][1];
	return NULL;
}

static void add_model(struct maker *m, cJSON *parent, const char *key, const char *name)
{
	cJSON *model = add_thing(m, parent, key, "Model", "", name);

	if (format_of(name))
		add_text(m, model, "format", format_of(name));
}

static void add_scan(struct maker *m, cJSON *items, uint32_t scan)
{
	const char *name = m->content->scans[scan] + strlen(m->content->folder) + 1;
	struct parts_of_place parts;
	double matrix[3][4];
	cJSON *annotation, *body, *list;
	char number[16];

	place_of(m->content, scan, matrix);
	if (!take_apart(matrix, &parts)) {
		diagnostics_add(m->draft->diagnostics, 0, "temple.ini", 0,
				"scan %.200s is left out: its matrix shears, which a manifest "
				"cannot say; save the scan in its place",
				name);
		return;
	}
	snprintf(number, sizeof(number), "%u", scan + 1);
	annotation = add_annotation(m, items, "models/", number, "painting");
	if (differs(parts.degrees, 0) || differs(parts.scale, 1)) {
		body = add_object(m, annotation, "body");
		add_text(m, body, "type", "SpecificResource");
		add_model(m, add_array(m, body, "source"), NULL, name);
		list = add_array(m, body, "transform");
		if (differs(parts.scale, 1))
			add_point(m, list, "ScaleTransform", parts.scale);
		if (differs(parts.degrees, 0))
			add_point(m, list, "RotateTransform", parts.degrees);
	} else {
		add_model(m, annotation, "body", name);
	}
	add_target(m, annotation, differs(parts.position, 0) ? parts.position : NULL);
}

/* The model stands where the scans do: it is in metres, and y is up. */
static void add_one_model(struct maker *m, cJSON *items)
{
	cJSON *annotation = add_annotation(m, items, "models/", "1", "painting");

	add_model(m, annotation, "body", m->model);
	add_target(m, annotation, NULL);
}

/* ---- parts */

static const cJSON *member(const cJSON *object, const char *key)
{
	return cJSON_GetObjectItemCaseSensitive(object, key);
}

static void add_choice(struct maker *m, cJSON **choice, cJSON *bodies, const char *language,
		       const char *format, const char *text)
{
	cJSON *body;

	if (!text)
		return;
	if (!*choice) {
		cJSON *made = add_object(m, bodies, NULL);

		add_text(m, made, "type", "Choice");
		*choice = add_array(m, made, "items");
	}
	body = add_object(m, *choice, NULL);
	add_text(m, body, "type", "TextualBody");
	add_text(m, body, "value", text);
	add_text(m, body, "language", language);
	add_text(m, body, "format", format);
}

static void add_document(struct maker *m, cJSON *bodies, const char *name)
{
	const struct info_build_options *options = m->draft->options;
	cJSON *choice = NULL;

	for (uint32_t i = 0; i < options->language_count && !m->failed; i++) {
		char file[DRAFT_PAGE_NAME_BYTES];
		char *html;

		draft_name_page(m->draft, name, i, file);
		if (draft_read_document(m->draft, file, &html) < 0)
			m->failed = true;
		add_choice(m, &choice, bodies, options->languages[i], "text/html", html);
		free(html);
	}
}

/* The order says what each text is: the titles come first, further documents last. */
static void add_texts(struct maker *m, cJSON *annotation, const cJSON *part,
		      const struct draft_part *read)
{
	const struct info_build_options *options = m->draft->options;
	static const char *const keys[] = { "title", "caption" };
	cJSON *bodies = add_array(m, annotation, "body"), *page = NULL;

	for (size_t k = 0; k < G_N_ELEMENTS(keys); k++) {
		cJSON *choice = NULL;

		for (uint32_t i = 0; i < options->language_count && !m->failed; i++)
			add_choice(m, &choice, bodies, options->languages[i], "text/plain",
				   cJSON_GetStringValue(
					   member(member(part, keys[k]), options->languages[i])));
	}
	for (uint32_t i = 0; i < options->language_count && !m->failed; i++)
		add_choice(m, &page, bodies, options->languages[i], "text/html",
			   read->pages[i].html);
	for (uint32_t n = 0; n < read->document_count && !m->failed; n++)
		add_document(m, bodies, read->documents[n]);
}

/* The anchor as written, with the digits of parts.json; that of a region without one is computed.
 */
static void anchor_of(const cJSON *part, const struct draft_part *read, double y_up[3])
{
	const cJSON *written = member(part, "anchor");
	double xyz[3];

	if (!written)
		written = member(member(part, "region"), "centre");
	for (int k = 0; k < 3; k++) {
		const cJSON *number = cJSON_GetArrayItem(written, k);

		xyz[k] = number ? number->valuedouble : (double)read->anchor_m[k];
	}
	y_up[0] = xyz[0];
	y_up[1] = xyz[2];
	y_up[2] = -xyz[1];
}

static void tell_left_out(const struct maker *m, const cJSON *part, const struct draft_part *read)
{
	static const char *const keys[] = { "reading", "thumbnail", "credits" };
	const cJSON *region = member(part, "region");
	const char *kind = cJSON_GetStringValue(member(region, "kind"));

	if (region && (!kind || strcmp(kind, "point") != 0 || member(part, "anchor")))
		diagnostics_add(m->draft->diagnostics, 0, "parts.json", read->line,
				"part \"%s\": its region is left out: a manifest has the anchor",
				read->id);
	for (size_t i = 0; i < G_N_ELEMENTS(keys); i++)
		if (member(part, keys[i]))
			diagnostics_add(m->draft->diagnostics, 0, "parts.json", read->line,
					"part \"%s\": \"%s\" is left out: a manifest has no place "
					"for it",
					read->id, keys[i]);
}

static void add_part(struct maker *m, cJSON *items, const cJSON *part,
		     const struct draft_part *read)
{
	cJSON *annotation = add_annotation(m, items, "comments/", read->id, "commenting");
	double y_up[3];

	add_texts(m, annotation, part, read);
	anchor_of(part, read, y_up);
	add_target(m, annotation, y_up);
	tell_left_out(m, part, read);
}

/* ---- the manifest */

/* Returns the items of a page that is the only one of the list. */
static cJSON *add_page(struct maker *m, cJSON *scene, const char *key, const char *name)
{
	cJSON *page =
		add_thing(m, add_array(m, scene, key), NULL, "AnnotationPage", "pages/", name);

	return add_array(m, page, "items");
}

static void fill(struct maker *m, cJSON *manifest, const cJSON *json)
{
	cJSON *scene, *items;
	const cJSON *part;
	uint32_t i = 0;

	add_text(m, manifest, "@context", "http://iiif.io/api/presentation/4/context.json");
	add_text(m, manifest, "id", m->base);
	add_text(m, manifest, "type", "Manifest");
	add_label(m, manifest);
	scene = add_thing(m, add_array(m, manifest, "items"), NULL, "Scene", "", "scene");
	add_label(m, scene);
	items = add_page(m, scene, "items", "models");
	if (m->model)
		add_one_model(m, items);
	for (uint32_t scan = 0; !m->model && scan < m->content->scan_count && !m->failed; scan++)
		add_scan(m, items, scan);
	items = add_page(m, scene, "annotations", "comments");
	cJSON_ArrayForEach(part, member(json, "parts")) if (!m->failed)
		add_part(m, items, part, &m->draft->parts[i++]);
	if (m->draft->tour_count > 0)
		diagnostics_add(m->draft->diagnostics, 0, "tours.json", 0,
				"tours are left out: a manifest has no place for them");
	if (member(json, "credits"))
		diagnostics_add(m->draft->diagnostics, 0, "parts.json", 0,
				"the credits of all parts are left out: a manifest has no place "
				"for them");
}

int annotations_iiif_make(cJSON **out, const struct draft *draft, const cJSON *json,
			  const char *base, const char *model)
{
	struct maker m = { .draft = draft, .model = model };
	struct content *content = malloc(sizeof(*content));
	int rc = content ? content_read(content, draft->options->folder, draft->diagnostics)
			 : -ENOMEM;
	char *slashed;

	*out = NULL;
	if (rc < 0) {
		free(content);
		return rc == -ENOMEM ? rc : -EINVAL;
	}
	slashed = g_strconcat(base, g_str_has_suffix(base, "/") ? "" : "/", NULL);
	m.content = content;
	m.base = slashed;
	*out = cJSON_CreateObject();
	m.failed = *out == NULL;
	if (!m.failed)
		fill(&m, *out, json);
	if (m.failed) {
		cJSON_Delete(*out);
		*out = NULL;
		rc = -ENOMEM;
	}
	g_free(slashed);
	content_release(content);
	free(content);
	return rc;
}
