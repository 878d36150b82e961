/* Reduces a page before an HTML parser reads it. libxml2 compares every attribute of a tag with all
 * those before it: one megabyte of attributes took half a minute. The output has at most one
 * attribute per tag, whatever the input, and is made in one pass.
 *
 * Kept: text, names of tags, src of img, href of a. Dropped: other attributes, comments,
 * declarations, scripts and styles. */
#ifndef GOPURA_FORMAT_HTML_TAGS_H
#define GOPURA_FORMAT_HTML_TAGS_H

#include "base/bytes.h"

enum {
	HTML_BYTES_MAX = 256 << 10,   /* of a page */
	HTML_TAG_ATTRIBUTES_MAX = 64, /* limit for published pages */
};

struct html_tags {
	uint32_t attribute_count; /* of the tag with the most attributes */
	unsigned line;            /* where that tag begins, from 1 */
};

/* Maximum number of output bytes for each input byte. */
enum { HTML_TAGS_GROWTH = 6 };
/* Appends the reduced page to *out. *found gets the tag with the most attributes; found may be
 * NULL. Returns the error of *out: 0, -EFBIG or -ENOMEM. */
must_check int html_tags_reduce(struct buffer *out, struct bytes html, struct html_tags *found);

#endif
