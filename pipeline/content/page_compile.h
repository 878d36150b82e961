/* Makes an article of a page's HTML. libxml2 parses the HTML and tolerates errors. Elements that an
 * article has nothing for contribute their text; scripts and styles contribute nothing. Only links
 * to parts, their pages and tours ("part:ID", "page:ID", "tour:ID") are kept. */
#ifndef GOPURA_PIPELINE_CONTENT_PAGE_COMPILE_H
#define GOPURA_PIPELINE_CONTENT_PAGE_COMPILE_H

#include "base/bytes.h"

/* Appends the encoded article to *out. -EBADMSG: not UTF-8, or neither text nor picture in it.
 * -EFBIG: html is larger than HTML_BYTES_MAX, or gives more than an article may have. -ENOMEM. */
must_check int page_compile(struct buffer *out, struct bytes html);
/* The same of several texts, one below the other with a rule between them. */
must_check int page_compile_all(struct buffer *out, const struct bytes *texts, uint32_t count);

#endif
