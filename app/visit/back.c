/* The back button of the bar: records the visitor's place before each step, and returns to it one
 * step at a time. */
#include "app/kiosk.h"
#include "base/log.h"

#define FLIGHT_MS  900
#define NEAR_SHARE 0.01f /* of the model's diagonal; an eye that moved less has not moved */

static bool is_on_tour(const struct kiosk *kiosk)
{
	return kiosk->tour.state != TOUR_OFF && !kiosk->tour.loops;
}

static struct place place_of(const struct kiosk *kiosk)
{
	const struct overlay *overlay = information_view_overlay(kiosk->shown.view);
	struct place here = { .card = overlay_card(overlay),
			      .page = overlay_page(overlay),
			      .read = overlay_read(overlay),
			      .wide = overlay_page_is_wide(overlay),
			      .searching = overlay_searching(overlay),
			      .on_tour = is_on_tour(kiosk) };

	navigator_goal(&kiosk->navigator, here.eye_m, here.target_m);
	return here;
}

void back_note(struct kiosk *kiosk)
{
	const struct place here = place_of(kiosk);

	way_back_note(&kiosk->way_back, &here);
}

void back_forget(struct kiosk *kiosk)
{
	kiosk->way_back.count = 0;
}

static void go_to(struct kiosk *kiosk, const struct place *place)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);

	if (!place->on_tour)
		tour_player_end(kiosk);
	if (place->page < 0) {
		overlay_close_page(overlay);
	} else if (place->page == overlay_page(overlay) ||
		   information_view_open_page(kiosk->shown.view, (uint32_t)place->page)) {
		overlay_widen_page(overlay, place->wide);
		overlay_read_from(overlay, place->read);
	}
	if (place->searching) {
		overlay_search_again(overlay);
		information_view_search(kiosk->shown.view);
	} else {
		overlay_show_search(overlay, false);
	}
	overlay_show_card(overlay, place->card);
	if (!place->on_tour || !tour_runs(&kiosk->tour))
		navigator_fly(&kiosk->navigator, place->eye_m, place->target_m, FLIGHT_MS);
	log_debug("app", "back: card %d, page %d%s", place->card, place->page,
		  place->searching ? ", search" : "");
}

static bool take(const struct kiosk *kiosk, struct way_back *way, struct place *out)
{
	const struct place here = place_of(kiosk);

	return way_back_take(way, &here, NEAR_SHARE * navigator_diagonal_m(&kiosk->navigator), out);
}

void back_press(struct kiosk *kiosk)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);
	struct place place;

	/* A picture or the choice of tours covers the rest, so it is closed first. */
	if (overlay_picture(overlay) >= 0)
		overlay_show_picture(overlay, -1);
	else if (overlay_choosing(overlay))
		overlay_show_tours(overlay, false);
	else if (take(kiosk, &kiosk->way_back, &place))
		go_to(kiosk, &place);
}

void back_say(struct kiosk *kiosk)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);
	struct way_back rest =
		kiosk->way_back; /* a copy: taking a place from it must not change the steps */
	struct place place;

	if (overlay)
		overlay_offer_back(overlay, overlay_picture(overlay) >= 0 ||
						    overlay_choosing(overlay) ||
						    take(kiosk, &rest, &place));
}
