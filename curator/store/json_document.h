/* A document that is an object of JSON, as a tree of cJSON, which keeps what it does not know. */
#ifndef GOPURA_CURATOR_STORE_JSON_DOCUMENT_H
#define GOPURA_CURATOR_STORE_JSON_DOCUMENT_H

#include "curator/store/documents.h"

struct cJSON;

/* Reads a document of at most bytes_max; an empty object, with "" as tag, if there is none. *out is
 * owned by the caller; NULL on failure, which has a diagnostic. -EINVAL: it is not an object of
 * JSON. */
must_check int json_document_read(struct cJSON **out, struct documents *documents, const char *name,
				  size_t bytes_max, char tag[DOCUMENT_TAG_BYTES],
				  struct diagnostics *diagnostics);

#endif
