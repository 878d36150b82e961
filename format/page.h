/* A page is an object that names other objects. All pages share one outer form, so that code that
 * walks a release (fetcher, verifier, packer) need not know what a page contains:
 *
 *   "GPag"  u16 kind  u16 version(1)  u32 child_count  u32 payload_bytes
 *   child_count x { u32 size_and_flag, 16 bytes hash }     bit 31 of the size: the child is a page
 *   payload (its form depends on the kind; see the header named after it)
 *
 * All integers are little endian. Nothing may follow the payload.
 *
 * The children of a page lie side by side in a pack, in the page's order ("the block of the page").
 * Child i is found in the page's block at the sum of the sizes before i. So the unsigned locator
 * needs one entry per page, not one per object. */
#ifndef GOPURA_FORMAT_PAGE_H
#define GOPURA_FORMAT_PAGE_H

#include "format/hash.h"

enum page_kind {
	PAGE_ROOT = 1,  /* format/root_page.h: one per release */
	PAGE_HIERARCHY, /* format/hierarchy.h: children are patch groups */
	PAGE_SAMPLES,   /* format/samples.h: children are brick pages */
	PAGE_BRICK,     /* 4 x 4 x 4 sampling points: children are face pages */
	PAGE_FACE,      /* one face of one sampling point: children are tiles */
	PAGE_INFO,      /* children: the information database (SQLite), then its pictures */
	PAGE_LABELS,    /* format/label.h: children are the labels of patch groups */
	PAGE_STREAM,    /* format/stream_page.h: children are blocks of a streaming mesh */
	PAGE_KINDS
};

enum {
	PAGE_HEADER_BYTES = 16,
	PAGE_CHILD_BYTES = 4 + HASH_BYTES,
	PAGE_BYTES_MAX = 4 << 20,   /* an encoded page; larger ones are refused */
	OBJECT_BYTES_MAX = 16 << 20 /* any object */
};

struct page_child {
	struct hash hash;
	uint32_t size; /* bytes of the object */
	bool is_page;
};

struct page {
	enum page_kind kind;
	uint32_t child_count;
	struct page_child *children; /* owned */
	struct bytes payload;        /* borrowed from the bytes that were decoded */
};

/* Appends the encoded page. Failures are out->error; a page above PAGE_BYTES_MAX sets -EFBIG. Kind
 * and child sizes must be valid: the encoder asserts them. */
void page_encode(struct buffer *out, const struct page *page);
/* The caller ends *out with page_finish(); it is zeroed on failure. Returns -ENOMEM, or -EBADMSG if
 * the object is not a page, is truncated, has trailing bytes or an unknown kind or version, or has
 * a child that is empty, without a hash, or larger than its kind may be. */
must_check int page_decode(struct page *out, struct bytes object);
/* Frees the children and zeroes the struct. NULL and zeroed are fine. */
void page_finish(struct page *page);

/* Returns true if the object begins as a page does. page_decode may still refuse it. */
bool page_is(struct bytes object);

/* Returns the offset of a child in the page's block, in bytes. */
uint64_t page_child_offset(const struct page *page, uint32_t child);

#endif
