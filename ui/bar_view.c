/* Lays out and draws the bar of controls; narrow panels get it in steps of saving width. */
#include "ui/bar_view.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "ui/endonym.h"
#include "ui/icon.h"

#define BAR_MM     11.0f
#define PADDING_MM 3.0f

void bar_view_init(struct bar_view *view, uint32_t *next_id)
{
	*view = (struct bar_view){ 0 };
	sprites_init(&view->sprite, 1, next_id);
}

void bar_view_finish(struct bar_view *view)
{
	sprites_finish(&view->sprite, 1);
}

/* ---- layout ---- */

static const char *label_of(const struct bar_view *view, const char *language, char *code,
			    size_t code_bytes)
{
	if (!view->codes)
		return ui_endonym(language);
	snprintf(code, code_bytes, "%s", language);
	for (char *c = code; *c; c++)
		*c = (char)toupper((unsigned char)*c);
	return code;
}

static void add(struct bar_view *view, enum bar_view_button_kind kind, int language, int width_px)
{
	view->buttons[view->button_count++] =
		(struct bar_view_button){ kind, language, view->width_px, width_px };
	view->width_px += width_px;
}

/* Returns a copy of the theme for labels; its context stays owned by the theme. */
static struct theme type_of(const struct bar_view *view, const struct theme *theme)
{
	struct theme type = *theme;

	if (view->usual)
		type.text_scale = 1;
	return type;
}

static void try_layout(struct bar_view *view, const struct theme *theme,
		       const struct languages *languages, struct bar_view_has has)
{
	struct theme type = type_of(view, theme);
	int target_px = theme_px(theme, view->tight ? THEME_TARGET_MM : BAR_MM);
	float padding_mm = view->tight ? 0.6f : view->codes ? 1.5f : PADDING_MM;

	view->button_count = 0;
	view->width_px = 0;
	add(view, BAR_HOME, -1, target_px);
	add(view, BAR_BACK, -1, target_px);
	add(view, BAR_HELP, -1, target_px);
	if (has.search)
		add(view, BAR_SEARCH, -1, target_px);
	if (has.tours)
		add(view, BAR_TOURS, -1, target_px);
	if (has.light && !view->toolless)
		add(view, BAR_LIGHT, -1, target_px);
	if (has.section && !view->toolless)
		add(view, BAR_SECTION, -1, target_px);
	if (has.measure && !view->toolless)
		add(view, BAR_MEASURE, -1, target_px);
	if (has.walk && !view->toolless)
		add(view, BAR_WALK, -1, target_px);
	add(view, BAR_LARGE, -1, target_px);
	if (has.reach)
		add(view, BAR_REACH, -1, target_px);
	if (languages->count > 1 && view->menu)
		add(view, BAR_LANGUAGES, -1, target_px);
	for (uint32_t i = 0; languages->count > 1 && !view->menu && i < languages->count; i++) {
		char code[20];
		const char *label = label_of(view, languages->codes[i], code, sizeof(code));
		PangoLayout *layout = theme_layout(&type, TEXT_BUTTON, label, -1);
		int width_px;

		pango_layout_get_pixel_size(layout, &width_px, NULL);
		g_object_unref(layout);
		width_px += 2 * theme_px(theme, padding_mm);
		add(view, BAR_LANGUAGE, (int)i, width_px > target_px ? width_px : target_px);
	}
}

void bar_view_lay_out(struct bar_view *view, const struct screen *screen,
		      const struct languages *languages, struct bar_view_has has)
{
	const int panel_px = screen_is_portrait(screen) ? screen->width_px : screen->width_px / 2;
	const int most_px = panel_px - 2 * screen_px(screen, THEME_GAP_MM);
	/* Type shrinks before buttons do. So large type moves only the language buttons. */
	bool *const savings[] = { &view->codes, &view->usual, &view->tight, &view->menu,
				  &view->toolless };

	for (size_t i = 0; i < ARRAY_COUNT(savings); i++)
		*savings[i] = false;
	view->menu = languages->count > BAR_LANGUAGES_MAX;
	view->height_px = screen_px(screen, BAR_MM);
	view->dirty = true;
	try_layout(view, screen->theme, languages, has);
	for (size_t i = 0; i < ARRAY_COUNT(savings) && view->width_px > most_px; i++) {
		*savings[i] = true;
		try_layout(view, screen->theme, languages, has);
	}
}

struct rect bar_view_rect(const struct bar_view *view, const struct theme *theme, int height_px)
{
	int margin_px = theme_px(theme, THEME_GAP_MM);

	return (struct rect){ margin_px, height_px - view->height_px - margin_px, view->width_px,
			      view->height_px };
}

/* Returns the button at x_px, relative to the bar, or NULL between buttons. */
static const struct bar_view_button *button_at(const struct bar_view *view, float x_px)
{
	for (uint32_t i = 0; i < view->button_count; i++) {
		const struct bar_view_button *button = &view->buttons[i];

		if (x_px >= (float)button->x_px && x_px < (float)(button->x_px + button->width_px))
			return button;
	}
	return NULL;
}

struct overlay_action bar_view_tap(const struct bar_view *view, const struct screen *screen,
				   const struct languages *languages, bool back, float x_px)
{
	static const enum overlay_action_kind kinds[] = {
		[BAR_HOME] = OVERLAY_HOME,           [BAR_BACK] = OVERLAY_BACK,
		[BAR_HELP] = OVERLAY_HELP,           [BAR_SEARCH] = OVERLAY_SEARCH,
		[BAR_TOURS] = OVERLAY_TOURS,         [BAR_LIGHT] = OVERLAY_LIGHT,
		[BAR_SECTION] = OVERLAY_SECTION,     [BAR_MEASURE] = OVERLAY_MEASURE,
		[BAR_WALK] = OVERLAY_WALK,           [BAR_LARGE] = OVERLAY_LARGE,
		[BAR_REACH] = OVERLAY_REACH,         [BAR_LANGUAGE] = OVERLAY_LANGUAGE,
		[BAR_LANGUAGES] = OVERLAY_LANGUAGES,
	};
	const struct bar_view_button *button = button_at(view, x_px - (float)screen->bar.x_px);
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = -1 };

	if (!button || (button->kind == BAR_BACK && !back) ||
	    (button->kind == BAR_LANGUAGE && button->language == languages->current))
		return action;
	action.kind = kinds[button->kind];
	if (button->kind == BAR_LANGUAGE)
		action.language = languages->codes[button->language];
	return action;
}

/* ---- drawing ---- */

static void draw_label(cairo_t *context, const struct theme *theme, const char *text,
		       double centre_x, double centre_y)
{
	PangoLayout *layout = theme_layout(theme, TEXT_BUTTON, text, -1);
	int width_px, height_px;

	pango_layout_get_pixel_size(layout, &width_px, &height_px);
	cairo_move_to(context, centre_x - width_px / 2.0, centre_y - height_px / 2.0);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);
}

static void draw_button(cairo_t *context, const struct bar_view *view,
			const struct bar_view_button *button, const struct theme *theme,
			const struct languages *languages, bool on, bool dim)
{
	static const enum icon icons[] = {
		[BAR_HOME] = ICON_HOME,       [BAR_BACK] = ICON_RETURN,
		[BAR_HELP] = ICON_HELP,       [BAR_SEARCH] = ICON_SEARCH,
		[BAR_TOURS] = ICON_TOUR,      [BAR_LIGHT] = ICON_LIGHT,
		[BAR_SECTION] = ICON_SECTION, [BAR_MEASURE] = ICON_MEASURE,
		[BAR_WALK] = ICON_WALK,       [BAR_LARGE] = ICON_LARGE,
		[BAR_REACH] = ICON_REACH,     [BAR_LANGUAGES] = ICON_LANGUAGES,
	};
	double x = button->x_px + button->width_px / 2.0, y = view->height_px / 2.0;
	int inset_px = theme_px(theme, 1.2f);
	struct theme type = type_of(view, theme);
	char code[20];

	if (on) {
		theme_rounded(context, button->x_px + inset_px, inset_px,
			      button->width_px - 2 * inset_px, view->height_px - 2 * inset_px,
			      theme_px(theme, THEME_RADIUS_MM));
		theme_set_source(context, theme_night_text, 1);
		cairo_fill(context);
	}
	theme_set_source(context, on ? theme_night : theme_night_text, dim ? THEME_DIM_ALPHA : 1);
	if (button->kind == BAR_LANGUAGE)
		draw_label(context, &type,
			   label_of(view, languages->codes[button->language], code, sizeof(code)),
			   x, y);
	else
		icon_draw(context, icons[button->kind], x, y, theme_text_px(&type, 5.0f));
}

static void draw(struct bar_view *view, const struct screen *screen,
		 const struct languages *languages, const struct bar_view_state *state)
{
	const bool on[] = { [BAR_HELP] = state->help,          [BAR_SEARCH] = state->search,
			    [BAR_TOURS] = state->tours,        [BAR_LARGE] = state->large,
			    [BAR_LIGHT] = state->light,        [BAR_SECTION] = state->section,
			    [BAR_MEASURE] = state->measure,    [BAR_WALK] = state->walk,
			    [BAR_REACH] = state->reach,        [BAR_LANGUAGE] = false,
			    [BAR_LANGUAGES] = state->languages };
	cairo_t *context = sprite_begin(&view->sprite, view->width_px, view->height_px);

	if (!context)
		return;
	theme_rounded(context, 0, 0, view->width_px, view->height_px,
		      screen_px(screen, THEME_RADIUS_MM));
	theme_set_source(context, theme_night, THEME_CHIP_ALPHA);
	cairo_fill(context);
	for (uint32_t i = 0; i < view->button_count; i++) {
		const struct bar_view_button *button = &view->buttons[i];

		draw_button(context, view, button, screen->theme, languages,
			    button->kind == BAR_LANGUAGE ? button->language == languages->current
							 : on[button->kind],
			    button->kind == BAR_BACK && !state->back);
	}
	sprite_end(&view->sprite, context);
}

void bar_view_update(struct bar_view *view, const struct screen *screen,
		     const struct languages *languages, struct bar_view_state state)
{
	if (!view->dirty && view->drawn_language == languages->current &&
	    memcmp(&view->drawn, &state, sizeof(state)) == 0)
		return;
	draw(view, screen, languages, &state);
	view->drawn = state;
	view->drawn_language = languages->current;
	view->dirty = false;
}

void bar_view_layers(const struct bar_view *view, const struct screen *screen,
		     struct layers *layers)
{
	layers_add_at(layers, &view->sprite, 1, (float)screen->bar.x_px, (float)screen->bar.y_px);
}
