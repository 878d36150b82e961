/* Computes the rectangle of every element on the panel, and lays callouts out into labels. */
#include <stdlib.h>

#include "ui/overlay_state.h"

#define HEAD_MM  13.0f
#define DETAIL   0.05f /* share of the scene's height; smaller parts are details */
#define CLOSE_MM 34.0f /* maximum width of the close control */

static int px(const struct overlay *overlay, float mm)
{
	return theme_px(&overlay->theme, mm);
}

/* Without the scene, which depends on what is open. */
static struct screen bare_screen(const struct overlay *overlay)
{
	return (struct screen){ .theme = &overlay->theme,
				.width_px = overlay->width_px,
				.height_px = overlay->height_px,
				.reach = overlay->comfort.reach,
				.bar = overlay_chrome_rect(overlay) };
}

struct screen overlay_screen(const struct overlay *overlay)
{
	struct screen screen = bare_screen(overlay);

	screen.scene = overlay_scene_rect(overlay);
	return screen;
}

bool overlay_is_portrait(const struct overlay *overlay)
{
	const struct screen screen = bare_screen(overlay);

	return screen_is_portrait(&screen);
}

bool overlay_offers_reach(const struct overlay *overlay)
{
	const struct screen screen = bare_screen(overlay);

	return screen_offers_reach(&screen);
}

int overlay_reach_top(const struct overlay *overlay)
{
	const struct screen screen = bare_screen(overlay);

	return screen_reach_top(&screen);
}

bool overlay_is_flat(const struct overlay *overlay)
{
	const struct screen screen = bare_screen(overlay);

	return screen_is_flat(&screen);
}

struct rect overlay_half_rect(const struct overlay *overlay)
{
	const struct screen screen = bare_screen(overlay);

	return screen_half(&screen);
}

struct rect overlay_page_rect(const struct overlay *overlay)
{
	if (overlay->page_wide)
		return (struct rect){ 0, 0, overlay->width_px, overlay->height_px };
	return overlay_half_rect(overlay);
}

struct rect overlay_scene_rect(const struct overlay *overlay)
{
	struct rect rect = { 0, 0, overlay->width_px, overlay->height_px };

	if (overlay->search.fade.on) {
		struct rect search = overlay_search_rect(overlay);

		/* If the search leaves nothing of the panel, the model keeps the whole panel behind
		 * it. */
		if (search.x_px > 0)
			rect.width_px = search.x_px;
		else if (search.y_px > 0)
			rect.height_px = search.y_px;
		return rect;
	}
	if (overlay->page_part >= 0 && overlay_half_rect(overlay).y_px > 0)
		rect.height_px = overlay_half_rect(overlay).y_px;
	else if (overlay->page_part >= 0)
		rect.width_px = overlay_half_rect(overlay).x_px;
	return rect;
}

/* On a flat panel the head is in the lowest line, beside the bar; else it is on top of the
 * paper. */
struct rect overlay_head_rect(const struct overlay *overlay, struct rect paper)
{
	if (overlay_is_flat(overlay)) {
		paper.x_px = overlay->width_px / 2;
		paper.width_px = overlay->width_px - paper.x_px;
		paper.y_px = overlay_chrome_rect(overlay).y_px - px(overlay, THEME_GAP_MM);
		paper.height_px = overlay->height_px - paper.y_px;
	} else {
		paper.height_px = px(overlay, HEAD_MM);
	}
	return paper;
}

struct rect overlay_close_in(const struct overlay *overlay, struct rect head)
{
	int width_px = theme_text_px(&overlay->theme, CLOSE_MM), gap_px = px(overlay, THEME_GAP_MM);

	return (struct rect){ head.x_px + head.width_px - width_px - gap_px, head.y_px + gap_px,
			      width_px, px(overlay, THEME_TARGET_MM) };
}

/* Below the head. In portrait and in reach mode it also ends above the bar, which never moves. */
struct rect overlay_view_rect(const struct overlay *overlay)
{
	struct rect rect = overlay_page_rect(overlay);
	int head_px = overlay_is_flat(overlay) ? 0 : px(overlay, HEAD_MM);

	rect.y_px += head_px;
	rect.height_px -= head_px;
	if (rect.x_px ==
	    0) /* it is below the model or has the whole panel, so the bar is over it */
		rect.height_px -= overlay->chrome.height_px + 2 * px(overlay, THEME_GAP_MM);
	if (rect.height_px < 1)
		rect.height_px = 1;
	return rect;
}

struct rect overlay_close_rect(const struct overlay *overlay)
{
	return overlay_close_in(overlay, overlay_head_rect(overlay, overlay_page_rect(overlay)));
}

/* Beside the close control; empty if the page cannot be widened. */
struct rect overlay_widen_rect(const struct overlay *overlay)
{
	struct rect close = overlay_close_rect(overlay);
	int side_px = px(overlay, THEME_TARGET_MM);

	if (overlay->comfort.reach)
		return (struct rect){ 0 };
	return (struct rect){ close.x_px - px(overlay, THEME_GAP_MM) - side_px, close.y_px, side_px,
			      side_px };
}

struct rect overlay_chrome_rect(const struct overlay *overlay)
{
	int margin_px = px(overlay, THEME_GAP_MM);

	return (struct rect){ margin_px, overlay->height_px - overlay->chrome.height_px - margin_px,
			      overlay->chrome.width_px, overlay->chrome.height_px };
}

static int floor_of(const struct overlay *overlay)
{
	const struct screen screen = overlay_screen(overlay);

	return screen_floor(&screen);
}

struct rect overlay_above_floor(const struct overlay *overlay, int width_px, int height_px)
{
	const struct screen screen = overlay_screen(overlay);

	return screen_above_floor(&screen, width_px, height_px);
}

struct rect overlay_card_rect(const struct overlay *overlay)
{
	int most_px = overlay_scene_rect(overlay).width_px - 2 * px(overlay, THEME_GAP_MM);
	int width_px, height_px;

	card_size(&overlay->theme, most_px, &width_px, &height_px);
	return overlay_above_floor(overlay, width_px, height_px);
}

struct rect overlay_help_rect(const struct overlay *overlay)
{
	const struct bitmap *bitmap = &overlay->sprites[BITMAP_HELP].bitmap;

	return overlay_above_floor(overlay, bitmap->width_px, bitmap->height_px);
}

struct rect overlay_invitation_rect(const struct overlay *overlay)
{
	const struct bitmap *bitmap = &overlay->sprites[BITMAP_INVITATION].bitmap;

	return overlay_above_floor(overlay, bitmap->width_px, bitmap->height_px);
}

/* In the middle of the panel: nothing else matters then. In reach mode it is low. */
struct rect overlay_question_rect(const struct overlay *overlay)
{
	const struct bitmap *bitmap = &overlay->sprites[BITMAP_QUESTION].bitmap;

	if (overlay->comfort.reach)
		return overlay_above_floor(overlay, bitmap->width_px, bitmap->height_px);
	return (struct rect){ (overlay->width_px - bitmap->width_px) / 2,
			      (overlay->height_px - bitmap->height_px) / 2, bitmap->width_px,
			      bitmap->height_px };
}

int overlay_scroll_most(const struct overlay *overlay)
{
	int most_px = overlay->article ? article_height_px(overlay->article) -
						 overlay_view_rect(overlay).height_px
				       : 0;

	return most_px > 0 ? most_px : 0;
}

int overlay_row_px(const struct overlay *overlay)
{
	return theme_text_px(&overlay->theme, THEME_TARGET_MM);
}

/* ---- callouts ---- */

static struct callout_area callout_area(const struct overlay *overlay)
{
	struct rect scene = overlay_scene_rect(overlay);
	int margin_px = px(overlay, THEME_MARGIN_MM), floor_px = floor_of(overlay), most_px;
	struct callout_area area = { .x_px = scene.x_px + margin_px,
				     .y_px = scene.y_px + margin_px,
				     .width_px = scene.width_px - 2 * margin_px,
				     .row_px = overlay_row_px(overlay),
				     .gap_px = px(overlay, THEME_GAP_MM),
				     .lead_px = px(overlay, THEME_MARGIN_MM) };

	if (overlay->card_part >= 0)
		floor_px = overlay_card_rect(overlay).y_px - px(overlay, THEME_GAP_MM);
	else if (overlay_choosing(overlay))
		floor_px = overlay_menu_rect(overlay).y_px - px(overlay, THEME_GAP_MM);
	else if (overlay_tour_shows(overlay))
		floor_px = overlay_tour_rect(overlay).y_px - px(overlay, THEME_GAP_MM);
	else if (overlay->invitation.on)
		floor_px = overlay_invitation_rect(overlay).y_px - px(overlay, THEME_GAP_MM);
	else if (overlay->help.on)
		floor_px = overlay_help_rect(overlay).y_px - px(overlay, THEME_GAP_MM);
	if (!overlay->comfort.reach &&
	    overlay_tools_top(overlay) - px(overlay, THEME_GAP_MM) < floor_px)
		floor_px = overlay_tools_top(overlay) - px(overlay, THEME_GAP_MM);
	if (overlay->comfort.reach) {
		if (overlay_tools_left(overlay) < area.x_px + area.width_px)
			area.width_px = overlay_tools_left(overlay) - area.x_px - margin_px;
		area.above_px = overlay_reach_top(overlay) - area.y_px;
		area.y_px = overlay_reach_top(overlay);
		if (overlay->page_part >= 0 || overlay->search.fade.on)
			floor_px = area.y_px; /* page or search take the labels' place */
	}
	area.height_px = floor_px - area.y_px;
	area.column_px = overlay->column_px;
	/* About half of the width is the model's; beside a page, where it is narrow, a little
	 * less. */
	most_px = area.width_px * (scene.width_px < overlay->width_px ? 31 : 27) / 100;
	if (area.column_px > most_px)
		area.column_px = most_px;
	area.detail_px = (float)scene.height_px * DETAIL;
	return area;
}

static struct label *find_label(struct overlay *overlay, int part)
{
	for (uint32_t i = 0; i < LABELS; i++)
		if (overlay->labels[i].part == part)
			return &overlay->labels[i];
	return NULL;
}

/* Returns a free label, or the faintest of those that fade out. There are more labels than
 * callouts. */
static struct label *take_label(struct overlay *overlay)
{
	struct label *best = NULL;

	for (uint32_t i = 0; i < LABELS; i++) {
		struct label *label = &overlay->labels[i];

		if (label->part >= 0 && label->fade.on)
			continue;
		if (!best || label->part < 0 ||
		    (best->part >= 0 && label->fade.alpha < best->fade.alpha))
			best = label;
		if (best->part < 0)
			break;
	}
	return best;
}

static void show_label(struct overlay *overlay, const struct callout *place)
{
	struct label *label = find_label(overlay, (int)place->part);

	if (!label) {
		label = take_label(overlay);
		if (!label)
			return;
		*label = (struct label){ .part = (int)place->part };
	} else if (label->place.left != place->left ||
		   abs(label->place.y_px - place->y_px) > overlay_row_px(overlay)) {
		label->fade.alpha = 0; /* it changed its place: fade in again, do not jump */
	}
	label->place = *place;
	label->fade.on = true;
}

static bool may_have_callout(struct overlay *overlay, int part)
{
	const struct label *label = find_label(overlay, part);

	return overlay->parts[part].in_view &&
	       (!overlay->parts[part].hidden ||
		(label && label->fade.on && label->hidden_ms < OVERLAY_HIDDEN_MS));
}

void overlay_lay_out_callouts(struct overlay *overlay)
{
	struct callout_area area = callout_area(overlay);

	for (uint32_t i = 0; i < overlay->part_count; i++) {
		int label_px = overlay->parts[i].label_px;

		overlay->anchors[i].label_px =
			label_px < area.column_px ? label_px : area.column_px;
		overlay->anchors[i].visible = may_have_callout(overlay, (int)i);
		/* A chosen part never counts as a detail. */
		overlay->anchors[i].size_px =
			(int)i == overlay->card_part || (int)i == overlay->page_part
				? 0
				: overlay->parts[i].size_px;
	}
	callouts_layout(&overlay->callouts, &area, overlay->anchors, overlay->part_count);
	for (uint32_t i = 0; i < LABELS; i++)
		overlay->labels[i].fade.on = false;
	for (uint32_t i = 0; i < overlay->callouts.count; i++)
		show_label(overlay, &overlay->callouts.list[i]);
}
