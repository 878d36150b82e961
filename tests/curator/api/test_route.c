#include "curator/api/route.h"

#include <stdio.h>
#include <string.h>

#include "tests/check.h"

static void handle(void *user, const struct api_request *request, struct api_response *response)
{
	(void)user;
	(void)request;
	(void)response;
}

static bool fits(const char *pattern, const char *path, struct api_request *request)
{
	snprintf(request->path, sizeof(request->path), "%s", path);
	return route_fits(pattern, request);
}

static void a_pattern_takes_its_parameters_from_the_path(void **state)
{
	struct api_request request = { 0 };

	(void)state;
	CHECK(fits("/api/pages/{id}.{language}", "/api/pages/east-gate.pt_BR", &request));
	CHECK(request.parameter_count == 2);
	CHECK(strcmp(api_parameter(&request, "id"), "east-gate") == 0);
	CHECK(strcmp(api_parameter(&request, "language"), "pt_BR") == 0);
	CHECK(fits("/api/parts", "/api/parts", &request) && request.parameter_count == 0);
}

static void no_parameter_leads_out_of_its_folder(void **state)
{
	static const char *const paths[] = {
		"/api/pages/../x.en",     "/api/pages/a/b.en", "/api/pages/.en",
		"/api/pages/a.",          "/api/pages/a b.en", "/api/pages/a.en/",
		"/api/pages/a.en.bak",    "/api/pages/a",      "/api/pages/a%2f.en",
		"/api/pages/\xc3\xa9.en", "/api/pages/",       "",
		"/api/pagesa.en",
	};
	struct api_request request = { 0 };

	(void)state;
	for (unsigned n = 0; n < ARRAY_COUNT(paths); n++)
		CHECK(!fits("/api/pages/{id}.{language}", paths[n], &request));
}

static void a_parameter_has_at_most_64_characters(void **state)
{
	struct api_request request = { 0 };
	char path[API_PATH_BYTES];

	(void)state;
	snprintf(path, sizeof(path), "/a/%064d", 0);
	CHECK(fits("/a/{id}", path, &request));
	snprintf(path, sizeof(path), "/a/%065d", 0);
	CHECK(!fits("/a/{id}", path, &request));
}

static const struct api_route routes[] = {
	{ API_GET, "/api/parts", ROLE_READER, 0, false, handle },
	{ API_PUT, "/api/parts/{id}", ROLE_EDITOR, API_JSON_BYTES_MAX, true, handle },
	{ API_GET, "/api/parts/{id}", ROLE_READER, 0, true, handle },
};

static void finds_the_route_of_a_method_and_its_user(void **state)
{
	int users[2];
	const struct api_routes tables[] = { { routes, 1, &users[0] },
					     { routes + 1, 2, &users[1] } };
	struct api_request request = { .method = API_GET, .path = "/api/parts/gate" };
	unsigned allowed;
	void *user = NULL;

	(void)state;
	CHECK(route_find(tables, 2, &request, &user, &allowed) == &routes[2]);
	CHECK(user == &users[1]);
	request.method = API_DELETE;
	CHECK(!route_find(tables, 2, &request, &user, &allowed));
	CHECK(allowed == (1u << API_PUT | 1u << API_GET));
	snprintf(request.path, sizeof(request.path), "/api/part");
	CHECK(!route_find(tables, 2, &request, &user, &allowed) && allowed == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_pattern_takes_its_parameters_from_the_path),
		cmocka_unit_test(no_parameter_leads_out_of_its_folder),
		cmocka_unit_test(a_parameter_has_at_most_64_characters),
		cmocka_unit_test(finds_the_route_of_a_method_and_its_user),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
