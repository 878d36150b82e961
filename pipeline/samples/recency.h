/* Numbers in the order in which they were used last, for what is kept within a limit. */
#ifndef GOPURA_PIPELINE_SAMPLES_RECENCY_H
#define GOPURA_PIPELINE_SAMPLES_RECENCY_H

#include <stdint.h>

#include "base/compiler.h"

#define RECENCY_NONE UINT32_MAX

struct recency {
	struct recency_links *links; /* owned; of each number */
	uint32_t newest, oldest;     /* RECENCY_NONE: nothing is in the list */
};

/* For numbers below count; the list is empty. Returns -ENOMEM. */
must_check int recency_init(struct recency *recency, uint32_t count);
void recency_finish(struct recency *recency); /* a zeroed one is fine */
/* Puts a number, which is not in the list, in front. */
void recency_add(struct recency *recency, uint32_t number);
/* Takes a number, which is in the list, out of it. */
void recency_remove(struct recency *recency, uint32_t number);

#endif
