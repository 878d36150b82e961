/* HTTP and WebSocket for curators' browsers, by libwebsockets: the page's files, the interface at
 * /api/ and a socket at /socket for each session. Listens on the loopback address only: there are
 * no accounts yet. */
#ifndef GOPURA_CURATOR_SERVER_WEB_SERVER_H
#define GOPURA_CURATOR_SERVER_WEB_SERVER_H

#include "base/compiler.h"
#include "curator/session/site.h"

enum { WEB_SERVER_SESSIONS_MAX = 8 };

struct web_server;

/* Listens on 127.0.0.1; port 0: a free one. site is borrowed for the lifetime of *out, which the
 * caller owns; NULL on failure. -EADDRINUSE: it cannot listen there. -ENOMEM. */
must_check int web_server_create(struct web_server **out, struct site *site, int port);
void web_server_destroy(struct web_server *server); /* ends all sessions; NULL is fine */

int web_server_port(const struct web_server *server);
/* Serves until web_server_stop. */
void web_server_run(struct web_server *server);
/* May be called by a signal handler. */
void web_server_stop(struct web_server *server);

#endif
