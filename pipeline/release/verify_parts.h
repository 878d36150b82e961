/* What the sources of the verifier share. Private to pipeline/release/verify*.c. */
#ifndef GOPURA_PIPELINE_RELEASE_VERIFY_PARTS_H
#define GOPURA_PIPELINE_RELEASE_VERIFY_PARTS_H

#include "base/progress.h"
#include "format/hierarchy.h"
#include "format/samples.h"
#include "format/tile.h"
#include "pipeline/release/object_map.h"
#include "pipeline/release/verify.h"
#include "storage/info.h"

/* A page that is still to be looked into: where it lies, and what it must be. */
struct verify_task {
	struct hash parent;
	uint64_t offset; /* in the parent's block */
	struct page_child child;
	enum page_kind kind;
};

struct verify_walk {
	const struct verify_options *options;
	struct verify_report *report;
	struct locator locator;
	struct hash_map seen; /* pages that are queued or done */
	struct verify_task *tasks;
	size_t task_count, task_room;
	uint32_t blocks_used;
	struct samples_page samples; /* once it was met, as the next two */
	struct hierarchy hierarchy;
	struct info *info;
	struct progress *progress;
};

/* The page being looked into; bytes are a copy, because the reader's are borrowed for one call. */
struct verify_page {
	struct hash name;
	struct page page;
};

/* Says what is wrong, unless something was said already; gives rc back. */
int verify_blame(struct verify_report *report, int rc, const char *text, ...) printf_like(3, 4);

/* The page's child, hashed and found right; borrowed until the next call. */
must_check int verify_child(struct verify_walk *walk, const struct verify_page *page,
			    uint32_t child, struct bytes *out);
/* Looks into the child later. */
must_check int verify_later(struct verify_walk *walk, const struct verify_page *page,
			    uint32_t child, enum page_kind kind);

/* What is in a page of its kind, and what its children that are no pages are. */
must_check int verify_root_page(struct verify_walk *walk, const struct verify_page *page);
must_check int verify_hierarchy_page(struct verify_walk *walk, const struct verify_page *page);
must_check int verify_samples_page(struct verify_walk *walk, const struct verify_page *page);
must_check int verify_brick_page(struct verify_walk *walk, const struct verify_page *page);
must_check int verify_face_page(struct verify_walk *walk, const struct verify_page *page);
must_check int verify_info_page(struct verify_walk *walk, const struct verify_page *page);
must_check int verify_labels_page(struct verify_walk *walk, const struct verify_page *page);

#endif
