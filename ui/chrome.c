/* Lays out and draws the bar of controls; narrow panels get it in steps of saving width. */
#include "ui/chrome.h"

#include <ctype.h>
#include <stdio.h>

#include "ui/endonym.h"
#include "ui/icon.h"

#define BAR_MM     11.0f
#define PADDING_MM 3.0f

static const char *label_of(const struct chrome *chrome, const char *language, char *code,
			    size_t code_bytes)
{
	if (!chrome->codes)
		return ui_endonym(language);
	snprintf(code, code_bytes, "%s", language);
	for (char *c = code; *c; c++)
		*c = (char)toupper((unsigned char)*c);
	return code;
}

static void add(struct chrome *chrome, enum chrome_button_kind kind, int language, int width_px)
{
	chrome->buttons[chrome->button_count++] =
		(struct chrome_button){ kind, language, chrome->width_px, width_px };
	chrome->width_px += width_px;
}

/* Returns a copy of the theme for labels; its context stays owned by the theme. */
static struct theme type_of(const struct chrome *chrome, const struct theme *theme)
{
	struct theme type = *theme;

	if (chrome->usual)
		type.text_scale = 1;
	return type;
}

static void try_layout(struct chrome *chrome, const struct theme *theme,
		       const char *const *languages, uint32_t language_count, struct chrome_has has)
{
	struct theme type = type_of(chrome, theme);
	int target_px = theme_px(theme, chrome->tight ? THEME_TARGET_MM : BAR_MM);
	float padding_mm = chrome->tight ? 0.6f : chrome->codes ? 1.5f : PADDING_MM;

	chrome->button_count = 0;
	chrome->width_px = 0;
	add(chrome, CHROME_HOME, -1, target_px);
	add(chrome, CHROME_BACK, -1, target_px);
	add(chrome, CHROME_HELP, -1, target_px);
	if (has.search)
		add(chrome, CHROME_SEARCH, -1, target_px);
	if (has.tours)
		add(chrome, CHROME_TOURS, -1, target_px);
	if (has.light && !chrome->toolless)
		add(chrome, CHROME_LIGHT, -1, target_px);
	if (has.section && !chrome->toolless)
		add(chrome, CHROME_SECTION, -1, target_px);
	add(chrome, CHROME_LARGE, -1, target_px);
	if (has.reach)
		add(chrome, CHROME_REACH, -1, target_px);
	if (language_count > 1 && chrome->menu)
		add(chrome, CHROME_LANGUAGES, -1, target_px);
	for (uint32_t i = 0; language_count > 1 && !chrome->menu && i < language_count; i++) {
		char code[20];
		const char *label = label_of(chrome, languages[i], code, sizeof(code));
		PangoLayout *layout = theme_layout(&type, TEXT_BUTTON, label, -1);
		int width_px;

		pango_layout_get_pixel_size(layout, &width_px, NULL);
		g_object_unref(layout);
		width_px += 2 * theme_px(theme, padding_mm);
		add(chrome, CHROME_LANGUAGE, (int)i, width_px > target_px ? width_px : target_px);
	}
}

void chrome_layout(struct chrome *out, const struct theme *theme, const char *const *languages,
		   uint32_t language_count, int most_width_px, struct chrome_has has)
{
	*out = (struct chrome){ .height_px = theme_px(theme, BAR_MM),
				.menu = language_count > CHROME_LANGUAGES_MAX };
	/* Type shrinks before buttons do. So large type moves only the language buttons. */
	bool *const savings[] = { &out->codes, &out->usual, &out->tight, &out->menu,
				  &out->toolless };

	try_layout(out, theme, languages, language_count, has);
	for (size_t i = 0; i < ARRAY_COUNT(savings) && out->width_px > most_width_px; i++) {
		*savings[i] = true;
		try_layout(out, theme, languages, language_count, has);
	}
}

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

static void draw_button(cairo_t *context, const struct chrome *chrome,
			const struct chrome_button *button, const struct theme *theme,
			const char *const *languages, bool on, bool dim)
{
	static const enum icon icons[] = {
		[CHROME_HOME] = ICON_HOME,       [CHROME_BACK] = ICON_RETURN,
		[CHROME_HELP] = ICON_HELP,       [CHROME_SEARCH] = ICON_SEARCH,
		[CHROME_TOURS] = ICON_TOUR,      [CHROME_LIGHT] = ICON_LIGHT,
		[CHROME_SECTION] = ICON_SECTION, [CHROME_LARGE] = ICON_LARGE,
		[CHROME_REACH] = ICON_REACH,     [CHROME_LANGUAGES] = ICON_LANGUAGES,
	};
	double x = button->x_px + button->width_px / 2.0, y = chrome->height_px / 2.0;
	int inset_px = theme_px(theme, 1.2f);
	struct theme type = type_of(chrome, theme);
	char code[20];

	if (on) {
		theme_rounded(context, button->x_px + inset_px, inset_px,
			      button->width_px - 2 * inset_px, chrome->height_px - 2 * inset_px,
			      theme_px(theme, THEME_RADIUS_MM));
		theme_set_source(context, theme_night_text, 1);
		cairo_fill(context);
	}
	theme_set_source(context, on ? theme_night : theme_night_text, dim ? THEME_DIM_ALPHA : 1);
	if (button->kind == CHROME_LANGUAGE)
		draw_label(context, &type,
			   label_of(chrome, languages[button->language], code, sizeof(code)), x, y);
	else
		icon_draw(context, icons[button->kind], x, y, theme_text_px(&type, 5.0f));
}

int chrome_draw(struct bitmap *out, const struct chrome *chrome, const struct theme *theme,
		const char *const *languages, struct chrome_state state)
{
	const bool on[] = { [CHROME_HELP] = state.help,          [CHROME_SEARCH] = state.search,
			    [CHROME_TOURS] = state.tours,        [CHROME_LARGE] = state.large,
			    [CHROME_LIGHT] = state.light,        [CHROME_SECTION] = state.section,
			    [CHROME_REACH] = state.reach,        [CHROME_LANGUAGE] = false,
			    [CHROME_LANGUAGES] = state.languages };
	cairo_t *context;
	int rc = bitmap_init(out, chrome->width_px, chrome->height_px);

	if (rc < 0)
		return rc;
	context = bitmap_begin(out);
	theme_rounded(context, 0, 0, chrome->width_px, chrome->height_px,
		      theme_px(theme, THEME_RADIUS_MM));
	theme_set_source(context, theme_night, THEME_CHIP_ALPHA);
	cairo_fill(context);
	for (uint32_t i = 0; i < chrome->button_count; i++) {
		const struct chrome_button *button = &chrome->buttons[i];

		draw_button(context, chrome, button, theme, languages,
			    button->kind == CHROME_LANGUAGE ? button->language == state.language
							    : on[button->kind],
			    button->kind == CHROME_BACK && !state.back);
	}
	bitmap_end(out, context);
	return 0;
}

const struct chrome_button *chrome_button_at(const struct chrome *chrome, float x_px)
{
	for (uint32_t i = 0; i < chrome->button_count; i++) {
		const struct chrome_button *button = &chrome->buttons[i];

		if (x_px >= (float)button->x_px && x_px < (float)(button->x_px + button->width_px))
			return button;
	}
	return NULL;
}
