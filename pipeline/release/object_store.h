/* The objects of a release that is being made, by name. Small ones are kept in memory; the many
 * tiles stay in the files where the sampler wrote them. One thread. */
#ifndef GOPURA_PIPELINE_RELEASE_OBJECT_STORE_H
#define GOPURA_PIPELINE_RELEASE_OBJECT_STORE_H

#include "format/page.h"
#include "format/patch.h"

struct object_store;

/* *out is owned by the caller; NULL on failure. Returns -ENOMEM. */
must_check int object_store_create(struct object_store **out);
void object_store_destroy(struct object_store *store); /* NULL is fine */

/* Adds an object; bytes are copied. *child (may be NULL) is set for use in a page. Adding it twice
 * is fine. Returns -EFBIG if it is empty or larger than OBJECT_BYTES_MAX, or -ENOMEM. */
must_check int object_store_add(struct object_store *store, struct bytes bytes,
				struct page_child *child);
/* Encodes a page and adds it likewise. */
must_check int object_store_add_page(struct object_store *store, const struct page *page,
				     struct page_child *child);
/* Adds an object that lies in a file at offset. path is copied, once for consecutive calls with the
 * same one. The file is not read now. */
must_check int object_store_add_stretch(struct object_store *store, const char *path,
					uint64_t offset, const struct page_child *child);

/* Appends the object to out. Returns -ENOENT if there is no such object, or -EBADMSG (logged) if
 * the file changed since (its bytes do not hash to the name any more). */
must_check int object_store_read(struct object_store *store, struct hash hash, struct buffer *out);
/* Reads a page into *page, which points into *bytes. The caller finishes both, also on failure;
 * *page is zeroed before. Errors of object_store_read and page_decode. */
must_check int object_store_read_page(struct object_store *store, const struct page_child *child,
				      struct page *page, struct buffer *bytes);
/* Reads the *count meshes of a group of patches, which the caller finishes; 0 on failure. Errors of
 * object_store_read and patch_group_decode. */
must_check int object_store_read_group(struct object_store *store, struct hash hash,
				       struct patch_mesh meshes[GROUP_PATCHES_MAX],
				       uint32_t *count);
/* Returns true if the store has the object. */
bool object_store_has(const struct object_store *store, struct hash hash);

#endif
