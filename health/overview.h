/* The page for people, as HTML. Pure. */
#ifndef GOPURA_HEALTH_OVERVIEW_H
#define GOPURA_HEALTH_OVERVIEW_H

#include "health/verdict.h"

/* Appends. */
void overview_write(struct buffer *out, const struct snapshot *snapshot,
		    const struct verdict *verdict);

#endif
