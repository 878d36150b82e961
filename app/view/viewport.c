/* Converts between the visitor's pixels and the panel's. */
#include "app/view/viewport.h"

#include <stdbool.h>
#include <string.h>

static bool is_sideways(const struct viewport *viewport)
{
	return viewport->rotation_deg == 90 || viewport->rotation_deg == 270;
}

int viewport_width_px(const struct viewport *viewport)
{
	return is_sideways(viewport) ? viewport->panel_height_px : viewport->panel_width_px;
}

int viewport_height_px(const struct viewport *viewport)
{
	return is_sideways(viewport) ? viewport->panel_width_px : viewport->panel_height_px;
}

void viewport_to_panel(const struct viewport *viewport, float *x_px, float *y_px)
{
	const float width = (float)viewport->panel_width_px;
	const float height = (float)viewport->panel_height_px;
	const float x = *x_px, y = *y_px;

	switch (viewport->rotation_deg) {
	case 90:
		*x_px = y;
		*y_px = height - x;
		break;
	case 180:
		*x_px = width - x;
		*y_px = height - y;
		break;
	case 270:
		*x_px = width - y;
		*y_px = x;
		break;
	}
}

void viewport_from_panel(const struct viewport *viewport, float *x_px, float *y_px)
{
	const float width = (float)viewport->panel_width_px;
	const float height = (float)viewport->panel_height_px;
	const float x = *x_px, y = *y_px;

	switch (viewport->rotation_deg) {
	case 90:
		*x_px = height - y;
		*y_px = x;
		break;
	case 180:
		*x_px = width - x;
		*y_px = height - y;
		break;
	case 270:
		*x_px = y;
		*y_px = width - x;
		break;
	}
}

void viewport_unshift(const struct viewport *viewport, float *x_px, float *y_px)
{
	viewport_to_panel(viewport, x_px, y_px);
	*x_px -= (float)viewport->shift_px[0];
	*y_px += (float)viewport->shift_px[1]; /* GL's y axis points up */
	viewport_from_panel(viewport, x_px, y_px);
}

void viewport_set_camera(const struct viewport *viewport, struct camera *camera)
{
	camera->width_px = viewport->panel_width_px;
	camera->height_px = viewport->panel_height_px;
	camera->rotation_deg = viewport->rotation_deg;
	memcpy(camera->shift_px, viewport->shift_px, sizeof(camera->shift_px));
}
