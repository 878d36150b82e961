/* One look for everything. Sizes are in millimetres of glass, so that a touch target has the same
 * size for a finger on a 10-inch panel and on a 55-inch one, if the latter has pixels enough. There
 * are few type sizes and few colours: stone, ink and one accent. docs/ui.md explains why. */
#ifndef GOPURA_UI_THEME_H
#define GOPURA_UI_THEME_H

#include <pango/pangocairo.h>
#include <stdbool.h>

#include "base/compiler.h"

/* Millimetres. A touch target is never smaller than THEME_TARGET_MM. */
#define THEME_TARGET_MM 9.0f
#define THEME_MARGIN_MM 4.0f
#define THEME_GAP_MM    2.0f
#define THEME_RADIUS_MM 1.2f
/* Scale of large type, for visitors with weak eyesight. */
#define THEME_LARGE_TYPE 1.35f
/* Alpha of lines and controls that are inactive now. */
#define THEME_DIM_ALPHA 0.5
/* Alpha of dark backgrounds over the model; the model shows through the rest. */
#define THEME_CHIP_ALPHA   0.82
#define THEME_LABEL_ALPHA  0.78
#define THEME_CHOSEN_ALPHA 0.95 /* of the accent colour, on a selected label */
#define THEME_BUTTON_ALPHA 0.7  /* for controls over a picture */

enum text_style {
	TEXT_LABEL,   /* of a callout */
	TEXT_TITLE,   /* of a card and of menus */
	TEXT_CAPTION, /* of a card */
	TEXT_BUTTON,
	TEXT_BODY, /* of a page; so are the following */
	TEXT_HEADING_1,
	TEXT_HEADING_2,
	TEXT_HEADING_3,
	TEXT_QUOTE,
	TEXT_FIGURE, /* under a picture */
	TEXT_CELL,   /* in a table */
	TEXT_STYLE_COUNT,
};

struct colour {
	double red, green, blue;
};

extern const struct colour theme_paper, theme_paper_shade, theme_ink, theme_ink_soft, theme_line,
	theme_accent, theme_night, theme_night_text;

struct theme {
	float px_per_mm;
	float text_scale; /* 1, or THEME_LARGE_TYPE */
	char language[17];
	PangoContext *context; /* owned */
};

/* Prepares a theme; px_per_mm > 0. End it with theme_finish. Returns -ENOMEM. */
must_check int theme_init(struct theme *theme, float px_per_mm, const char *language);
void theme_finish(struct theme *theme); /* NULL and zeroed are fine */
/* Sets the language ("ja", "km"), which chooses glyph variants and line breaks. Copied. */
void theme_set_language(struct theme *theme, const char *language);

/* Returns true if the language's script has italics. If not, emphasis is shown by weight. */
bool theme_has_italics(const struct theme *theme);

/* Returns true for Arabic, Hebrew, Persian and Urdu: lists and fields begin at the right. */
bool theme_is_right_to_left(const struct theme *theme);

int theme_px(const struct theme *theme, float mm);      /* millimetres to pixels; at least 1 */
int theme_text_px(const struct theme *theme, float mm); /* for sizes that grow with type */
/* Returns px_per_mm, or more where pixels are so large that the smallest letters would have too
 * few: on a panel of 55 inches and 1920 pixels they would have 6. */
float theme_legible_px_per_mm(float px_per_mm);
/* Guesses the pixels per millimetre of a panel from its size in pixels: its shorter side is taken
 * for 210 mm; never too few for letters. */
float theme_guess_px_per_mm(int width_px, int height_px);

/* Sets the source colour of a context. */
void theme_set_source(cairo_t *context, struct colour colour, double alpha);
/* Adds a rectangle with rounded corners to the path. */
void theme_rounded(cairo_t *context, double x, double y, double width, double height,
		   double radius);

/* Returns a layout that wraps at width_px (-1: one line, never wrapped), for any script. Release it
 * with g_object_unref. Aborts if memory runs out, as all of Pango does. */
PangoLayout *theme_layout(const struct theme *theme, enum text_style style, const char *text,
			  int width_px);
/* Limits a layout to `lines` lines of width_px; text that does not fit ends in an ellipsis. */
void theme_limit_lines(PangoLayout *layout, int width_px, int lines);
int theme_style_px(const struct theme *theme, enum text_style style); /* size of its type */

/* A single line, as in lists. It is no taller than needed: fonts of some scripts ask for twice
 * their size, for marks that no line above can collide with here. Text that is too long ends in an
 * ellipsis. In a right-to-left language the line begins at the right, whatever its own script.
 * theme_line_px() returns its height. */
int theme_line_px(const struct theme *theme, enum text_style style, const char *text);
/* Draws such a line with its upper left corner at x_px, y_px, at most width_px wide. */
void theme_show_line(cairo_t *context, const struct theme *theme, enum text_style style,
		     struct colour colour, const char *text, int x_px, int y_px, int width_px);
/* Returns true if the first letter is Hebrew, Arabic or a related script. */
bool theme_begins_at_right(const char *text);

#endif
