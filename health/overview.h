/* The page for people, as HTML. Pure but for the local time zone. */
#ifndef GOPURA_HEALTH_OVERVIEW_H
#define GOPURA_HEALTH_OVERVIEW_H

#include "health/verdict.h"

/* Appends the page to out. */
void overview_write(struct buffer *out, const struct snapshot *snapshot,
		    const struct verdict *verdict);

#endif
