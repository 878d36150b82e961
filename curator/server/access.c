/* The questions to a request, in order. */
#include "curator/server/access.h"

#include <errno.h>
#include <string.h>

/* The museum's sign-on says who it is. A cookie of somebody else is of no use then; without one,
 * all that changes something is refused, until the page has got its token. */
static void believe_sign_on(const struct access *access, struct gate_visitor *visitor,
			    const char *name)
{
	if (strcmp(visitor->caller.name, name) == 0)
		return;
	*visitor = (struct gate_visitor){ 0 };
	memcpy(visitor->caller.name, name, strlen(name) + 1);
	visitor->caller.role = gate_role(access->gate, name);
}

int access_identify(const struct access *access, const struct request_head *head,
		    struct api_request *request, struct api_response *response)
{
	struct gate_visitor visitor;

	if (!origin_is_welcome(access->names, head->host, head->origin)) {
		api_fail(response, 403,
			 "this server has another name, or another site's page asks");
		return -EACCES;
	}
	if (gate_identify(access->gate, request->cookie, GATE_REQUEST, &visitor) < 0) {
		api_fail(response, 429, "too many requests: wait a second");
		api_add_header(response, "retry-after:", "1");
		return -EAGAIN;
	}
	if (access->head.sign_on[0])
		believe_sign_on(access, &visitor, request->sign_on);
	request->caller = visitor.caller;
	memcpy(request->token, visitor.token, sizeof(request->token));
	return 0;
}

int access_judge(enum role least, const struct request_head *head,
		 const struct api_request *request, struct api_response *response)
{
	if (least == ROLE_NONE)
		return 0;
	if (request->caller.role == ROLE_NONE)
		api_fail(response, 401, "sign in first");
	else if (request->caller.role < least)
		api_fail(response, 403, "%s is a %s, and this takes a%s %s", request->caller.name,
			 role_name(request->caller.role), least == ROLE_EDITOR ? "n" : "",
			 role_name(least));
	else if (request->method != API_GET && !sign_in_secret_is(request->token, head->token))
		api_fail(response, 403, "the page is older than the session: load it again");
	else
		return 0;
	return -EACCES;
}
