/* Spoken texts of pages, from the folder to what the kiosk reads. */
#include <errno.h>

#include "storage/info_spoken.h"
#include "tests/pipeline/content/info_folder.h"

static const char recording[] = "demo/content/pages/central-tower.en.opus";

/* Puts the first `bytes` of the recording beside the tower's page; SIZE_MAX: all. */
static void write_recording(const char *name, size_t bytes)
{
	struct buffer file;

	buffer_init(&file, 1 << 20);
	CHECK(buffer_read_file(&file, recording) == 0);
	write_file(name, file.data, bytes < file.size ? bytes : file.size);
	buffer_finish(&file);
}

static void comes_back_with_its_words(void **state)
{
	struct info_built built;
	struct info_spoken spoken;
	struct info *info;

	(void)state;
	write_recording("pages/tower.en.opus", SIZE_MAX);
	write_text("pages/tower.en.vtt", "WEBVTT\n\n00:00.000 --> 00:02.000\nThe highest\n\n"
					 "00:02.000 --> 00:03.500\nof five.\n");
	CHECK(build(&built) == 0);
	CHECK(built.file_count == 3); /* two pictures */
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	CHECK(info_spoken(info, 0, "en", &spoken) == 0);
	CHECK(spoken.duration_ms > 10000 && spoken.duration_ms < 60000);
	CHECK(spoken.cue_count == 2 && spoken.cues[1].begin_ms == 2000);
	CHECK(strcmp(spoken.cues[1].text, "of five.") == 0);
	bool listed = false;
	for (uint32_t n = 0; n < built.file_count; n++)
		listed |= hash_equal(built.files[n].hash, spoken.hash) &&
			  strcmp(built.files[n].name, "pages/tower.en.opus") == 0 &&
			  built.files[n].size == spoken.bytes;
	CHECK(listed);
	/* The page in Khmer has none of its own; where there is no page, the English one is shown
	 * and spoken. */
	CHECK(info_spoken(info, 0, "km", &spoken) == -ENOENT);
	CHECK(info_spoken(info, 1, "en", &spoken) == -ENOENT);
	CHECK(info_spoken(info, 2, "en", &spoken) == -ENOENT);
	info_close(info);
	info_built_finish(&built);
}

static void a_content_without_sound_has_no_tables_of_it(void **state)
{
	struct info_built built;

	(void)state;
	CHECK(build(&built) == 0);
	CHECK(!memmem(built.database.data, built.database.size, "TABLE spoken", 12));
	info_built_finish(&built);
}

static void refuses_what_is_not_complete(void **state)
{
	struct info_built built;
	struct buffer file;

	(void)state;
	buffer_init(&file, 1 << 20);
	CHECK(buffer_read_file(&file, recording) == 0);
	for (size_t tenth = 0; tenth < 10; tenth++) {
		write_recording("pages/tower.en.opus", file.size * tenth / 10);
		CHECK(build(&built) == -EINVAL);
		CHECK(was_told("pages/tower.en.opus", 0, "is not a complete Ogg Opus file"));
	}
	file.data[file.size / 2] ^= 0x10;
	write_file("pages/tower.en.opus", file.data, file.size);
	CHECK(build(&built) == -EINVAL);
	CHECK(was_told("pages/tower.en.opus", 0, "is not a complete Ogg Opus file"));
	write_text("pages/tower.en.opus", "no sound");
	CHECK(build(&built) == -EINVAL);
	CHECK(was_told("pages/tower.en.opus", 0, "is not a complete Ogg Opus file"));
	buffer_finish(&file);
}

static void names_what_does_not_belong_together(void **state)
{
	struct info_built built;

	(void)state;
	write_recording("pages/gate.km.opus", SIZE_MAX); /* there is no page gate.km.html */
	write_recording("pages/tower.en.opus", SIZE_MAX);
	write_text("pages/tower.en.vtt", "WEBVTT\n\n09:00.000 --> 09:01.000\nLate\n");
	CHECK(build(&built) == -EINVAL);
	CHECK(was_told("pages/gate.km.opus", 0, "write pages/gate.km.html"));
	CHECK(was_told("pages/tower.en.vtt", 0, "begin after the end of pages/tower.en.opus"));
}

#define IN_A_FOLDER(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		IN_A_FOLDER(comes_back_with_its_words),
		IN_A_FOLDER(a_content_without_sound_has_no_tables_of_it),
		IN_A_FOLDER(refuses_what_is_not_complete),
		IN_A_FOLDER(names_what_does_not_belong_together),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
