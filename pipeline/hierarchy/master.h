/* The master: the whole hierarchy of a content folder, at home in its .work, never published as it
 * is. Two files: .work/master/groups-STAMP holds the groups' objects one after the other,
 * .work/master/index what they are; the index is written last, so the two belong together or
 * there is no master. */
#ifndef GOPURA_PIPELINE_HIERARCHY_MASTER_H
#define GOPURA_PIPELINE_HIERARCHY_MASTER_H

#include "format/hash.h"
#include "format/hierarchy.h"
#include "format/root_page.h"
#include "pipeline/hierarchy/multires.h"
#include "pipeline/import/mesh.h"

struct master {
	struct hash stamp; /* of what it was made from, and how */
	struct lattice lattice;
	float box_min_m[3], box_max_m[3]; /* of the scan */
	uint64_t source_triangles;        /* of the scan, as imported */
	struct hierarchy hierarchy;       /* owned; complete */
	uint64_t *places;                 /* owned; of each group's object in the file, bytes */
	uint32_t *sizes;                  /* owned; bytes */
	float *losses_m4; /* owned; of each group, what its absence costs: see multires_sink */
	int fd;           /* owned; of the objects */
};

struct master_options {
	struct multires_options multires;
	bool material_colours; /* colour vertices by pipeline/material/material.h and not as the
				  scan is */
};

/* What a build found and made; for people. */
struct master_report {
	struct lattice_counts counts;
	struct multires_stats stats;
	int64_t duration_ms;
};

/* The stamp of a master made from scans with that key in that way. */
struct hash master_stamp(struct hash scans_key, const struct master_options *options);

/* folder: DIR/.work/master; made where it is missing, what it held goes. The mesh is borrowed.
 * -EINVAL: not one triangle with an area. -E2BIG: see multires_build. Else as the disk says. */
must_check int master_build(const char *folder, const struct mesh *mesh, struct hash stamp,
			    const struct master_options *options, struct master_report *report);

/* *out is owned by the caller; NULL on failure. -ENOENT: there is none; -ESTALE: of another stamp
 * (stamp may be NULL: any will do); -EBADMSG: damaged. In each of these cases: build it. */
must_check int master_open(struct master **out, const char *folder, const struct hash *stamp);
void master_destroy(struct master *master); /* NULL is fine */

/* Object of group g, appended: see format/patch.h. Any thread. -EINVAL: no such group; -EBADMSG:
 * the file is shorter than the index says. */
must_check int master_read_group(const struct master *master, uint32_t group, struct buffer *out);

/* A part of the master that is to be published. */
struct master_cut {
	struct hierarchy hierarchy; /* owned; finer is NONE where what is finer stays home */
	uint32_t *groups;           /* owned; of each of its groups, the group of the master */
	uint64_t triangle_count;    /* of all its patches, coarse and fine together */
};

/* The groups without which the picture is most wrong, while the triangles of all their patches are
 * at most share (0..1) of the scan's; 1: everything, the finest level too. -ERANGE: not even group
 * 0 is; -ENOMEM. Zeroed on failure. */
must_check int master_cut_create(struct master_cut *out, const struct master *master, double share);
void master_cut_finish(struct master_cut *cut); /* NULL is fine */

#endif
