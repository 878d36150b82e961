/* Turns each source of a release into a page and its objects: the rendered samples, the information
 * of the content folder, the labels, and the coarse part of the master hierarchy. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_SOURCES_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_SOURCES_H

#include "pipeline/content/sources.h"
#include "pipeline/hierarchy/master.h"
#include "pipeline/release/object_store.h"

/* Adds the samples page with its brick and face pages. Tiles stay where the sampler wrote them.
 * Returns -ENOENT if sampling is not complete. Errors are logged. */
must_check int publish_samples(struct object_store *objects, const char *content,
			       struct page_child *out);

/* Adds the information page: the database, then the pictures of the content folder by hash. Errors
 * are logged. */
must_check int publish_info(struct object_store *objects, const struct info_built *info,
			    const char *folder, struct page_child *out);

/* Adds the labels page and its objects: which parts the published patches belong to, according to
 * the scan's surface (docs/labels.md). children holds the pages of the hierarchy and the
 * information. Returns 1 if *out is set, 0 if no part has a region and so there are no labels.
 * Errors are logged. */
must_check int publish_labels(struct object_store *objects, const struct root_page *root,
			      struct sources *sources,
			      const struct page_child children[ROOT_CHILD_COUNT],
			      struct page_child *out);

/* Adds the hierarchy page and its groups: the part of the master within the share. If not even the
 * top group fits, the top group alone is published, with a warning: there must be something to
 * show. *published_triangles counts all patches. Errors are logged. */
must_check int publish_hierarchy(struct object_store *objects, const struct master *master,
				 double share, struct page_child *out,
				 uint64_t *published_triangles);

#endif
