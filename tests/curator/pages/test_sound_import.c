/* What is stored of recordings, from the demo's own. */
#include "curator/pages/sound_import.h"

#include <errno.h>
#include <string.h>

#include "pipeline/content/spoken_sound.h"
#include "storage/info_spoken.h"
#include "tests/check.h"

static const char demo[] = "demo/content/pages/central-tower.en.opus";

static void read_demo(struct buffer *out)
{
	buffer_init(out, 16 << 20);
	CHECK(buffer_read_file(out, demo) == 0);
}

static void copy(struct buffer *out, const struct buffer *file)
{
	buffer_init(out, 16 << 20);
	CHECK(sound_import_copy(out, buffer_bytes(file)) == 0);
}

static bool has(const struct buffer *file, const char *text)
{
	return memmem(file->data, file->size, text, strlen(text)) != NULL;
}

static uint32_t duration_of(const struct buffer *file)
{
	uint32_t ms;

	CHECK(spoken_sound_measure(buffer_bytes(file), false, &ms) == 0);
	return ms;
}

static void leaves_out_all_but_the_sound(void **state)
{
	static const char stray[] = "who found it may have it";
	struct buffer file, with_stray, out, again;

	(void)state;
	read_demo(&file);
	CHECK(has(&file, "ENCODER="));
	copy(&out, &file);
	CHECK(!has(&out, "ENCODER=") && !has(&out, "libopus"));
	CHECK(duration_of(&out) == duration_of(&file));
	/* all but the headers is as it was */
	CHECK(memcmp(out.data + out.size - 5000, file.data + file.size - 5000, 5000) == 0);
	copy(&again, &out);
	CHECK(again.size == out.size && memcmp(again.data, out.data, out.size) == 0);
	buffer_finish(&again);
	/* between the first page, of 47 bytes, and the next */
	buffer_init(&with_stray, 16 << 20);
	buffer_put(&with_stray, file.data, 47);
	buffer_put(&with_stray, stray, sizeof(stray));
	buffer_put(&with_stray, file.data + 47, file.size - 47);
	copy(&again, &with_stray);
	CHECK(again.size == out.size && memcmp(again.data, out.data, out.size) == 0);
	buffer_finish(&again);
	buffer_finish(&with_stray);
	buffer_finish(&out);
	buffer_finish(&file);
}

static void copies_each_of_a_chain(void **state)
{
	struct buffer file, chain, one, out;

	(void)state;
	read_demo(&file);
	buffer_init(&chain, 16 << 20);
	buffer_put(&chain, file.data, file.size);
	buffer_put(&chain, file.data, file.size);
	copy(&one, &file);
	copy(&out, &chain);
	CHECK(out.size == 2 * one.size && memcmp(out.data, one.data, one.size) == 0 &&
	      memcmp(out.data + one.size, one.data, one.size) == 0);
	buffer_finish(&out);
	buffer_finish(&one);
	buffer_finish(&chain);
	buffer_finish(&file);
}

static void does_so_in_a_sandbox(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct buffer file, here, out;

	(void)state;
	read_demo(&file);
	copy(&here, &file);
	buffer_init(&out, INFO_SPOKEN_BYTES_MAX);
	CHECK(sound_import(&out, buffer_bytes(&file), &diagnostics) == 0);
	CHECK(out.size == here.size && memcmp(out.data, here.data, out.size) == 0);
	buffer_finish(&out);
	buffer_finish(&here);
	buffer_finish(&file);
	diagnostics_finish(&diagnostics);
}

static void refuses_what_is_none(void **state)
{
	struct buffer file, out;

	(void)state;
	read_demo(&file);
	buffer_init(&out, 16 << 20);
	/* without a whole second header, or at all; what is cut off later is found by decoding */
	for (size_t size = 0; size < 200; size++) {
		buffer_clear(&out);
		const int rc = sound_import_copy(&out, (struct bytes){ file.data, size });

		CHECK(rc == 0 || rc == -EBADMSG);
		CHECK(size > 100 || rc == -EBADMSG);
	}
	buffer_clear(&out);
	file.data[47 + 30] ^= 1; /* the checksum of the second page is wrong, so it is left out */
	CHECK(sound_import_copy(&out, buffer_bytes(&file)) == -EBADMSG);
	buffer_finish(&out);
	buffer_finish(&file);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(leaves_out_all_but_the_sound),
		cmocka_unit_test(copies_each_of_a_chain),
		cmocka_unit_test(does_so_in_a_sandbox),
		cmocka_unit_test(refuses_what_is_none),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
