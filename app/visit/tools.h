/* The visitor's use of the tools that the content offers: a raking light, a section,
 * measuring, and walking. See docs/tools.md. */
#ifndef GOPURA_APP_VISIT_TOOLS_H
#define GOPURA_APP_VISIT_TOOLS_H

#include "app/view/anchors.h"
#include "app/view/eye.h"
#include "app/view/redraw.h"
#include "app/visit/measuring.h"
#include "input/touch.h"

/* What the tools work with; borrowed. */
struct tools_env {
	const struct exhibit *shown;
	struct eye *eye;
	const struct viewport *viewport;
	struct anchors *anchors;
	struct redraw *redraw;
};

struct tools {
	struct tools_env env;
	struct scene_tools now;
	struct measuring measure;
	bool walks, no_way;       /* no_way: none leads to what was touched last */
	enum overlay_handle held; /* the handle that a finger holds; one at a time */
	uint32_t contact;         /* the contact of that finger */
	float grabbed_at[2]; /* where on the disc the finger came down; how far from a measured end
			      */
	float grabbed_push_m;
};

/* All tools are off at first. */
void tools_init(struct tools *tools, const struct tools_env *env);
/* Switches a tool on or off. */
void tools_press(struct tools *tools, enum overlay_tool tool);
/* Switches all off, for the next visitor. */
void tools_end(struct tools *tools);
/* Returns whether a tool is on. */
bool tools_are_used(const struct tools *tools);
/* A tap on the model: with measuring on it sets an end, on foot it leads there. Returns false if no
 * tool takes it. */
bool tools_take_tap(struct tools *tools, float x_px, float y_px);
/* Handles a touch on a tool's disc or on the knob of a measured end. Returns true if the finger
 * belongs to the tool until it lifts.
 */
bool tools_take_touch(struct tools *tools, const struct touch_event *event);
/* Called before each frame: tells scene and overlay the tools' state. */
void tools_show(struct tools *tools);

#endif
