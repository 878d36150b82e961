/* Makes a plain article of a page's HTML: for releases from before pages were articles, which a
 * terminal goes on showing until the museum publishes another. It needs no HTML parser: the page
 * was checked when it was published, and what is lost (docs/article.md) is back with the next
 * release. */
#ifndef GOPURA_STORAGE_PLAIN_PAGE_H
#define GOPURA_STORAGE_PLAIN_PAGE_H

#include "base/bytes.h"

/* Appends the encoded article to *out. -EBADMSG: not UTF-8, too large, or neither text nor picture
 * in it. -ENOMEM. */
must_check int plain_page(struct buffer *out, struct bytes html);

#endif
