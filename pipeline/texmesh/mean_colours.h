/* The colours of the vertices that are left of a scan. */
#ifndef GOPURA_PIPELINE_TEXMESH_MEAN_COLOURS_H
#define GOPURA_PIPELINE_TEXMESH_MEAN_COLOURS_H

#include "pipeline/texmesh/reduced_mesh.h"

/* Gives each vertex of *reduced, which was made of whole, the mean of the light of those vertices
 * of whole that are nearest to it along the surface, by the area around each. Both have colours.
 * -ENOMEM: *reduced is as it was. */
must_check int mean_colours(struct reduced_mesh *reduced, const struct reduced_mesh *whole);

#endif
