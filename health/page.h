/* The pages of gopura-health: one for people, the metrics for Prometheus, and a few words for
 * scripts. Pure. */
#ifndef GOPURA_HEALTH_PAGE_H
#define GOPURA_HEALTH_PAGE_H

#include "health/verdict.h"

enum { PAGE_BYTES_MAX = 124 * 1024 };

enum page {
	PAGE_NONE,     /* any other path */
	PAGE_OVERVIEW, /* / */
	PAGE_METRICS,  /* /metrics */
	PAGE_HEALTH,   /* /health */
	PAGE_VISITS,   /* /visits.csv: a file that the kiosk writes (storage/usage.h) */
};

/* Returns the page of a path without its query. */
enum page page_of_path(const char *path);
/* Writes a page into out, whose ceiling is at least PAGE_BYTES_MAX; a failure is kept there. *type
 * becomes its content type, static. Returns the HTTP status. Only for PAGE_OVERVIEW, PAGE_METRICS
 * and PAGE_HEALTH. */
int page_write(struct buffer *out, const char **type, enum page page,
	       const struct snapshot *snapshot, const struct verdict *verdict);

#endif
