/* Texts that are judged as if they had been saved, for those who write and wait. */
#include <errno.h>

#include "tests/pipeline/content/info_folder.h"

static int build_instead(struct info_built *out, const struct info_text_instead *instead,
			 uint32_t count, bool skims)
{
	static const char *const languages[] = { "en", "km" };
	const struct info_build_options options = { .folder = folder,
						    .languages = languages,
						    .language_count = 2,
						    .instead = instead,
						    .instead_count = count,
						    .skims_pictures = skims,
						    .diagnostics = &told };

	diagnostics_finish(&told);
	return info_build(out, &options);
}

static struct bytes text(const char *string)
{
	return (struct bytes){ (const uint8_t *)string, strlen(string) };
}

static void a_text_instead_of_a_file_is_built_as_if_it_were_saved(void **state)
{
	static const char page[] = "<p>Nobody enters here.</p>";
	const struct info_text_instead instead = { "pages/gate.en.html", text(page) };
	struct info_built before, saved;

	(void)state;
	CHECK(build_instead(&before, &instead, 1, false) == 0);
	write_text("pages/gate.en.html", page);
	CHECK(build_instead(&saved, NULL, 0, false) == 0);
	CHECK(before.database.size == saved.database.size);
	CHECK(memcmp(before.database.data, saved.database.data, saved.database.size) == 0);
	info_built_finish(&before);
	info_built_finish(&saved);
}

static void its_faults_are_named_as_those_of_the_file(void **state)
{
	const struct info_text_instead page = { "pages/gate.en.html",
						text("<p>x</p>\n<script>y</script>") };
	const struct info_text_instead parts = { "parts.json", text("{\"parts\": 7}") };
	const struct info_text_instead gone = { "pages/gate.en.html", { NULL, 0 } };
	struct info_built built;

	(void)state;
	CHECK(build_instead(&built, &page, 1, false) == -EINVAL);
	CHECK(was_told("pages/gate.en.html", 2, "script"));
	CHECK(build_instead(&built, &parts, 1, false) == -EINVAL);
	CHECK(was_told("parts.json", 1, "top level"));
	CHECK(build_instead(&built, &gone, 1, false) == -EINVAL);
	CHECK(was_told("pages/gate.en.html", 0, "is missing"));
	CHECK(build_instead(&built, NULL, 0, false) == 0);
	info_built_finish(&built);
}

static void pictures_that_are_skimmed_must_be_there_and_begin_as_pictures(void **state)
{
	const struct info_text_instead missing = {
		"pages/gate.en.html", text("<p>x</p><img src=\"pictures/none.png\">")
	};
	struct info_built built;

	(void)state;
	CHECK(build_instead(&built, NULL, 0, true) == 0);
	info_built_finish(&built);
	CHECK(build_instead(&built, &missing, 1, true) == -EINVAL);
	CHECK(was_told("pages/gate.en.html", 1, "is not there"));
	write_text("pictures/a.png", "no picture");
	CHECK(build_instead(&built, NULL, 0, true) == -EINVAL);
	CHECK(was_told("pictures/a.png", 0, "not a complete"));
	write_text("pictures/a.png", "\x89PNG but no more");
	CHECK(build_instead(&built, NULL, 0, true) == 0);
	info_built_finish(&built);
	CHECK(build_instead(&built, NULL, 0, false) == -EINVAL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(
			a_text_instead_of_a_file_is_built_as_if_it_were_saved, set_up, tear_down),
		cmocka_unit_test_setup_teardown(its_faults_are_named_as_those_of_the_file, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(
			pictures_that_are_skimmed_must_be_there_and_begin_as_pictures, set_up,
			tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
