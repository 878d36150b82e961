/* What a release is made of, each part into a page and its objects: the samples that were rendered,
 * the information of the content folder, the coarse part of the master hierarchy. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_SOURCES_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_SOURCES_H

#include "pipeline/content/info_build.h"
#include "pipeline/content/part_faces.h"
#include "pipeline/hierarchy/master.h"
#include "pipeline/release/object_store.h"

/* The samples page, its bricks and faces; tiles stay where the sampler left them. -ENOENT: nothing
 * was sampled, or not all. Errors are logged. */
must_check int publish_samples(struct object_store *objects, const char *content,
			       struct page_child *out);

/* The information page: the database, then the pictures by hash. -EINVAL: parts.json or a page is
 * at fault (every fault is logged). */
must_check int publish_info(struct object_store *objects, const struct info_build_options *options,
			    struct page_child *out);

/* The labels page and its objects: which parts the published patches of the hierarchy page belong
 * to, by the scan's surface (docs/labels.md). 1: there it is; 0: no part has a region, so there is
 * none. Errors are logged. */
must_check int publish_labels(struct object_store *objects, const struct root_page *root,
			      struct part_faces_all *faces,
			      const struct page_child children[ROOT_CHILD_COUNT],
			      struct page_child *out);

/* The hierarchy page and its groups: the part of the master within the share. Where not even the
 * top of it is, the top alone, with a warning: a picture needs something. *published_triangles
 * counts all patches. Errors are logged. */
must_check int publish_hierarchy(struct object_store *objects, const struct master *master,
				 double share, struct page_child *out,
				 uint64_t *published_triangles);

#endif
