#include "curator/pages/part_change.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <string.h>

#include "tests/check.h"

static int change(cJSON *part, const char *field, const char *language, const char *from,
		  const char *to)
{
	const struct part_change wanted = { field, language, from, to };
	struct diagnostics diagnostics = { 0 };
	struct buffer theirs;
	int rc;

	buffer_init(&theirs, 1000);
	rc = part_change_make(part, &wanted, &theirs, &diagnostics);
	buffer_finish(&theirs);
	return rc;
}

static bool is(cJSON *part, const char *json)
{
	cJSON *expected = cJSON_Parse(json);
	const bool equal = cJSON_Compare(part, expected, true);

	cJSON_Delete(expected);
	return equal;
}

static void texts_are_set_and_removed_with_what_held_them(void **state)
{
	cJSON *part = cJSON_Parse("{\"id\": \"a\", \"x\": [1]}");

	(void)state;
	CHECK(change(part, "title", "en", "", "Gate") == 0);
	CHECK(change(part, "creator", "", "", "Ana\nBen") == 0);
	CHECK(change(part, "rights", "fr", "", "Libre") == 0);
	CHECK(change(part, "thumbnail", "", "", "pictures/a.jpg") == 0);
	CHECK(is(part, "{\"id\": \"a\", \"x\": [1], \"title\": {\"en\": \"Gate\"}, \"credits\": "
		       "{\"creator\": [\"Ana\", \"Ben\"], \"rights\": {\"fr\": \"Libre\"}}, "
		       "\"thumbnail\": \"pictures/a.jpg\"}"));
	CHECK(change(part, "title", "en", "Gate", "") == 0);
	CHECK(change(part, "creator", "", "Ana\nBen", "") == 0);
	CHECK(change(part, "rights", "fr", "Libre", "") == 0);
	CHECK(change(part, "thumbnail", "", "pictures/a.jpg", "") == 0);
	CHECK(is(part, "{\"id\": \"a\", \"x\": [1]}"));
	cJSON_Delete(part);
}

/* A list would be no caption to the kiosk. One that was saved as a list is a text again. */
static void a_caption_of_two_lines_is_one_text(void **state)
{
	cJSON *part = cJSON_Parse("{\"caption\": {\"fr\": [\"Une\", \"deux\"]}}");

	(void)state;
	CHECK(change(part, "caption", "en", "", "One\ntwo") == 0);
	CHECK(change(part, "caption", "fr", "Une\ndeux", "Une\ntrois") == 0);
	CHECK(change(part, "rights", "en", "", "A\nB") == 0);
	CHECK(is(part, "{\"caption\": {\"en\": \"One\\ntwo\", \"fr\": \"Une\\ntrois\"}, "
		       "\"credits\": {\"rights\": {\"en\": \"A\\nB\"}}}"));
	CHECK(change(part, "caption", "en", "One\ntwo", "") == 0);
	cJSON_Delete(part);
}

static void a_text_that_somebody_else_changed_is_not_overwritten(void **state)
{
	cJSON *part = cJSON_Parse("{\"title\": {\"en\": \"Theirs\"}}");

	(void)state;
	CHECK(change(part, "title", "en", "Old", "Mine") == -ESTALE);
	CHECK(change(part, "title", "en", "Old", "Theirs") == 0); /* they agree */
	CHECK(is(part, "{\"title\": {\"en\": \"Theirs\"}}"));
	CHECK(change(part, "title", "en", "Theirs", "Ours") == 0);
	cJSON_Delete(part);
}

static void only_texts_of_a_part_can_be_changed(void **state)
{
	cJSON *part = cJSON_Parse("{\"credits\": {\"source\": {\"en\": \"A\"}, \"date\": \"1\"}}");

	(void)state;
	CHECK(change(part, "id", "", "", "x") == -EINVAL);
	CHECK(change(part, "region", "", "", "x") == -EINVAL);
	CHECK(change(part, "title", "", "", "x") == -EINVAL);
	CHECK(change(part, "thumbnail", "en", "", "x") == -EINVAL);
	/* One text for all languages would drop those of each, and the other way round. */
	CHECK(change(part, "source", "", "", "x") == -EINVAL);
	CHECK(change(part, "date", "en", "", "x") == -EINVAL);
	cJSON_Delete(part);
}

static void parts_are_moved_and_removed(void **state)
{
	struct parts_file parts = { .root = cJSON_Parse("{\"parts\": [{\"id\": \"a\"}, {\"id\": "
							"\"b\"}, {\"id\": \"c\"}]}") };

	(void)state;
	CHECK(part_change_place(&parts, "c", "a") == 0);
	CHECK(is(parts.root, "{\"parts\": [{\"id\":\"c\"}, {\"id\":\"a\"}, {\"id\":\"b\"}]}"));
	CHECK(part_change_place(&parts, "c", "b") == 0);
	CHECK(is(parts.root, "{\"parts\": [{\"id\":\"a\"}, {\"id\":\"c\"}, {\"id\":\"b\"}]}"));
	CHECK(part_change_place(&parts, "a", "") == 0);
	CHECK(is(parts.root, "{\"parts\": [{\"id\":\"c\"}, {\"id\":\"b\"}, {\"id\":\"a\"}]}"));
	CHECK(part_change_place(&parts, "a", "x") == -ENOENT);
	CHECK(part_change_place(&parts, "x", "a") == -ENOENT);
	CHECK(part_change_remove(&parts, "b") == 0 && part_change_remove(&parts, "b") == -ENOENT);
	CHECK(is(parts.root, "{\"parts\": [{\"id\":\"c\"}, {\"id\":\"a\"}]}"));
	parts_file_finish(&parts);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(texts_are_set_and_removed_with_what_held_them),
		cmocka_unit_test(a_caption_of_two_lines_is_one_text),
		cmocka_unit_test(a_text_that_somebody_else_changed_is_not_overwritten),
		cmocka_unit_test(only_texts_of_a_part_can_be_changed),
		cmocka_unit_test(parts_are_moved_and_removed),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
