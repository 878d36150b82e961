/* The invitation has a line for each language. tests/ui/test_languages_view.c has many of them on
 * every panel. */
#include <string.h>

#include "tests/ui/views.h"
#include "ui/invitation_view.h"
#include "ui/translate.h"

/* Returns the light pixels of its lines. */
static uint32_t invite(const char *const *codes, uint32_t count)
{
	struct theme theme;
	const struct screen screen = make_screen(&theme, "ar");
	struct languages languages;
	struct invitation_view view;
	uint32_t next_id = 0, pixels;

	CHECK(languages_copy(&languages, codes, count) == 0);
	invitation_view_init(&view, &next_id);
	invitation_view_draw(&view, &screen, &theme, &languages);
	CHECK(view.sprite.revision == 0); /* not yet */
	CHECK(invitation_view_show(&view, true) && !invitation_view_show(&view, true));
	invitation_view_draw(&view, &screen, &theme, &languages);
	CHECK(strcmp(theme.language, "ar") == 0); /* as before */
	pixels = text_pixels(&view.sprite.bitmap, 0.35, 1, 1, true);
	invitation_view_finish(&view);
	languages_free(&languages);
	theme_finish(&theme);
	return pixels;
}

static void each_language_has_a_line_and_each_text_one(void **state)
{
	static const char *const both[] = { "en", "ar" }, *const twice[] = { "en", "en-GB" };
	const uint32_t english = invite(both, 1);

	(void)state;
	CHECK(english > 100 && invite(both, 2) > english + 100);
	CHECK(invite(twice, 2) == english);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_language_has_a_line_and_each_text_one),
	};

	if (translate_open(TEST_LOCALE) < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
