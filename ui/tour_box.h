/* The box that the menu of tours and the tour that runs stand in: its size and its head. */
#ifndef GOPURA_UI_TOUR_BOX_H
#define GOPURA_UI_TOUR_BOX_H

#include "ui/screen.h"

#define TOUR_BOX_PADDING_MM 3.0f
#define TOUR_BOX_ICON_MM    3.2f

int tour_box_width(const struct screen *screen);
/* The height available above the bar; in reach mode only its low part. */
int tour_box_most_height(const struct screen *screen);
/* The height of the head, the line with the title. */
int tour_box_head(const struct screen *screen);
/* The width of the control that closes. It takes the whole end of the head. */
int tour_box_cross(const struct screen *screen);

#endif
