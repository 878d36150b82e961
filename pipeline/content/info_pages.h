/* Reads and compiles the pages of the parts into the draft. Private to pipeline/content. */
#ifndef GOPURA_PIPELINE_CONTENT_INFO_PAGES_H
#define GOPURA_PIPELINE_CONTENT_INFO_PAGES_H

#include "pipeline/content/draft.h"

/* Reads and checks the pages of the parts. Call it after draft_read_parts and draft_read_tours,
 * because pages may link to both. */
must_check int draft_read_pages(struct draft *draft);

/* Reads a document that draft_read_pages has checked, by the name of its file. *html is owned by
 * the caller; NULL: it is not in that language, or after a failure. */
must_check int draft_read_document(const struct draft *draft, const char *file, char **html);

#endif
