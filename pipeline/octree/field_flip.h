/* Removes small bodies and small cavities of a closed surface from the field itself, by giving
 * their corners the other sign: so every later surface, and the octree, is without them. */
#ifndef GOPURA_PIPELINE_OCTREE_FIELD_FLIP_H
#define GOPURA_PIPELINE_OCTREE_FIELD_FLIP_H

#include "pipeline/import/mesh.h"
#include "pipeline/octree/corner_field.h"

/* mesh is the closed surface of the field. Flips the corners next to each part that has less than a
 * share of the triangles of the largest one; of a thick one, only its skin, so that it must be
 * called again with the new surface. *parts: how many there were. -ENOMEM, -ENOSPC, -EFBIG as
 * corner_field_add; the field is then only to be finished. */
must_check int field_flip_small(struct corner_field *field, const struct mesh *mesh, double share,
				uint32_t *parts);

#endif
