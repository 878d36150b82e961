/* Publishes scenery: what stands beside the scans. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_SCENERY_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_SCENERY_H

#include "pipeline/content/sources.h"
#include "pipeline/release/object_store.h"

/* Adds the scenery of the content folder, and sets *out to the root page's child. Returns 1, 0 if
 * the folder has none, or a negative errno, logged. */
must_check int publish_scenery(struct object_store *objects, struct sources *sources,
			       struct page_child *out);

#endif
