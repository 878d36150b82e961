/* The control discs of the tools: a lamp on its ring, and a section seen from above. Each disc has
 * its own place above the bar's line, at the right end of the scene, and shows unless something
 * open covers that place. */
#ifndef GOPURA_UI_TOOLS_VIEW_H
#define GOPURA_UI_TOOLS_VIEW_H

#include "ui/action.h"
#include "ui/fade.h"
#include "ui/layers.h"
#include "ui/overlay_data.h"
#include "ui/screen.h"

/* Places that something open takes. Text has priority over controls: a disc hides, but its tool
 * stays on and keeps its effect. */
struct tools_view_obstacles {
	bool all; /* something takes the whole panel */
	struct rect rects[6];
	uint32_t count;
};

struct tools_view {
	unsigned offered; /* by the content; mask of enum overlay_tool */
	bool fit;         /* the bar has room for their buttons */
	struct overlay_tools now;
	struct fade fades[OVERLAY_DISC_COUNT]; /* on: the disc is visible */
	int drawn_width_px, drawn_height_px;   /* the size for which the discs were drawn */
	bool dirty;
	struct sprite discs[OVERLAY_DISC_COUNT], knob, push_knob, line;
};

/* The knobs; centres in pixels of the panel. */
struct tools_view_knobs {
	float light[2], turn[2], push[2];
	float along[2];          /* direction of the push, a unit vector */
	float line_px, thick_px; /* half the length and half the thickness of the section's line */
};

void tools_view_init(struct tools_view *view, uint32_t *next_id);
void tools_view_finish(struct tools_view *view);

/* Returns the place of a tool's disc. */
struct rect tools_view_rect(const struct tools_view *view, const struct screen *screen, int tool);
/* Returns true if the tool is on and its place is free. */
bool tools_view_shows(const struct tools_view *view, const struct screen *screen,
		      const struct tools_view_obstacles *obstacles, int tool);
/* Top and left edge of the visible discs; the panel's height and width if there are none. */
int tools_view_top(const struct tools_view *view, const struct screen *screen,
		   const struct tools_view_obstacles *obstacles);
int tools_view_left(const struct tools_view *view, const struct screen *screen,
		    const struct tools_view_obstacles *obstacles);
/* Returns true if the point is on a visible disc. */
bool tools_view_covers(const struct tools_view *view, const struct screen *screen,
		       const struct tools_view_obstacles *obstacles, float x_px, float y_px);
/* Returns the handle at that point, or OVERLAY_HANDLE_NONE. */
enum overlay_handle tools_view_handle_at(const struct tools_view *view, const struct screen *screen,
					 const struct tools_view_obstacles *obstacles, float x_px,
					 float y_px);
/* Converts a finger's position to the coordinates of the handle's disc: right, up; the ring is at
 * 1. */
void tools_view_handle_place(const struct tools_view *view, const struct screen *screen,
			     enum overlay_handle handle, float x_px, float y_px, float at[2]);
/* Sets the centres of the knobs and the section's line. */
void tools_view_knobs(const struct tools_view *view, const struct screen *screen,
		      struct tools_view_knobs *out);

/* Draws what changed and advances by step_ms. Returns true if something still moves. *moved is set
 * to true if a disc came or went. */
bool tools_view_update(struct tools_view *view, const struct screen *screen,
		       const struct tools_view_obstacles *obstacles, int64_t step_ms, bool *moved);
void tools_view_layers(const struct tools_view *view, const struct screen *screen,
		       struct layers *layers);

#endif
