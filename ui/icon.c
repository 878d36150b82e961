/* Draws each icon with Cairo in a box from -1 to 1, which icon_draw scales. */
#include "ui/icon.h"

#include <math.h>

static void line(cairo_t *c, double x0, double y0, double x1, double y1)
{
	cairo_move_to(c, x0, y0);
	cairo_line_to(c, x1, y1);
}

static void ring(cairo_t *c, double x, double y, double radius)
{
	cairo_new_sub_path(c);
	cairo_arc(c, x, y, radius, 0, 4 * acos(0.0));
}

static void dot(cairo_t *c, double x, double y, double radius)
{
	cairo_stroke(c);
	ring(c, x, y, radius);
	cairo_fill(c);
}

/* Adds an arrow head with its tip at x, y, pointing along dx, dy (unit length). */
static void arrow_head(cairo_t *c, double x, double y, double dx, double dy)
{
	double size = 0.38;

	cairo_move_to(c, x - size * (dx + dy), y - size * (dy - dx));
	cairo_line_to(c, x, y);
	cairo_line_to(c, x - size * (dx - dy), y - size * (dy + dx));
}

static void draw_home(cairo_t *c)
{
	/* Three stepped terraces and a tower: the first view of the temple. */
	cairo_move_to(c, -1, 0.85);
	cairo_line_to(c, 1, 0.85);
	cairo_move_to(c, -0.75, 0.85);
	cairo_line_to(c, -0.75, 0.4);
	cairo_line_to(c, -0.45, 0.4);
	cairo_line_to(c, -0.45, 0);
	cairo_curve_to(c, -0.42, -0.45, -0.2, -0.7, 0, -0.95);
	cairo_curve_to(c, 0.2, -0.7, 0.42, -0.45, 0.45, 0);
	cairo_line_to(c, 0.45, 0.4);
	cairo_line_to(c, 0.75, 0.4);
	cairo_line_to(c, 0.75, 0.85);
}

/* Draws two arrows along a diagonal, given the distances of their tails and heads from the
 * middle. */
static void draw_corners(cairo_t *c, double tail, double head)
{
	const double way = (head > tail ? 1 : -1) * sqrt(0.5);

	line(c, tail, -tail, head, -head);
	arrow_head(c, head, -head, way, -way);
	line(c, -tail, tail, -head, head);
	arrow_head(c, -head, head, -way, way);
}

/* Equator, two parallels, two meridians. */
static void draw_globe(cairo_t *c)
{
	ring(c, 0, 0, 0.95);
	line(c, -0.95, 0, 0.95, 0);
	cairo_move_to(c, -0.8, -0.5);
	cairo_curve_to(c, -0.4, -0.3, 0.4, -0.3, 0.8, -0.5);
	cairo_move_to(c, -0.8, 0.5);
	cairo_curve_to(c, -0.4, 0.3, 0.4, 0.3, 0.8, 0.5);
	cairo_move_to(c, 0, -0.95);
	cairo_curve_to(c, -0.6, -0.5, -0.6, 0.5, 0, 0.95);
	cairo_move_to(c, 0, -0.95);
	cairo_curve_to(c, 0.6, -0.5, 0.6, 0.5, 0, 0.95);
}

static void draw_help(cairo_t *c)
{
	cairo_arc(c, 0, -0.38, 0.46, -2 * acos(0.0), 0.55);
	cairo_curve_to(c, 0.2, 0.12, 0, 0.15, 0, 0.42);
	dot(c, 0, 0.86, 0.15);
}

/* The paths of the fingers. The fingertips are drawn over them, where help_view_fingers() puts
 * them. */
static void draw_turn(cairo_t *c)
{
	line(c, -0.95, 0, 0.95, 0);
	arrow_head(c, -0.95, 0, -1, 0);
	arrow_head(c, 0.95, 0, 1, 0);
}

static void draw_zoom(cairo_t *c)
{
	line(c, -0.95, 0.95, 0.95, -0.95);
	arrow_head(c, -0.95, 0.95, -0.707, 0.707);
	arrow_head(c, 0.95, -0.95, 0.707, -0.707);
}

static void draw_tap(cairo_t *c)
{
	ring(c, 0, 0, 0.92);
	dot(c, 0, 0, 0.36);
}

static void draw_letter(cairo_t *c, double x, double half, double height)
{
	cairo_move_to(c, x - half, 0.85);
	cairo_line_to(c, x, 0.85 - height);
	cairo_line_to(c, x + half, 0.85);
	line(c, x - half * 0.6, 0.85 - height * 0.36, x + half * 0.6, 0.85 - height * 0.36);
}

static void draw_seated(cairo_t *c)
{
	cairo_move_to(c, -0.3, -0.4);
	cairo_line_to(c, -0.25, 0.15);
	cairo_line_to(c, 0.35, 0.15);
	cairo_line_to(c, 0.7, 0.85);
	line(c, -0.28, -0.15, 0.3, -0.15);
	cairo_new_sub_path(c);
	cairo_arc(c, -0.15, 0.38, 0.57, 0.2, 3.7);
	dot(c, -0.32, -0.8, 0.2);
}

static void draw_light(cairo_t *c)
{
	line(c, -0.98, 0.9, 0.98, 0.9);
	for (int ray = 0; ray < 4; ray++) {
		const double turn = -0.1 - ray * 0.5, x = cos(turn), y = sin(turn);

		line(c, -0.55 + 0.62 * x, 0.25 + 0.62 * y, -0.55 + 1.1 * x, 0.25 + 1.1 * y);
	}
	cairo_move_to(c, 0.3, 0.9);
	cairo_curve_to(c, 0.4, 0.35, 0.85, 0.35, 0.95, 0.9);
	dot(c, -0.55, 0.25, 0.34);
}

static void draw_section(cairo_t *c)
{
	cairo_rectangle(c, -0.85, -0.5, 1.7, 1.1);
	line(c, 0, -1, 0, 1);
	cairo_stroke(c);
	cairo_rectangle(c, -0.85, -0.5, 0.85, 1.1);
	cairo_fill(c);
}

static void draw_close(cairo_t *c)
{
	line(c, -0.85, -0.85, 0.85, 0.85);
	line(c, -0.85, 0.85, 0.85, -0.85);
}

static void draw_forward(cairo_t *c)
{
	cairo_move_to(c, -0.4, -0.8);
	cairo_line_to(c, 0.4, 0);
	cairo_line_to(c, -0.4, 0.8);
}

static void draw_back(cairo_t *c)
{
	cairo_move_to(c, 0.4, -0.8);
	cairo_line_to(c, -0.4, 0);
	cairo_line_to(c, 0.4, 0.8);
}

static void draw_search(cairo_t *c)
{
	ring(c, -0.2, -0.2, 0.68);
	line(c, 0.3, 0.3, 0.9, 0.9);
}

static void draw_space(cairo_t *c)
{
	cairo_move_to(c, -1, 0);
	cairo_line_to(c, -1, 0.45);
	cairo_line_to(c, 1, 0.45);
	cairo_line_to(c, 1, 0);
}

static void draw_large(cairo_t *c)
{
	draw_letter(c, -0.66, 0.3, 0.8);
	draw_letter(c, 0.36, 0.58, 1.65);
}

static void draw_tour(cairo_t *c)
{
	cairo_move_to(c, -0.6, 0.7);
	cairo_curve_to(c, 1.5, 0.6, -1.5, -0.35, 0.3, -0.55);
	cairo_stroke(c);
	ring(c, 0.62, -0.6, 0.3);
	dot(c, -0.75, 0.7, 0.26);
}

static void draw_walk(cairo_t *c)
{
	dot(c, 0.08, -0.85, 0.2);
	cairo_move_to(c, 0.02, -0.45); /* the trunk, and the leg behind */
	cairo_line_to(c, -0.08, 0.15);
	cairo_line_to(c, -0.55, 0.95);
	cairo_stroke(c);
	cairo_move_to(c, -0.08, 0.15); /* the leg in front */
	cairo_line_to(c, 0.3, 0.5);
	cairo_line_to(c, 0.42, 0.95);
	cairo_stroke(c);
	cairo_move_to(c, -0.55, 0.1); /* the arms */
	cairo_line_to(c, -0.4, -0.3);
	cairo_line_to(c, 0.02, -0.45);
	cairo_line_to(c, 0.3, -0.15);
	cairo_line_to(c, 0.6, -0.05);
}

/* A ruler that lies aslant. */
static void draw_measure(cairo_t *c)
{
	cairo_save(c);
	cairo_rotate(c, -0.7854);
	cairo_rectangle(c, -1.05, -0.4, 2.1, 0.8);
	for (int i = -2; i <= 2; i++)
		line(c, 0.36 * i, -0.4, 0.36 * i, i % 2 ? -0.1 : 0.05);
	cairo_restore(c);
}

static void draw_push(cairo_t *c)
{
	line(c, 0, -0.95, 0, 0.95);
	arrow_head(c, 0, -0.95, 0, -1);
	arrow_head(c, 0, 0.95, 0, 1);
}

static void draw_widen(cairo_t *c)
{
	draw_corners(c, 0.15, 0.9);
}

static void draw_narrow(cairo_t *c)
{
	draw_corners(c, 0.9, 0.15);
}

static void draw_return(cairo_t *c)
{
	line(c, 0.9, 0, -0.9, 0);
	cairo_move_to(c, -0.15, -0.75);
	cairo_line_to(c, -0.9, 0);
	cairo_line_to(c, -0.15, 0.75);
}

static void draw_pause(cairo_t *c)
{
	line(c, -0.4, -0.7, -0.4, 0.7);
	line(c, 0.4, -0.7, 0.4, 0.7);
}

static void draw_listen(cairo_t *c)
{
	cairo_move_to(c, -0.95, -0.3);
	cairo_line_to(c, -0.55, -0.3);
	cairo_line_to(c, -0.1, -0.75);
	cairo_line_to(c, -0.1, 0.75);
	cairo_line_to(c, -0.55, 0.3);
	cairo_line_to(c, -0.95, 0.3);
	cairo_close_path(c);
	for (int wave = 1; wave <= 2; wave++) {
		cairo_new_sub_path(c);
		cairo_arc(c, -0.1, 0, 0.2 + 0.4 * wave, -0.75, 0.75);
	}
}

static void draw_stop(cairo_t *c)
{
	cairo_rectangle(c, -0.6, -0.6, 1.2, 1.2);
	cairo_fill_preserve(c);
}

static void draw_backspace(cairo_t *c)
{
	cairo_move_to(c, -1.2, 0);
	cairo_line_to(c, -0.5, -0.75);
	cairo_line_to(c, 1.1, -0.75);
	cairo_line_to(c, 1.1, 0.75);
	cairo_line_to(c, -0.5, 0.75);
	cairo_close_path(c);
	line(c, -0.1, -0.3, 0.5, 0.3);
	line(c, -0.1, 0.3, 0.5, -0.3);
}

void icon_draw(cairo_t *context, enum icon icon, double x, double y, double size)
{
	static void (*const drawings[])(cairo_t *) = {
		[ICON_CLOSE] = draw_close,     [ICON_FORWARD] = draw_forward,
		[ICON_BACK] = draw_back,       [ICON_HOME] = draw_home,
		[ICON_HELP] = draw_help,       [ICON_TURN] = draw_turn,
		[ICON_ZOOM] = draw_zoom,       [ICON_TAP] = draw_tap,
		[ICON_SEARCH] = draw_search,   [ICON_SPACE] = draw_space,
		[ICON_LARGE] = draw_large,     [ICON_REACH] = draw_seated,
		[ICON_TOUR] = draw_tour,       [ICON_LIGHT] = draw_light,
		[ICON_SECTION] = draw_section, [ICON_PUSH] = draw_push,
		[ICON_MEASURE] = draw_measure, [ICON_WALK] = draw_walk,
		[ICON_WIDEN] = draw_widen,     [ICON_NARROW] = draw_narrow,
		[ICON_LANGUAGES] = draw_globe, [ICON_RETURN] = draw_return,
		[ICON_PAUSE] = draw_pause,     [ICON_BACKSPACE] = draw_backspace,
		[ICON_LISTEN] = draw_listen,   [ICON_STOP] = draw_stop,
	};

	cairo_save(context);
	cairo_translate(context, x, y);
	cairo_scale(context, size / 2, size / 2);
	cairo_set_line_width(context, icon == ICON_TURN || icon == ICON_ZOOM ? 0.13 : 0.24);
	cairo_set_line_cap(context, CAIRO_LINE_CAP_ROUND);
	cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
	cairo_new_path(context);
	drawings[icon](context);
	cairo_stroke(context);
	cairo_restore(context);
}
