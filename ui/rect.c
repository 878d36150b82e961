/* Tests whether points lie in rectangles, and whether rectangles overlap. */
#include "ui/rect.h"

bool rect_holds(struct rect rect, float x_px, float y_px)
{
	return x_px >= (float)rect.x_px && x_px < (float)(rect.x_px + rect.width_px) &&
	       y_px >= (float)rect.y_px && y_px < (float)(rect.y_px + rect.height_px);
}

bool rect_meets(struct rect a, struct rect b)
{
	return a.x_px < b.x_px + b.width_px && b.x_px < a.x_px + a.width_px &&
	       a.y_px < b.y_px + b.height_px && b.y_px < a.y_px + a.height_px;
}
