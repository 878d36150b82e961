/* How much of a surface can be seen from possible camera positions. Surface inside the material
 * needs few triangles ("Visibility-guided simplification", Zhang and Turk 2002).
 *
 * The model becomes 256 voxels along its longest side. Enclosed air counts as material. For each
 * voxel of air it is found, when first asked for, from which of its eight viewpoints it is seen;
 * vertices look up the voxel in front of them. Viewpoints are spread evenly over a box of twice the
 * model's size, above its lowest point; each voxel has others. Up is +z. */
#ifndef GOPURA_PIPELINE_HIERARCHY_EXPOSURE_H
#define GOPURA_PIPELINE_HIERARCHY_EXPOSURE_H

#include <stdint.h>

#include "base/compiler.h"

/* About 36 MiB at most, shared with processes that are forked later. */
struct exposure;

/* *out is owned by the caller; NULL on failure. Returns -ENOMEM. */
must_check int exposure_create(struct exposure **out);
void exposure_destroy(struct exposure *exposure); /* NULL is fine */

/* Marks the voxels of a triangle. Any thread and process; the order does not matter. */
void exposure_add(struct exposure *exposure, const uint16_t corners[3][3]);
/* To be called once, when all triangles are in. Returns -ENOMEM. */
must_check int exposure_close(struct exposure *exposure);

/* Returns the share of viewpoints from which nothing hides a vertex, each weighted by the cosine
 * between view direction and normal; 255 means a half or more. Both sides of the surface count,
 * because the orientation of scans is not always right. Any thread and process, after
 * exposure_close. */
uint8_t exposure_of(struct exposure *exposure, const uint16_t position[3], const float normal[3]);

#endif
