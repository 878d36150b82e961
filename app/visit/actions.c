/* One row for each action of the overlay: the function that carries it out, and whether it is a
 * step for the back button or halts a tour. */
#include "app/visit/actions.h"

#include <string.h>

#include "base/compiler.h"
#include "base/log.h"
#include "storage/info_tour.h"

static struct overlay *overlay_of(const struct actions *actions)
{
	return exhibit_overlay(actions->shown);
}

/* ---- parts */

static void fly_to_part(const struct actions *actions, int part)
{
	eye_fly_to_part(actions->eye, actions->viewport, (uint32_t)part);
}

static const char *id_of(const struct actions *actions, int part)
{
	return info_part(exhibit_info(actions->shown), (uint32_t)part)->id;
}

static void show_card(const struct actions *actions, int part)
{
	if (part >= 0) {
		log_debug("app", "card of %s", id_of(actions, part));
		counting_part(actions->counting, USAGE_PART, part);
	}
	overlay_show_card(overlay_of(actions), part);
}

static void open_page(const struct actions *actions, int part)
{
	if (part < 0 || !information_view_open_page(actions->shown->view, (uint32_t)part))
		return;
	log_debug("app", "page of %s", id_of(actions, part));
	counting_part(actions->counting, USAGE_PAGE, part);
	show_card(actions, -1);
	fly_to_part(actions, part);
}

/* Returns the part under a finger, or -1. Uses the labels of the release; if they are not loaded,
 * the regions of the parts. */
static int part_under(const struct actions *actions, float x_px, float y_px)
{
	const struct exhibit *shown = actions->shown;
	const struct info *info = exhibit_info(shown);
	float point_m[3];
	const char *id;

	if (!info || !eye_pick(actions->eye, actions->viewport, x_px, y_px, point_m))
		return -1;
	viewport_to_panel(actions->viewport, &x_px, &y_px);
	id = scene_part(shown->scene, &actions->eye->camera, x_px, y_px);
	if (!id)
		return information_view_part_at(shown->view, point_m);
	return *id ? info_find(info, id) : -1;
}

/* Something beside the scan, such as a door, answers the finger itself. */
static bool touch_scenery(const struct actions *actions, float x_px, float y_px)
{
	struct scene *scene = actions->shown->scene;

	viewport_to_panel(actions->viewport, &x_px, &y_px);
	if (!scene || !actions->eye->ready ||
	    !scene_touch(scene, &actions->eye->camera, x_px, y_px))
		return false;
	log_debug("app", "the scenery was touched");
	return true;
}

void actions_show_part_at(const struct actions *actions, float x_px, float y_px)
{
	const int part = touch_scenery(actions, x_px, y_px) ? -1 : part_under(actions, x_px, y_px);

	listening_end(actions->listening);
	if (part >= 0 && part != overlay_card(overlay_of(actions)))
		back_note(actions->back);
	show_card(actions, part);
}

void actions_open_part_at(const struct actions *actions, float x_px, float y_px)
{
	const int part = part_under(actions, x_px, y_px);

	listening_end(actions->listening);
	if (part < 0)
		return;
	back_note(actions->back);
	open_page(actions, part);
}

/* ---- one function for each action */

typedef void carry_out(const struct actions *actions, const struct overlay_action *action);

static void do_nothing(const struct actions *actions, const struct overlay_action *action)
{
	(void)actions, (void)action;
}

static void do_open_card(const struct actions *actions, const struct overlay_action *action)
{
	show_card(actions, action->part);
}

static void do_open_page(const struct actions *actions, const struct overlay_action *action)
{
	open_page(actions, action->part);
}

static void do_close_card(const struct actions *actions, const struct overlay_action *action)
{
	(void)action;
	show_card(actions, -1);
}

/* Closes the page. Its part was in the middle of the area beside the page; if nobody has moved the
 * eye since, flies so that the part is in the middle of the whole panel. */
static void do_close_page(const struct actions *actions, const struct overlay_action *action)
{
	struct overlay *overlay = overlay_of(actions);
	const int part = overlay_page(overlay);

	(void)action;
	overlay_close_page(overlay);
	if (part >= 0 && navigator_is_left_alone(&actions->eye->navigator))
		fly_to_part(actions, part);
}

static void do_widen_page(const struct actions *actions, const struct overlay_action *action)
{
	struct overlay *overlay = overlay_of(actions);

	(void)action;
	overlay_widen_page(overlay, !overlay_page_is_wide(overlay));
	log_debug("app", "page: %s",
		  overlay_page_is_wide(overlay) ? "over the whole panel" : "beside the model");
}

static void do_set_language(const struct actions *actions, const struct overlay_action *action)
{
	information_view_set_language(actions->shown->view, action->language);
	counting_part(actions->counting, USAGE_LANGUAGE, -1);
}

static void do_choose_language(const struct actions *actions, const struct overlay_action *action)
{
	struct overlay *overlay = overlay_of(actions);

	(void)action;
	overlay_show_languages(overlay, !overlay_choosing_language(overlay));
}

/* Follows a link of a page: starts the tour, or opens the part's page. A part without a page is
 * shown on the model, and the open page stays. */
static void do_follow_link(const struct actions *actions, const struct overlay_action *action)
{
	const struct info *info = exhibit_info(actions->shown);
	int part;

	if (strncmp(action->link, "tour:", 5) == 0) {
		tour_player_start(actions->tours, info_find_tour(info, action->link + 5));
		return;
	}
	part = info_find(info, action->link);
	if (part >= 0 && !info_part(info, (uint32_t)part)->has_page) {
		show_card(actions, part);
		fly_to_part(actions, part);
		return;
	}
	open_page(actions, part);
}

static void do_press_tour(const struct actions *actions, const struct overlay_action *action)
{
	(void)action;
	tour_player_press(actions->tours);
}

static void do_start_tour(const struct actions *actions, const struct overlay_action *action)
{
	tour_player_start(actions->tours, action->tour);
}

static void do_end_tour(const struct actions *actions, const struct overlay_action *action)
{
	(void)action;
	tour_player_end(actions->tours);
}

static void do_go_home(const struct actions *actions, const struct overlay_action *action)
{
	struct overlay *overlay = overlay_of(actions);

	(void)action;
	tour_player_end(actions->tours);
	overlay_show_tours(overlay, false);
	overlay_close_page(overlay);
	overlay_show_search(overlay, false);
	show_card(actions, -1);
	eye_fly_home(actions->eye);
}

static void do_go_back(const struct actions *actions, const struct overlay_action *action)
{
	(void)action;
	back_press(actions->back);
}

static void do_help(const struct actions *actions, const struct overlay_action *action)
{
	struct overlay *overlay = overlay_of(actions);

	(void)action;
	overlay_show_help(overlay, !overlay_help(overlay));
}

static void do_search(const struct actions *actions, const struct overlay_action *action)
{
	struct overlay *overlay = overlay_of(actions);

	(void)action;
	overlay_show_search(overlay, !overlay_searching(overlay));
	if (overlay_searching(overlay))
		counting_part(actions->counting, USAGE_SEARCH, -1);
}

/* Switches large text or easy reach on or off. Easy reach moves the page, so the area left for the
 * model may change; the part is then centred again. */
static void do_change_comfort(const struct actions *actions, const struct overlay_action *action)
{
	struct overlay *overlay = overlay_of(actions);
	struct overlay_comfort comfort = overlay_comfort(overlay);

	if (action->kind == OVERLAY_LARGE)
		comfort.large = !comfort.large;
	else
		comfort.reach = !comfort.reach;
	overlay_set_comfort(overlay, comfort);
	log_debug("app", "comfort:%s%s", comfort.large ? " large" : "",
		  comfort.reach ? " reach" : "");
	if (action->kind == OVERLAY_REACH && overlay_page(overlay) >= 0)
		fly_to_part(actions, overlay_page(overlay));
}

static void do_press_tool(const struct actions *actions, const struct overlay_action *action)
{
	tools_press(actions->tools, action->kind == OVERLAY_LIGHT     ? OVERLAY_TOOL_LIGHT
				    : action->kind == OVERLAY_SECTION ? OVERLAY_TOOL_SECTION
				    : action->kind == OVERLAY_MEASURE ? OVERLAY_TOOL_MEASURE
								      : OVERLAY_TOOL_WALK);
}

static void do_choose_layer(const struct actions *actions, const struct overlay_action *action)
{
	if (!actions->shown->scene)
		return;
	scene_choose_layer(actions->shown->scene, action->choice);
	log_debug("app", "layer %u", action->choice);
}

static void do_listen(const struct actions *actions, const struct overlay_action *action)
{
	(void)action;
	listening_press(actions->listening);
}

static void do_show_picture(const struct actions *actions, const struct overlay_action *action)
{
	overlay_show_picture(overlay_of(actions), action->picture);
	log_debug("app", "picture %d", action->picture);
}

static void do_press_key(const struct actions *actions, const struct overlay_action *action)
{
	actions_press_key(actions, action->key);
}

static void do_show_found(const struct actions *actions, const struct overlay_action *action)
{
	overlay_show_search(overlay_of(actions), false);
	show_card(actions, action->part);
	fly_to_part(actions, action->part);
}

/* The log gets only the number of bytes typed, not the text, which is private. The number is enough
 * to test keyboards. */
void actions_press_key(const struct actions *actions, int key)
{
	struct overlay *overlay = overlay_of(actions);

	if (!overlay_press(overlay, key))
		return;
	information_view_search(actions->shown->view);
	log_debug("app", "search: %zu bytes typed", strlen(overlay_query(overlay)));
}

/* ---- the table */

enum {
	/* A step that the back button can undo. An action that only closes something is none. */
	STEP = 1,
	STEP_IF_OPENS = 2, /* a step only where it opens something */
	/* Halts a tour: it opens something to read or leads elsewhere, which does not fit a moving
	 * camera. */
	HALTS_TOUR = 4,
};

static const struct {
	carry_out *carry_out;
	unsigned is; /* of the above */
} table[] = {
	[OVERLAY_NONE] = { do_nothing, 0 },
	[OVERLAY_SWALLOWED] = { do_nothing, 0 },
	[OVERLAY_OPEN_CARD] = { do_open_card, STEP | HALTS_TOUR },
	[OVERLAY_OPEN_PAGE] = { do_open_page, STEP | HALTS_TOUR },
	[OVERLAY_CLOSE_CARD] = { do_close_card, 0 },
	[OVERLAY_CLOSE_PAGE] = { do_close_page, 0 },
	[OVERLAY_WIDEN_PAGE] = { do_widen_page, 0 },
	[OVERLAY_LISTEN] = { do_listen, HALTS_TOUR },
	[OVERLAY_LANGUAGE] = { do_set_language, 0 },
	[OVERLAY_LANGUAGES] = { do_choose_language, 0 },
	[OVERLAY_LINK] = { do_follow_link, STEP | HALTS_TOUR },
	[OVERLAY_HOME] = { do_go_home, STEP },
	[OVERLAY_BACK] = { do_go_back, 0 },
	[OVERLAY_HELP] = { do_help, HALTS_TOUR },
	[OVERLAY_SEARCH] = { do_search, STEP_IF_OPENS | HALTS_TOUR },
	[OVERLAY_LARGE] = { do_change_comfort, 0 },
	[OVERLAY_REACH] = { do_change_comfort, 0 },
	[OVERLAY_LIGHT] = { do_press_tool, 0 },
	[OVERLAY_SECTION] = { do_press_tool, 0 },
	[OVERLAY_MEASURE] = { do_press_tool, 0 },
	[OVERLAY_WALK] = { do_press_tool, 0 },
	[OVERLAY_CHOICE] = { do_choose_layer, 0 },
	[OVERLAY_KEY] = { do_press_key, 0 },
	[OVERLAY_FOUND] = { do_show_found, STEP | HALTS_TOUR },
	[OVERLAY_PICTURE] = { do_show_picture, 0 },
	[OVERLAY_TOURS] = { do_press_tour, STEP_IF_OPENS },
	[OVERLAY_TOUR] = { do_start_tour, STEP },
	[OVERLAY_TOUR_PAUSE] = { do_press_tour, 0 },
	[OVERLAY_TOUR_CLOSE] = { do_end_tour, 0 },
};

_Static_assert(ARRAY_COUNT(table) == OVERLAY_TOUR_CLOSE + 1, "one row for each action");

static bool is_step(const struct actions *actions, enum overlay_action_kind kind)
{
	const struct overlay *overlay = overlay_of(actions);

	if (table[kind].is & STEP)
		return true;
	if (!(table[kind].is & STEP_IF_OPENS))
		return false;
	return kind == OVERLAY_SEARCH
		       ? !overlay_searching(overlay)
		       : !overlay_choosing(overlay) && !tour_player_has_visitor(actions->tours);
}

void actions_carry_out(const struct actions *actions, const struct overlay_action *action)
{
	struct overlay *overlay = overlay_of(actions);
	const bool chose_language = overlay_choosing_language(overlay);

	if (is_step(actions, action->kind))
		back_note(actions->back);
	if (table[action->kind].is & HALTS_TOUR)
		tour_player_halt(actions->tours);
	if (action->kind != OVERLAY_LISTEN && action->kind != OVERLAY_SWALLOWED)
		listening_end(actions->listening);
	if (action->kind != OVERLAY_LANGUAGES && action->kind != OVERLAY_NONE)
		overlay_show_languages(overlay, false);
	if (action->kind == OVERLAY_BACK && chose_language)
		return; /* the choice of languages is what it closed */
	table[action->kind].carry_out(actions, action);
}
