/* The overlay: its creation and content, which element a tap hits, and the update of each frame. */
#include "ui/overlay.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ui/hint.h"
#include "ui/overlay_state.h"

_Static_assert((int)LABELS >= 2 * (int)CALLOUTS_MAX, "labels that come and labels that go");

enum {
	PAGE_FADE_MS = 110, /* the page is fully visible within 150 ms of the tap */
	STEP_MOST_MS = 100, /* a longer pause counts as this long */
	LABELS_A_FRAME = 4, /* labels drawn in one update */
	STRIPS_A_FRAME = 1, /* so that opening a page drops no frame */
	FLING_SLOWDOWN_MS = 350,
	FLING_LEAST_PX_PER_S = 20,
};

/* ---- creation ---- */

void overlay_lay_out_chrome(struct overlay *overlay)
{
	int gaps_px = 2 * theme_px(&overlay->theme, THEME_GAP_MM);
	/* The bar must fit beside an open page. */
	int most_px = overlay_is_portrait(overlay) ? overlay->width_px : overlay->width_px / 2;
	const struct chrome_has has = {
		.search = overlay->part_count > 0,
		.tours = overlay->tours.count > 0,
		.light = overlay->tools.offered & OVERLAY_TOOL_LIGHT,
		.section = overlay->tools.offered & OVERLAY_TOOL_SECTION,
		.reach = overlay_offers_reach(overlay),
	};

	chrome_layout(&overlay->chrome, &overlay->theme,
		      (const char *const *)overlay->languages.codes, overlay->languages.count,
		      most_px - gaps_px, has);
	if (!overlay->chrome.menu)
		overlay_show_languages(overlay, false);
	overlay->chrome_dirty = true;
}

static int start(struct overlay *overlay, const struct overlay_options *options)
{
	int shorter_px =
		options->width_px < options->height_px ? options->width_px : options->height_px;
	float px_per_mm = options->px_per_mm;
	int rc;

	if (px_per_mm <= 0)
		px_per_mm = theme_guess_px_per_mm(options->width_px, options->height_px);
	/* On a panel smaller than a hand everything shrinks; otherwise it would be cut off. */
	px_per_mm = fminf(px_per_mm, (float)shorter_px / 85.0f);
	rc = theme_init(&overlay->theme, px_per_mm, options->languages[0]);
	if (rc == 0)
		rc = languages_copy(&overlay->languages, options->languages,
				    options->language_count);
	if (rc < 0)
		return rc;
	overlay_lay_out_chrome(overlay);
	overlay_draw_fixed(overlay);
	overlay->strip_px = options->height_px / (STRIPS - 4) > STRIP_PX
				    ? options->height_px / (STRIPS - 4)
				    : STRIP_PX;
	overlay_draw_help(overlay); /* its size is needed for layout */
	return 0;
}

int overlay_create(struct overlay **out, const struct overlay_options *options)
{
	struct overlay *overlay;
	uint32_t next_id = 0;
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
	sprites_init(overlay->sprites, BITMAP_COUNT, &next_id);
	languages_view_init(&overlay->languages_view, &next_id);
	assert(next_id <= OVERLAY_BITMAPS_MAX);
	overlay->help.on = true;
	overlay->card_part = overlay->page_part = overlay->search.pressed = -1;
	for (uint32_t i = 0; i < LABELS; i++)
		overlay->labels[i].part = -1;
	for (uint32_t i = 0; i < STRIPS; i++)
		overlay->strips[i].index = -1;
	rc = start(overlay, options);
	if (rc < 0) {
		overlay_destroy(overlay);
		return rc;
	}
	*out = overlay;
	return 0;
}

static void drop_parts(struct part *parts, uint32_t count)
{
	for (uint32_t i = 0; parts && i < count; i++) {
		free(parts[i].title);
		free(parts[i].caption);
		free(parts[i].thumbnail);
	}
	free(parts);
}

void overlay_destroy(struct overlay *overlay)
{
	if (!overlay)
		return;
	article_destroy(overlay->article);
	drop_parts(overlay->parts, overlay->part_count);
	free(overlay->anchors);
	free(overlay->search.found);
	overlay_drop_tours(overlay->tours.entries);
	sprites_finish(overlay->sprites, BITMAP_COUNT);
	languages_view_finish(&overlay->languages_view);
	languages_free(&overlay->languages);
	theme_finish(&overlay->theme);
	free(overlay);
}

/* ---- content ---- */

static int copy_part(struct part *to, const struct overlay_part *from)
{
	to->title = strdup(from->title);
	to->caption = strdup(from->caption);
	to->thumbnail = strdup(from->thumbnail);
	to->has_page = from->has_page;
	return to->title && to->caption && to->thumbnail ? 0 : -ENOMEM;
}

void overlay_forget_labels(struct overlay *overlay)
{
	for (uint32_t i = 0; i < LABELS; i++)
		overlay->labels[i] = (struct label){ .part = -1 };
	overlay->callouts.count = 0;
	overlay->callouts_dirty = true;
}

static void drop_page(struct overlay *overlay)
{
	overlay->gallery = (struct gallery){ 0 };
	article_destroy(overlay->article);
	overlay->article = NULL;
	overlay->page = (struct fade){ 0 };
	overlay->page_part = -1;
	overlay->page_wide = false;
}

int overlay_parts(struct overlay *overlay, const struct overlay_part *parts, uint32_t count)
{
	struct part *copies = calloc((size_t)count + 1, sizeof(*copies));
	struct callout_anchor *anchors = calloc((size_t)count + 1, sizeof(*anchors));
	int rc = copies && anchors ? 0 : -ENOMEM;
	bool had_parts;

	if (count > OVERLAY_PARTS_MAX)
		rc = -EINVAL;
	for (uint32_t i = 0; rc == 0 && i < count; i++)
		rc = copy_part(&copies[i], &parts[i]);
	if (rc == 0 && count != overlay->part_count && overlay_search_parts(overlay, count) < 0)
		rc = -ENOMEM;
	if (rc < 0) {
		drop_parts(copies, count > OVERLAY_PARTS_MAX ? 0 : count);
		free(anchors);
		return rc;
	}
	if (count != overlay->part_count) {
		drop_page(overlay);
		overlay->card = overlay->search.fade = (struct fade){ 0 };
		overlay->card_part = -1;
	} else if (overlay->part_count > 0) {
		memcpy(anchors, overlay->anchors, count * sizeof(*anchors));
	}
	drop_parts(overlay->parts, overlay->part_count);
	free(overlay->anchors);
	overlay->parts = copies;
	overlay->anchors = anchors;
	had_parts = overlay->part_count > 0;
	overlay->part_count = count;
	if (had_parts != (count > 0)) {
		overlay->help_dirty = true;
		overlay_lay_out_chrome(overlay);
	}
	overlay_search_language(overlay); /* its rows have other texts now */
	overlay_measure_labels(overlay);
	overlay_forget_labels(overlay);
	overlay->card_dirty = overlay->head_dirty = true;
	return 0;
}

void overlay_language(struct overlay *overlay, const char *language)
{
	if (!languages_set(&overlay->languages, language))
		return;
	theme_set_language(&overlay->theme, language);
	overlay->chrome_dirty = overlay->help_dirty = true;
	overlay->question_drawn_s = 0; /* draw it again in the new language */
	overlay->card_dirty = overlay->head_dirty = true;
	overlay->tour.dirty = overlay->tours.dirty = overlay->tools.dirty = true;
	overlay_search_language(overlay);
	overlay_show_languages(overlay, false);
	overlay->languages_view.dirty = true;
	overlay_forget_labels(overlay);
}

void overlay_anchors(struct overlay *overlay, const struct overlay_anchor *anchors, uint32_t count)
{
	for (uint32_t i = 0; i < count && i < overlay->part_count; i++) {
		overlay->anchors[i].x_px = anchors[i].x_px;
		overlay->anchors[i].y_px = anchors[i].y_px;
		overlay->parts[i].size_px = anchors[i].size_px;
		overlay->parts[i].in_view = anchors[i].visible;
		overlay->parts[i].hidden = anchors[i].hidden;
	}
	overlay->callouts_dirty = true;
}

void overlay_show_card(struct overlay *overlay, int part)
{
	if (part >= (int)overlay->part_count)
		part = -1;
	if (part == overlay->card_part)
		return;
	if (part >= 0)
		overlay_widen_page(overlay,
				   false); /* a card is about the model, which must be visible */
	overlay->card_part = part;
	overlay->card.on = part >= 0;
	overlay->callouts_dirty = true;
	if (part < 0)
		return;
	if (overlay->card_shown != part)
		overlay->card.alpha = 0;
	overlay->card_shown = part;
	overlay->card_dirty = true;
	overlay_show_help(overlay, false); /* card and help share their place */
	overlay_show_tours(overlay, false);
}

int overlay_card(const struct overlay *overlay)
{
	return overlay->card_part;
}

int overlay_show_page(struct overlay *overlay, int part, struct bytes bytes, const char *credits)
{
	struct article_options options = { .theme = &overlay->theme,
					   .pictures = overlay->pictures,
					   .credits = credits };
	struct article *article;
	int rc;

	if (part < 0 || part >= (int)overlay->part_count)
		return -EINVAL;
	if (overlay->page_part < 0)
		overlay->page_wide = false;
	options.width_px = overlay_view_rect(overlay).width_px;
	options.view_px = overlay_view_rect(overlay).height_px;
	rc = article_create(&article, &options, bytes);
	if (rc < 0)
		return rc;
	overlay->gallery = (struct gallery){ 0 };
	article_destroy(overlay->article);
	overlay->article = article;
	overlay->page_part = overlay->page_titled = part;
	overlay->page.on = true;
	overlay->scroll_px = 0;
	overlay->scroll_px_per_s = 0;
	for (uint32_t i = 0; i < STRIPS; i++)
		overlay->strips[i] = (struct strip){ .index = -1 };
	overlay->head_dirty = true;
	overlay_show_search(overlay, false); /* the page takes its place */
	overlay_show_card(overlay, -1);      /* the page has all its information */
	overlay_show_help(overlay, false);
	overlay_show_tours(overlay, false);
	overlay->callouts_dirty = true;
	return 0;
}

void overlay_close_page(struct overlay *overlay)
{
	overlay_show_picture(overlay, -1);
	overlay->page_part = -1;
	overlay->page.on = false;
	overlay->callouts_dirty = true;
}

float overlay_read(const struct overlay *overlay)
{
	return overlay->page_part >= 0
		       ? overlay->scroll_px / (float)article_height_px(overlay->article)
		       : 0;
}

void overlay_read_from(struct overlay *overlay, float share)
{
	if (overlay->page_part < 0)
		return;
	overlay->scroll_px_per_s = 0;
	overlay->scroll_px = fminf(share * (float)article_height_px(overlay->article),
				   (float)overlay_scroll_most(overlay));
}

void overlay_offer_back(struct overlay *overlay, bool on)
{
	overlay->chrome_dirty |= overlay->back != on;
	overlay->back = on;
}

int overlay_page(const struct overlay *overlay)
{
	return overlay->page_part;
}

void overlay_show_help(struct overlay *overlay, bool on)
{
	if (overlay->help.on == on)
		return;
	overlay->help.on = on;
	overlay->help_dirty |= on;
	overlay->help_ms = on ? 0 : overlay->help_ms;
	overlay->chrome_dirty = overlay->callouts_dirty = true;
	if (!on)
		return;
	overlay_show_card(overlay, -1);
	overlay_show_tours(overlay, false);
}

bool overlay_help(const struct overlay *overlay)
{
	return overlay->help.on;
}

void overlay_invite(struct overlay *overlay, bool on)
{
	if (overlay->invitation.on == on)
		return;
	overlay->invitation.on = on;
	if (on)
		overlay_draw_invitation(overlay);
	overlay_show_help(overlay, !on);
	overlay->callouts_dirty = true;
}

void overlay_ask(struct overlay *overlay, int seconds_left)
{
	overlay->question.on = seconds_left >= 0;
	if (seconds_left >= 0)
		overlay->question_s = seconds_left;
}

void overlay_picture_arrived(struct overlay *overlay, const char *name)
{
	int from_px = overlay->article ? article_picture_arrived(overlay->article, name) : -1;

	overlay_search_picture(overlay, name);
	overlay_gallery_arrived(overlay, name);
	overlay_picture_of_tours(overlay, name);
	for (uint32_t i = 0; from_px >= 0 && i < STRIPS; i++)
		if ((overlay->strips[i].index + 1) * overlay->strip_px > from_px)
			overlay->strips[i].stale = true;
	if (overlay->card_part >= 0 &&
	    strcmp(overlay->parts[overlay->card_part].thumbnail, name) == 0)
		overlay->card_dirty = true;
}

void overlay_show_languages(struct overlay *overlay, bool on)
{
	overlay->chrome_dirty |=
		languages_view_show(&overlay->languages_view, on && overlay->chrome.menu);
}

bool overlay_choosing_language(const struct overlay *overlay)
{
	return overlay->languages_view.fade.on;
}

/* ---- touch ---- */

static int label_at(const struct overlay *overlay, float x_px, float y_px)
{
	for (uint32_t i = 0; i < LABELS; i++) {
		const struct label *label = &overlay->labels[i];
		struct rect rect = { label->place.x_px, label->place.y_px, label->place.width_px,
				     overlay_row_px(overlay) };

		if (label->part >= 0 && label->fade.on && rect_holds(rect, x_px, y_px))
			return label->part;
	}
	return -1;
}

static struct overlay_action tap_page(const struct overlay *overlay, float x_px, float y_px)
{
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = overlay->page_part };
	struct rect view = overlay_view_rect(overlay);
	int picture;

	if (rect_holds(overlay_head_rect(overlay, overlay_page_rect(overlay)), x_px, y_px)) {
		/* The whole right end of the head closes, so that a near miss closes too. */
		if (x_px >= (float)overlay_close_rect(overlay).x_px)
			action.kind = OVERLAY_CLOSE_PAGE;
		else if (rect_holds(overlay_widen_rect(overlay), x_px, y_px))
			action.kind = OVERLAY_WIDEN_PAGE;
		return action;
	}
	if (!rect_holds(view, x_px, y_px))
		return action;
	x_px -= (float)view.x_px;
	y_px += overlay->scroll_px - (float)view.y_px;
	action.link = article_link_at(overlay->article, x_px, y_px);
	picture = article_picture_at(overlay->article, x_px, y_px);
	if (action.link)
		action.kind = OVERLAY_LINK;
	else if (picture >= 0)
		action = (struct overlay_action){ .kind = OVERLAY_PICTURE,
						  .part = overlay->page_part,
						  .picture = picture };
	return action;
}

static struct overlay_action tap_chrome(const struct overlay *overlay, float x_px)
{
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = -1 };
	const struct chrome_button *button = chrome_button_at(&overlay->chrome, x_px);

	if (!button)
		return action;
	if (button->kind == CHROME_HOME) {
		action.kind = OVERLAY_HOME;
	} else if (button->kind == CHROME_BACK) {
		action.kind = overlay->back ? OVERLAY_BACK : OVERLAY_SWALLOWED;
	} else if (button->kind == CHROME_HELP) {
		action.kind = OVERLAY_HELP;
	} else if (button->kind == CHROME_SEARCH) {
		action.kind = OVERLAY_SEARCH;
	} else if (button->kind == CHROME_TOURS) {
		action.kind = OVERLAY_TOURS;
	} else if (button->kind == CHROME_LIGHT) {
		action.kind = OVERLAY_LIGHT;
	} else if (button->kind == CHROME_SECTION) {
		action.kind = OVERLAY_SECTION;
	} else if (button->kind == CHROME_LARGE) {
		action.kind = OVERLAY_LARGE;
	} else if (button->kind == CHROME_REACH) {
		action.kind = OVERLAY_REACH;
	} else if (button->kind == CHROME_LANGUAGES) {
		action.kind = OVERLAY_LANGUAGES;
	} else if (button->language != overlay->languages.current) {
		action.kind = OVERLAY_LANGUAGE;
		action.language = overlay->languages.codes[button->language];
	}
	return action;
}

static struct overlay_action tap_card(const struct overlay *overlay, float x_px, float y_px)
{
	struct overlay_action action = { .kind = OVERLAY_SWALLOWED, .part = overlay->card_part };
	struct rect card = overlay_card_rect(overlay);

	if (card_closes(&overlay->theme, card.width_px, x_px - (float)card.x_px,
			y_px - (float)card.y_px))
		action.kind = OVERLAY_CLOSE_CARD;
	else if (overlay->parts[overlay->card_part].has_page)
		action.kind = OVERLAY_OPEN_PAGE;
	return action;
}

struct overlay_action overlay_tap(const struct overlay *overlay, float x_px, float y_px)
{
	struct overlay_action action = { .kind = OVERLAY_NONE, .part = -1 };
	const struct screen screen = overlay_screen(overlay);
	struct rect chrome = screen.bar;

	if (rect_holds(chrome, x_px, y_px))
		return tap_chrome(overlay, x_px - (float)chrome.x_px);
	if (overlay->languages_view.fade.on)
		return languages_view_tap(&screen, &overlay->languages, x_px, y_px);
	if (overlay->gallery.fade.on)
		return overlay_gallery_tap(overlay, x_px, y_px);
	if (overlay->search.fade.on && rect_holds(overlay_search_rect(overlay), x_px, y_px))
		return overlay_search_tap(overlay, x_px, y_px);
	if (overlay->card_part >= 0 && rect_holds(overlay_card_rect(overlay), x_px, y_px))
		return tap_card(overlay, x_px, y_px);
	if (overlay->page_part >= 0 && rect_holds(overlay_page_rect(overlay), x_px, y_px))
		return tap_page(overlay, x_px, y_px);
	if (overlay->tours.fade.on && rect_holds(overlay_menu_rect(overlay), x_px, y_px))
		return overlay_menu_tap(overlay, x_px, y_px);
	if (overlay_tour_shows(overlay) && rect_holds(overlay_tour_rect(overlay), x_px, y_px))
		return overlay_tour_tap(overlay, x_px, y_px);
	if (overlay_on_tools(overlay, x_px, y_px)) {
		action.kind = OVERLAY_SWALLOWED;
		return action;
	}
	if (overlay->help.on && rect_holds(overlay_help_rect(overlay), x_px, y_px)) {
		action.kind = OVERLAY_HELP;
		return action;
	}
	action.part = label_at(overlay, x_px, y_px);
	if (action.part >= 0)
		action.kind = OVERLAY_OPEN_CARD;
	return action;
}

bool overlay_covers(const struct overlay *overlay, float x_px, float y_px)
{
	const struct screen screen = overlay_screen(overlay);

	if (overlay->gallery.fade.on)
		return true;
	if (overlay->languages_view.fade.on &&
	    rect_holds(languages_view_rect(&screen, &overlay->languages), x_px, y_px))
		return true;
	if (rect_holds(overlay_chrome_rect(overlay), x_px, y_px))
		return true;
	if (overlay->page_part >= 0 && rect_holds(overlay_page_rect(overlay), x_px, y_px))
		return true;
	if (overlay->search.fade.on && rect_holds(overlay_search_rect(overlay), x_px, y_px))
		return true;
	if (overlay->tours.fade.on && rect_holds(overlay_menu_rect(overlay), x_px, y_px))
		return true;
	if (overlay_tour_shows(overlay) && rect_holds(overlay_tour_rect(overlay), x_px, y_px))
		return true;
	if (overlay_on_tools(overlay, x_px, y_px))
		return true;
	return overlay->card_part >= 0 && rect_holds(overlay_card_rect(overlay), x_px, y_px);
}

static void scroll_by(float *scroll_px, float *px_per_s, int most_px, float by_px)
{
	float to_px = *scroll_px + by_px;

	*scroll_px = fminf(fmaxf(to_px, 0), (float)most_px);
	if (*scroll_px != to_px)
		*px_per_s = 0;
}

void overlay_scroll(struct overlay *overlay, float dy_px)
{
	struct search *search = &overlay->search;

	search->scroll_px_per_s = overlay->scroll_px_per_s = 0;
	if (search->fade.on)
		scroll_by(&search->scroll_px, &search->scroll_px_per_s,
			  overlay_found_scroll_most(overlay), -dy_px);
	else
		scroll_by(&overlay->scroll_px, &overlay->scroll_px_per_s,
			  overlay_scroll_most(overlay), -dy_px);
}

void overlay_fling(struct overlay *overlay, float vy_px_per_s)
{
	if (overlay->search.fade.on)
		overlay->search.scroll_px_per_s = -vy_px_per_s;
	else
		overlay->scroll_px_per_s = -vy_px_per_s;
}

/* ---- a frame ---- */

static bool advance_scroll(float *scroll_px, float *px_per_s, int most_px, int64_t step_ms)
{
	if (*px_per_s == 0)
		return false;
	scroll_by(scroll_px, px_per_s, most_px, *px_per_s * (float)step_ms / 1000);
	*px_per_s *= expf(-(float)step_ms / FLING_SLOWDOWN_MS);
	if (fabsf(*px_per_s) < FLING_LEAST_PX_PER_S)
		*px_per_s = 0;
	return *px_per_s != 0;
}

/* Dims a label while its part is hidden. A short occlusion, as by a passing pillar, removes
 * nothing. */
static bool watch_hidden(struct overlay *overlay, struct label *label, int64_t step_ms)
{
	label->dim.on = overlay->parts[label->part].hidden;
	if (!label->dim.on || !label->fade.on) {
		label->hidden_ms = 0;
		return fade_advance(&label->dim, step_ms);
	}
	label->hidden_ms += step_ms;
	overlay->callouts_dirty |= label->hidden_ms >= OVERLAY_HIDDEN_MS;
	fade_advance(&label->dim, step_ms);
	return true;
}

static bool update_labels(struct overlay *overlay, int64_t step_ms)
{
	uint32_t budget = LABELS_A_FRAME;
	bool moving = false;

	for (uint32_t i = 0; i < LABELS; i++) {
		struct label *label = &overlay->labels[i];
		bool selected;

		if (label->part < 0)
			continue;
		selected = label->part == overlay->card_part || label->part == overlay->page_part;
		if (label->fade.on &&
		    (!label->drawn || label->drawn_selected != selected ||
		     overlay->sprites[BITMAP_LABEL + i].bitmap.width_px != label->place.width_px)) {
			if (budget == 0) {
				moving = true;
				continue;
			}
			overlay_draw_label(overlay, i);
			budget--;
		}
		moving |= fade_advance(&label->fade, step_ms);
		moving |= watch_hidden(overlay, label, step_ms);
		if (!label->fade.on && label->fade.alpha == 0)
			*label = (struct label){ .part = -1 };
	}
	return moving;
}

static bool update_strips(struct overlay *overlay, int64_t step_ms)
{
	struct rect view = overlay_view_rect(overlay);
	int first = (int)overlay->scroll_px / overlay->strip_px;
	/* One strip more than is visible, so that scrolling finds it drawn. */
	int last = ((int)overlay->scroll_px + view.height_px) / overlay->strip_px + 1;
	int end = article_height_px(overlay->article) / overlay->strip_px;
	uint32_t budget = STRIPS_A_FRAME;
	bool moving = false;

	for (int index = first; index <= last && index <= end; index++) {
		uint32_t slot = (uint32_t)index % STRIPS;
		struct strip *strip = &overlay->strips[slot];

		if (strip->index != index || strip->stale) {
			if (budget == 0) {
				moving = true;
				continue;
			}
			strip->index = index;
			strip->stale = false;
			strip->fade.on = true;
			if (overlay->page.alpha < 1) /* it appears together with its page */
				strip->fade.alpha = 1;
			overlay_draw_strip(overlay, slot);
			budget--;
		}
		moving |= fade_advance(&strip->fade, step_ms);
	}
	return moving;
}

static void draw_what_changed(struct overlay *overlay)
{
	if (overlay->help_dirty)
		overlay_draw_help(overlay);
	if (overlay->chrome_dirty)
		overlay_draw_chrome(overlay);
	if (overlay->card_dirty && overlay->card_part >= 0)
		overlay_draw_card(overlay);
	if (overlay->head_dirty && overlay->page_part >= 0)
		overlay_draw_page_head(overlay);
	if (overlay->question.on && overlay->question_drawn_s != overlay->question_s)
		overlay_draw_question(overlay);
	overlay->help_dirty = overlay->chrome_dirty = false;
	overlay->card_dirty = overlay->head_dirty = false;
}

bool overlay_update(struct overlay *overlay, int64_t now_ms)
{
	const struct screen screen = overlay_screen(overlay);
	int64_t step_ms = overlay->then_ms ? now_ms - overlay->then_ms : 0;
	bool moving;

	if (step_ms < 0 || step_ms > STEP_MOST_MS)
		step_ms = step_ms < 0 ? 0 : STEP_MOST_MS;
	overlay->then_ms = now_ms;
	draw_what_changed(overlay);
	moving = overlay_update_tours(overlay, step_ms);
	moving |= languages_view_update(&overlay->languages_view, &screen, &overlay->languages,
					step_ms);
	moving |= overlay_update_tools(overlay, step_ms);
	if (overlay->callouts_dirty)
		overlay_lay_out_callouts(overlay);
	overlay->callouts_dirty = false;
	moving |= fade_advance(&overlay->help, step_ms);
	if (overlay->help.on && overlay->help_ms < HINT_MOVES_MS) {
		overlay->help_ms += step_ms;
		moving = true;
	}
	moving |= fade_advance(&overlay->invitation, step_ms);
	moving |= fade_advance(&overlay->question, step_ms);
	moving |= fade_advance(&overlay->card, step_ms);
	moving |= fade_advance(&overlay->page, step_ms * FADE_MS / PAGE_FADE_MS);
	moving |= advance_scroll(&overlay->scroll_px, &overlay->scroll_px_per_s,
				 overlay_scroll_most(overlay), step_ms);
	if (overlay->search.scroll_px_per_s != 0)
		moving |=
			advance_scroll(&overlay->search.scroll_px, &overlay->search.scroll_px_per_s,
				       overlay_found_scroll_most(overlay), step_ms);
	moving |= overlay_update_search(overlay, step_ms);
	moving |= overlay_update_gallery(overlay, step_ms);
	moving |= update_labels(overlay, step_ms);
	if (!overlay->page.on && overlay->page.alpha == 0)
		drop_page(overlay);
	else if (overlay->article)
		moving |= update_strips(overlay, step_ms);
	return moving;
}
