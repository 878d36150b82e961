/* Builds the hierarchy of a scan of any size in blocks (docs/hierarchy.md): passes over the scan,
 * then stage after stage, with one process for each block. */
#ifndef GOPURA_PIPELINE_HIERARCHY_BLOCK_BUILD_H
#define GOPURA_PIPELINE_HIERARCHY_BLOCK_BUILD_H

#include "geometry/substance.h"
#include "pipeline/hierarchy/lattice_mesh.h"
#include "pipeline/hierarchy/multires.h"
#include "pipeline/import/mesh.h"

struct block_build {
	struct lattice lattice;
	float box_min_m[3], box_max_m[3];
	struct hierarchy hierarchy; /* owned */
	struct multires_stats stats;
	struct lattice_counts counts;
};

/* Builds the hierarchy with the files of a folder, which exists; the caller removes it afterwards.
 * A build that was cut off goes on with what it left there, so a folder must belong to one scan and
 * one set of options. The sink gets object number n as group (group_count - 1 - n) of the
 * hierarchy. is_stone and substance: as block_look has them. The mesh is
 * borrowed; it may be a mapped file. *out is owned by the caller; zeroed on failure. Returns
 * -EINVAL if no triangle has an area, a position is not finite or a triangle names a vertex that
 * does not exist; the errors of multires_build and of the disk; -EIO if a process was killed;
 * -EPROTO if the result breaks a rule of format/hierarchy.h. */
must_check int block_build(struct block_build *out, const char *folder, const struct mesh *mesh,
			   const struct multires_options *options, bool is_stone,
			   enum substance_kind substance, const struct multires_sink *sink);
void block_build_finish(struct block_build *build); /* NULL is fine */

#endif
