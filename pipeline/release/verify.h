/* Walks a whole release, as a suspicious stranger would: the chain of roots, signatures, expiry,
 * the locator, every pack and every object by its hash, every page, patch group, tile and the
 * information database by its decoder, and that what pages say about their children is so. */
#ifndef GOPURA_PIPELINE_RELEASE_VERIFY_H
#define GOPURA_PIPELINE_RELEASE_VERIFY_H

#include "format/metadata.h"
#include "format/root_page.h"
#include "pipeline/release/release_reader.h"

enum { VERIFY_WHY_BYTES = 1280 };

struct verify_options {
	struct release_reader *reader;
	struct bytes
		trusted_root; /* root/1.json from a place that is trusted; empty: the release's */
	int64_t now_s;        /* expiry is judged by it; 0: not at all */
};

/* What there is of one kind. */
struct verify_sum {
	uint64_t count, bytes;
};

struct verify_report {
	struct trust_root trust;
	struct release release;
	struct timestamp timestamp;
	struct root_page root;
	uint32_t locator_bytes, pack_count;
	uint64_t read_bytes; /* all files; packs may hold blocks of other releases too */
	struct verify_sum pages[PAGE_LABELS + 1]; /* by enum page_kind */
	struct verify_sum groups, tiles, pictures, database, labels;
	uint64_t hierarchy_triangles; /* of all published patches */
	uint32_t patches;
	uint32_t points, faces; /* that show something */
	uint32_t parts;
	char why[VERIFY_WHY_BYTES]; /* the first thing that is wrong, and where; "" */
};

/* 0: all is right. Negative errno: report->why says what is not; the rest is as far as it got. */
must_check int verify_release(struct verify_report *report, const struct verify_options *options);

#endif
