/* Where the blocks of pages lie in the packs. Unsigned (every object is checked by its own hash)
 * and self-checking, so that repacking changes no hash. One file a release, `locator/ROOTHASH`:
 *
 *   "GLoc"  u32 version(1)  u32 pack_count  u32 block_count
 *   pack_count x { 16 bytes name }          a pack is the file packs/HEX of its name
 *   block_count x { 16 bytes page, u32 pack, u32 offset, u32 size }    sorted by page
 *   16 bytes: hash of all before
 *
 * The block of page P holds P's children side by side (format/page.h). The root page itself is the
 * whole block of the zero hash. */
#ifndef GOPURA_FORMAT_LOCATOR_H
#define GOPURA_FORMAT_LOCATOR_H

#include "format/hash.h"

struct locator_block {
	struct hash page;
	uint32_t pack;   /* index into packs */
	uint32_t offset; /* in the pack, bytes */
	uint32_t size;   /* bytes */
};

struct locator {
	uint32_t pack_count, block_count;
	struct hash *packs;           /* owned */
	struct locator_block *blocks; /* owned; sorted by page */
};

/* Appends the file, its checksum included; blocks must be sorted. Failures are out->error. */
void locator_encode(struct buffer *out, const struct locator *locator);
/* Copies all it needs. *out is finished by the caller; on failure it is zeroed. -EBADMSG: damaged,
 * truncated or no locator; -ENOMEM. */
must_check int locator_decode(struct locator *out, struct bytes file);
/* NULL: not there. */
const struct locator_block *locator_find(const struct locator *locator, struct hash page);
void locator_finish(struct locator *locator);

#endif
