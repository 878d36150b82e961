/* Verifies a whole release without trusting it: the chain of roots, signatures, expiry, the
 * locator, every pack and object by its hash, and every page, patch group, tile and the information
 * database by its decoder. It also checks that what pages say about their children is true. */
#ifndef GOPURA_PIPELINE_RELEASE_VERIFY_H
#define GOPURA_PIPELINE_RELEASE_VERIFY_H

#include "pipeline/release/release_reader.h"
#include "pipeline/release/verify_report.h"

struct verify_options {
	struct release_reader *reader;
	/* root/1.json or tuf/1.root.json from a trusted source; empty: the release's own, in the
	 * earlier form where it has one */
	struct bytes trusted_root;
	const char *target; /* of The Update Framework: the release's path; NULL: release.json */
	int64_t now_s;      /* the time for expiry checks, seconds since 1970; 0: no check */
};

/* Returns 0 if everything is correct. Otherwise report->diagnostics has the first error, and the
 * rest of the report is filled as far as verification got. */
must_check int verify_release(struct verify_report *report, const struct verify_options *options);

#endif
