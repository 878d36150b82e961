/* Whether a request may do what it asks for: by its host and origin, its cookie or the museum's own
 * sign-on, the route's role and the page's token. */
#ifndef GOPURA_CURATOR_SERVER_ACCESS_H
#define GOPURA_CURATOR_SERVER_ACCESS_H

#include "curator/accounts/gate.h"
#include "curator/api/route.h"
#include "curator/server/request_head.h"

/* Borrowed. */
struct access {
	struct gate *gate;
	const struct origin_names *names;
	struct request_head_options head;
};

/* Sets caller and token of a request. Returns 0, or -EACCES or -EAGAIN with an answer. A request
 * without a session passes; its role is ROLE_NONE. */
must_check int access_identify(const struct access *access, const struct request_head *head,
			       struct api_request *request, struct api_response *response);
/* Judges a request whose caller is known. Returns 0, or -EACCES with an answer. */
must_check int access_judge(enum role least, const struct request_head *head,
			    const struct api_request *request, struct api_response *response);

#endif
