/* Packs: the files that hold the objects of a release.
 *
 * A pack is an immutable file of about PACK_BYTES, named by the hash of its bytes. It holds blocks:
 * the children of one page side by side, in the page's order. Blocks are in the order in which they
 * are needed, breadth first from the root: the root page (the block of the zero hash), the root's
 * children, the patch groups (coarse first), the brick pages, the information, the labels, the face
 * pages, the tiles.
 *
 * A block that an earlier release already has is not written again. Pages are known by hash, so the
 * new locator points into the old pack. A new release adds packs and never rewrites one. */
#ifndef GOPURA_PIPELINE_RELEASE_PACK_H
#define GOPURA_PIPELINE_RELEASE_PACK_H

#include "format/locator.h"
#include "pipeline/release/object_store.h"

enum {
	PACK_BYTES = 32 << 20,    /* a pack ends before the block that would exceed this */
	PACK_BYTES_MAX = 1 << 30, /* limit of one block, and so of a pack */
};

struct pack_options {
	const char *release; /* the release folder; packs/ and locator/ are created in it */
	struct object_store *objects;
	struct page_child root; /* the root page; in objects */
	const struct locator
		*before;     /* locator of an earlier release in the same folder; NULL: none */
	uint32_t pack_bytes; /* 0: PACK_BYTES */
	void (*progress)(void *data, uint64_t done_bytes); /* may be NULL */
	void *progress_data;
};

struct pack_result {
	uint32_t packs_written, packs_reused;
	uint32_t blocks_written, blocks_reused;
	uint64_t written_bytes; /* bytes in new packs */
	uint64_t reused_bytes;  /* bytes of blocks in old packs */
	uint64_t locator_bytes;
};

/* Writes the packs, then locator/ROOT. Deterministic. A block is reused only if its old pack is
 * still there and long enough; otherwise it is written again. Other publishers into the folder wait
 * meanwhile. Errors are logged. */
must_check int pack_release(const struct pack_options *options, struct pack_result *result);

/* Reads locator/ROOT of a release folder. The caller ends *out with locator_finish(), also on
 * failure. Returns -ENOENT if there is none, or the errors of locator_decode and the disk. */
must_check int pack_read_locator(struct locator *out, const char *release, struct hash root);
/* The same, and looks for the packs that it names. -ENODATA: one is missing or cut off, which is
 * logged as a warning; *out is set then. */
must_check int pack_read_whole(struct locator *out, const char *release, struct hash root);

#endif
