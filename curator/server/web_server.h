/* HTTP and WebSocket for curators' browsers, by libwebsockets: the page's files, the interface at
 * /api/ and a socket at /socket for each session. */
#ifndef GOPURA_CURATOR_SERVER_WEB_SERVER_H
#define GOPURA_CURATOR_SERVER_WEB_SERVER_H

#include "base/compiler.h"
#include "curator/accounts/gate.h"
#include "curator/session/site.h"

enum { WEB_SERVER_SESSIONS_MAX = 8 };

enum { WEB_SERVER_HOSTS_MAX = 4 };

/* All borrowed for the lifetime of the server. */
struct web_server_options {
	struct site *site;
	struct gate *gate;
	const char *listen;                      /* an address of this machine, or "unix:PATH" */
	int port;                                /* 0: a free one */
	const char *hosts[WEB_SERVER_HOSTS_MAX]; /* names under which a proxy serves it */
	unsigned host_count;
	const char *release; /* the release folder, to compare with; NULL: nothing is published */
	const char *sign_on; /* the header in which a proxy names who has signed on; NULL: none */
};

struct web_server;

/* *out is owned by the caller; NULL on failure. -EADDRINUSE: it cannot listen there. -EINVAL: a
 * host is no name. -ENOMEM. */
must_check int web_server_create(struct web_server **out, const struct web_server_options *options);
void web_server_destroy(struct web_server *server); /* ends all sessions; NULL is fine */

/* 0: it listens on a path. */
int web_server_port(const struct web_server *server);
/* Serves until web_server_stop. */
void web_server_run(struct web_server *server);
/* May be called by a signal handler. */
void web_server_stop(struct web_server *server);

#endif
