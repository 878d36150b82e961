/* How much of a surface can be seen from where an eye may be: what lies inside the stone needs few
 * triangles ("Visibility-guided simplification", Zhang and Turk 2002). */
#ifndef GOPURA_PIPELINE_HIERARCHY_EXPOSURE_H
#define GOPURA_PIPELINE_HIERARCHY_EXPOSURE_H

#include "pipeline/hierarchy/lattice_mesh.h"

/* Sets `seen` of every vertex: of viewpoints spread evenly over the box twice the model, above its
 * lowest point, those from which nothing hides the vertex, each weighted by the cosine at which it
 * looks at the surface; 255: a half and more. An estimate from eight viewpoints a vertex, and the
 * model as 256 voxels along its longest side. Up is +z. The result is the same for any number of
 * jobs. -ENOMEM. */
must_check int exposure_find(struct lattice_mesh *mesh, uint32_t jobs);

#endif
