/* JSON and the lines of its objects. */
#include "base/json_text.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/compiler.h"
#include "tests/check.h"

static struct diagnostics diagnostics;

static int parse(struct json_text *out, const char *text)
{
	struct buffer buffer;
	int rc;

	diagnostics = (struct diagnostics){ 0 };
	buffer_init(&buffer, 1 << 20);
	buffer_put(&buffer, text, strlen(text));
	rc = json_text_parse(out, &buffer, "parts.json", &diagnostics);
	buffer_finish(&buffer);
	return rc;
}

/* Checks that every object has, as its member "n", the number of its line. Returns how many were
 * checked. */
static int check_lines(const struct json_text *json, const cJSON *value)
{
	const cJSON *child;
	int count = 0;

	if (cJSON_IsObject(value)) {
		const cJSON *expected = cJSON_GetObjectItemCaseSensitive(value, "n");

		CHECK(expected && json_text_line(json, value) == (unsigned)expected->valueint);
		count++;
	}
	cJSON_ArrayForEach(child, value)
	{
		count += check_lines(json, child);
	}
	return count;
}

static void finds_the_lines_of_all_objects(void **state)
{
	static const struct {
		const char *text;
		int count;
	} cases[] = {
		{ "{\"n\": 1}", 1 },
		{ "\n\n[7, {\"n\": 3}, {\"n\": 3},\n{\"n\": 4}]", 3 },
		{ "{\"n\": 1, \"a\": [1, \"{\", {\"n\": 1}\n,[[{\n\"n\": 2}]], {\"n\"\n:\n3}],\n"
		  "\"b\"\n: {\"n\": 7}}",
		  5 },
		/* what is in strings does not count as JSON, but their lines count */
		{ "[\"{\\\"\", \"\\\\\", \"]\n\n\", {\"n\": 3}]", 1 },
		{ "{\"{\\\"\": \"\xe1\x9e\x80\", \"n\": 1,\n\"\\u00e9\": {\"n\": 2}}", 2 },
		{ "\xef\xbb\xbf\n{\"n\": 2, \"a\": null, \"b\": true, \"c\": -1.5e3}", 1 },
		{ "{\r\n\"n\": 1, \"a\":\r\n{\"n\": 3}, \"a\": {\"n\": 3}}", 3 },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct json_text json;

		if (parse(&json, cases[i].text) != 0)
			fail_msg("case %zu was refused: %s", i, diagnostics.first.text);
		if (check_lines(&json, json.root) != cases[i].count)
			fail_msg("case %zu has other objects", i);
		CHECK(json_text_line(&json, NULL) == 0);
		json_text_finish(&json);
	}
}

static void knows_no_lines_where_the_parsers_differ(void **state)
{
	struct json_text json;

	(void)state;
	CHECK(parse(&json, "[\f{\"a\": 1}]") == 0);
	CHECK(json_text_line(&json, json.root->child) == 0);
	json_text_finish(&json);
}

static void names_the_line_of_what_it_refuses(void **state)
{
	static const struct {
		const char *text, *words;
		unsigned line;
	} cases[] = {
		{ "", "is empty", 1 },
		{ "[1,\n2,\n3", "not valid JSON", 3 },
		{ "{\"a\": 1}\n{}", "not valid JSON", 2 },
		{ "{\"a\": 1\n\n\"b\": 2}", "not valid JSON", 3 },
		{ "[\"\n\n\\x\"]", "not valid JSON", 3 },
		{ "[\n\"caf\xe9\"]", "not UTF-8", 2 },
		{ "[\n\n\"\xed\xa0\x80\"]", "not UTF-8", 3 },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct json_text json;

		CHECK(parse(&json, cases[i].text) == -EBADMSG);
		if (diagnostics.first.line != cases[i].line ||
		    !strstr(diagnostics.first.text, cases[i].words))
			fail_msg("case %zu: %s", i, diagnostics.first.text);
		CHECK(!json.root);
		json_text_finish(&json);
	}
}

static void refuses_what_has_no_room_for_its_end(void **state)
{
	struct json_text json;
	struct buffer buffer;

	(void)state;
	buffer_init(&buffer, 2);
	buffer_put(&buffer, "[]", 2);
	CHECK(json_text_parse(&json, &buffer, "parts.json", NULL) == -EFBIG);
	json_text_finish(&json);
	buffer_finish(&buffer);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(finds_the_lines_of_all_objects),
		cmocka_unit_test(knows_no_lines_where_the_parsers_differ),
		cmocka_unit_test(names_the_line_of_what_it_refuses),
		cmocka_unit_test(refuses_what_has_no_room_for_its_end),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
