/* The triangles of a scan that a curator has marked, with every earlier state. A change is kept as
 * the ranges of triangles that it added or took away, so undoing it is doing it again. One
 * thread. */
#ifndef GOPURA_CURATOR_REGION_REGION_SET_H
#define GOPURA_CURATOR_REGION_REGION_SET_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"
#include "pipeline/import/face_list.h"
#include "pipeline/import/mesh.h"

/* What one change flipped. */
struct region_step {
	struct face_range *ranges; /* of triangles; owned; ascending, neither overlapping nor
				      touching */
	uint32_t count, room;
};

struct region_set {
	uint32_t triangle_count;   /* of the mesh */
	uint32_t count;            /* of the region */
	uint64_t *bits;            /* owned; 64 triangles each, the lowest bit first */
	uint64_t *wanted;          /* owned; the change that is being made */
	struct region_step *steps; /* owned; [0, done_count) are done, the others undone */
	uint32_t step_count, step_room, done_count;
};

/* An empty region of a mesh of so many triangles. *set is zeroed on failure. -ENOMEM. */
must_check int region_set_init(struct region_set *set, uint32_t triangle_count);
void region_set_finish(struct region_set *set); /* NULL and zeroed are fine */

static inline bool region_set_has(const struct region_set *set, uint32_t triangle)
{
	return set->bits[triangle / 64] >> triangle % 64 & 1;
}

/* A change: begin, any number of puts, commit. A change that changes nothing is no step; any other
 * one drops the steps that were undone. commit: -ENOMEM; then the region is as it was. */
void region_set_begin(struct region_set *set);
void region_set_put(struct region_set *set, uint32_t triangle, bool in);
/* Puts all triangles. */
void region_set_put_all(struct region_set *set, bool in);
must_check int region_set_commit(struct region_set *set);

/* Return false if there is nothing to undo or redo. */
bool region_set_undo(struct region_set *set);
bool region_set_redo(struct region_set *set);
/* Forgets all steps: the region as it is now is where undoing ends. */
void region_set_forget(struct region_set *set);

/* Adds the triangles that share a vertex with one of the region, or takes away those that share one
 * with a triangle outside. Each is a change of its own. -ENOMEM. */
must_check int region_set_grow(struct region_set *set, const struct mesh *mesh);
must_check int region_set_shrink(struct region_set *set, const struct mesh *mesh);

/* Gets the faces of one scan of the mesh that the region's triangles come from. out->count is 0 if
 * there are none, or if the scan's faces have no numbers. The caller finishes *out
 * (face_list_finish). -ENOMEM. */
must_check int region_set_faces(struct face_list *out, const struct region_set *set,
				const struct mesh *mesh, uint32_t scan);

#endif
