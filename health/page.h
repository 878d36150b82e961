/* What gopura-health answers: a page for people, Prometheus's text, a word for load balancers and
 * scripts. Whole HTTP answers, heads and all. Pure. */
#ifndef GOPURA_HEALTH_PAGE_H
#define GOPURA_HEALTH_PAGE_H

#include "health/request.h"
#include "health/verdict.h"

enum { PAGE_BYTES_MOST = 128 * 1024 };

/* out is written from its beginning; its ceiling is PAGE_BYTES_MOST at least. */
void page_answer(struct buffer *out, const struct request *request, const struct snapshot *snapshot,
		 const struct verdict *verdict);
/* To what is none of ours: status as by request_parse. */
void page_refuse(struct buffer *out, int status);

#endif
