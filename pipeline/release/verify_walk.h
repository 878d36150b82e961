/* The walk over all pages of a release that is verified: what is queued, what was met, and the
 * first fault. */
#ifndef GOPURA_PIPELINE_RELEASE_VERIFY_WALK_H
#define GOPURA_PIPELINE_RELEASE_VERIFY_WALK_H

#include "base/progress.h"
#include "format/hierarchy.h"
#include "format/samples.h"
#include "format/tile.h"
#include "pipeline/release/release_reader.h"
#include "pipeline/release/verify_report.h"
#include "storage/info_spoken.h"

/* A page that is still to be verified: where it is, and which kind it must have. */
struct verify_task {
	struct hash parent;
	uint64_t offset; /* bytes, in the parent's block */
	struct page_child child;
	enum page_kind kind;
};

struct verify_walk {
	struct release_reader *reader;
	struct verify_report *report;
	struct locator locator;
	struct map seen; /* pages that are queued or done */
	struct verify_task *tasks;
	uint32_t task_count, task_room;
	uint32_t blocks_used;
	struct samples_page samples; /* set when its page was verified, as the next two */
	struct hierarchy hierarchy;
	struct info *info;
	struct progress *progress;
};

/* The page being verified. It points into a copy of the bytes, because the reader's are borrowed
 * for one call only. */
struct verify_page {
	struct hash name;
	struct page page;
};

/* Adds what the reader of the release says to the diagnostics of the report. Returns rc. */
int verify_blame_reader(struct verify_walk *walk, int rc);

/* Reads a child of a page and checks its hash; borrowed until the next call. */
must_check int verify_child(struct verify_walk *walk, const struct verify_page *page,
			    uint32_t child, struct bytes *out);
/* Queues a page; one that was met before is queued only once. -ENOMEM. */
must_check int verify_queue(struct verify_walk *walk, const struct verify_task *task);
/* Queues the child for verification; it must be a page of that kind. */
must_check int verify_later(struct verify_walk *walk, const struct verify_page *page,
			    uint32_t child, enum page_kind kind);

#endif
