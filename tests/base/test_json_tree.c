/* What is taken for JSON, and who owns an item that goes nowhere. Lack of memory:
 * tests/e2e/torture.sh.
 */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>
#include <cmocka.h>

#include "base/json_tree.h"
#include "tests/check.h"

static struct bytes text(const char *text)
{
	return (struct bytes){ (const uint8_t *)text, strlen(text) };
}

static void takes_one_object_and_nothing_else(void **state)
{
	static const struct {
		const char *text;
		int rc, rc_of_object;
	} cases[] = {
		{ "{}", 0, 0 },
		{ " {\"a\": [1]} \r\n\t", 0, 0 },
		{ "", -EBADMSG, -EBADMSG },
		{ "{", -EBADMSG, -EBADMSG },
		{ "[1]", 0, -EBADMSG },
		{ "{} {}", 0, -EBADMSG },
		{ "7", 0, -EBADMSG },
		{ "{\"a\": 1,}", -EBADMSG, -EBADMSG },
	};
	cJSON *json;

	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		CHECK(json_parse(&json, text(cases[i].text)) == cases[i].rc);
		CHECK(!json == (cases[i].rc < 0));
		cJSON_Delete(json);
		CHECK(json_parse_object(&json, text(cases[i].text)) == cases[i].rc_of_object);
		CHECK(!json == (cases[i].rc_of_object < 0));
		cJSON_Delete(json);
	}
}

static void says_where_the_value_ends(void **state)
{
	const char *const both = "[1] [2]", *end;
	cJSON *json;

	(void)state;
	CHECK(json_parse_to(&json, text(both), &end) == 0 && end == both + 3);
	cJSON_Delete(json);
}

static void takes_what_cannot_be_added(void **state)
{
	cJSON *object = cJSON_CreateObject();
	char *line, *indented;

	(void)state;
	CHECK(json_add(object, "list", cJSON_CreateArray()));
	CHECK(json_append(cJSON_GetObjectItem(object, "list"), cJSON_CreateNumber(7)));
	CHECK(!json_add(NULL, "a", cJSON_CreateNumber(1)));
	CHECK(!json_append(NULL, cJSON_CreateNumber(1)));
	CHECK(!json_add(object, "a", NULL) && !json_append(object, NULL));
	line = json_line(object);
	indented = json_indented(object);
	CHECK(line && strcmp(line, "{\"list\":[7]}") == 0);
	CHECK(indented && strcmp(indented, "{\n\t\"list\":\t[7]\n}") == 0);
	free(line);
	free(indented);
	cJSON_Delete(object);
	CHECK(!json_line(NULL));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(takes_one_object_and_nothing_else),
		cmocka_unit_test(says_where_the_value_ends),
		cmocka_unit_test(takes_what_cannot_be_added),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
