/* Turns the coarse part of the master hierarchy into the hierarchy page of a release and its
 * objects. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_HIERARCHY_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_HIERARCHY_H

#include "pipeline/hierarchy/master.h"
#include "pipeline/release/object_store.h"

/* What was published of the geometry. */
struct published_patches {
	uint64_t triangle_count; /* of all patches, coarse and fine together */
	uint64_t bytes;          /* of all groups, as they lie in the release */
};

/* Adds the hierarchy page and its groups: the part of the master within the share. If not even the
 * top group fits, the top group alone is published, with a warning: there must be something to
 * show. Errors are logged. */
must_check int publish_hierarchy(struct object_store *objects, const struct master *master,
				 double share, struct page_child *out,
				 struct published_patches *published);

#endif
