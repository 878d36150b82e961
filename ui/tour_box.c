/* Sizes of the box for tours. */
#include "ui/tour_box.h"

#define WIDTH_MM 150.0f

int tour_box_width(const struct screen *screen)
{
	int most_px = screen->scene.width_px - 2 * screen_px(screen, THEME_GAP_MM);
	int width_px = screen_text_px(screen, WIDTH_MM);

	return width_px < most_px ? width_px : most_px;
}

int tour_box_most_height(const struct screen *screen)
{
	int gap_px = screen_px(screen, THEME_GAP_MM), reach_px = screen_reach_top(screen);

	return screen->bar.y_px - gap_px - (reach_px > gap_px ? reach_px + gap_px : gap_px);
}

int tour_box_head(const struct screen *screen)
{
	return screen_text_px(screen, THEME_TARGET_MM) + screen_px(screen, THEME_GAP_MM);
}

int tour_box_cross(const struct screen *screen)
{
	return screen_px(screen, THEME_TARGET_MM) + screen_px(screen, THEME_GAP_MM);
}
