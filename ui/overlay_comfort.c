/* Large type, reach mode and a page over the whole panel: measures and places again what is
 * shown. */
#include "ui/overlay_state.h"

struct overlay_comfort overlay_comfort(const struct overlay *overlay)
{
	return overlay->comfort;
}

/* Lays the page out again. The first visible line stays about the same. */
static void lay_out_page(struct overlay *overlay)
{
	struct rect view = overlay_view_rect(overlay);
	float read = overlay->scroll_px / (float)article_height_px(overlay->article);
	int most_px;

	if (article_lay_out(overlay->article, view.width_px, view.height_px) < 0)
		overlay_close_page(overlay); /* no memory for the links */
	most_px = overlay_scroll_most(overlay);
	overlay->scroll_px = read * (float)article_height_px(overlay->article);
	if (overlay->scroll_px > (float)most_px)
		overlay->scroll_px = (float)most_px;
	overlay->scroll_px_per_s = 0;
	for (uint32_t i = 0; i < STRIPS; i++)
		overlay->strips[i] = (struct strip){ .index = -1 };
}

void overlay_widen_page(struct overlay *overlay, bool on)
{
	on = on && overlay->page_part >= 0 && !overlay->comfort.reach;
	if (on == overlay->page_wide)
		return;
	overlay->page_wide = on;
	if (overlay->article)
		lay_out_page(overlay);
	overlay->head_dirty = overlay->callouts_dirty = true;
}

bool overlay_page_is_wide(const struct overlay *overlay)
{
	return overlay->page_wide;
}

void overlay_set_comfort(struct overlay *overlay, struct overlay_comfort comfort)
{
	comfort.reach &= overlay_offers_reach(overlay);
	if (comfort.large == overlay->comfort.large && comfort.reach == overlay->comfort.reach)
		return;
	overlay->comfort = comfort;
	overlay->page_wide &= !comfort.reach;
	overlay->theme.text_scale = comfort.large ? THEME_LARGE_TYPE : 1;
	overlay_lay_out_chrome(overlay);
	overlay_measure_labels(overlay);
	overlay_forget_labels(overlay);
	overlay_search_language(overlay); /* its rows and keys have another size now */
	overlay->search.scroll_px = overlay->search.scroll_px_per_s = 0;
	if (overlay->article)
		lay_out_page(overlay);
	if (overlay->invitation.on)
		overlay_draw_invitation(overlay);
	overlay->tools.dirty = overlay->tour.dirty = overlay->tours.dirty = true;
	overlay->languages_view.dirty = true;
	overlay->help_dirty = overlay->card_dirty = overlay->head_dirty = true;
	overlay->gallery.words_dirty = true;
	overlay->question_drawn_s = 0;
}
