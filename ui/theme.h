/* One look for everything: sizes in millimetres of glass, so that a target is as large for a finger
 * on a 10-inch panel as on a 55-inch one; few type sizes; stone, ink and one accent. docs/ui.md
 * says why. */
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
/* Type for who sees little, in sizes of the usual one. */
#define THEME_LARGE_TYPE 1.35f
/* Of a line that waits for its turn to be lit. */
#define THEME_DIM_ALPHA 0.5
/* How much of night is in a chip over the model, at least: the rest is whatever shines through. */
#define THEME_CHIP_ALPHA   0.82
#define THEME_LABEL_ALPHA  0.78
#define THEME_CHOSEN_ALPHA 0.95 /* of accent, the label that is chosen */
#define THEME_BUTTON_ALPHA 0.7  /* controls over a picture */

enum text_style {
	TEXT_LABEL,   /* on a callout */
	TEXT_TITLE,   /* of a card, and in the page's header */
	TEXT_CAPTION, /* of a card */
	TEXT_BUTTON,
	TEXT_BODY, /* of a page, and below */
	TEXT_HEADING_1,
	TEXT_HEADING_2,
	TEXT_HEADING_3,
	TEXT_QUOTE,
	TEXT_FIGURE, /* under a picture */
	TEXT_CELL,   /* of a table */
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

/* px_per_mm > 0. -ENOMEM. */
must_check int theme_init(struct theme *theme, float px_per_mm, const char *language);
void theme_finish(struct theme *theme); /* NULL and zeroed are fine */
/* Chooses the glyph variants and line breaks of a language ("ja", "km"). */
void theme_set_language(struct theme *theme, const char *language);

/* Scripts that know no italics are not slanted: their emphasis is weight. */
bool theme_has_italics(const struct theme *theme);

/* Arabic, Hebrew, Persian, Urdu: lists and fields begin at the right. */
bool theme_is_right_to_left(const struct theme *theme);

int theme_px(const struct theme *theme, float mm);      /* at least 1 */
int theme_text_px(const struct theme *theme, float mm); /* of what grows with the type */
/* Of a panel of which nothing else is known: as a 20 cm tall one, never under 3.2. */
float theme_guess_px_per_mm(int width_px, int height_px);

void theme_set_source(cairo_t *context, struct colour colour, double alpha);
/* A path. */
void theme_rounded(cairo_t *context, double x, double y, double width, double height,
		   double radius);

/* A layout that wraps at width_px (-1: one line, never wrapped), for any script. Released by
 * g_object_unref; aborts where memory ran out, as all of Pango does. */
PangoLayout *theme_layout(const struct theme *theme, enum text_style style, const char *text,
			  int width_px);
/* At most `lines` lines; what does not fit ends in an ellipsis. */
void theme_limit_lines(PangoLayout *layout, int width_px, int lines);
int theme_style_px(const struct theme *theme, enum text_style style); /* the size of its type */

/* A line that stands alone, as in lists. It is no taller than it needs to be: fonts of some scripts
 * ask for twice their size, for marks that meet no line above here. What is too long ends in an
 * ellipsis; where the language is read from the right the line begins there, whatever its script.
 */
int theme_line_px(const struct theme *theme, enum text_style style, const char *text);
void theme_show_line(cairo_t *context, const struct theme *theme, enum text_style style,
		     struct colour colour, const char *text, int x_px, int y_px, int width_px);
/* By its first letter: Hebrew, Arabic and their kin. */
bool theme_begins_at_right(const char *text);

#endif
