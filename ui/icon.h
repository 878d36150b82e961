/* A few pictograms as strokes, in the source colour of the context. */
#ifndef GOPURA_UI_ICON_H
#define GOPURA_UI_ICON_H

#include <cairo.h>

enum icon {
	ICON_CLOSE,
	ICON_FORWARD,
	ICON_BACK,
	ICON_HOME,
	ICON_RETURN, /* an arrow to where one came from */
	ICON_HELP,
	ICON_TURN, /* one finger goes sideways */
	ICON_ZOOM, /* two fingers part */
	ICON_TAP,
	ICON_SEARCH,
	ICON_SPACE,
	ICON_BACKSPACE,
	ICON_LARGE, /* type */
	ICON_REACH, /* who sits in a wheelchair */
	ICON_TOUR,  /* a way from stop to stop */
	ICON_PAUSE,
	ICON_LIGHT,   /* a lamp low beside a relief */
	ICON_SECTION, /* a body that is cut */
	ICON_PUSH,    /* to and fro */
	ICON_WIDEN,   /* out into the corners */
	ICON_NARROW,
	ICON_LANGUAGES, /* a globe */
};

/* About size across, centred on x, y. */
void icon_draw(cairo_t *context, enum icon icon, double x, double y, double size);

#endif
