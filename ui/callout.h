/* Where callouts go: pure geometry, no text, no drawing.
 *
 * Labels stand in two columns, left and right of the model, with all leader ends of a column on
 * one vertical line; anchors between the two lines only. So no leader can run over a label. A
 * column's labels are ordered; their heights are the least-squares answer to "as near to your
 * anchor as you can without touching a neighbour" (isotonic regression by pooling adjacent
 * violators), which never moves further than the anchors moved. Where two leaders of a column
 * cross, the two labels change places (for given places that shortens the leaders, so it ends), and
 * so do neighbours of which one's leader all but runs through the other's dot; side and order of
 * the frame before are kept as long as nothing crosses. Few from far, details from near: a part has
 * one while it looks large enough, and a little longer.
 *
 * Boundary labelling after Bekos et al. 2007, one-sided straight leaders, twice. */
#ifndef GOPURA_UI_CALLOUT_H
#define GOPURA_UI_CALLOUT_H

#include <stdbool.h>
#include <stdint.h>

enum {
	CALLOUTS_A_SIDE = 14,
	CALLOUTS_MAX = 2 * CALLOUTS_A_SIDE,
	CALLOUTS_FEW = 6, /* as many are shown even where all are details */
};

struct callout_area {
	int x_px, y_px, width_px, height_px; /* labels stay inside */
	int column_px;                       /* width of a column; no label is wider */
	int row_px, gap_px;                  /* height of every label; between two */
	int lead_px;                         /* shortest horizontal run of a leader */
	int above_px;                        /* how far above it anchors may lie */
	float detail_px; /* parts that look smaller wait until they are nearer; 0: none do */
};

struct callout_anchor {
	float x_px, y_px;
	bool visible;
	int label_px;  /* width of its label */
	float size_px; /* across, of the part as it is seen; 0: of a place without a size */
};

struct callout {
	uint32_t part; /* index into the anchors */
	bool left;
	int x_px, y_px, width_px;       /* of the label; its height is the area's row */
	float port_x_px, port_y_px;     /* where the leader leaves the label */
	float anchor_x_px, anchor_y_px; /* where it ends */
};

/* Left column from top to bottom, then the right one. The state that makes the next layout stable
 * is this list itself: zero it once, then pass it again. */
struct callouts {
	struct callout list[CALLOUTS_MAX];
	uint32_t count;
};

/* Earlier anchors are more important: they stay when there are more than fit. */
void callouts_layout(struct callouts *callouts, const struct callout_area *area,
		     const struct callout_anchor *anchors, uint32_t count);

/* The two leaders cross strictly (a shared end does not count). */
bool callouts_cross(const struct callout *a, const struct callout *b);

#endif
