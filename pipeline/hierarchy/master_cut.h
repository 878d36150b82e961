/* Selects the part of a master hierarchy that is published. */
#ifndef GOPURA_PIPELINE_HIERARCHY_MASTER_CUT_H
#define GOPURA_PIPELINE_HIERARCHY_MASTER_CUT_H

#include "pipeline/hierarchy/master.h"

/* The part of a master that is to be published. */
struct master_cut {
	struct hierarchy
		hierarchy; /* owned; finer is HIERARCHY_NONE if the finer group is not published */
	uint32_t *groups;  /* owned; for each group of the cut, its group in the master */
	uint64_t triangle_count; /* in all its patches, coarse and fine together */
};

/* Selects the groups without which the picture has the largest error, as long as the triangles of
 * all their patches are at most share (0..1) of the scan's; 1: everything, with the finest level.
 * Returns -ERANGE if not even group 0 fits, or -ENOMEM. *out is owned by the caller; zeroed on
 * failure. */
must_check int master_cut_create(struct master_cut *out, const struct master *master, double share);
void master_cut_finish(struct master_cut *cut); /* NULL is fine */

#endif
