/* Which redirections of the museum server are followed. Pure.
 *
 *   the same host and port         where it is asked by http also its https, on port 443
 *   a host that was named          by name alone: on the scheme's own port; name:port: there
 *   https                          always; http only where the server itself is asked by http, and
 *                                  never after https
 *
 * Whoever can answer for the server once (a captive portal, a server that was broken into) could
 * else have the terminal ask anything of any machine of the museum's network. */
#ifndef GOPURA_NET_REDIRECT_H
#define GOPURA_NET_REDIRECT_H

#include "base/bytes.h"

enum { REDIRECT_HOSTS_MAX = 4, REDIRECT_HOSTS_BYTES = 512, REDIRECTS_MAX = 4 };

/* "cdn.example, cdn2.example:8443": names or IPv4 addresses, REDIRECT_HOSTS_MAX at most. NULL and
 * "" are fine. */
must_check bool redirect_hosts_valid(const char *hosts);

/* From an answer of `from` to `to`, both whole urls; `server` is the release's. hosts are valid. */
must_check bool redirect_allowed(const char *server, const char *from, const char *to,
				 const char *hosts);

#endif
