/* Older versions of documents, and merging with one. Any thread. */
#ifndef GOPURA_CURATOR_STORE_DOCUMENTS_VERSIONS_H
#define GOPURA_CURATOR_STORE_DOCUMENTS_VERSIONS_H

#include "curator/store/documents.h"

/* Merges a text that began from `base` ("": from nothing) with the one that is there, as text_merge
 * does. tag is that of the latter, from which the merged text then begins. -ENOENT: there is none,
 * or the history has no such base. -EINVAL: not text. With a diagnostic. */
must_check int documents_merge(struct documents *documents, const char *name, const char *base,
			       struct bytes mine, struct buffer *out, bool *is_clean,
			       char tag[DOCUMENT_TAG_BYTES], struct diagnostics *diagnostics);

/* Keeps a text that is no version, so that what is written after it can be merged as from there. */
must_check int documents_keep(struct documents *documents, const char *name, struct bytes text,
			      char tag[DOCUMENT_TAG_BYTES], struct diagnostics *diagnostics);

/* Lists the versions of a document, the newest first; of one that was removed too. */
must_check int documents_versions(struct documents *documents, const char *name,
				  struct history_version *out, uint32_t max, uint32_t *count,
				  struct diagnostics *diagnostics);
/* Reads a document as it was in a version. -ENOENT: it was not there. With a diagnostic. */
must_check int documents_read_version(struct documents *documents, const char *name,
				      const char *version, struct buffer *text,
				      struct diagnostics *diagnostics);

#endif
