/* Where the blocks of pages lie in the packs. The locator is not signed: every object is checked by
 * its own hash, and so packs can be rearranged without changing a hash. It checks itself with a
 * hash at its end. One file per release, `locator/ROOTHASH`. It is what a terminal downloads before
 * it can show anything, so it is short:
 *
 *   "GLoc"  u32 version(2)  u32 pack_count  u32 run_count  u32 block_count  u32 name_bytes
 *   pack_count x { 16 bytes name }                   a pack is the file packs/HEX of its name
 *   run_count x { u32 pack, u32 offset, u32 count }  blocks that lie side by side
 *   block_count x { name_bytes of the page, u32 size }     run by run, as they lie
 *   16 bytes: hash of all before
 *
 * Names of pages are cut off where they still differ: name_bytes is 8, or more if two begin alike.
 * Version 1, which is still read, had no runs, and instead of the last two tables
 *
 *   block_count x { 16 bytes page, u32 pack, u32 offset, u32 size }    sorted by page
 *
 * The block of page P holds the children of P side by side (format/page.h). The root page is
 * nobody's child; it forms the block of the zero hash. */
#ifndef GOPURA_FORMAT_LOCATOR_H
#define GOPURA_FORMAT_LOCATOR_H

#include "format/hash.h"

struct locator_block {
	struct hash page; /* in one that was read the first name_bytes, and zeros */
	uint32_t pack;    /* index into packs */
	uint32_t offset;  /* in the pack, bytes */
	uint32_t size;    /* bytes */
};

struct locator {
	uint32_t pack_count, block_count;
	struct hash *packs;           /* owned */
	struct locator_block *blocks; /* owned; decoded ones are sorted by page */
	uint32_t name_bytes;          /* that pages that were read are told apart by */
};

/* Appends the file with its checksum. Blocks may be in any order. Failures are out->error, also
 * -ENOMEM. */
void locator_encode(struct buffer *out, const struct locator *locator);
/* Copies what it needs from file. The caller ends *out with locator_finish(); it is zeroed on
 * failure. Returns -EBADMSG if the file is damaged, truncated or not a locator, or -ENOMEM. */
must_check int locator_decode(struct locator *out, struct bytes file);
/* Returns the block of a page, borrowed from the locator, or NULL. */
const struct locator_block *locator_find(const struct locator *locator, struct hash page);
/* Frees the arrays and zeroes the struct. NULL and zeroed are fine. */
void locator_finish(struct locator *locator);

#endif
