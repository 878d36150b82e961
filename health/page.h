/* The answers of gopura-health: a page for people, Prometheus's text, and one word for load
 * balancers and scripts. They are whole HTTP answers with their heads. Pure. */
#ifndef GOPURA_HEALTH_PAGE_H
#define GOPURA_HEALTH_PAGE_H

#include "health/request.h"
#include "health/verdict.h"

enum { PAGE_BYTES_MAX = 128 * 1024 };

/* Writes the answer to any request but REQUEST_VISITS into out, which is cleared first; its ceiling
 * is at least PAGE_BYTES_MAX. A failure is kept in out. */
void page_answer(struct buffer *out, const struct request *request, const struct snapshot *snapshot,
		 const struct verdict *verdict);
/* Appends the head of the answer to REQUEST_VISITS. The body is the file of counts of what visitors
 * look at (storage/usage.h), file_bytes long, which the server sends as it is. */
void page_visits_head(struct buffer *out, uint64_t file_bytes);
/* Writes the answer to a request that cannot be served into out, which is cleared first. status: as
 * from request_parse, or 503. */
void page_refuse(struct buffer *out, int status);

#endif
