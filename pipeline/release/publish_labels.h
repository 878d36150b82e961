/* Computes the labels of the published patches and turns them into the labels page of a release. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_LABELS_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_LABELS_H

#include "format/root_page.h"
#include "pipeline/content/sources.h"
#include "pipeline/release/object_store.h"

/* Adds the labels page and its objects: which parts the published patches belong to, according to
 * the scan's surface (docs/labels.md). children holds the pages of the hierarchy and the
 * information. Returns 1 if *out is set, 0 if no part has a region and so there are no labels.
 * Errors are logged. */
must_check int publish_labels(struct object_store *objects, const struct root_page *root,
			      struct sources *sources,
			      const struct page_child children[ROOT_CHILD_COUNT],
			      struct page_child *out);

#endif
