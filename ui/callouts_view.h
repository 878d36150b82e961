/* The names of parts beside the model, each with a leader to its place. ui/callout.h computes where
 * they go; this view keeps labels that come and go, and draws them. */
#ifndef GOPURA_UI_CALLOUTS_VIEW_H
#define GOPURA_UI_CALLOUTS_VIEW_H

#include "ui/callout.h"
#include "ui/fade.h"
#include "ui/layers.h"
#include "ui/overlay_data.h"
#include "ui/parts.h"
#include "ui/screen.h"

enum { CALLOUT_LABELS = 64 };

struct callouts_view_label {
	int part; /* -1: the label is free */
	bool drawn, drawn_chosen;
	struct fade fade, dim; /* dim.on: its part is hidden */
	int64_t hidden_ms;     /* how long it has been hidden */
	struct callout place;
	struct sprite sprite;
};

/* What is known of a part. */
struct callouts_view_part {
	int label_px; /* width of the label */
	struct overlay_anchor anchor;
};

struct callouts_view {
	struct callouts_view_part *parts; /* owned */
	struct callout_anchor *anchors;   /* owned; as many */
	uint32_t part_count, part_room, anchor_room;
	bool dirty;    /* lay out again */
	int column_px; /* width of the widest label */
	struct callouts callouts;
	struct callouts_view_label labels[CALLOUT_LABELS];
	struct sprite leader, dot;
};

/* What is open, as far as it concerns callouts. */
struct callouts_view_room {
	int chosen[2]; /* parts that never count as details and whose labels are lit; -1: none */
	int floor_px;  /* labels end above this line */
	int right_px;  /* and left of this one, in reach mode */
	bool taken;    /* page or search take the labels' place in reach mode */
};

/* Draws what never changes. */
void callouts_view_init(struct callouts_view *view, const struct theme *theme, uint32_t *next_id);
void callouts_view_finish(struct callouts_view *view);

/* Makes room for that many parts, and changes nothing else. Returns -ENOMEM. */
must_check int callouts_view_reserve(struct callouts_view *view, uint32_t part_count);
/* There is room for these parts: they are shown from now on, once their anchors are given. */
void callouts_view_set_parts(struct callouts_view *view, const struct theme *theme,
			     const struct parts *parts);
/* The size of type changed: measures the labels again. */
void callouts_view_measure(struct callouts_view *view, const struct theme *theme,
			   const struct parts *parts);
/* Drops all labels; they fade in again. */
void callouts_view_forget(struct callouts_view *view);
/* Copies the anchors. Extra entries are ignored. */
void callouts_view_anchors(struct callouts_view *view, const struct overlay_anchor *anchors,
			   uint32_t count);

/* Returns the height of a label. */
int callouts_view_row_px(const struct screen *screen);
/* Returns the part whose label is at that point, or -1. */
int callouts_view_part_at(const struct callouts_view *view, const struct screen *screen, float x_px,
			  float y_px);
/* Lays out if necessary, draws what changed and advances by step_ms. Returns true if something
 * still moves. */
bool callouts_view_update(struct callouts_view *view, const struct screen *screen,
			  const struct parts *parts, const struct callouts_view_room *room,
			  int64_t step_ms);
void callouts_view_layers(const struct callouts_view *view, struct layers *layers);

#endif
