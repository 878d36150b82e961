/* Composes the views: which may be open at the same time, which one a tap hits, and the order in
 * which they are drawn. Views know nothing of one another. */
#include "ui/overlay.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ui/overlay_layout.h"

enum { STEP_MOST_MS = 100 }; /* a longer pause counts as this long */

/* On a panel smaller than a hand everything shrinks; otherwise it would be cut off. */
#define SHORTER_LEAST_MM 85.0f

struct rect overlay_scene_rect(const struct overlay *overlay)
{
	return overlay_screen(overlay).scene;
}

static void lay_out_bar(struct overlay *overlay)
{
	const struct screen screen = overlay_screen(overlay);
	const struct bar_view_has has = {
		.search = overlay->parts.count > 0,
		.tours = overlay->tours.count > 0,
		.light = overlay->tools.offered & OVERLAY_TOOL_LIGHT,
		.section = overlay->tools.offered & OVERLAY_TOOL_SECTION,
		.measure = overlay->tools.offered & OVERLAY_TOOL_MEASURE,
		.walk = overlay->tools.offered & OVERLAY_TOOL_WALK,
		.reach = screen_offers_reach(&screen),
	};

	bar_view_lay_out(&overlay->bar, &screen, &overlay->languages, has);
	overlay->tools.fit = !overlay->bar.toolless;
	if (!overlay->bar.menu)
		overlay_show_languages(overlay, false);
}

/* ---- creation ---- */

static void start_views(struct overlay *overlay)
{
	const struct theme *theme = &overlay->theme;
	struct screen screen;
	uint32_t next_id = 0;

	paper_init(&overlay->paper, theme, &next_id);
	bar_view_init(&overlay->bar, &next_id);
	callouts_view_init(&overlay->callouts, theme, &next_id);
	card_view_init(&overlay->card, &next_id);
	choice_view_init(&overlay->choice, &next_id);
	gallery_view_init(&overlay->gallery, theme, &next_id);
	help_view_init(&overlay->help, theme, &next_id);
	invitation_view_init(&overlay->invitation, &next_id);
	languages_view_init(&overlay->languages_view, &next_id);
	measure_view_init(&overlay->measure, &next_id);
	page_view_init(&overlay->page, theme, overlay->height_px, &next_id);
	question_view_init(&overlay->question, &next_id);
	search_view_init(&overlay->search, &next_id);
	tools_view_init(&overlay->tools, &next_id);
	tour_player_view_init(&overlay->tour, &next_id);
	tours_view_init(&overlay->tours, &next_id);
	assert(next_id <= OVERLAY_BITMAPS_MAX);
	lay_out_bar(overlay);
	screen = overlay_screen(overlay);
	help_view_update(&overlay->help, &screen, false, 0); /* its size is needed for layout */
}

static int start(struct overlay *overlay, const struct overlay_options *options)
{
	int shorter_px =
		options->width_px < options->height_px ? options->width_px : options->height_px;
	float px_per_mm = options->px_per_mm;
	int rc;

	if (px_per_mm <= 0)
		px_per_mm = theme_guess_px_per_mm(options->width_px, options->height_px);
	px_per_mm = fminf(px_per_mm, (float)shorter_px / SHORTER_LEAST_MM);
	rc = theme_init(&overlay->theme, px_per_mm, options->languages[0]);
	if (rc == 0)
		rc = languages_copy(&overlay->languages, options->languages,
				    options->language_count);
	if (rc == 0)
		start_views(overlay);
	return rc;
}

int overlay_create(struct overlay **out, const struct overlay_options *options)
{
	struct overlay *overlay;
	int rc;

	*out = NULL;
	if (options->width_px < 320 || options->height_px < 320 || options->width_px > 8192 ||
	    options->height_px > 8192 || options->language_count < 1 ||
	    options->language_count > OVERLAY_LANGUAGES_MAX)
		return -EINVAL;
	overlay = calloc(1, sizeof(*overlay));
	if (!overlay)
		return -ENOMEM;
	overlay->width_px = options->width_px;
	overlay->height_px = options->height_px;
	overlay->pictures = (struct picture_source){ options->picture, options->data };
	rc = start(overlay, options);
	if (rc < 0) {
		overlay_destroy(overlay);
		return rc;
	}
	*out = overlay;
	return 0;
}

void overlay_destroy(struct overlay *overlay)
{
	if (!overlay)
		return;
	bar_view_finish(&overlay->bar);
	callouts_view_finish(&overlay->callouts);
	card_view_finish(&overlay->card);
	choice_view_finish(&overlay->choice);
	gallery_view_finish(&overlay->gallery);
	help_view_finish(&overlay->help);
	invitation_view_finish(&overlay->invitation);
	languages_view_finish(&overlay->languages_view);
	measure_view_finish(&overlay->measure);
	page_view_finish(&overlay->page);
	question_view_finish(&overlay->question);
	search_view_finish(&overlay->search);
	tools_view_finish(&overlay->tools);
	tour_player_view_finish(&overlay->tour);
	tours_view_finish(&overlay->tours);
	paper_finish(&overlay->paper);
	parts_free(&overlay->parts);
	languages_free(&overlay->languages);
	theme_finish(&overlay->theme);
	free(overlay);
}

/* ---- content ---- */

int overlay_parts(struct overlay *overlay, const struct overlay_part *parts, uint32_t count)
{
	const bool had_parts = overlay->parts.count > 0;
	struct screen screen;
	struct parts copies;
	int rc = count > OVERLAY_PARTS_MAX ? -EINVAL : 0;

	if (rc == 0)
		rc = search_view_reserve(&overlay->search, count);
	if (rc == 0)
		rc = callouts_view_reserve(&overlay->callouts, count);
	if (rc == 0)
		rc = parts_copy(&copies, parts, count);
	if (rc < 0)
		return rc;
	if (count != overlay->parts.count) {
		page_view_drop(&overlay->page);
		gallery_view_drop(&overlay->gallery);
		card_view_drop(&overlay->card);
	}
	parts_free(&overlay->parts);
	overlay->parts = copies;
	search_view_set_count(&overlay->search, count);
	callouts_view_set_parts(&overlay->callouts, &overlay->theme, &overlay->parts);
	if (had_parts != (count > 0)) {
		overlay->help.dirty = true;
		lay_out_bar(overlay);
	}
	screen = overlay_screen(overlay);
	search_view_redraw(&overlay->search, &screen); /* its rows have other texts now */
	overlay->card.dirty = overlay->page.head_dirty = true;
	return 0;
}

/* Texts or the size of type changed. */
static void redraw_words(struct overlay *overlay)
{
	const struct screen screen = overlay_screen(overlay);

	search_view_redraw(&overlay->search, &screen);
	overlay->help.dirty = overlay->card.dirty = overlay->page.head_dirty = true;
	overlay->tour.dirty = overlay->tours.dirty = overlay->tools.dirty = true;
	overlay->languages_view.dirty = overlay->question.dirty = overlay->choice.dirty = true;
	overlay->measure.dirty = true;
}

void overlay_language(struct overlay *overlay, const char *language)
{
	if (!languages_set(&overlay->languages, language))
		return;
	theme_set_language(&overlay->theme, language);
	overlay_show_languages(overlay, false);
	redraw_words(overlay);
	callouts_view_forget(&overlay->callouts);
}

void overlay_anchors(struct overlay *overlay, const struct overlay_anchor *anchors, uint32_t count)
{
	callouts_view_anchors(&overlay->callouts, anchors, count);
}

int overlay_tours(struct overlay *overlay, const struct overlay_tour *tours, uint32_t count)
{
	const uint32_t before = overlay->tours.count;
	int rc = tours_view_set(&overlay->tours, tours, count);

	if (rc < 0)
		return rc;
	overlay->tour.dirty = true;
	if (before == count)
		return 0;
	tour_player_view_drop(&overlay->tour);
	lay_out_bar(overlay);
	return 0;
}

void overlay_offer_tools(struct overlay *overlay, unsigned tools)
{
	if (tools == overlay->tools.offered)
		return;
	overlay->tools.offered = tools;
	overlay->tools.dirty = true;
	lay_out_bar(overlay);
}

unsigned overlay_tools_offered(const struct overlay *overlay)
{
	return overlay->tools.fit ? overlay->tools.offered : 0;
}

void overlay_offer_back(struct overlay *overlay, bool on)
{
	overlay->back = on;
}

void overlay_picture_arrived(struct overlay *overlay, const char *name)
{
	const int part = overlay->card.part;

	page_view_picture_arrived(&overlay->page, name);
	search_view_picture_arrived(&overlay->search, &overlay->parts, name);
	if (overlay->page.article)
		gallery_view_picture_arrived(&overlay->gallery, overlay->page.article, name);
	tours_view_picture_arrived(&overlay->tours, name);
	if (part >= 0 && strcmp(overlay->parts.list[part].thumbnail, name) == 0)
		overlay->card.dirty = true;
}

/* ---- what is open ---- */

void overlay_show_card(struct overlay *overlay, int part)
{
	if (part >= (int)overlay->parts.count)
		part = -1;
	if (part == overlay->card.part)
		return;
	if (part >= 0)
		overlay_widen_page(overlay,
				   false); /* a card is about the model, which must be visible */
	card_view_show(&overlay->card, part);
	overlay->callouts.dirty = true;
	if (part < 0)
		return;
	overlay_show_help(overlay, false); /* card and help share their place */
	overlay_show_tours(overlay, false);
}

int overlay_card(const struct overlay *overlay)
{
	return overlay->card.part;
}

int overlay_show_page(struct overlay *overlay, int part, struct bytes bytes, const char *credits)
{
	const struct screen screen = overlay_screen(overlay);
	int rc;

	if (part < 0 || part >= (int)overlay->parts.count)
		return -EINVAL;
	rc = page_view_open(&overlay->page, &screen, part, bytes, credits, &overlay->pictures);
	if (rc < 0)
		return rc;
	gallery_view_drop(&overlay->gallery);
	overlay_show_search(overlay, false); /* the page takes its place */
	overlay_show_card(overlay, -1);      /* the page has all its information */
	overlay_show_help(overlay, false);
	overlay_show_tours(overlay, false);
	overlay->callouts.dirty = true;
	return 0;
}

void overlay_close_page(struct overlay *overlay)
{
	overlay_show_picture(overlay, -1);
	page_view_close(&overlay->page);
	overlay->callouts.dirty = true;
}

int overlay_page(const struct overlay *overlay)
{
	return overlay->page.part;
}

void overlay_offer_spoken(struct overlay *overlay, bool offered)
{
	page_view_offer_spoken(&overlay->page, offered && overlay->page.part >= 0);
}

void overlay_show_spoken(struct overlay *overlay, const struct overlay_spoken *spoken)
{
	page_view_show_spoken(&overlay->page, overlay->page.part >= 0 ? spoken : NULL);
}

void overlay_widen_page(struct overlay *overlay, bool on)
{
	const struct screen screen = overlay_screen(overlay);

	if (!page_view_widen(&overlay->page, &screen, on))
		return;
	overlay->callouts.dirty = true;
	if (overlay->page.part < 0) /* no memory to lay it out again */
		overlay_close_page(overlay);
}

bool overlay_page_is_wide(const struct overlay *overlay)
{
	return overlay->page.wide;
}

float overlay_read(const struct overlay *overlay)
{
	return page_view_read(&overlay->page);
}

void overlay_read_from(struct overlay *overlay, float share)
{
	const struct screen screen = overlay_screen(overlay);

	page_view_read_from(&overlay->page, &screen, share);
}

void overlay_show_picture(struct overlay *overlay, int picture)
{
	const struct screen screen = overlay_screen(overlay);
	const struct article_layout *article = overlay->page.article;

	gallery_view_show(&overlay->gallery, &screen, picture,
			  article ? (int)article_layout_picture_count(article) : 0);
}

int overlay_picture(const struct overlay *overlay)
{
	return overlay->gallery.fade.on ? overlay->gallery.at : -1;
}

void overlay_show_help(struct overlay *overlay, bool on)
{
	if (!help_view_show(&overlay->help, on))
		return;
	overlay->callouts.dirty = true;
	if (!on)
		return;
	overlay_show_card(overlay, -1);
	overlay_show_tours(overlay, false);
}

bool overlay_help(const struct overlay *overlay)
{
	return overlay->help.fade.on;
}

void overlay_invite(struct overlay *overlay, bool on)
{
	const struct screen screen = overlay_screen(overlay);

	if (!invitation_view_show(&overlay->invitation, on))
		return;
	invitation_view_draw(&overlay->invitation, &screen, &overlay->theme, &overlay->languages);
	overlay_show_help(overlay, !on);
	overlay->callouts.dirty = true;
}

void overlay_ask(struct overlay *overlay, int seconds_left)
{
	question_view_ask(&overlay->question, seconds_left);
}

void overlay_show_search(struct overlay *overlay, bool on)
{
	if (on == overlay->search.fade.on || (on && overlay->parts.count == 0))
		return;
	if (on) {
		overlay_search_again(overlay, "");
		return;
	}
	search_view_close(&overlay->search);
	overlay->callouts.dirty = true;
}

void overlay_search_again(struct overlay *overlay, const char *query)
{
	struct screen screen;

	if (overlay->parts.count == 0)
		return;
	overlay_close_page(overlay);
	overlay_show_card(overlay, -1);
	overlay_show_help(overlay, false);
	overlay_show_tours(overlay, false);
	screen = overlay_screen(overlay);
	search_view_open(&overlay->search, &screen, query);
	overlay->callouts.dirty = true;
}

bool overlay_searching(const struct overlay *overlay)
{
	return overlay->search.fade.on;
}

const char *overlay_query(const struct overlay *overlay)
{
	return overlay->search.query;
}

bool overlay_press(struct overlay *overlay, int key)
{
	const struct screen screen = overlay_screen(overlay);

	return search_view_press(&overlay->search, &screen, key);
}

void overlay_found(struct overlay *overlay, const uint32_t *parts, uint32_t count)
{
	search_view_set_found(&overlay->search, parts, count);
}

void overlay_show_tours(struct overlay *overlay, bool on)
{
	if (!tours_view_show(&overlay->tours, on))
		return;
	overlay->callouts.dirty = true;
	if (!overlay->tours.fade.on)
		return;
	overlay_close_page(overlay);
	overlay_show_search(overlay, false);
	overlay_show_card(overlay, -1);
	overlay_show_help(overlay, false);
}

bool overlay_choosing(const struct overlay *overlay)
{
	return overlay->tours.fade.on;
}

void overlay_show_tour(struct overlay *overlay, const struct overlay_tour_state *state)
{
	overlay->callouts.dirty |= tour_player_view_set(&overlay->tour, state);
}

void overlay_show_languages(struct overlay *overlay, bool on)
{
	languages_view_show(&overlay->languages_view, on && overlay->bar.menu);
}

bool overlay_choosing_language(const struct overlay *overlay)
{
	return overlay->languages_view.fade.on;
}

void overlay_show_tools(struct overlay *overlay, const struct overlay_tools *state)
{
	const unsigned changed = overlay->tools.now.on ^ state->on;

	overlay->tools.now = *state;
	measure_view_set(&overlay->measure, overlay->tools.fit ? state : NULL);
	if (!changed)
		return;
	overlay->tools.dirty = overlay->callouts.dirty = true;
	if (changed & state->on)
		overlay_show_help(overlay,
				  false); /* help and tools share their place on small panels */
}

void overlay_show_choice(struct overlay *overlay, const char *const *titles, uint32_t count,
			 uint32_t chosen)
{
	choice_view_set(&overlay->choice, titles, count, chosen);
}

/* ---- comfort ---- */

struct overlay_comfort overlay_comfort(const struct overlay *overlay)
{
	return overlay->comfort;
}

void overlay_set_comfort(struct overlay *overlay, struct overlay_comfort comfort)
{
	struct screen screen = overlay_screen(overlay);
	const bool had_page = overlay->page.part >= 0;

	comfort.reach &= screen_offers_reach(&screen);
	if (comfort.large == overlay->comfort.large && comfort.reach == overlay->comfort.reach)
		return;
	overlay->comfort = comfort;
	overlay->theme.text_scale = comfort.large ? THEME_LARGE_TYPE : 1;
	lay_out_bar(overlay);
	redraw_words(overlay);
	screen = overlay_screen(overlay);
	callouts_view_measure(&overlay->callouts, &overlay->theme, &overlay->parts);
	overlay->search.scroll = (struct scroll){ 0 };
	page_view_lay_out(&overlay->page, &screen);
	if (had_page && overlay->page.part < 0) /* no memory to lay it out again */
		overlay_close_page(overlay);
	invitation_view_draw(&overlay->invitation, &screen, &overlay->theme, &overlay->languages);
	overlay->gallery.words_dirty = true;
}

/* ---- touch ---- */

static bool on_tools(const struct overlay *overlay, const struct screen *screen, float x_px,
		     float y_px)
{
	const struct tools_view_obstacles obstacles = overlay_obstacles(overlay, screen);

	return tools_view_covers(&overlay->tools, screen, &obstacles, x_px, y_px);
}

static bool on_choice(const struct overlay *overlay, const struct screen *screen, float x_px,
		      float y_px)
{
	const struct tools_view_obstacles obstacles = overlay_obstacles(overlay, screen);

	return choice_view_shows(&overlay->choice, screen, &obstacles) &&
	       rect_holds(choice_view_rect(&overlay->choice, screen), x_px, y_px);
}

struct overlay_action overlay_tap(const struct overlay *overlay, float x_px, float y_px)
{
	const struct screen screen = overlay_screen(overlay);
	struct overlay_action action = { .kind = OVERLAY_NONE, .part = -1 };

	if (rect_holds(screen.bar, x_px, y_px))
		return bar_view_tap(&overlay->bar, &screen, &overlay->languages, overlay->back,
				    x_px);
	if (overlay->languages_view.fade.on)
		return languages_view_tap(&screen, &overlay->languages, x_px, y_px);
	if (overlay->gallery.fade.on)
		return gallery_view_tap(&overlay->gallery, &screen, x_px, y_px);
	if (on_choice(overlay, &screen, x_px, y_px))
		return choice_view_tap(&overlay->choice, &screen, x_px);
	if (overlay->search.fade.on && rect_holds(search_view_rect(&screen), x_px, y_px))
		return search_view_tap(&overlay->search, &screen, x_px, y_px);
	if (overlay->card.part >= 0 && rect_holds(card_view_rect(&screen), x_px, y_px))
		return card_view_tap(&overlay->card, &screen, &overlay->parts, x_px, y_px);
	if (overlay->page.part >= 0 &&
	    rect_holds(page_view_rect(&overlay->page, &screen), x_px, y_px))
		return page_view_tap(&overlay->page, &screen, x_px, y_px);
	if (overlay->tours.fade.on &&
	    rect_holds(tours_view_rect(&overlay->tours, &screen), x_px, y_px))
		return tours_view_tap(&overlay->tours, &screen, x_px, y_px);
	if (overlay_tour_shows(overlay) &&
	    rect_holds(tour_player_view_rect(&overlay->tour, &screen), x_px, y_px))
		return tour_player_view_tap(&overlay->tour, &screen, x_px, y_px);
	if (on_tools(overlay, &screen, x_px, y_px)) {
		action.kind = OVERLAY_SWALLOWED;
		return action;
	}
	if (overlay->help.fade.on &&
	    rect_holds(help_view_rect(&overlay->help, &screen), x_px, y_px)) {
		/* Who touched the invitation made the help come under the same finger. */
		action.kind =
			overlay->help.shown_ms < HELP_NEW_MS ? OVERLAY_SWALLOWED : OVERLAY_HELP;
		return action;
	}
	action.part = callouts_view_part_at(&overlay->callouts, &screen, x_px, y_px);
	if (action.part >= 0)
		action.kind = OVERLAY_OPEN_CARD;
	return action;
}

/* Help and callouts do not cover: a gesture that begins there is the model's. */
bool overlay_covers(const struct overlay *overlay, float x_px, float y_px)
{
	const struct screen screen = overlay_screen(overlay);

	if (overlay->gallery.fade.on)
		return true;
	if (overlay->languages_view.fade.on &&
	    rect_holds(languages_view_rect(&screen, &overlay->languages), x_px, y_px))
		return true;
	if (rect_holds(screen.bar, x_px, y_px))
		return true;
	if (overlay->page.part >= 0 &&
	    rect_holds(page_view_rect(&overlay->page, &screen), x_px, y_px))
		return true;
	if (overlay->search.fade.on && rect_holds(search_view_rect(&screen), x_px, y_px))
		return true;
	if (overlay->tours.fade.on &&
	    rect_holds(tours_view_rect(&overlay->tours, &screen), x_px, y_px))
		return true;
	if (overlay_tour_shows(overlay) &&
	    rect_holds(tour_player_view_rect(&overlay->tour, &screen), x_px, y_px))
		return true;
	if (on_tools(overlay, &screen, x_px, y_px) || on_choice(overlay, &screen, x_px, y_px))
		return true;
	return overlay->card.part >= 0 && rect_holds(card_view_rect(&screen), x_px, y_px);
}

enum overlay_handle overlay_handle_at(const struct overlay *overlay, float x_px, float y_px)
{
	const struct screen screen = overlay_screen(overlay);
	const struct tools_view_obstacles obstacles = overlay_obstacles(overlay, &screen);
	enum overlay_handle handle;

	if (overlay->question.fade.on ||
	    (overlay->languages_view.fade.on &&
	     rect_holds(languages_view_rect(&screen, &overlay->languages), x_px, y_px)))
		return OVERLAY_HANDLE_NONE;
	handle = tools_view_handle_at(&overlay->tools, &screen, &obstacles, x_px, y_px);
	if (handle != OVERLAY_HANDLE_NONE || overlay_covers(overlay, x_px, y_px))
		return handle;
	return measure_view_handle_at(&overlay->measure, &screen, x_px, y_px);
}

void overlay_handle_place(const struct overlay *overlay, enum overlay_handle handle, float x_px,
			  float y_px, float at[2])
{
	const struct screen screen = overlay_screen(overlay);

	tools_view_handle_place(&overlay->tools, &screen, handle, x_px, y_px, at);
}

void overlay_scroll(struct overlay *overlay, float dy_px)
{
	const struct screen screen = overlay_screen(overlay);

	overlay->search.scroll.px_per_s = overlay->page.scroll.px_per_s = 0;
	if (overlay->search.fade.on)
		scroll_by(&overlay->search.scroll,
			  search_view_scroll_most(&overlay->search, &screen), -dy_px);
	else
		scroll_by(&overlay->page.scroll, page_view_scroll_most(&overlay->page, &screen),
			  -dy_px);
}

void overlay_fling(struct overlay *overlay, float vy_px_per_s)
{
	struct scroll *scroll =
		overlay->search.fade.on ? &overlay->search.scroll : &overlay->page.scroll;

	scroll->px_per_s = -vy_px_per_s;
}

void overlay_picture_drag(struct overlay *overlay, float dx_px, float dy_px)
{
	const struct screen screen = overlay_screen(overlay);

	gallery_view_drag(&overlay->gallery, &screen, dx_px, dy_px);
}

void overlay_picture_drag_end(struct overlay *overlay, float vx_px_per_s)
{
	const struct screen screen = overlay_screen(overlay);

	gallery_view_drag_end(&overlay->gallery, &screen, vx_px_per_s);
}

void overlay_picture_pinch(struct overlay *overlay, float x_px, float y_px, float scale,
			   float dx_px, float dy_px)
{
	const struct screen screen = overlay_screen(overlay);

	gallery_view_pinch(&overlay->gallery, &screen, x_px, y_px, scale, dx_px, dy_px);
}

void overlay_picture_double_tap(struct overlay *overlay, float x_px, float y_px)
{
	const struct screen screen = overlay_screen(overlay);

	gallery_view_double_tap(&overlay->gallery, &screen, x_px, y_px);
}

/* ---- a frame ---- */

static void update_bar(struct overlay *overlay, const struct screen *screen)
{
	const struct bar_view_state state = {
		.back = overlay->back,
		.help = overlay->help.fade.on,
		.search = overlay->search.fade.on,
		.tours = overlay->tours.fade.on || overlay->tour.runs,
		.large = overlay->comfort.large,
		.reach = overlay->comfort.reach,
		.light = overlay->tools.now.on & OVERLAY_TOOL_LIGHT,
		.section = overlay->tools.now.on & OVERLAY_TOOL_SECTION,
		.measure = overlay->tools.now.on & OVERLAY_TOOL_MEASURE,
		.walk = overlay->tools.now.on & OVERLAY_TOOL_WALK,
		.languages = overlay->languages_view.fade.on,
	};

	bar_view_update(&overlay->bar, screen, &overlay->languages, state);
}

static bool update_tour(struct overlay *overlay, const struct screen *screen, int64_t step_ms)
{
	const bool shows = overlay_tour_shows(overlay);

	overlay->callouts.dirty |= overlay->tour.fade.on != shows;
	return tour_player_view_update(&overlay->tour, screen, shows,
				       overlay->tours.list[overlay->tour.tour].title, step_ms);
}

static bool update_tools(struct overlay *overlay, const struct screen *screen, int64_t step_ms)
{
	const struct tools_view_obstacles obstacles = overlay_obstacles(overlay, screen);

	return tools_view_update(&overlay->tools, screen, &obstacles, step_ms,
				 &overlay->callouts.dirty);
}

static bool update_choice(struct overlay *overlay, const struct screen *screen, int64_t step_ms)
{
	const struct tools_view_obstacles obstacles = overlay_obstacles(overlay, screen);

	return choice_view_update(&overlay->choice, screen, &obstacles, step_ms);
}

static bool update_measure(struct overlay *overlay, const struct screen *screen, int64_t step_ms)
{
	const struct tools_view_obstacles obstacles = overlay_obstacles(overlay, screen);

	return measure_view_update(&overlay->measure, screen, !obstacles.all,
				   choice_view_shows(&overlay->choice, screen, &obstacles)
					   ? choice_view_rect(&overlay->choice, screen)
					   : (struct rect){ 0 },
				   step_ms);
}

/* Callouts come after all that they must not touch. */
static bool update_callouts(struct overlay *overlay, const struct screen *screen, int64_t step_ms)
{
	const struct callouts_view_room room = overlay_callouts_room(overlay, screen);

	return callouts_view_update(&overlay->callouts, screen, &overlay->parts, &room, step_ms);
}

static bool update_page(struct overlay *overlay, const struct screen *screen, int64_t step_ms)
{
	const char *title =
		overlay->page.part >= 0 ? overlay->parts.list[overlay->page.part].title : "";
	bool moving = gallery_view_update(&overlay->gallery, screen, overlay->page.article,
					  &overlay->pictures, step_ms);

	moving |= page_view_update(&overlay->page, screen, title, step_ms);
	if (!overlay->page.article)
		gallery_view_drop(&overlay->gallery); /* its pictures are the page's */
	return moving;
}

bool overlay_update(struct overlay *overlay, int64_t now_ms)
{
	const struct screen screen = overlay_screen(overlay);
	const struct picture_source *pictures = &overlay->pictures;
	const struct parts *parts = &overlay->parts;
	int64_t step_ms = overlay->then_ms ? now_ms - overlay->then_ms : 0;
	bool moving;

	if (step_ms < 0 || step_ms > STEP_MOST_MS)
		step_ms = step_ms < 0 ? 0 : STEP_MOST_MS;
	overlay->then_ms = now_ms;
	update_bar(overlay, &screen);
	moving = help_view_update(&overlay->help, &screen, parts->count > 0, step_ms);
	moving |= card_view_update(&overlay->card, &screen, parts, pictures, step_ms);
	moving |= question_view_update(&overlay->question, &screen, step_ms);
	moving |= invitation_view_update(&overlay->invitation, step_ms);
	moving |= update_tour(overlay, &screen, step_ms);
	moving |= tours_view_update(&overlay->tours, &screen, pictures, step_ms);
	moving |= languages_view_update(&overlay->languages_view, &screen, &overlay->languages,
					step_ms);
	moving |= update_tools(overlay, &screen, step_ms);
	moving |= update_choice(overlay, &screen, step_ms);
	moving |= update_measure(overlay, &screen, step_ms);
	moving |= update_callouts(overlay, &screen, step_ms);
	moving |= search_view_update(&overlay->search, &screen, parts, pictures, step_ms);
	moving |= update_page(overlay, &screen, step_ms);
	return moving;
}

uint32_t overlay_layers(const struct overlay *overlay, struct overlay_layer *list, uint32_t most)
{
	const struct screen screen = overlay_screen(overlay);
	struct layers layers = { .list = list, .most = most };

	callouts_view_layers(&overlay->callouts, &layers);
	measure_view_layers(&overlay->measure, &screen, &layers);
	tools_view_layers(&overlay->tools, &screen, &layers);
	choice_view_layers(&overlay->choice, &layers);
	help_view_layers(&overlay->help, &screen, overlay->parts.count > 0, &layers);
	invitation_view_layers(&overlay->invitation, &screen, &layers);
	tour_player_view_layers(&overlay->tour, &screen, &layers);
	tours_view_layers(&overlay->tours, &screen, &layers);
	page_view_layers(&overlay->page, &screen, &overlay->paper, &layers);
	card_view_layers(&overlay->card, &screen, &layers);
	search_view_layers(&overlay->search, &screen, &overlay->paper, &layers);
	gallery_view_layers(&overlay->gallery, &screen, &layers);
	languages_view_layers(&overlay->languages_view, &screen, &overlay->languages, &layers);
	bar_view_layers(&overlay->bar, &screen, &layers);
	question_view_layers(&overlay->question, &screen, &layers);
	return layers.count;
}

void overlay_paint(const struct overlay *overlay, cairo_t *context)
{
	struct overlay_layer list[OVERLAY_LAYERS_MAX];
	const struct layers layers = { .list = list,
				       .count = overlay_layers(overlay, list, OVERLAY_LAYERS_MAX) };

	layers_paint(&layers, context);
}
