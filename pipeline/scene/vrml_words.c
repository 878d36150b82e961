/* Lays each string out as one line at a size of LAYOUT_SIZE, takes the outline of its letters, and
 * scales what fills it to the size that FontStyle says. */
#include "pipeline/scene/vrml_words.h"

#include <errno.h>
#include <math.h>
#include <pango/pangocairo.h>
#include <string.h>

#include "pipeline/scene/vrml_trim.h"

enum { STRINGS_MAX = 1024, STRING_BYTES_MAX = 1024, LAYOUT_SIZE = 100 };

#define TOLERANCE 0.4 /* of curves, in units of the layout */

struct style {
	char font[80]; /* as Pango has it, without a size */
	float size, spacing;
	const char *major, *minor; /* "BEGIN", "MIDDLE", "END"; minor also "FIRST" */
	const char *language;      /* or NULL */
};

struct words {
	struct soup *soup;
	const struct vrml_node *node;
	const uint8_t *rgb;
	struct diagnostics *diagnostics;
	struct style style;
	cairo_t *cairo; /* owned */
	PangoLayout *layout;
	struct trim_edge edges[TRIM_EDGES_MAX];
	uint32_t edge_count;
	/* of the line that is added: */
	float from[2], stretch; /* x is times stretch too */
};

static const char *string_of(const struct vrml_node *node, const char *field, uint32_t at,
			     const char *otherwise)
{
	const struct vrml_value *value = node ? vrml_get(node, field) : NULL;

	return value && at < value->count && *value->strings[at] ? value->strings[at] : otherwise;
}

static void read_style(struct style *out, const struct vrml_node *text)
{
	const struct vrml_node *font = vrml_get_node(text, "fontStyle");
	const char *family, *style;

	if (font && strcmp(font->type->name, "FontStyle") != 0)
		font = NULL;
	family = string_of(font, "family", 0, "SERIF");
	style = string_of(font, "style", 0, "PLAIN");
	snprintf(out->font, sizeof(out->font), "%.40s%s%s",
		 strcmp(family, "SERIF") == 0        ? "Serif"
		 : strcmp(family, "SANS") == 0       ? "Sans"
		 : strcmp(family, "TYPEWRITER") == 0 ? "Monospace"
						     : family,
		 strstr(style, "BOLD") ? " Bold" : "", strstr(style, "ITALIC") ? " Italic" : "");
	out->size = font ? vrml_get_float(font, "size", 1) : 1;
	out->spacing = font ? vrml_get_float(font, "spacing", 1) : 1;
	out->major = string_of(font, "justify", 0, "BEGIN");
	out->minor = string_of(font, "justify", 1, "FIRST");
	out->language = string_of(font, "language", 0, NULL);
}

static int fault(const struct words *words, const char *what)
{
	return diagnostics_add(words->diagnostics, -EBADMSG, words->node->file, words->node->line,
			       "Text %s", what);
}

/* ---- outlines */

static int add_edge(struct words *words, const double from[2], const double to[2])
{
	struct trim_edge *edge;

	if (from[0] == to[0] && from[1] == to[1])
		return 0;
	if (words->edge_count == TRIM_EDGES_MAX)
		return fault(words, "has a string with too many letters; split it into several");
	edge = &words->edges[words->edge_count++];
	memcpy(edge->from, from, sizeof(edge->from));
	memcpy(edge->to, to, sizeof(edge->to));
	return 0;
}

/* Takes the contours of the layout, y up and 0 at the baseline. */
static int take_outline(struct words *words)
{
	double first[2] = { 0 }, at[2] = { 0 };
	cairo_path_t *path;
	int rc = 0;

	words->edge_count = 0;
	cairo_new_path(words->cairo);
	cairo_move_to(words->cairo, 0, 0);
	pango_cairo_layout_line_path(words->cairo,
				     pango_layout_get_line_readonly(words->layout, 0));
	path = cairo_copy_path_flat(words->cairo);
	if (path->status != CAIRO_STATUS_SUCCESS)
		rc = -ENOMEM;
	for (int i = 0; i < path->num_data && rc == 0; i += path->data[i].header.length) {
		const cairo_path_data_t *data = &path->data[i];
		double to[2] = { first[0], first[1] };

		if (data->header.type == CAIRO_PATH_MOVE_TO ||
		    data->header.type == CAIRO_PATH_LINE_TO) {
			to[0] = data[1].point.x;
			to[1] = -data[1].point.y;
		}
		/* A contour that was left open is closed. */
		rc = data->header.type == CAIRO_PATH_MOVE_TO ? add_edge(words, at, first)
							     : add_edge(words, at, to);
		if (data->header.type == CAIRO_PATH_MOVE_TO)
			memcpy(first, to, sizeof(first));
		memcpy(at, to, sizeof(at));
	}
	if (rc == 0)
		rc = add_edge(words, at, first);
	cairo_path_destroy(path);
	return rc;
}

static int add_triangle(void *data, const double a[2], const double b[2], const double c[2])
{
	struct words *words = data;
	const double *places[] = { a, b, c };
	const float scale = words->style.size / LAYOUT_SIZE;
	struct soup_corner corners[3] = { 0 };

	for (int i = 0; i < 3; i++) {
		corners[i].position[0] =
			words->from[0] + words->stretch * scale * (float)places[i][0];
		corners[i].position[1] = words->from[1] + scale * (float)places[i][1];
		memcpy(corners[i].rgb, words->rgb, 3);
	}
	return soup_add(words->soup, corners, 3);
}

/* ---- lines */

/* Sets the string, and returns its width in the node's metres. */
static int lay_out(struct words *words, const char *string, float *width)
{
	PangoRectangle logical;

	if (strlen(string) > STRING_BYTES_MAX || !g_utf8_validate(string, -1, NULL))
		return fault(words, "has a string that is not UTF-8, or over 1024 bytes; correct "
				    "it");
	pango_layout_set_text(words->layout, string, -1);
	pango_layout_get_extents(words->layout, NULL, &logical);
	*width = (float)logical.width / PANGO_SCALE * words->style.size / LAYOUT_SIZE;
	return 0;
}

static float share_of(const char *justify)
{
	return strcmp(justify, "MIDDLE") == 0 ? 0.5f : strcmp(justify, "END") == 0 ? 1 : 0;
}

/* How far the first baseline is above 0. */
static float top_of(const struct style *style, uint32_t lines)
{
	const float block = style->size * style->spacing * (float)(lines - 1) + style->size;

	if (strcmp(style->minor, "FIRST") == 0)
		return 0;
	return share_of(style->minor) * block - 0.8f * style->size; /* what is above a baseline */
}

static int add_line(struct words *words, const struct vrml_value *strings, uint32_t at,
		    float longest)
{
	const struct vrml_value *lengths = vrml_get(words->node, "length");
	const float most = vrml_get_float(words->node, "maxExtent", 0);
	const float told = lengths && at < lengths->count ? lengths->floats[at] : 0;
	float width;
	int rc = lay_out(words, strings->strings[at], &width);

	if (rc < 0 || !(width > 0))
		return rc;
	words->stretch = told > 0 ? told / width : 1;
	if (most > 0 && longest > most)
		words->stretch *= most / longest;
	words->from[0] = -share_of(words->style.major) * words->stretch * width;
	words->from[1] = top_of(&words->style, strings->count) -
			 words->style.size * words->style.spacing * (float)at;
	rc = take_outline(words);
	return rc < 0 ? rc : trim_triangles(words->edges, words->edge_count, add_triangle, words);
}

static int add_lines(struct words *words, const struct vrml_value *strings)
{
	float longest = 0, width;
	int rc = 0;

	if (strings->count > STRINGS_MAX)
		return fault(words, "has over 1024 strings; split it into several");
	for (uint32_t i = 0; i < strings->count && rc == 0; i++) {
		rc = lay_out(words, strings->strings[i], &width);
		longest = rc == 0 ? fmaxf(longest, width) : longest;
	}
	for (uint32_t i = 0; i < strings->count && rc == 0; i++)
		rc = add_line(words, strings, i, longest);
	return rc;
}

/* Letters are not fitted to pixels. */
static void set_font(struct words *words)
{
	PangoFontDescription *font = pango_font_description_from_string(words->style.font);
	PangoContext *context = pango_layout_get_context(words->layout);
	cairo_font_options_t *options = cairo_font_options_create();

	pango_font_description_set_absolute_size(font, (double)LAYOUT_SIZE * PANGO_SCALE);
	pango_layout_set_font_description(words->layout, font);
	pango_font_description_free(font);
	cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
	cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
	pango_cairo_context_set_font_options(context, options);
	cairo_font_options_destroy(options);
	if (words->style.language && g_utf8_validate(words->style.language, -1, NULL))
		pango_context_set_language(context,
					   pango_language_from_string(words->style.language));
	pango_layout_set_single_paragraph_mode(words->layout, true);
}

int vrml_words_add(struct soup *soup, const struct vrml_node *text, const uint8_t rgb[3],
		   struct diagnostics *diagnostics)
{
	const struct vrml_value *strings = vrml_get(text, "string");
	cairo_surface_t *surface;
	struct words *words;
	int rc;

	if (!strings || strings->count == 0)
		return 1;
	words = g_try_new0(struct words, 1);
	if (!words)
		return -ENOMEM;
	words->soup = soup;
	words->node = text;
	words->rgb = rgb;
	words->diagnostics = diagnostics;
	read_style(&words->style, text);
	surface = cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1);
	words->cairo = cairo_create(surface);
	cairo_surface_destroy(surface);
	cairo_set_tolerance(words->cairo, TOLERANCE);
	words->layout = pango_cairo_create_layout(words->cairo);
	set_font(words);
	rc = isfinite(words->style.size) && words->style.size > 0
		     ? add_lines(words, strings)
		     : fault(words, "has a size that is not above 0; correct its FontStyle");
	g_object_unref(words->layout);
	cairo_destroy(words->cairo);
	g_free(words);
	return rc < 0 ? rc : 1;
}
