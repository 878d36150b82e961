/* Decides which redirections of the museum server are followed. Pure functions. Both the host and
 * the scheme must be acceptable.
 *
 * Host: the same host and port as the server (if the server is used over http, also its https on
 * port 443), or a listed host: "name" on the default port of the scheme, "name:port" on that port
 * only.
 *
 * Scheme: https, or http if the server itself is used over http and no https url came before.
 *
 * Without this check, whoever answers for the server once (a captive portal, a compromised server)
 * could make the terminal send requests to any machine of the museum's network. */
#ifndef GOPURA_NET_REDIRECT_H
#define GOPURA_NET_REDIRECT_H

#include "base/bytes.h"

enum { REDIRECT_HOSTS_MAX = 4, REDIRECT_HOSTS_BYTES = 512, REDIRECTS_MAX = 4 };

/* Checks a list such as "cdn.example, cdn2.example:8443": names or IPv4 addresses, at most
 * REDIRECT_HOSTS_MAX. NULL and "" are valid. */
must_check bool redirect_hosts_valid(const char *hosts);

/* Returns whether an answer of `from` may redirect to `to`; both are complete urls. `server` is the
 * url of the release. `hosts` must be valid (redirect_hosts_valid) or NULL. */
must_check bool redirect_allowed(const char *server, const char *from, const char *to,
				 const char *hosts);

#endif
