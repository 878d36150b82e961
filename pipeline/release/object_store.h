/* The objects of a release that is being made, by name: small ones in memory, the many tiles where
 * they lie already (a stretch of a file). One thread. */
#ifndef GOPURA_PIPELINE_RELEASE_OBJECT_STORE_H
#define GOPURA_PIPELINE_RELEASE_OBJECT_STORE_H

#include "format/page.h"

struct object_store;

must_check int object_store_create(struct object_store **out);
void object_store_destroy(struct object_store *store); /* NULL is fine */

/* bytes are copied. *child (may be NULL) becomes what a page says of it. -EFBIG: empty or larger
 * than an object may be. */
must_check int object_store_add(struct object_store *store, struct bytes bytes,
				struct page_child *child);
/* The same for a page, which is encoded here. */
must_check int object_store_add_page(struct object_store *store, const struct page *page,
				     struct page_child *child);
/* An object that lies in a file; path is copied, once a run of calls with the same one. */
must_check int object_store_add_stretch(struct object_store *store, const char *path,
					uint64_t offset, const struct page_child *child);

/* Appends the object to out. -ENOENT: no such object. -EBADMSG: the file has changed since (its
 * bytes do not hash to the name any more). */
must_check int object_store_read(struct object_store *store, struct hash hash, struct buffer *out);
bool object_store_has(const struct object_store *store, struct hash hash);

#endif
