/* Signing in and out over HTTP: docs/curator.md lists the addresses. */
#ifndef GOPURA_CURATOR_SERVER_SIGN_IN_ROUTES_H
#define GOPURA_CURATOR_SERVER_SIGN_IN_ROUTES_H

#include "curator/accounts/gate.h"
#include "curator/api/route.h"

/* Borrowed for the lifetime of the table. */
struct sign_in_place {
	struct gate *gate;
	const char *cookie; /* its name */
	const char *temple; /* its name, for the page */
	bool is_sign_on;    /* the museum's own, so there are no passwords */
	/* Called when somebody has signed out, so that open sockets are looked at. */
	void (*wake)(void *user);
	void *user;
};

struct api_routes sign_in_routes(struct sign_in_place *place);

#endif
