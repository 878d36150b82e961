/* How much of a surface can be seen from possible camera positions. Surface inside the material
 * needs few triangles ("Visibility-guided simplification", Zhang and Turk 2002). */
#ifndef GOPURA_PIPELINE_HIERARCHY_EXPOSURE_H
#define GOPURA_PIPELINE_HIERARCHY_EXPOSURE_H

#include "pipeline/hierarchy/lattice_mesh.h"

/* Sets `seen` of every vertex. Viewpoints are spread evenly over a box of twice the model's size,
 * above its lowest point. `seen` is the share of viewpoints from which nothing hides the vertex,
 * each weighted by the cosine between view direction and normal; 255 means a half or more. It is an
 * estimate from eight viewpoints per vertex, with the model as 256 voxels along its longest side.
 * Up is +z. The result is the same for any number of jobs (threads). Returns -ENOMEM. */
must_check int exposure_find(struct lattice_mesh *mesh, uint32_t jobs);

#endif
