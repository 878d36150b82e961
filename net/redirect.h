/* Decides which redirections of the museum server are followed. Pure functions.
 *
 * - The same host and port are allowed. A server used over http may also redirect to its https on
 * port 443.
 * - A listed host is allowed: "name" only on the default port of the scheme, "name:port" only on
 * that port.
 * - https is always allowed; http only if the server itself is used over http, and never after
 * https.
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
