/* Reads a release from a folder, or from a server by URL (libcurl). It reads whole files and keeps
 * the last packs, because objects that are needed together lie together. One thread. */
#ifndef GOPURA_PIPELINE_RELEASE_RELEASE_READER_H
#define GOPURA_PIPELINE_RELEASE_RELEASE_READER_H

#include "format/locator.h"
#include "format/page.h"

struct release_reader;

struct release_reader_options {
	const char *place;   /* copied; a folder, or https://..., http://... */
	const char *ca_file; /* copied; for https; NULL: the system's authorities */
};

/* *out is owned by the caller; on failure it is NULL. Nothing is read yet. Returns -ENOMEM,
 * -ENAMETOOLONG, or -EIO if libcurl cannot be set up. */
must_check int release_reader_create(struct release_reader **out,
				     const struct release_reader_options *options);
void release_reader_destroy(struct release_reader *reader); /* NULL is fine */

/* Reads a file of the release ("release.json") into out, which is cleared first. Returns -ENOENT if
 * it does not exist; release_reader_why describes other errors. */
must_check int release_reader_file(struct release_reader *reader, const char *name,
				   struct buffer *out);

/* Reads a pack, borrowed until the next call. Returns -EBADMSG if it does not hash to its name. */
must_check int release_reader_pack(struct release_reader *reader, struct hash name,
				   struct bytes *out);

/* Reads a child of a page: offset is its place in the page's block, *child its entry in the page.
 * For the root page itself, page is the zero hash and offset 0. *out is borrowed until the next
 * call; its hash is checked. Returns -ENOENT if there is no such block or pack, -EBADMSG if
 * something is damaged. */
must_check int release_reader_child(struct release_reader *reader, const struct locator *locator,
				    struct hash page, uint64_t offset,
				    const struct page_child *child, struct bytes *out);

/* Describes the last error for people: "packs/12ab...: does not hash to its name". Never NULL;
 * borrowed. */
const char *release_reader_why(const struct release_reader *reader);
/* Returns the number of bytes read so far. */
uint64_t release_reader_bytes(const struct release_reader *reader);

#endif
