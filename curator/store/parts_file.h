/* parts.json as a tree of cJSON, which keeps what it does not know. Hold documents_lock from
 * reading it to saving it. */
#ifndef GOPURA_CURATOR_STORE_PARTS_FILE_H
#define GOPURA_CURATOR_STORE_PARTS_FILE_H

#include "curator/store/documents.h"

#define PARTS_FILE "parts.json"

enum { PARTS_FILE_BYTES_MAX = 64 << 20 };

struct cJSON;

struct parts_file {
	struct cJSON *root; /* owned */
	char tag[DOCUMENT_TAG_BYTES];
};

/* Reads it; one without parts if there is no file. *out is for parts_file_finish, and empty on
 * failure, which has a diagnostic. -EINVAL: it is not JSON, or "parts" is no list. */
must_check int parts_file_read(struct parts_file *out, struct documents *documents,
			       struct diagnostics *diagnostics);
void parts_file_finish(struct parts_file *parts); /* NULL and zeroed are fine */

/* Returns the list of parts, borrowed; an empty one is added if there is none. NULL: no memory. */
struct cJSON *parts_file_list(const struct parts_file *parts);
/* Returns the first part of that id, borrowed, or NULL. */
struct cJSON *parts_file_find(const struct parts_file *parts, const char *id);
#endif
