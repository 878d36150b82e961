/* The request for a frame: whoever changes the picture asks for one, and the loop draws it when the
 * panel is ready. */
#ifndef GOPURA_APP_VIEW_REDRAW_H
#define GOPURA_APP_VIEW_REDRAW_H

#include <stdbool.h>

struct redraw {
	bool wanted;
};

/* Requests a frame, because the picture has changed. */
static inline void redraw_ask(struct redraw *redraw)
{
	redraw->wanted = true;
}

#endif
