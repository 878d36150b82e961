/* The master: the complete hierarchy of a content folder. It stays local, in the folder .work, and
 * is never published as it is. .work/master/groups-STAMP holds the objects of all groups one after
 * the other; .work/master/index describes them. The index is written last. So either both files
 * belong together, or there is no valid master. Several processes and machines may build one master
 * at once (docs/cluster.md): all make the same bytes. */
#ifndef GOPURA_PIPELINE_HIERARCHY_MASTER_H
#define GOPURA_PIPELINE_HIERARCHY_MASTER_H

#include "format/hash.h"
#include "format/hierarchy.h"
#include "format/root_page.h"
#include "geometry/substance.h"
#include "pipeline/hierarchy/multires.h"
#include "pipeline/import/mesh.h"

struct master {
	struct hash stamp; /* hash of its sources and options */
	struct lattice lattice;
	float box_min_m[3], box_max_m[3]; /* bounding box of the scan */
	uint64_t source_triangles;        /* triangles of the scan as imported */
	struct hierarchy hierarchy;       /* owned; complete */
	uint64_t *places; /* owned; offset of each group's object in the file, bytes */
	uint32_t *sizes;  /* owned; size of each object, bytes */
	float *losses_m4; /* owned; the cost of leaving out each group: see multires_sink */
	int fd;           /* owned; the file of objects */
};

struct master_options {
	struct multires_options multires;
	bool material_colours; /* use a material, not the scan's colours */
	enum substance_kind
		substance; /* which; SUBSTANCE_NONE: that of pipeline/material/material.h */
};

/* The result of a build, for people. */
struct master_report {
	struct lattice_counts counts;
	struct multires_stats stats;
	int64_t duration_ms;
};

/* Returns the stamp of a master that is made from scans with that key and with those options. */
struct hash master_stamp(struct hash scans_key, const struct master_options *options);

/* Builds a master in folder (DIR/.work/master). The folder is created if needed. What interrupted
 * builds of other stamps left there is removed before, other older files once this master is
 * complete. What one of this stamp left is used, or made again if it is damaged. The mesh is
 * borrowed. *report is always set; it has no levels if another process was faster, completed this
 * master and removed what both worked on. Returns -EINVAL if no triangle has an area, the errors of
 * multires_build, or those of the disk. */
must_check int master_build(const char *folder, const struct mesh *mesh, struct hash stamp,
			    const struct master_options *options, struct master_report *report);

/* Removes from the folder of a complete master with that stamp what killed builds left there. */
void master_drop_leftovers(const char *folder, struct hash stamp);

/* Opens the master of a folder. *out is owned by the caller; NULL on failure. Returns -ENOENT if
 * there is none, -ESTALE if its stamp or version differs (stamp may be NULL: any will do), -EBADMSG
 * if it is damaged; in each of these cases, build it. Other errors are those of the disk, and
 * -ENOMEM. */
must_check int master_open(struct master **out, const char *folder, const struct hash *stamp);
void master_destroy(struct master *master); /* NULL is fine */

/* Appends the object of a group: see format/patch.h. Any thread. Returns -EINVAL if there is no
 * such group, -EBADMSG if the file is shorter than the index says. */
must_check int master_read_group(const struct master *master, uint32_t group, struct buffer *out);

#endif
