/* The pages of gopura-health: one for people, the metrics for Prometheus, and a few words for
 * scripts. Pure. */
#ifndef GOPURA_HEALTH_WEB_PAGE_H
#define GOPURA_HEALTH_WEB_PAGE_H

#include "health/verdict.h"

enum { WEB_PAGE_BYTES_MAX = 124 * 1024 };

enum web_page {
	WEB_PAGE_NONE,     /* any other path */
	WEB_PAGE_OVERVIEW, /* / */
	WEB_PAGE_METRICS,  /* /metrics */
	WEB_PAGE_HEALTH,   /* /health */
	WEB_PAGE_VISITS,   /* /visits.csv: a file that the kiosk writes (storage/usage.h) */
};

/* Returns the page of a path without its query. */
enum web_page web_page_of_path(const char *path);
/* Writes a page into out, whose ceiling is at least WEB_PAGE_BYTES_MAX; a failure is kept there.
 * *type becomes its content type, static. Returns the HTTP status. Only for WEB_PAGE_OVERVIEW,
 * WEB_PAGE_METRICS and WEB_PAGE_HEALTH. */
int web_page_write(struct buffer *out, const char **type, enum web_page page,
		   const struct snapshot *snapshot, const struct verdict *verdict);

#endif
