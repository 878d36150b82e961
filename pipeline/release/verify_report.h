/* What the verification of a release found. */
#ifndef GOPURA_PIPELINE_RELEASE_VERIFY_REPORT_H
#define GOPURA_PIPELINE_RELEASE_VERIFY_REPORT_H

#include "base/diagnostics.h"
#include "format/metadata.h"
#include "format/root_page.h"

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
	struct verify_sum pages[PAGE_KINDS]; /* indexed by enum page_kind */
	struct verify_sum groups, stream_blocks, tiles, files, database, labels, scenery,
		solid;                /* files: pictures and spoken texts */
	uint64_t hierarchy_triangles; /* in all published patches */
	uint32_t patches;
	uint32_t points, faces; /* which show something */
	uint32_t parts;
	struct diagnostics diagnostics; /* the first error and its place; empty if none */
};

#endif
