/* What gopura-health answers: a page for people, Prometheus's text, a word for load balancers and
 * scripts. Whole HTTP answers, heads and all. Pure. */
#ifndef GOPURA_HEALTH_PAGE_H
#define GOPURA_HEALTH_PAGE_H

#include "health/request.h"
#include "health/verdict.h"

enum { PAGE_BYTES_MAX = 128 * 1024 };

/* To all requests but REQUEST_VISITS. out is written from its beginning; its ceiling is
 * PAGE_BYTES_MAX at least. */
void page_answer(struct buffer *out, const struct request *request, const struct snapshot *snapshot,
		 const struct verdict *verdict);
/* The head of the answer to REQUEST_VISITS: the counts of what visitors look at (storage/usage.h)
 * follow as they are, in a file of so many bytes. */
void page_visits_head(struct buffer *out, uint64_t file_bytes);
/* The answer to what cannot be served: status as by request_parse, or 503. */
void page_refuse(struct buffer *out, int status);

#endif
