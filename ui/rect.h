/* A rectangle in pixels of the panel as the visitor sees it: x right, y down. */
#ifndef GOPURA_UI_RECT_H
#define GOPURA_UI_RECT_H

#include <stdbool.h>

struct rect {
	int x_px, y_px, width_px, height_px;
};

/* Returns true if the point is in the rectangle. The right and the lower edge are outside. */
bool rect_holds(struct rect rect, float x_px, float y_px);
/* Returns true if the rectangles share at least one pixel. */
bool rect_meets(struct rect a, struct rect b);

#endif
