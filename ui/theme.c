/* Colours, type styles and fonts of the interface, and Pango layouts made from them. */
#include "ui/theme.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ui/languages.h"

#define LINE_HEIGHT_MAX 1.5 /* of a single line, in multiples of its type size */

#define RGB(r, g, b)                                                                               \
	{                                                                                          \
		(r) / 255.0, (g) / 255.0, (b) / 255.0                                              \
	}

const struct colour theme_paper = RGB(248, 244, 236);
const struct colour theme_paper_shade = RGB(236, 229, 217);
const struct colour theme_ink = RGB(43, 37, 32);
const struct colour theme_ink_soft = RGB(106, 95, 84);
const struct colour theme_line = RGB(214, 204, 189);
const struct colour theme_accent = RGB(158, 72, 38); /* laterite */
const struct colour theme_night = RGB(28, 25, 22);
const struct colour theme_night_text = RGB(246, 240, 230);

/* Each script is named: fonts that the system would choose have another weight and line height. */
static const char serif[] =
	"Noto Serif, Noto Serif Khmer, Noto Serif CJK JP, Noto Naskh Arabic, Noto Serif Thai, "
	"Noto Serif Devanagari, Noto Serif Lao, Noto Serif Myanmar, Noto Serif Hebrew, "
	"Noto Serif Tamil";
static const char sans[] =
	"Noto Sans, Noto Sans Khmer, Noto Sans CJK JP, Noto Sans Arabic, Noto Sans Thai, "
	"Noto Sans Devanagari, Noto Sans Lao, Noto Sans Myanmar, Noto Sans Hebrew, Noto Sans Tamil";

static const struct {
	const char *families;
	float size_mm; /* size of the em */
	PangoWeight weight;
	bool italic;
	float line_spacing;
} styles[TEXT_STYLE_COUNT] = {
	[TEXT_LABEL] = { sans, 4.0f, PANGO_WEIGHT_MEDIUM, false, 1.0f },
	[TEXT_TITLE] = { serif, 5.6f, PANGO_WEIGHT_SEMIBOLD, false, 1.05f },
	[TEXT_CAPTION] = { sans, 4.0f, PANGO_WEIGHT_NORMAL, false, 1.1f },
	[TEXT_BUTTON] = { sans, 3.9f, PANGO_WEIGHT_MEDIUM, false, 1.0f },
	[TEXT_BODY] = { sans, 4.5f, PANGO_WEIGHT_NORMAL, false, 1.2f },
	[TEXT_HEADING_1] = { serif, 8.4f, PANGO_WEIGHT_SEMIBOLD, false, 1.05f },
	[TEXT_HEADING_2] = { serif, 6.2f, PANGO_WEIGHT_SEMIBOLD, false, 1.05f },
	[TEXT_HEADING_3] = { sans, 4.9f, PANGO_WEIGHT_SEMIBOLD, false, 1.05f },
	[TEXT_QUOTE] = { serif, 4.8f, PANGO_WEIGHT_NORMAL, true, 1.2f },
	[TEXT_FIGURE] = { sans, 3.7f, PANGO_WEIGHT_NORMAL, false, 1.1f },
	[TEXT_CELL] = { sans, 4.1f, PANGO_WEIGHT_NORMAL, false, 1.1f },
};

/* Corrections for scripts whose letters are small in their em, or whose fonts leave room for marks
 * that few texts have. Not used for controls, where texts of several languages stand side by
 * side. */
static const struct {
	const char language[3];
	float size, line;
} scripts[] = {
	{ "km", 1.1f, 1 },     { "th", 1.1f, 1 },     { "hi", 1.05f, 1 },
	{ "ar", 1.1f, 0.72f }, { "fa", 1.1f, 0.72f }, { "ur", 1.1f, 0.8f },
};

static float script_size(const struct theme *theme)
{
	for (size_t i = 0; i < ARRAY_COUNT(scripts); i++)
		if (languages_is(theme->language, scripts[i].language))
			return scripts[i].size;
	return 1;
}

static float script_line(const struct theme *theme)
{
	for (size_t i = 0; i < ARRAY_COUNT(scripts); i++)
		if (languages_is(theme->language, scripts[i].language))
			return scripts[i].line;
	return 1;
}

int theme_init(struct theme *theme, float px_per_mm, const char *language)
{
	cairo_font_options_t *options;

	memset(theme, 0, sizeof(*theme));
	theme->px_per_mm = px_per_mm;
	theme->text_scale = 1;
	theme->context = pango_font_map_create_context(pango_cairo_font_map_get_default());
	if (!theme->context)
		return -ENOMEM;
	/* Textures move by fractions of a pixel. So antialiasing is grey, without sub-pixel
	 * colours. */
	options = cairo_font_options_create();
	cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
	cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_SLIGHT);
	cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
	pango_cairo_context_set_font_options(theme->context, options);
	cairo_font_options_destroy(options);
	pango_context_set_round_glyph_positions(theme->context, FALSE);
	theme_set_language(theme, language);
	return 0;
}

void theme_finish(struct theme *theme)
{
	if (!theme)
		return;
	if (theme->context)
		g_object_unref(theme->context);
	memset(theme, 0, sizeof(*theme));
}

void theme_set_language(struct theme *theme, const char *language)
{
	snprintf(theme->language, sizeof(theme->language), "%s", language);
	pango_context_set_language(theme->context, pango_language_from_string(theme->language));
}

bool theme_has_italics(const struct theme *theme)
{
	static const char *const without[] = { "km", "ja", "zh", "ko", "th", "lo",
					       "my", "hi", "ar", "he", "fa" };

	for (size_t i = 0; i < ARRAY_COUNT(without); i++)
		if (languages_is(theme->language, without[i]))
			return false;
	return true;
}

bool theme_is_right_to_left(const struct theme *theme)
{
	static const char *const those[] = { "ar", "he", "fa", "ur" };

	for (size_t i = 0; i < ARRAY_COUNT(those); i++)
		if (languages_is(theme->language, those[i]))
			return true;
	return false;
}

int theme_px(const struct theme *theme, float mm)
{
	int px = (int)lroundf(mm * theme->px_per_mm);

	return px > 0 ? px : 1;
}

int theme_text_px(const struct theme *theme, float mm)
{
	return theme_px(theme, mm * theme->text_scale);
}

float theme_legible_px_per_mm(float px_per_mm)
{
	return fmaxf(px_per_mm, 3.2f);
}

float theme_guess_px_per_mm(int width_px, int height_px)
{
	int shorter = width_px < height_px ? width_px : height_px;

	return theme_legible_px_per_mm((float)shorter / 210.0f);
}

void theme_set_source(cairo_t *context, struct colour colour, double alpha)
{
	cairo_set_source_rgba(context, colour.red, colour.green, colour.blue, alpha);
}

void theme_rounded(cairo_t *context, double x, double y, double width, double height, double radius)
{
	const double quarter = acos(0.0);

	cairo_new_sub_path(context);
	cairo_arc(context, x + width - radius, y + radius, radius, -quarter, 0);
	cairo_arc(context, x + width - radius, y + height - radius, radius, 0, quarter);
	cairo_arc(context, x + radius, y + height - radius, radius, quarter, 2 * quarter);
	cairo_arc(context, x + radius, y + radius, radius, 2 * quarter, 3 * quarter);
	cairo_close_path(context);
}

int theme_style_px(const struct theme *theme, enum text_style style)
{
	const float script = style == TEXT_BUTTON ? 1 : script_size(theme);

	return theme_text_px(theme, styles[style].size_mm * script);
}

PangoLayout *theme_layout(const struct theme *theme, enum text_style style, const char *text,
			  int width_px)
{
	PangoLayout *layout = pango_layout_new(theme->context);
	PangoFontDescription *font = pango_font_description_new();

	pango_font_description_set_family_static(font, styles[style].families);
	pango_font_description_set_weight(font, styles[style].weight);
	if (styles[style].italic && theme_has_italics(theme))
		pango_font_description_set_style(font, PANGO_STYLE_ITALIC);
	pango_font_description_set_absolute_size(font, theme_style_px(theme, style) *
							       (double)PANGO_SCALE);
	pango_layout_set_font_description(layout, font);
	pango_font_description_free(font);
	pango_layout_set_line_spacing(layout, styles[style].line_spacing * script_line(theme));
	/* Break between words first. A word longer than the line (Khmer is written without spaces)
	 * is broken between clusters, never inside one. */
	pango_layout_set_wrap(layout, PANGO_WRAP_WORD_CHAR);
	pango_layout_set_width(layout, width_px < 0 ? -1 : width_px * PANGO_SCALE);
	pango_layout_set_text(layout, text, -1);
	return layout;
}

void theme_limit_lines(PangoLayout *layout, int width_px, int lines)
{
	pango_layout_set_width(layout, width_px * PANGO_SCALE);
	pango_layout_set_height(layout, -lines);
	pango_layout_set_ellipsize(layout, PANGO_ELLIPSIZE_END);
}

/* ---- single lines ---- */

bool theme_begins_at_right(const char *text)
{
	while (*text && !g_unichar_isalpha(g_utf8_get_char(text)))
		text = g_utf8_next_char(text);
	return *text && g_utf8_get_char(text) >= 0x590 && g_utf8_get_char(text) < 0x900;
}

/* Returns the height of a single line. *above_px is set to the unused space that its font has
 * above. */
static int trim_line(const struct theme *theme, enum text_style style, PangoLayout *layout,
		     int *above_px)
{
	const int most_px = (int)lround(theme_style_px(theme, style) * LINE_HEIGHT_MAX);
	int height_px, baseline_px;

	pango_layout_get_pixel_size(layout, NULL, &height_px);
	*above_px = 0;
	if (height_px <= most_px)
		return height_px;
	baseline_px = PANGO_PIXELS(pango_layout_get_baseline(layout));
	*above_px = (height_px - most_px) * baseline_px / height_px;
	return most_px;
}

int theme_line_px(const struct theme *theme, enum text_style style, const char *text)
{
	PangoLayout *layout = theme_layout(theme, style, text, -1);
	int above_px, height_px = trim_line(theme, style, layout, &above_px);

	g_object_unref(layout);
	return height_px;
}

void theme_show_line(cairo_t *context, const struct theme *theme, enum text_style style,
		     struct colour colour, const char *text, int x_px, int y_px, int width_px)
{
	PangoLayout *layout = theme_layout(theme, style, text, -1);
	int above_px;

	theme_limit_lines(layout, width_px > 1 ? width_px : 1, 1);
	/* Pango aligns "left" to the beginning of a line in the text's own direction. */
	if (theme_is_right_to_left(theme) && !theme_begins_at_right(text))
		pango_layout_set_alignment(layout, PANGO_ALIGN_RIGHT);
	trim_line(theme, style, layout, &above_px);
	theme_set_source(context, colour, 1);
	cairo_move_to(context, x_px, y_px - above_px);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);
}
