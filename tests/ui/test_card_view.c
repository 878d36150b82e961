/* The card opens, closes and is mirrored with its language. */
#include "tests/ui/views.h"
#include "ui/card_view.h"
#include "ui/translate.h"

static const struct overlay_part list[] = {
	{ "البرج", "حجر", "", true },
	{ "Gate", "Of stone", "pictures/gate.jpg", false },
};
static const struct parts parts = { (struct overlay_part *)list, ARRAY_COUNT(list) };
static const struct picture_source no_pictures;

static void settle(struct card_view *view, const struct screen *screen)
{
	while (card_view_update(view, screen, &parts, &no_pictures, 16))
		;
}

static void it_is_mirrored_with_its_language(void **state)
{
	struct theme theme;
	const struct screen screen = make_screen(&theme, "ar");
	const struct rect rect = card_view_rect(&screen);
	const float top = (float)rect.y_px + 20, left = (float)rect.x_px + 20;
	const float right = (float)(rect.x_px + rect.width_px) - 20;
	struct card_view view;
	uint32_t next_id = 0;

	(void)state;
	card_view_init(&view, &next_id);
	CHECK(card_view_show(&view, 0));
	settle(&view, &screen);
	CHECK(card_view_tap(&view, &screen, &parts, left, top).kind == OVERLAY_CLOSE_CARD);
	CHECK(card_view_tap(&view, &screen, &parts, right, top).kind == OVERLAY_OPEN_PAGE);
	/* The title at the right, nothing but paper beside it. */
	CHECK(text_pixels(&view.sprite.bitmap, 0.6, 0.97, 0.4, false) > 100);
	CHECK(text_pixels(&view.sprite.bitmap, 0.2, 0.6, 0.4, false) == 0);
	theme_set_language(&theme, "en");
	CHECK(card_view_tap(&view, &screen, &parts, right, top).kind == OVERLAY_CLOSE_CARD);
	card_view_finish(&view);
	theme_finish(&theme);
}

static void another_part_fades_in_anew_and_without_a_page_opens_none(void **state)
{
	struct theme theme;
	const struct screen screen = make_screen(&theme, "en");
	const struct rect rect = card_view_rect(&screen);
	struct card_view view;
	uint32_t next_id = 0, drawn;

	(void)state;
	card_view_init(&view, &next_id);
	CHECK(!card_view_show(&view, -1) && card_view_show(&view, 0));
	settle(&view, &screen);
	CHECK(view.fade.alpha == 1);
	drawn = view.sprite.revision;
	settle(&view, &screen);
	CHECK(view.sprite.revision == drawn); /* nothing changed: nothing is drawn */
	CHECK(card_view_show(&view, 1) && view.fade.alpha == 0);
	settle(&view, &screen);
	CHECK(view.sprite.revision == drawn + 1);
	CHECK(card_view_tap(&view, &screen, &parts, middle_x(rect), middle_y(rect)).kind ==
	      OVERLAY_SWALLOWED);
	CHECK(card_view_show(&view, -1) && view.part == -1 && view.fade.alpha == 1);
	settle(&view, &screen);
	CHECK(view.fade.alpha == 0);
	card_view_finish(&view);
	theme_finish(&theme);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_is_mirrored_with_its_language),
		cmocka_unit_test(another_part_fades_in_anew_and_without_a_page_opens_none),
	};

	if (translate_open(TEST_LOCALE) < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
