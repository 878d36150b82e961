#include "pipeline/release/inspect.h"

#include <errno.h>

#include "pipeline/release/inspect_release.h"
#include "tests/pipeline/release/tiny_release.h"

static struct tiny tiny;
static struct release_reader *reader;
static char *text;
static size_t text_size;
static FILE *to;

static int set_up(void **state)
{
	struct release_reader_options options = { .place = tiny.release };

	(void)state;
	tiny_make(&tiny);
	options.place = tiny.release;
	tiny_publish(&tiny, "the first");
	to = open_memstream(&text, &text_size);
	return to && release_reader_create(&reader, &options) == 0 ? 0 : -1;
}

static int tear_down(void **state)
{
	(void)state;
	release_reader_destroy(reader);
	fclose(to);
	free(text);
	tiny_remove(&tiny);
	return 0;
}

static bool says(const char *words)
{
	fflush(to);
	return strstr(text, words) != NULL;
}

static void a_release_is_shown_from_the_top(void **state)
{
	(void)state;
	CHECK(inspect_release(to, reader, NULL) == 0);
	CHECK(says("\"the first\""));
	CHECK(says("signed by"));
	CHECK(says("4 published of 40, 10.00 %"));
	CHECK(says("5 x 1 x 1 points"));
	CHECK(says("hierarchy page") && says("information page"));
}

/* The hash that stands before `words` on the last line that has them. */
static struct hash hash_before(const char *words)
{
	struct hash hash;
	char hex[HASH_HEX_BYTES] = "", *at = NULL;

	fflush(to);
	for (char *next = text; (next = strstr(next, words)); next++)
		at = next;
	CHECK(at != NULL);
	while (at > text && at[-1] != '\n')
		at--;
	CHECK(sscanf(at, "  child %*u %32s", hex) == 1);
	CHECK(hash_from_hex(&hash, hex) == 0);
	return hash;
}

static void an_object_is_found_by_its_name(void **state)
{
	struct hash hash;

	(void)state;
	CHECK(inspect_release(to, reader, NULL) == 0);
	hash = hash_before("bytes  page"); /* the last page that is a child */
	CHECK(inspect_object(to, reader, NULL, hash) == 0);
	CHECK(says("in packs/"));
	CHECK(inspect_object(to, reader, NULL, (struct hash){ { 1, 2 } }) == -ENOENT);
	CHECK(says("has no object of that name"));
}

static void what_is_damaged_or_foreign_is_said_to_be(void **state)
{
	(void)state;
	CHECK(inspect_bytes(to, (struct bytes){ (const uint8_t *)"GPag1", 5 }) == -EBADMSG);
	CHECK(says("damaged"));
	CHECK(inspect_bytes(to, (struct bytes){ (const uint8_t *)"hello", 5 }) == -EBADMSG);
	CHECK(says("of an unknown format"));
	CHECK(inspect_bytes(to, (struct bytes){ NULL, 0 }) == -EBADMSG);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_release_is_shown_from_the_top, set_up, tear_down),
		cmocka_unit_test_setup_teardown(an_object_is_found_by_its_name, set_up, tear_down),
		cmocka_unit_test_setup_teardown(what_is_damaged_or_foreign_is_said_to_be, set_up,
						tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
