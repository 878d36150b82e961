/* Verifies a whole release without trusting it: the chain of roots, signatures, expiry, the
 * locator, every pack and object by its hash, and every page, patch group, tile and the information
 * database by its decoder. It also checks that what pages say about their children is true. */
#ifndef GOPURA_PIPELINE_RELEASE_VERIFY_H
#define GOPURA_PIPELINE_RELEASE_VERIFY_H

#include "format/metadata.h"
#include "format/root_page.h"
#include "pipeline/release/release_reader.h"

enum { VERIFY_WHY_BYTES = 1280 };

struct verify_options {
	struct release_reader *reader;
	struct bytes trusted_root; /* root/1.json from a trusted source; empty: the release's own */
	int64_t now_s;             /* the time for expiry checks, seconds since 1970; 0: no check */
};

/* Number and size of objects of one kind. */
struct verify_sum {
	uint64_t count, bytes;
};

struct verify_report {
	struct trust_root trust;
	struct release release;
	struct timestamp timestamp;
	struct root_page root;
	uint32_t locator_bytes, pack_count;
	uint64_t read_bytes; /* of all files; packs may hold blocks of other releases too */
	struct verify_sum pages[PAGE_LABELS + 1]; /* indexed by enum page_kind */
	struct verify_sum groups, tiles, pictures, database, labels;
	uint64_t hierarchy_triangles; /* in all published patches */
	uint32_t patches;
	uint32_t points, faces; /* which show something */
	uint32_t parts;
	char why[VERIFY_WHY_BYTES]; /* the first error and its place; "" if none */
};

/* Returns 0 if everything is correct. Otherwise report->why describes the first error, and the rest
 * of the report is filled as far as verification got. */
must_check int verify_release(struct verify_report *report, const struct verify_options *options);

#endif
