/* Computes the places on the panel that several views refer to. */
#include "ui/screen.h"

/* Reach mode uses a third of the panel, but not less than the search needs with keys of
 * THEME_TARGET_MM. */
#define REACH_MM          70.0f
#define REACH_PORTRAIT_MM 110.0f
#define REACH_WIDTH_MM    200.0f /* two keyboards side by side */

int screen_px(const struct screen *screen, float mm)
{
	return theme_px(screen->theme, mm);
}

int screen_text_px(const struct screen *screen, float mm)
{
	return theme_text_px(screen->theme, mm);
}

bool screen_is_portrait(const struct screen *screen)
{
	return screen->height_px > screen->width_px;
}

static int reach_height(const struct screen *screen)
{
	int least_px = screen_px(screen, screen_is_portrait(screen) ? REACH_PORTRAIT_MM : REACH_MM);

	return screen->height_px / 3 > least_px ? screen->height_px / 3 : least_px;
}

bool screen_offers_reach(const struct screen *screen)
{
	int least_px =
		screen_px(screen, screen_is_portrait(screen) ? REACH_WIDTH_MM / 2 : REACH_WIDTH_MM);

	return 2 * reach_height(screen) <= screen->height_px && screen->width_px >= least_px;
}

int screen_reach_top(const struct screen *screen)
{
	return screen->reach ? screen->height_px - reach_height(screen) : 0;
}

bool screen_is_flat(const struct screen *screen)
{
	return screen->reach && !screen_is_portrait(screen);
}

struct rect screen_half(const struct screen *screen)
{
	struct rect rect = { 0, 0, screen->width_px, screen->height_px };

	if (screen->reach || screen_is_portrait(screen)) {
		rect.y_px = screen->reach ? screen_reach_top(screen) : screen->height_px / 2;
		rect.height_px -= rect.y_px;
	} else {
		rect.x_px = screen->width_px / 2;
		rect.width_px -= rect.x_px;
	}
	return rect;
}

int screen_floor(const struct screen *screen)
{
	int bottom_px = screen->scene.y_px + screen->scene.height_px;

	return (bottom_px < screen->bar.y_px && !screen->reach ? bottom_px : screen->bar.y_px) -
	       screen_px(screen, THEME_GAP_MM);
}

struct rect screen_above_floor(const struct screen *screen, int width_px, int height_px)
{
	return (struct rect){ screen->scene.x_px + (screen->scene.width_px - width_px) / 2,
			      screen_floor(screen) - height_px, width_px, height_px };
}
