/* Compares the visitor's place with the recorded ones, and opens, closes and flies to what differs.
 */
#include "app/visit/back.h"

#include <stdio.h>

#include "base/log.h"

#define NEAR_SHARE 0.01f /* of the model's diagonal; an eye that moved less has not moved */

void back_init(struct back *back, const struct back_env *env)
{
	*back = (struct back){ .env = *env };
}

static struct place place_of(const struct back *back)
{
	const struct overlay *overlay = exhibit_overlay(back->env.shown);
	struct place here = { .card = overlay_card(overlay),
			      .page = overlay_page(overlay),
			      .read = overlay_read(overlay),
			      .wide = overlay_page_is_wide(overlay),
			      .searching = overlay_searching(overlay),
			      .on_tour = tour_player_has_visitor(back->env.tours) };

	if (here.searching)
		snprintf(here.query, sizeof(here.query), "%s", overlay_query(overlay));
	navigator_goal(&back->env.eye->navigator, here.eye_m, here.target_m);
	return here;
}

void back_note(struct back *back)
{
	const struct place here = place_of(back);

	way_back_note(&back->way, &here);
}

void back_forget(struct back *back)
{
	back->way.count = 0;
}

void back_on_release(void *data, const struct exhibit_change *change)
{
	(void)change;
	back_forget(data);
}

static void go_to(struct back *back, const struct place *place)
{
	struct overlay *overlay = exhibit_overlay(back->env.shown);

	if (!place->on_tour)
		tour_player_end(back->env.tours);
	if (place->page < 0) {
		overlay_close_page(overlay);
	} else if (place->page == overlay_page(overlay) ||
		   information_view_open_page(back->env.shown->view, (uint32_t)place->page)) {
		overlay_widen_page(overlay, place->wide);
		overlay_read_from(overlay, place->read);
	}
	if (place->searching) {
		overlay_search_again(overlay, place->query);
		information_view_search(back->env.shown->view);
	} else {
		overlay_show_search(overlay, false);
	}
	overlay_show_card(overlay, place->card);
	if (!place->on_tour || !tour_runs(&back->env.tours->tour))
		navigator_fly(&back->env.eye->navigator, place->eye_m, place->target_m,
			      EYE_FLIGHT_MS);
	log_debug("app", "back: card %d, page %d%s", place->card, place->page,
		  place->searching ? ", search" : "");
}

/* Takes the last place that differs from the current one. Returns false if there is none. */
static bool take(const struct back *back, struct way_back *way, struct place *out)
{
	const struct place here = place_of(back);

	return way_back_take(way, &here,
			     NEAR_SHARE * navigator_diagonal_m(&back->env.eye->navigator), out);
}

void back_press(struct back *back)
{
	struct overlay *overlay = exhibit_overlay(back->env.shown);
	struct place place;

	/* A picture or the choice of tours covers the rest, so it is closed first. */
	if (overlay_picture(overlay) >= 0)
		overlay_show_picture(overlay, -1);
	else if (overlay_choosing(overlay))
		overlay_show_tours(overlay, false);
	else if (take(back, &back->way, &place))
		go_to(back, &place);
}

void back_show(struct back *back)
{
	struct overlay *overlay = exhibit_overlay(back->env.shown);
	/* A copy: taking a place from it must not change the steps. */
	struct way_back rest = back->way;
	struct place place;

	if (overlay)
		overlay_offer_back(overlay, overlay_picture(overlay) >= 0 ||
						    overlay_choosing(overlay) ||
						    take(back, &rest, &place));
}
