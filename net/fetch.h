/* The fetcher as a whole: one loop over the kiosk's socket and the server's answers. docs/fetch.md
 * tells how it works. */
#ifndef GOPURA_NET_FETCH_H
#define GOPURA_NET_FETCH_H

#include <stdint.h>

#include "base/compiler.h"

struct fetch_options {
	const char *release_url; /* https://..., http://..., a folder */
	const char *stick_path;  /* a folder where a release may come to lie; NULL: none */
	const char *cache_path;
	uint64_t cache_budget_bytes;
	const char *ca_file; /* NULL: the system's */
	const char
		*redirect_hosts;  /* that the server may redirect to (net/redirect.h); NULL: none */
	const char *socket_path;  /* to listen on; NULL: fd */
	const char *metrics_path; /* to offer figures on (docs/health.md); NULL: none */
	int fd;                   /* connected already; the fetcher ends with it */
	uint32_t poll_s;
	uint64_t rate_limit; /* bytes a second of a release that is not shown yet; 0: none */
	uint32_t stall_s;    /* 0: the default */
};

/* Until SIGTERM or SIGINT, or until the kiosk closes fd: 0. Negative errno when it cannot begin. */
must_check int fetch_run(const struct fetch_options *options);

#endif
