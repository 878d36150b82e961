/* /api/session: who is signed in, signing in, signing out. */
#include "curator/server/sign_in_routes.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <sodium.h>
#include <string.h>

#include "base/log.h"

enum { SIGN_IN_BODY_BYTES_MAX = 4096 };

static void set_cookie(struct api_response *response, const struct sign_in_place *place,
		       const char *key, bool is_secure)
{
	api_add_header(response, "set-cookie:", "%s=%s; Path=/; HttpOnly; SameSite=Strict%s%s",
		       place->cookie, key, is_secure ? "; Secure" : "", *key ? "" : "; Max-Age=0");
}

static void send_visitor(struct api_response *response, const struct sign_in_place *place,
			 const struct caller *caller, const char *token)
{
	cJSON *json = cJSON_CreateObject();

	cJSON_AddStringToObject(json, "name", caller->name);
	cJSON_AddStringToObject(json, "role", role_name(caller->role));
	cJSON_AddStringToObject(json, "token", token);
	cJSON_AddStringToObject(json, "temple", place->temple);
	cJSON_AddBoolToObject(json, "sign_on", place->is_sign_on);
	api_send_json(response, json);
}

/* A page that comes from the museum's sign-on has no session yet. */
static void get_session(void *user, const struct api_request *request,
			struct api_response *response)
{
	const struct sign_in_place *place = user;
	struct gate_visitor visitor = { .caller = request->caller };
	char key[SIGN_IN_SECRET_BYTES];

	memcpy(visitor.token, request->token, sizeof(visitor.token));
	if (place->is_sign_on && request->caller.role > ROLE_NONE && !*request->token) {
		if (gate_admit(place->gate, request->caller.name, key, &visitor) < 0) {
			api_fail(response, 401, "sign in first");
			return;
		}
		log_info("curator", "%s has signed on", visitor.caller.name);
		set_cookie(response, place, key, request->is_secure);
		sodium_memzero(key, sizeof(key));
	}
	send_visitor(response, place, &visitor.caller, visitor.token);
}

static const char *text_of(const cJSON *json, const char *key)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, key);

	return cJSON_IsString(item) ? item->valuestring : "";
}

/* The same sentence whether there is such an account or not. */
static void refuse(struct api_response *response, const char *address, int rc, int64_t wait_ms)
{
	const long long wait_s = (wait_ms + 999) / 1000;

	if (rc == -EAGAIN) {
		api_fail(response, 429, "too many wrong attempts: try again in %lld second%s",
			 wait_s, wait_s == 1 ? "" : "s");
		api_add_header(response, "retry-after:", "%lld", wait_s);
		return;
	}
	log_warn("curator", "refused to sign in from %s", *address ? address : "this machine");
	api_fail(response, 401, "name or password is wrong");
}

static void post_session(void *user, const struct api_request *request,
			 struct api_response *response)
{
	const struct sign_in_place *place = user;
	struct gate_visitor visitor;
	char key[SIGN_IN_SECRET_BYTES];
	int64_t wait_ms;
	cJSON *json;
	int rc;

	if (place->is_sign_on) {
		api_fail(response, 403, "the museum's own sign-on signs in here");
		return;
	}
	if (strncmp(request->content_type, "application/json", 16) != 0) {
		api_fail(response, 415, "the body must be application/json");
		return;
	}
	if (api_read_json(request, response, &json) < 0)
		return;
	rc = gate_sign_in(place->gate, text_of(json, "name"), text_of(json, "password"),
			  request->address, key, &visitor, &wait_ms);
	cJSON_Delete(json);
	if (rc < 0) {
		refuse(response, request->address, rc, wait_ms);
		return;
	}
	if (*request->cookie)
		gate_sign_out(place->gate, request->cookie); /* whoever it was */
	log_info("curator", "%s has signed in", visitor.caller.name);
	set_cookie(response, place, key, request->is_secure);
	send_visitor(response, place, &visitor.caller, visitor.token);
	sodium_memzero(key, sizeof(key));
}

static void delete_session(void *user, const struct api_request *request,
			   struct api_response *response)
{
	const struct sign_in_place *place = user;
	const struct caller nobody = { 0 };

	gate_sign_out(place->gate, request->cookie);
	log_info("curator", "%s has signed out", request->caller.name);
	set_cookie(response, place, "", request->is_secure);
	send_visitor(response, place, &nobody, "");
	place->wake(place->user);
}

struct api_routes sign_in_routes(struct sign_in_place *place)
{
	static const struct api_route routes[] = {
		{ API_GET, "/api/session", ROLE_NONE, 0, false, get_session },
		{ API_POST, "/api/session", ROLE_NONE, SIGN_IN_BODY_BYTES_MAX, true, post_session },
		{ API_DELETE, "/api/session", ROLE_READER, 0, false, delete_session },
	};

	return (struct api_routes){ routes, ARRAY_COUNT(routes), place };
}
