/* Places callouts: pure geometry, no text, no drawing.
 *
 * Labels stand in two columns, left and right of the model. All leaders of a column start on one
 * vertical line, and anchors lie between the two lines. So no leader can cross a label. The labels
 * of a column are ordered. Their heights are the least-squares solution of "each label as near to
 * its anchor as possible, without touching a neighbour" (isotonic regression by pooling adjacent
 * violators). This solution never moves further than the anchors moved. If two leaders of a column
 * cross, their labels change places; for fixed positions this shortens the leaders, so it
 * terminates. Neighbours also change places if the leader of one almost runs through the other's
 * dot. Side and order of the frame before are kept as long as nothing crosses. A part has a callout
 * while it looks large enough, and a little longer: few callouts from far, details from near.
 *
 * Boundary labelling after Bekos et al. 2007, one-sided with straight leaders, applied twice. */
#ifndef GOPURA_UI_CALLOUT_H
#define GOPURA_UI_CALLOUT_H

#include <stdbool.h>
#include <stdint.h>

enum {
	CALLOUTS_A_SIDE = 14,
	CALLOUTS_MAX = 2 * CALLOUTS_A_SIDE,
	CALLOUTS_FEW = 6, /* so many are shown even if all parts are details */
};

struct callout_area {
	int x_px, y_px, width_px, height_px; /* labels stay inside */
	int column_px;                       /* width of a column; no label is wider */
	int row_px, gap_px;                  /* height of every label; gap between two */
	int lead_px;                         /* minimum horizontal length of a leader */
	int above_px;                        /* how far above the area anchors may lie */
	float detail_px; /* parts that look smaller get no callout yet; 0: no such limit */
};

struct callout_anchor {
	float x_px, y_px;
	bool visible;
	int label_px;  /* width of its label */
	float size_px; /* size of the part on the panel; 0: a place without a size */
};

struct callout {
	uint32_t part; /* index into the anchors */
	bool left;
	int x_px, y_px, width_px;       /* the label; its height is the area's row_px */
	float port_x_px, port_y_px;     /* where the leader leaves the label */
	float anchor_x_px, anchor_y_px; /* where the leader ends */
};

/* Left column from top to bottom, then the right one. The list itself is the state that keeps the
 * next layout stable: zero it once, then pass it again. */
struct callouts {
	struct callout list[CALLOUTS_MAX];
	uint32_t count;
};

/* Lays out callouts for count anchors, starting from the last layout. Earlier anchors are more
 * important: they stay if there are more than fit. */
void callouts_layout(struct callouts *callouts, const struct callout_area *area,
		     const struct callout_anchor *anchors, uint32_t count);

/* Returns true if the two leaders cross strictly (a shared end does not count). */
bool callouts_cross(const struct callout *a, const struct callout *b);

#endif
