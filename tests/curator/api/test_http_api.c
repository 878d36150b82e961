#include "curator/api/http_api.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/check.h"

static struct api_response fresh(void)
{
	struct api_response response = { 0 };

	buffer_init(&response.body, API_RESPONSE_BYTES_MAX);
	return response;
}

static bool says(struct api_response *response, const char *text)
{
	buffer_put_u8(&response->body, 0);
	return strstr((const char *)response->body.data, text) != NULL;
}

static void a_tag_is_found_in_a_list(void **state)
{
	(void)state;
	CHECK(api_tag_matches("\"abc\"", "abc"));
	CHECK(api_tag_matches("\"x\", W/\"abc\"", "abc"));
	CHECK(api_tag_matches("*", "abc"));
	CHECK(!api_tag_matches("", "abc"));
	CHECK(!api_tag_matches("\"abcd\", \"ab\"", "abc"));
	CHECK(!api_tag_matches("abc", "abc"));
	CHECK(!api_tag_matches("\"abc", "abc"));
	CHECK(!api_tag_matches("\"a\" W/", "abc"));
}

static void an_answer_that_the_browser_has_is_not_sent(void **state)
{
	struct api_request request = { .if_none_match = "\"one\"" };
	struct api_response response = fresh();

	(void)state;
	CHECK(api_send_tag(&request, &response, "one"));
	CHECK(response.status == 304 && response.body.size == 0);
	CHECK(strcmp(response.headers[0].value, "\"one\"") == 0);
	response = fresh();
	CHECK(!api_send_tag(&request, &response, "two"));
	CHECK(response.status == 0 && response.header_count == 1);
}

static void a_query_gives_its_values_by_name(void **state)
{
	struct api_request request = { .query = "a=1\0ab=two words\0c\0d=", .query_bytes = 22 };

	(void)state;
	CHECK(strcmp(api_query(&request, "a"), "1") == 0);
	CHECK(strcmp(api_query(&request, "ab"), "two words") == 0);
	CHECK(strcmp(api_query(&request, "d"), "") == 0);
	CHECK(!api_query(&request, "c") && !api_query(&request, "b"));
}

static void a_body_must_be_an_object(void **state)
{
	static const char *const bad[] = { "", "[]", "1", "{", "nul", "\"\"" };
	struct api_request request = { 0 };
	struct api_response response;
	cJSON *json;

	(void)state;
	for (unsigned n = 0; n < ARRAY_COUNT(bad); n++) {
		response = fresh();
		buffer_init(&request.body, 64);
		buffer_put_text(&request.body, bad[n]);
		CHECK(api_read_json(&request, &response, &json) == -EINVAL && !json);
		CHECK(response.status == 400 && says(&response, "\"message\""));
		buffer_finish(&request.body);
		buffer_finish(&response.body);
	}
	response = fresh();
	buffer_init(&request.body, 64);
	buffer_put_text(&request.body, "{\"a\":[1]}");
	CHECK(api_read_json(&request, &response, &json) == 0 && json && response.status == 0);
	cJSON_Delete(json);
	buffer_finish(&request.body);
}

static void an_error_drops_what_was_answered_before(void **state)
{
	struct api_response response = fresh();

	(void)state;
	api_add_header(&response, "etag:", "\"x\"");
	api_send_bytes(&response, "image/png", (struct bytes){ (const uint8_t *)"abc", 3 });
	api_fail(&response, 409, "part \"%s\" is there", "gate");
	CHECK(response.status == 409 && response.header_count == 0);
	CHECK(strcmp(response.type, "application/json") == 0);
	CHECK(says(&response, "{\"message\":\"part \\\"gate\\\" is there\"}"));
	buffer_finish(&response.body);
}

static void an_errno_has_a_status_and_its_diagnostic(void **state)
{
	static const int cases[][2] = { { -ENOENT, 404 }, { -EINVAL, 422 }, { -ESTALE, 412 },
					{ -EEXIST, 409 }, { -ENOSPC, 507 }, { -EIO, 500 } };

	(void)state;
	for (unsigned n = 0; n < ARRAY_COUNT(cases); n++) {
		struct diagnostics diagnostics = { 0 };
		struct api_response response = fresh();

		diagnostics_add(&diagnostics, cases[n][0], "parts.json", 7, "is not right");
		api_fail_with(&response, cases[n][0], &diagnostics);
		CHECK(response.status == cases[n][1]);
		CHECK(says(&response, "parts.json:7: is not right"));
		buffer_finish(&response.body);
	}
}

static void no_value_of_a_header_begins_another_one(void **state)
{
	struct api_response response = fresh();
	char large[API_HEADER_BYTES + 1];

	(void)state;
	api_add_header(&response, "location:", "/a\r\nset-cookie: x=y");
	CHECK(response.status == 500 && response.header_count == 0);
	memset(large, 'a', sizeof(large) - 1);
	large[sizeof(large) - 1] = '\0';
	response.status = 0;
	api_add_header(&response, "location:", "%s", large);
	CHECK(response.status == 500 && response.header_count == 0);
	response.status = 0;
	for (unsigned n = 0; n < API_HEADERS_MAX; n++)
		api_add_header(&response, "x-n:", "%u", n);
	CHECK(response.status == 0 && response.header_count == API_HEADERS_MAX);
	api_add_header(&response, "x-n:", "more");
	CHECK(response.status == 500);
	buffer_finish(&response.body);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_tag_is_found_in_a_list),
		cmocka_unit_test(an_answer_that_the_browser_has_is_not_sent),
		cmocka_unit_test(a_query_gives_its_values_by_name),
		cmocka_unit_test(a_body_must_be_an_object),
		cmocka_unit_test(an_error_drops_what_was_answered_before),
		cmocka_unit_test(an_errno_has_a_status_and_its_diagnostic),
		cmocka_unit_test(no_value_of_a_header_begins_another_one),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
