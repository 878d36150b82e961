/* Where an overlay has its views now, for tests that look and feel there. */
#ifndef GOPURA_TESTS_UI_PLACES_H
#define GOPURA_TESTS_UI_PLACES_H

#include "ui/overlay_layout.h"

static inline struct rect bar_place(const struct overlay *overlay)
{
	return overlay_screen(overlay).bar;
}

static inline struct rect card_place(const struct overlay *overlay)
{
	const struct screen screen = overlay_screen(overlay);

	return card_view_rect(&screen);
}

static inline struct rect help_place(const struct overlay *overlay)
{
	const struct screen screen = overlay_screen(overlay);

	return help_view_rect(&overlay->help, &screen);
}

static inline struct rect invitation_place(const struct overlay *overlay)
{
	const struct screen screen = overlay_screen(overlay);

	return invitation_view_rect(&overlay->invitation, &screen);
}

static inline struct rect question_place(const struct overlay *overlay)
{
	const struct screen screen = overlay_screen(overlay);

	return question_view_rect(&overlay->question, &screen);
}

static inline struct rect page_place(const struct overlay *overlay)
{
	const struct screen screen = overlay_screen(overlay);

	return page_view_rect(&overlay->page, &screen);
}

static inline struct rect page_window(const struct overlay *overlay)
{
	const struct screen screen = overlay_screen(overlay);

	return page_view_window(&overlay->page, &screen);
}

static inline struct rect search_place(const struct overlay *overlay)
{
	const struct screen screen = overlay_screen(overlay);

	return search_view_rect(&screen);
}

static inline struct rect list_place(const struct overlay *overlay)
{
	const struct screen screen = overlay_screen(overlay);

	return search_view_list(&overlay->search, &screen);
}

#endif
