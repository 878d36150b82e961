/* Turns the coarse part of the master hierarchy into the hierarchy page of a release and its
 * objects. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_HIERARCHY_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_HIERARCHY_H

#include "pipeline/hierarchy/master.h"
#include "pipeline/release/object_store.h"

/* Adds the hierarchy page and its groups: the part of the master within the share. If not even the
 * top group fits, the top group alone is published, with a warning: there must be something to
 * show. *published_triangles counts all patches. Errors are logged. */
must_check int publish_hierarchy(struct object_store *objects, const struct master *master,
				 double share, struct page_child *out,
				 uint64_t *published_triangles);

#endif
