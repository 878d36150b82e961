/* Computes the room that the open views leave for each view. */
#include "ui/overlay_layout.h"

/* What page or search leave of the panel. */
static struct rect scene_of(const struct overlay *overlay, const struct screen *screen)
{
	struct rect rect = { 0, 0, screen->width_px, screen->height_px };
	struct rect taken;

	if (overlay->search.fade.on)
		taken = search_view_rect(screen);
	else if (overlay->page.part >= 0)
		taken = screen_half(screen);
	else
		return rect;
	/* If the search leaves nothing of the panel, the model keeps the whole panel behind it. */
	if (taken.x_px > 0)
		rect.width_px = taken.x_px;
	else if (taken.y_px > 0)
		rect.height_px = taken.y_px;
	return rect;
}

struct screen overlay_screen(const struct overlay *overlay)
{
	struct screen screen = {
		.theme = &overlay->theme,
		.width_px = overlay->width_px,
		.height_px = overlay->height_px,
		.reach = overlay->comfort.reach,
		.bar = bar_view_rect(&overlay->bar, &overlay->theme, overlay->height_px),
	};

	screen.scene = scene_of(overlay, &screen);
	return screen;
}

bool overlay_tour_shows(const struct overlay *overlay)
{
	return overlay->tour.runs && overlay->card.part < 0 && overlay->page.part < 0 &&
	       !overlay->search.fade.on && !overlay->help.fade.on && !overlay->tours.fade.on;
}

static void add_obstacle(struct tools_view_obstacles *obstacles, bool is_open, struct rect rect)
{
	if (is_open)
		obstacles->rects[obstacles->count++] = rect;
}

struct tools_view_obstacles overlay_obstacles(const struct overlay *overlay,
					      const struct screen *screen)
{
	struct tools_view_obstacles obstacles = { .all = overlay->gallery.fade.on ||
							 overlay->invitation.fade.on };

	add_obstacle(&obstacles, overlay->search.fade.on, search_view_rect(screen));
	add_obstacle(&obstacles, overlay->page.part >= 0, page_view_rect(&overlay->page, screen));
	add_obstacle(&obstacles, overlay->card.part >= 0, card_view_rect(screen));
	add_obstacle(&obstacles, overlay->help.fade.on, help_view_rect(&overlay->help, screen));
	add_obstacle(&obstacles, overlay->tours.fade.on, tours_view_rect(&overlay->tours, screen));
	add_obstacle(&obstacles, overlay_tour_shows(overlay),
		     tour_player_view_rect(&overlay->tour, screen));
	return obstacles;
}

struct callouts_view_room overlay_callouts_room(const struct overlay *overlay,
						const struct screen *screen)
{
	const struct tools_view_obstacles obstacles = overlay_obstacles(overlay, screen);
	const int gap_px = screen_px(screen, THEME_GAP_MM);
	const int tools_px = tools_view_top(&overlay->tools, screen, &obstacles) - gap_px;
	struct callouts_view_room room = {
		.chosen = { overlay->card.part, overlay->page.part },
		.floor_px = screen_floor(screen),
		.right_px = tools_view_left(&overlay->tools, screen, &obstacles),
		.taken = overlay->page.part >= 0 || overlay->search.fade.on,
	};

	if (overlay->card.part >= 0)
		room.floor_px = card_view_rect(screen).y_px - gap_px;
	else if (overlay->tours.fade.on)
		room.floor_px = tours_view_rect(&overlay->tours, screen).y_px - gap_px;
	else if (overlay_tour_shows(overlay))
		room.floor_px = tour_player_view_rect(&overlay->tour, screen).y_px - gap_px;
	else if (overlay->invitation.fade.on)
		room.floor_px = invitation_view_rect(&overlay->invitation, screen).y_px - gap_px;
	else if (overlay->help.fade.on)
		room.floor_px = help_view_rect(&overlay->help, screen).y_px - gap_px;
	if (!screen->reach && tools_px < room.floor_px)
		room.floor_px = tools_px;
	return room;
}
