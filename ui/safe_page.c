/* Draws the page that stands in for the model: an animated tower and a short message in several
 * languages. */
#include "ui/safe_page.h"

#include <math.h>
#include <string.h>

#include "ui/translate.h"

enum {
	STOREYS = 6,
	LINE_MS = 3000,  /* how long one language is lit */
	RISE_MS = 12000, /* from the first storey lit to all dark again */
	DRIFT_X_MS = 97000,
	DRIFT_Y_MS = 61000,
};

#define SHORTER_SIDE_MM                                                                            \
	105.0f /* every panel is treated as this large, so that text is readable from afar */
#define DRIFT_SHARE  0.025 /* share of the shorter side, each way */
#define TOWER_WIDTH  1.44  /* extent of its drawing */
#define TOWER_HEIGHT 2.13

static const char *const languages[SAFE_PAGE_LINES_MAX] = { "en", "fr", "km", "ja",
							    "de", "es", "zh", "ar" };

/* ---- creation */

static bool is_wide(const struct safe_page *page)
{
	return page->width_px > page->height_px;
}

static double shorter(const struct safe_page *page)
{
	return is_wide(page) ? page->height_px : page->width_px;
}

/* Skips a language without a font, which would show as a row of boxes, and one without a
 * catalogue. */
static void add_line(struct safe_page *page, const char *language)
{
	/* Translators: shown while the terminal cannot show its model. */
	static const char english[] = N_("We will be right back");
	const char *text = translate(language, english);
	struct safe_page_line *line = &page->lines[page->line_count];
	PangoLayout *layout;
	int width, height;

	if (page->line_count > 0 && strcmp(text, english) == 0)
		return;
	theme_set_language(&page->theme, language);
	layout = theme_layout(&page->theme, TEXT_TITLE, text, -1);
	if (pango_layout_get_unknown_glyphs_count(layout) > 0) {
		g_object_unref(layout);
		return;
	}
	pango_layout_get_pixel_size(layout, &width, &height);
	line->layout = layout;
	line->width_px = width;
	line->height_px = height + theme_px(&page->theme, THEME_GAP_MM / 2);
	page->line_count++;
	page->text_width_px = fmax(page->text_width_px, line->width_px);
	page->text_height_px += line->height_px;
}

int safe_page_init(struct safe_page *out, int width_px, int height_px)
{
	int rc;

	*out = (struct safe_page){ .width_px = width_px, .height_px = height_px };
	rc = theme_init(&out->theme, (float)shorter(out) / SHORTER_SIDE_MM, languages[0]);
	for (int i = 0; rc == 0 && i < SAFE_PAGE_LINES_MAX; i++)
		add_line(out, languages[i]);
	return rc;
}

void safe_page_finish(struct safe_page *page)
{
	for (int i = 0; i < page->line_count; i++)
		g_object_unref(page->lines[i].layout);
	theme_finish(&page->theme);
	memset(page, 0, sizeof(*page));
}

/* ---- the tower: its foot is at 0, 0, and it extends upwards */

static double smooth(double t)
{
	t = t < 0 ? 0 : t > 1 ? 1 : t;
	return t * t * (3 - 2 * t);
}

/* How brightly a storey is lit, 0..1: storeys light up one after the other, then all fade
 * together. */
static double light(int storey, int64_t time_ms)
{
	const double at = (double)(time_ms % RISE_MS) / RISE_MS;
	const double rises = smooth((at - 0.09 * storey) / 0.2);

	return rises * (1 - smooth((at - 0.85) / 0.15));
}

static void storey_path(cairo_t *c, double half_width, double bottom, double height)
{
	const double lip = half_width * 0.08, cornice = fmin(height * 0.26, 0.1);

	cairo_new_path(c);
	cairo_move_to(c, -half_width, -bottom);
	cairo_line_to(c, half_width, -bottom);
	cairo_line_to(c, half_width * 0.97, -(bottom + height - cornice));
	cairo_line_to(c, half_width + lip, -(bottom + height - cornice));
	cairo_curve_to(c, half_width + lip, -(bottom + height), half_width * 0.9,
		       -(bottom + height), half_width * 0.82, -(bottom + height));
	cairo_line_to(c, -half_width * 0.82, -(bottom + height));
	cairo_curve_to(c, -half_width * 0.9, -(bottom + height), -half_width - lip,
		       -(bottom + height), -half_width - lip, -(bottom + height - cornice));
	cairo_line_to(c, -half_width * 0.97, -(bottom + height - cornice));
	cairo_close_path(c);
}

static void mix(cairo_t *c, struct colour dark, struct colour lit, double share)
{
	cairo_set_source_rgb(c, dark.red + (lit.red - dark.red) * share,
			     dark.green + (lit.green - dark.green) * share,
			     dark.blue + (lit.blue - dark.blue) * share);
}

static void draw_door(cairo_t *c, double share)
{
	mix(c, theme_night, theme_paper, share * 0.9);
	cairo_new_path(c);
	cairo_move_to(c, -0.13, 0);
	cairo_line_to(c, -0.13, -0.3);
	cairo_curve_to(c, -0.13, -0.4, -0.05, -0.42, 0, -0.48);
	cairo_curve_to(c, 0.05, -0.42, 0.13, -0.4, 0.13, -0.3);
	cairo_line_to(c, 0.13, 0);
	cairo_close_path(c);
	cairo_fill(c);
}

static void draw_tower(cairo_t *c, int64_t time_ms)
{
	const struct colour stone = { 0.24, 0.20, 0.17 };
	double bottom = 0;

	for (int i = 0; i < STOREYS; i++) {
		const double height = i == 0 ? 0.62 : 0.36 - 0.042 * i;

		storey_path(c, i == 0 ? 0.66 : 0.56 - 0.078 * i, bottom, height);
		mix(c, stone, theme_accent, light(i, time_ms));
		cairo_fill(c);
		bottom += height + 0.012;
	}
	cairo_new_path(c); /* the lotus on the top */
	cairo_move_to(c, -0.085, -bottom);
	cairo_curve_to(c, -0.13, -bottom - 0.09, -0.03, -bottom - 0.12, 0, -bottom - 0.26);
	cairo_curve_to(c, 0.03, -bottom - 0.12, 0.13, -bottom - 0.09, 0.085, -bottom);
	cairo_close_path(c);
	mix(c, stone, theme_accent, light(STOREYS, time_ms));
	cairo_fill(c);
	draw_door(c, light(0, time_ms));
}

/* ---- the words */

/* Returns 1 while a line is lit, with a smooth change to the next line. */
static double emphasis(const struct safe_page *page, int line, int64_t time_ms)
{
	const int64_t round_ms = (int64_t)LINE_MS * page->line_count;
	const double at = (double)(time_ms % round_ms) / LINE_MS - line;
	const double since = at < -0.5 ? at + page->line_count : at;

	return smooth((since + 0.15) / 0.3) * (1 - smooth((since - 0.85) / 0.3));
}

static void draw_lines(const struct safe_page *page, cairo_t *c, double left, double top,
		       bool centred, int64_t time_ms)
{
	double y = top;

	for (int i = 0; i < page->line_count; i++) {
		const struct safe_page_line *line = &page->lines[i];
		const double inset = centred ? (page->text_width_px - line->width_px) / 2 : 0;

		theme_set_source(c, theme_night_text,
				 THEME_DIM_ALPHA +
					 (1 - THEME_DIM_ALPHA) * emphasis(page, i, time_ms));
		cairo_move_to(c, left + inset, y);
		pango_cairo_show_layout(c, line->layout);
		y += line->height_px;
	}
}

/* Sets the size of the box around 0, 0 that holds tower and words, beside or above each other. */
static void box_size(const struct safe_page *page, double tower, double gap, double *width,
		     double *height)
{
	const double tower_width = TOWER_WIDTH * tower;

	if (is_wide(page)) {
		*width = tower_width + gap + page->text_width_px;
		*height = fmax(TOWER_HEIGHT * tower, page->text_height_px);
	} else {
		*width = fmax(tower_width, page->text_width_px);
		*height = TOWER_HEIGHT * tower + gap + page->text_height_px;
	}
}

void safe_page_draw(const struct safe_page *page, cairo_t *context, int64_t time_ms)
{
	const double turn = 4 * acos(0.0), side = shorter(page), drift = DRIFT_SHARE * side;
	const double tower = side * 0.29, gap = side * 0.08;
	const bool wide = is_wide(page);
	double width, height, scale;

	box_size(page, tower, gap, &width, &height);
	scale = fmin(1, fmin(0.9 * page->width_px / width, 0.9 * page->height_px / height));
	theme_set_source(context, theme_night, 1);
	cairo_paint(context);
	cairo_save(context);
	cairo_translate(context,
			page->width_px / 2.0 +
				drift * sin(turn * (double)(time_ms % DRIFT_X_MS) / DRIFT_X_MS),
			page->height_px / 2.0 +
				drift * sin(turn * (double)(time_ms % DRIFT_Y_MS) / DRIFT_Y_MS));
	cairo_scale(context, scale, scale);
	draw_lines(page, context, wide ? width / 2 - page->text_width_px : -page->text_width_px / 2,
		   wide ? -page->text_height_px / 2 : height / 2 - page->text_height_px, !wide,
		   time_ms);
	cairo_translate(context, wide ? (TOWER_WIDTH * tower - width) / 2 : 0,
			wide ? TOWER_HEIGHT * tower / 2 : TOWER_HEIGHT * tower - height / 2);
	cairo_scale(context, tower, tower);
	draw_tower(context, time_ms);
	cairo_restore(context);
}
