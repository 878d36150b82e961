/* Everything that is known about the parts of a folder, as one object for the page in the browser.
 */
#ifndef GOPURA_CURATOR_PAGES_INFORMATION_LIST_H
#define GOPURA_CURATOR_PAGES_INFORMATION_LIST_H

#include "curator/session/site.h"

/* Appends {"name", "languages": [...], "parts": [...], "tours": [{"id", "title"}], "pictures":
 * [NAME ...], "credits": {...}, "problems": [...]}. A part has id, title, caption, reading and
 * credits as parts.json has them, "thumbnail", "kind" of its region, "without_page", and "pages":
 * {LANGUAGE: TAG}. Negative errno, with a diagnostic. */
must_check int information_list(struct site *site, struct buffer *out,
				struct diagnostics *diagnostics);

#endif
