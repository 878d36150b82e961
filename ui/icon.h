/* Pictograms drawn as strokes in the context's source colour. */
#ifndef GOPURA_UI_ICON_H
#define GOPURA_UI_ICON_H

#include <cairo.h>

enum icon {
	ICON_CLOSE,
	ICON_FORWARD,
	ICON_BACK,
	ICON_HOME,
	ICON_RETURN, /* an arrow back to the last place */
	ICON_HELP,
	ICON_TURN, /* one finger moves sideways */
	ICON_ZOOM, /* two fingers move apart */
	ICON_TAP,
	ICON_SEARCH,
	ICON_SPACE,
	ICON_BACKSPACE,
	ICON_LARGE, /* large type */
	ICON_REACH, /* a person in a wheelchair */
	ICON_TOUR,  /* a path from stop to stop */
	ICON_PAUSE,
	ICON_LISTEN, /* a loudspeaker */
	ICON_STOP,
	ICON_LIGHT,   /* a lamp low beside a relief */
	ICON_SECTION, /* a solid that is cut */
	ICON_MEASURE, /* a ruler */
	ICON_WALK,    /* a person who walks */
	ICON_PUSH,    /* two arrows, to and fro */
	ICON_WIDEN,   /* arrows out into the corners */
	ICON_NARROW,
	ICON_LANGUAGES, /* a globe */
};

/* Draws an icon, about size across, centred on x, y. */
void icon_draw(cairo_t *context, enum icon icon, double x, double y, double size);

#endif
