/* Reads a release where it lies: a folder, or a server by URL (libcurl). Whole files only; the
 * packs read last are kept, because objects wanted together lie together. One thread. */
#ifndef GOPURA_PIPELINE_RELEASE_RELEASE_READER_H
#define GOPURA_PIPELINE_RELEASE_RELEASE_READER_H

#include "format/locator.h"
#include "format/page.h"

struct release_reader;

struct release_reader_options {
	const char *place;   /* copied; a folder, or https://..., http://... */
	const char *ca_file; /* copied; for https; NULL: the system's authorities */
};

/* *out is owned by the caller; on failure it is NULL. Nothing is read yet. */
must_check int release_reader_create(struct release_reader **out,
				     const struct release_reader_options *options);
void release_reader_destroy(struct release_reader *reader); /* NULL is fine */

/* A file of the release ("release.json") into out, cleared first. -ENOENT: not there; other errors
 * are told by release_reader_why. */
must_check int release_reader_file(struct release_reader *reader, const char *name,
				   struct buffer *out);

/* The pack, borrowed until the next call. It hashes to its name: -EBADMSG otherwise. */
must_check int release_reader_pack(struct release_reader *reader, struct hash name,
				   struct bytes *out);

/* Child number `child` of the page (the root page: page is the zero hash, child 0), borrowed until
 * the next call, hashed and found right. -ENOENT: no block or pack. -EBADMSG: something is damaged.
 */
must_check int release_reader_child(struct release_reader *reader, const struct locator *locator,
				    struct hash page, uint64_t offset,
				    const struct page_child *child, struct bytes *out);

/* What went wrong last, for people: "packs/12ab...: does not hash to its name". Never NULL. */
const char *release_reader_why(const struct release_reader *reader);
/* All bytes read so far. */
uint64_t release_reader_bytes(const struct release_reader *reader);

#endif
