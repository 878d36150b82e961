/* Chooses which parts get a callout, orders the labels of each column and resolves overlaps and
 * crossings. */
#include "ui/callout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SHOWN_DETAIL 0.75f /* a shown part stays down to this share of the size limit */

struct candidate {
	uint32_t part;
	int64_t rank; /* the smaller rank stays */
	int order;    /* index in the last frame's list, or -1 */
	float x_px, y_px;
	int label_px;
};

struct column {
	struct candidate list[CALLOUTS_A_SIDE];
	uint32_t count;
	int centre_px[CALLOUTS_A_SIDE]; /* centres of the labels */
	bool left;
};

struct layout {
	const struct callout_area *area;
	const struct callout_anchor *anchors;
	uint32_t anchor_count;
	const struct callouts *before;
	float left_port_px, right_port_px;
	bool strict;     /* choose sides by the middle alone */
	float detail_px; /* size limit for parts that are not shown yet */
};

static double side_of(double ax, double ay, double bx, double by, double cx, double cy)
{
	return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
}

bool callouts_cross(const struct callout *a, const struct callout *b)
{
	double c = side_of(a->port_x_px, a->port_y_px, a->anchor_x_px, a->anchor_y_px, b->port_x_px,
			   b->port_y_px);
	double d = side_of(a->port_x_px, a->port_y_px, a->anchor_x_px, a->anchor_y_px,
			   b->anchor_x_px, b->anchor_y_px);
	double e = side_of(b->port_x_px, b->port_y_px, b->anchor_x_px, b->anchor_y_px, a->port_x_px,
			   a->port_y_px);
	double f = side_of(b->port_x_px, b->port_y_px, b->anchor_x_px, b->anchor_y_px,
			   a->anchor_x_px, a->anchor_y_px);

	return c * d < 0 && e * f < 0;
}

/* ---- choice and order ---- */

static const struct callout *find_before(const struct layout *layout, uint32_t part, int *order)
{
	for (uint32_t i = 0; i < layout->before->count; i++) {
		if (layout->before->list[i].part == part) {
			*order = (int)i;
			return &layout->before->list[i];
		}
	}
	*order = -1;
	return NULL;
}

static bool is_eligible(const struct layout *layout, const struct callout_anchor *anchor)
{
	const struct callout_area *area = layout->area;

	return anchor->visible && anchor->label_px > 0 && anchor->label_px <= area->column_px &&
	       anchor->x_px >= layout->left_port_px + (float)area->lead_px &&
	       anchor->x_px <= layout->right_port_px - (float)area->lead_px &&
	       anchor->y_px >= (float)(area->y_px - area->above_px) &&
	       anchor->y_px <= (float)(area->y_px + area->height_px);
}

/* A shown label keeps its side while its anchor moves a little past the middle. */
static bool goes_left(const struct layout *layout, const struct callout *before, float x_px)
{
	float middle = (layout->left_port_px + layout->right_port_px) / 2;
	float band = 0.05f * (layout->right_port_px - layout->left_port_px);

	if (before && !layout->strict)
		return before->left ? x_px < middle + band : x_px < middle - band;
	return x_px < middle;
}

static uint32_t capacity(const struct callout_area *area)
{
	int rows = (area->height_px + area->gap_px) / (area->row_px + area->gap_px);

	if (rows < 0)
		rows = 0;
	return rows < CALLOUTS_A_SIDE ? (uint32_t)rows : CALLOUTS_A_SIDE;
}

/* Keeps the `most` best-ranked candidates, unordered. */
static void offer(struct column *column, uint32_t most, struct candidate candidate)
{
	uint32_t worst = 0;

	if (column->count < most) {
		column->list[column->count++] = candidate;
		return;
	}
	for (uint32_t i = 1; i < column->count; i++)
		if (column->list[i].rank > column->list[worst].rank)
			worst = i;
	if (most > 0 && candidate.rank < column->list[worst].rank)
		column->list[worst] = candidate;
}

/* Returns the size limit: the area's, or less, so that the CALLOUTS_FEW largest parts are shown. */
static float detail_of(const struct layout *layout)
{
	float largest[CALLOUTS_FEW] = { 0 }; /* in descending order */

	for (uint32_t i = 0; i < layout->anchor_count; i++) {
		const struct callout_anchor *anchor = &layout->anchors[i];
		float size_px = anchor->size_px > 0 ? anchor->size_px : INFINITY;

		if (!is_eligible(layout, anchor))
			continue;
		for (int k = 0; k < CALLOUTS_FEW; k++) {
			if (size_px <= largest[k])
				continue;
			float smaller = largest[k];
			largest[k] = size_px;
			size_px = smaller;
		}
	}
	return fminf(layout->area->detail_px, largest[CALLOUTS_FEW - 1]);
}

static bool is_detail(const struct layout *layout, const struct callout_anchor *anchor, bool shown)
{
	return anchor->size_px > 0 &&
	       anchor->size_px < layout->detail_px * (shown ? SHOWN_DETAIL : 1);
}

static void choose(const struct layout *layout, struct column *left, struct column *right)
{
	uint32_t most = capacity(layout->area);

	for (uint32_t i = 0; i < layout->anchor_count; i++) {
		const struct callout_anchor *anchor = &layout->anchors[i];
		const struct callout *before;
		struct candidate candidate = { .part = i,
					       .x_px = anchor->x_px,
					       .y_px = anchor->y_px,
					       .label_px = anchor->label_px };

		if (!is_eligible(layout, anchor))
			continue;
		before = find_before(layout, i, &candidate.order);
		if (is_detail(layout, anchor, before))
			continue;
		/* A shown part stays, unless a much more important one comes. */
		candidate.rank = 4 * (int64_t)i - (before ? layout->anchor_count : 0);
		offer(goes_left(layout, before, anchor->x_px) ? left : right, most, candidate);
	}
}

static void swap(struct column *column, uint32_t a, uint32_t b)
{
	struct candidate candidate = column->list[a];

	column->list[a] = column->list[b];
	column->list[b] = candidate;
}

static int by_height(const void *a, const void *b)
{
	const struct candidate *left = a, *right = b;

	if (left->y_px != right->y_px)
		return left->y_px < right->y_px ? -1 : 1;
	return left->part < right->part ? -1 : 1;
}

/* Sorts by height, but labels of the last frame keep their order among themselves. */
static void sort(struct column *column)
{
	qsort(column->list, column->count, sizeof(column->list[0]), by_height);
	for (uint32_t i = 1; i < column->count; i++) {
		if (column->list[i].order < 0)
			continue;
		/* Insertion sort of the old labels only. New ones stay where their height puts
		 * them. */
		for (uint32_t at = i; at > 0;) {
			uint32_t above = at - 1;

			while (above > 0 && column->list[above].order < 0)
				above--;
			if (column->list[above].order < 0 ||
			    column->list[above].order < column->list[at].order)
				break;
			swap(column, above, at);
			at = above;
		}
	}
}

/* ---- heights ---- */

/* Pools adjacent violators: labels that touch form a pool at the mean of the heights they want. */
static void settle(const struct layout *layout, struct column *column)
{
	const struct callout_area *area = layout->area;
	int pitch = area->row_px + area->gap_px;
	float low = (float)area->y_px + (float)area->row_px / 2;
	float high = (float)(area->y_px + area->height_px) - (float)area->row_px / 2 -
		     (float)(((int)column->count - 1) * pitch);
	float mean[CALLOUTS_A_SIDE];
	uint32_t size[CALLOUTS_A_SIDE], pools = 0, at = 0;

	for (uint32_t i = 0; i < column->count; i++) {
		mean[pools] = column->list[i].y_px - (float)((int)i * pitch);
		size[pools++] = 1;
		while (pools > 1 && mean[pools - 2] > mean[pools - 1]) {
			uint32_t both = size[pools - 2] + size[pools - 1];

			mean[pools - 2] = (mean[pools - 2] * (float)size[pools - 2] +
					   mean[pools - 1] * (float)size[pools - 1]) /
					  (float)both;
			size[--pools - 1] = both;
		}
	}
	for (uint32_t p = 0; p < pools; p++) {
		float base = fminf(fmaxf(mean[p], low), fmaxf(high, low));

		for (uint32_t k = 0; k < size[p]; k++, at++)
			column->centre_px[at] = (int)floorf(base) + (int)at * pitch;
	}
}

static struct callout place(const struct layout *layout, const struct column *column, uint32_t i)
{
	const struct candidate *candidate = &column->list[i];
	struct callout out = { .part = candidate->part,
			       .left = column->left,
			       .width_px = candidate->label_px,
			       .anchor_x_px = candidate->x_px,
			       .anchor_y_px = candidate->y_px };

	out.y_px = column->centre_px[i] - layout->area->row_px / 2;
	out.port_x_px = column->left ? layout->left_port_px : layout->right_port_px;
	out.port_y_px = (float)out.y_px + (float)layout->area->row_px / 2;
	out.x_px = (int)out.port_x_px - (column->left ? candidate->label_px : 0);
	return out;
}

static bool find_crossing(const struct layout *layout, const struct column *column, uint32_t *a,
			  uint32_t *b)
{
	for (uint32_t i = 0; i < column->count; i++) {
		struct callout upper = place(layout, column, i);

		for (uint32_t k = i + 1; k < column->count; k++) {
			struct callout lower = place(layout, column, k);

			if (callouts_cross(&upper, &lower)) {
				*a = i;
				*b = k;
				return true;
			}
		}
	}
	return false;
}

/* Heights change with the order, so the proof of termination for fixed positions does not fully
 * hold. The number of swaps is therefore limited; past the limit, the less important of the two
 * labels is removed. */
static void uncross(const struct layout *layout, struct column *column)
{
	uint32_t tries = column->count * column->count, a, b;

	settle(layout, column);
	while (find_crossing(layout, column, &a, &b)) {
		if (tries > 0) {
			tries--;
			swap(column, a, b);
		} else {
			uint32_t gone = column->list[a].rank > column->list[b].rank ? a : b;

			column->count--;
			memmove(&column->list[gone], &column->list[gone + 1],
				(column->count - gone) * sizeof(column->list[0]));
		}
		settle(layout, column);
	}
}

/* Distance from a point to a leader, pixels. */
static float distance_to(const struct callout *leader, float x_px, float y_px)
{
	float dx = leader->anchor_x_px - leader->port_x_px;
	float dy = leader->anchor_y_px - leader->port_y_px;
	float square = dx * dx + dy * dy, t = 0;

	if (square > 0)
		t = ((x_px - leader->port_x_px) * dx + (y_px - leader->port_y_px) * dy) / square;
	t = fminf(fmaxf(t, 0), 1);
	return hypotf(leader->port_x_px + t * dx - x_px, leader->port_y_px + t * dy - y_px);
}

/* The distance that the leaders of two neighbours keep from each other's dots. */
static float clearance(const struct layout *layout, const struct column *column, uint32_t upper)
{
	struct callout a = place(layout, column, upper), b = place(layout, column, upper + 1);

	return fminf(distance_to(&a, b.anchor_x_px, b.anchor_y_px),
		     distance_to(&b, a.anchor_x_px, a.anchor_y_px));
}

/* If a leader almost runs through another label's dot, it seems to belong to that label. Neighbours
 * change places if that separates them clearly. */
static void clear_dots(const struct layout *layout, struct column *column)
{
	float near_px = (float)layout->area->row_px / 3;

	for (uint32_t i = 0; i + 1 < column->count; i++) {
		struct column tried = *column;
		float now_px = clearance(layout, column, i);
		uint32_t a, b;

		if (now_px >= near_px)
			continue;
		swap(&tried, i, i + 1);
		settle(layout, &tried);
		if (clearance(layout, &tried, i) > 2 * near_px - now_px &&
		    !find_crossing(layout, &tried, &a, &b))
			*column = tried;
	}
}

static void lay_out(const struct layout *layout, struct callouts *out)
{
	struct column columns[2] = { { .left = true }, { .left = false } };

	choose(layout, &columns[0], &columns[1]);
	out->count = 0;
	for (int side = 0; side < 2; side++) {
		sort(&columns[side]);
		uncross(layout, &columns[side]);
		clear_dots(layout, &columns[side]);
		for (uint32_t i = 0; i < columns[side].count; i++)
			out->list[out->count++] = place(layout, &columns[side], i);
	}
}

static bool sides_cross(const struct callouts *callouts)
{
	for (uint32_t i = 0; i < callouts->count; i++)
		for (uint32_t k = i + 1; k < callouts->count; k++)
			if (callouts->list[i].left != callouts->list[k].left &&
			    callouts_cross(&callouts->list[i], &callouts->list[k]))
				return true;
	return false;
}

void callouts_layout(struct callouts *callouts, const struct callout_area *area,
		     const struct callout_anchor *anchors, uint32_t count)
{
	struct layout layout = {
		.area = area, .anchors = anchors, .anchor_count = count, .before = callouts
	};
	struct callouts out;

	layout.left_port_px = (float)(area->x_px + area->column_px);
	layout.right_port_px = (float)(area->x_px + area->width_px - area->column_px);
	layout.detail_px = detail_of(&layout);
	lay_out(&layout, &out);
	if (sides_cross(&out)) {
		/* With sides chosen by the middle alone, leaders of different sides cannot
		 * cross. */
		layout.strict = true;
		lay_out(&layout, &out);
	}
	*callouts = out;
}
