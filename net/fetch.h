/* The fetcher process: one loop over the kiosk's socket and the server's answers. docs/fetch.md
 * describes how it works. */
#ifndef GOPURA_NET_FETCH_H
#define GOPURA_NET_FETCH_H

#include <stdint.h>

#include "base/compiler.h"

struct fetch_options {
	const char *release_url; /* https://..., http://..., or a folder */
	/* folder where a USB stick with a release may be mounted; NULL: none */
	const char *stick_path;
	const char *cache_path;
	/* at least 4 MiB */
	uint64_t cache_budget_bytes;
	const char *ca_file; /* NULL: the system's */
	/* Hosts that the server may redirect to (net/redirect.h); NULL: none. */
	const char *redirect_hosts;
	const char *socket_path;  /* path to listen on; NULL: fd is used */
	const char *metrics_path; /* socket path for metrics (docs/health.md); NULL: none */
	int fd; /* already connected, taken; the fetcher exits when it is closed */
	/* seconds between checks for a new release */
	uint32_t poll_s;
	uint64_t rate_limit; /* bytes per second for a release that is not shown yet; 0: no limit */
	uint32_t wait_ms;    /* what is asked for at once takes about so long; 0: half a second */
	uint32_t stall_s;    /* seconds without data before a request fails; 0: the default */
};

/* Runs until SIGTERM or SIGINT, or until the kiosk closes fd; then returns 0. Returns a negative
 * errno if it cannot start or if waiting for events fails. Options are borrowed. */
must_check int fetch_run(const struct fetch_options *options);

#endif
