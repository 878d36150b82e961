/* What a release is made of, each part into a page and its objects: the samples that were rendered,
 * the information of the content folder, the coarse part of the master hierarchy. */
#ifndef GOPURA_PIPELINE_PUBLISH_SOURCES_H
#define GOPURA_PIPELINE_PUBLISH_SOURCES_H

#include "format/hierarchy.h"
#include "pipeline/object_store.h"
#include "storage/info.h"

/* The samples page, its bricks and faces; tiles stay where the sampler left them. -ENOENT: nothing
 * was sampled, or not all. Errors are logged. */
must_check int publish_samples(struct object_store *objects, const char *content,
			       struct page_child *out);

/* The information page: the database, then the pictures by hash. -EINVAL: parts.json or a page is
 * at fault (every fault is logged). */
must_check int publish_info(struct object_store *objects, const struct info_build_options *options,
			    struct page_child *out);

/* The master hierarchy, as much of it as publishing needs. */
struct publish_master {
	const struct hierarchy *hierarchy;
	uint64_t source_triangles; /* of the scan */
	/* Appends the object of a group. */
	int (*read_group)(void *data, uint32_t group, struct buffer *out);
	void *data;
};

/* Which groups leave the museum: from the coarsest on, by error, as long as all published patches
 * together have at most share of the scan's triangles; never a group without those it refines.
 * The top is always there: a picture needs something, and where it alone passes the share, a
 * warning says so. chosen: hierarchy->group_count flags, written. -ENOMEM. */
must_check int publish_choose_groups(bool *chosen, const struct publish_master *master,
				     double share, uint64_t *published_triangles);

/* The hierarchy page and its groups. *published_triangles counts all patches of them. */
must_check int publish_hierarchy(struct object_store *objects, const struct publish_master *master,
				 double share, struct page_child *out,
				 uint64_t *published_triangles);

#endif
