/* Places and draws the ends, the line and the words of what is measured. */
#include "ui/measure_view.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ui/icon.h"
#include "ui/translate.h"

enum { NUMBER_BYTES = 64 };

#define STEM_MM                                                                                    \
	11.0f /* from the end to the middle of its knob, so that no finger hides the end           \
	       */
#define MARK_MM    4.0f
#define LINE_MM    1.6f
#define PADDING_MM 3.0f

void measure_view_init(struct measure_view *view, uint32_t *next_id)
{
	*view = (struct measure_view){ 0 };
	sprites_init(&view->words, 1, next_id);
	sprites_init(&view->knob, 1, next_id);
	sprites_init(&view->mark, 1, next_id);
	sprites_init(&view->stem, 1, next_id);
	sprites_init(&view->line, 1, next_id);
}

void measure_view_finish(struct measure_view *view)
{
	sprites_finish(&view->words, 1);
	sprites_finish(&view->knob, 1);
	sprites_finish(&view->mark, 1);
	sprites_finish(&view->stem, 1);
	sprites_finish(&view->line, 1);
}

void measure_view_set(struct measure_view *view, const struct overlay_tools *state)
{
	view->measures = state && state->on & OVERLAY_TOOL_MEASURE;
	view->walks = state && state->on & OVERLAY_TOOL_WALK;
	if (!state)
		return;
	view->now = state->measure;
	view->no_way = state->no_way;
}

/* ---- words ---- */

/* A number in that unit, rounded to 10 to the power of `digit` metres. */
static void write_number(char out[NUMBER_BYTES], const char *language, double value_m, int digit)
{
	/* Translators: the sign before the decimals of a number, as in 2.35 */
	const char *sign = translate(language, N_("."));
	const double step = pow(10, digit), rounded_m = round(value_m / step) * step;
	const int power = rounded_m > 0.999999 ? 0 : rounded_m > 0.009999 ? -2 : -3;
	const char *unit = power == 0 ? "m" : power == -2 ? "cm" : "mm";
	const int decimals = power > digit ? power - digit : 0;
	char number[40];
	size_t whole;

	snprintf(number, sizeof(number), "%.*f", decimals, rounded_m / pow(10, power));
	whole = strcspn(number, ".");
	snprintf(out, NUMBER_BYTES, "%.*s%s%s %s", (int)whole, number, number[whole] ? sign : "",
		 number[whole] ? number + whole + 1 : "", unit);
}

void measure_view_text(char *out, size_t size, const char *language, float length_m, float error_m)
{
	/* A tenth of a millimetre is finer than any scan of a building. */
	const double error = fmax((double)error_m, 1e-4);
	int digit = (int)floor(log10(error));
	double rounded = ceil(error / pow(10, digit) - 1e-6);
	char length_text[NUMBER_BYTES], error_text[NUMBER_BYTES];

	if (rounded > 9) {
		rounded = 1;
		digit++;
	}
	write_number(length_text, language, (double)length_m, digit);
	write_number(error_text, language, rounded * pow(10, digit), digit);
	snprintf(out, size, "%s ± %s", length_text, error_text);
}

static const char *hint_of(const struct measure_view *view)
{
	if (view->measures)
		/* Translators: for measuring between them. */
		return view->now.count == 0 ? N_("Touch two places on the model")
					    : N_("Touch the second place");
	return view->no_way ? N_("No way leads there on foot")
			    /* Translators: the visitor walks through the temple. */
			    : N_("Touch the floor to walk there");
}

static void say(const struct measure_view *view, const char *language,
		char text[MEASURE_TEXT_BYTES])
{
	if (view->measures && view->now.count >= 2)
		measure_view_text(text, MEASURE_TEXT_BYTES, language, view->now.length_m,
				  view->now.error_m);
	else
		snprintf(text, MEASURE_TEXT_BYTES, "%s", translate(language, hint_of(view)));
}

/* ---- places ---- */

/* The middle of an end's knob: below the end, or above it at the scene's lower edge. */
static void knob_of(const struct measure_view *view, const struct screen *screen, int end,
		    float at[2])
{
	const float stem = (float)screen_px(screen, STEM_MM);
	const float room = (float)screen_px(screen, THEME_TARGET_MM) / 2;

	at[0] = view->now.at_px[end][0];
	at[1] = view->now.at_px[end][1] + stem;
	if (at[1] + room > (float)screen_floor(screen))
		at[1] -= 2 * stem;
}

static bool shows_end(const struct measure_view *view, unsigned end)
{
	return view->measures && end < view->now.count && view->now.in_sight[end];
}

enum overlay_handle measure_view_handle_at(const struct measure_view *view,
					   const struct screen *screen, float x_px, float y_px)
{
	static const enum overlay_handle handles[2] = { OVERLAY_HANDLE_FROM, OVERLAY_HANDLE_TO };
	float nearest = (float)screen_px(screen, THEME_TARGET_MM) / 2;
	enum overlay_handle found = OVERLAY_HANDLE_NONE;

	for (unsigned end = 0; end < 2 && view->fade.on; end++) {
		float at[2];

		if (!shows_end(view, end))
			continue;
		knob_of(view, screen, (int)end, at);
		const float far = hypotf(x_px - at[0], y_px - at[1]);

		if (far <= nearest) {
			nearest = far;
			found = handles[end];
		}
	}
	return found;
}

/* ---- drawing ---- */

static void draw_words(struct measure_view *view, const struct screen *screen)
{
	const int padding = screen_px(screen, PADDING_MM), gap = screen_px(screen, THEME_GAP_MM);
	PangoLayout *layout = theme_layout(screen->theme, TEXT_TITLE, view->text, -1);
	int width_px, height_px;
	cairo_t *context;

	theme_limit_lines(layout, screen->scene.width_px - 2 * gap - 2 * padding, 2);
	pango_layout_set_alignment(layout, PANGO_ALIGN_CENTER);
	pango_layout_get_pixel_size(layout, &width_px, &height_px);
	/* What limits the lines may have widened the layout to all the room; the chip is as wide as
	 * its words. */
	pango_layout_set_width(layout, width_px * PANGO_SCALE);
	context = sprite_begin(&view->words, width_px + 2 * padding, height_px + padding);
	if (context) {
		theme_rounded(context, 0, 0, width_px + 2 * padding, height_px + padding,
			      screen_px(screen, THEME_RADIUS_MM));
		theme_set_source(context, theme_night, THEME_CHIP_ALPHA);
		cairo_fill(context);
		theme_set_source(context, theme_night_text, 1);
		cairo_move_to(context, padding, padding / 2.0);
		pango_cairo_show_layout(context, layout);
		sprite_end(&view->words, context);
	}
	g_object_unref(layout);
}

/* A bright ring on a dark one, so that it shows on every stone. */
static void draw_ring(struct sprite *sprite, int side_px, double radius, double line_px,
		      bool is_filled)
{
	const double middle = side_px / 2.0, turn = 4 * acos(0.0);
	cairo_t *context = sprite_begin(sprite, side_px, side_px);

	if (!context)
		return;
	cairo_arc(context, middle, middle, middle * radius, 0, turn);
	theme_set_source(context, theme_night, is_filled ? 0.45 : 0);
	cairo_fill_preserve(context);
	cairo_set_line_width(context, 2 * line_px);
	theme_set_source(context, theme_night, 1);
	cairo_stroke_preserve(context);
	cairo_set_line_width(context, line_px);
	theme_set_source(context, theme_night_text, 1);
	cairo_stroke(context);
	sprite_end(sprite, context);
}

/* Bright in the middle, dark at both sides. */
static void draw_line(struct sprite *sprite, const struct screen *screen, float mm)
{
	const int thick_px = 2 * screen_px(screen, mm);
	cairo_t *context = sprite_begin(sprite, 8, thick_px);

	if (!context)
		return;
	theme_set_source(context, theme_night, 0.8);
	cairo_paint(context);
	theme_set_source(context, theme_night_text, 1);
	cairo_rectangle(context, 0, thick_px / 4.0, 8, thick_px / 2.0);
	cairo_fill(context);
	sprite_end(sprite, context);
}

static void draw_marks(struct measure_view *view, const struct screen *screen)
{
	const double line_px = screen_px(screen, 0.5f);

	draw_ring(&view->knob, screen_px(screen, THEME_TARGET_MM), 0.84, line_px, true);
	draw_ring(&view->mark, screen_px(screen, MARK_MM), 0.6, line_px, false);
	draw_line(&view->line, screen, LINE_MM / 2);
	draw_line(&view->stem, screen, LINE_MM / 4);
}

/* ---- a frame ---- */

static void place_words(struct measure_view *view, const struct screen *screen, struct rect taken)
{
	const struct rect scene = screen->scene;
	const int gap = screen_px(screen, THEME_GAP_MM);
	struct rect rect = { 0, scene.y_px + gap, view->words.bitmap.width_px,
			     view->words.bitmap.height_px };

	rect.x_px = scene.x_px + (scene.width_px - rect.width_px) / 2;
	if (taken.width_px > 0 && rect_meets(rect, taken))
		rect.y_px = taken.y_px + taken.height_px + gap;
	view->text_at_px[0] = (float)rect.x_px;
	view->text_at_px[1] = (float)rect.y_px;
}

bool measure_view_update(struct measure_view *view, const struct screen *screen, bool shows,
			 struct rect taken, int64_t step_ms)
{
	char text[MEASURE_TEXT_BYTES];

	view->fade.on = (view->measures || view->walks) && shows;
	if (view->fade.on) {
		say(view, screen->theme->language, text);
		if (view->dirty || view->line.revision == 0)
			draw_marks(view, screen);
		if (view->dirty || strcmp(text, view->text) != 0 ||
		    view->drawn_width_px != screen->scene.width_px) {
			memcpy(view->text, text, sizeof(text));
			draw_words(view, screen);
			view->drawn_width_px = screen->scene.width_px;
		}
		view->dirty = false;
		place_words(view, screen, taken);
	}
	return fade_advance(&view->fade, step_ms);
}

/* A sprite as a straight line from one point to another. */
static void add_line(struct layers *layers, const struct sprite *sprite, float alpha,
		     const float from[2], const float to[2])
{
	const float across[2] = { to[0] - from[0], to[1] - from[1] };
	const float length = hypotf(across[0], across[1]);
	const float middle[2] = { (from[0] + to[0]) / 2, (from[1] + to[1]) / 2 };

	if (length > 0)
		layers_add_turned(layers, sprite, alpha, middle,
				  (float[2]){ -across[1] / length, across[0] / length }, length / 2,
				  (float)sprite->bitmap.height_px / 2);
}

void measure_view_layers(const struct measure_view *view, const struct screen *screen,
			 struct layers *layers)
{
	const float alpha = fade_eased(&view->fade), upright[2] = { 0, -1 };
	const float knob = (float)view->knob.bitmap.width_px / 2;
	const float mark = (float)view->mark.bitmap.width_px / 2;

	if (shows_end(view, 0) && shows_end(view, 1))
		add_line(layers, &view->line, alpha, view->now.at_px[0], view->now.at_px[1]);
	for (unsigned end = 0; end < 2; end++) {
		const float *at = view->now.at_px[end];
		float below[2], near_end[2], near_knob[2];

		if (!shows_end(view, end))
			continue;
		knob_of(view, screen, (int)end, below);
		const float down = below[1] > at[1] ? 1 : -1;

		near_end[0] = near_knob[0] = at[0];
		near_end[1] = at[1] + down * mark * 0.6f;
		near_knob[1] = below[1] - down * knob * 0.84f;
		add_line(layers, &view->stem, alpha, near_end, near_knob);
		layers_add_turned(layers, &view->mark, alpha, at, upright, mark, mark);
		layers_add_turned(layers, &view->knob, alpha, below, upright, knob, knob);
	}
	layers_add_at(layers, &view->words, alpha, view->text_at_px[0], view->text_at_px[1]);
}
