/* The tags of a page, before an HTML parser reads it. libxml2 compares every attribute of a tag
 * with all before it: a megabyte of them took it half a minute. What comes out of here has at most
 * one attribute in a tag, whatever went in, and is made in one pass.
 *
 * Kept: text, the names of tags, src of img, href of a. Gone: other attributes, comments,
 * declarations, scripts and styles. */
#ifndef GOPURA_FORMAT_HTML_TAGS_H
#define GOPURA_FORMAT_HTML_TAGS_H

#include "base/bytes.h"

enum { HTML_TAG_ATTRIBUTES_MAX = 64 }; /* of what is published */

struct html_tags {
	uint32_t attribute_count; /* of the tag that has the most */
	unsigned line;            /* where that tag begins, from 1 */
};

/* Appends to *out, at most HTML_TAGS_GROWTH bytes for one. found may be NULL. What out has as its
 * error is given back. */
enum { HTML_TAGS_GROWTH = 6 };
must_check int html_tags_reduce(struct buffer *out, struct bytes html, struct html_tags *found);

#endif
