/* Where the views of an overlay leave room for one another, from what is open. Private to ui; tests
 * look at it too. */
#ifndef GOPURA_UI_OVERLAY_LAYOUT_H
#define GOPURA_UI_OVERLAY_LAYOUT_H

#include "ui/overlay_state.h"

/* Returns the layout as it is now. */
struct screen overlay_screen(const struct overlay *overlay);
/* Returns true if a tour runs and nothing else takes its place. */
bool overlay_tour_shows(const struct overlay *overlay);
/* Returns what is open and in the way of the tools' discs. */
struct tools_view_obstacles overlay_obstacles(const struct overlay *overlay,
					      const struct screen *screen);
/* Returns the room for callouts: they end above whatever stands low in the scene, and above or left
 * of the tools. */
struct callouts_view_room overlay_callouts_room(const struct overlay *overlay,
						const struct screen *screen);

#endif
