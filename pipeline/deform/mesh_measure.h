/* Measures a mesh before and after it is deformed. */
#ifndef GOPURA_PIPELINE_DEFORM_MESH_MEASURE_H
#define GOPURA_PIPELINE_DEFORM_MESH_MEASURE_H

#include "pipeline/import/mesh.h"

struct mesh_measure {
	float low[3], high[3];
	double area;   /* of all triangles */
	double volume; /* that they enclose; it means nothing where the mesh is open */
	uint32_t vertices, triangles;
	uint32_t border_edges; /* of one triangle only, by place; 0: the mesh is closed */
};

/* Units are the mesh's. jobs: number of threads; the result does not depend on it. -ENOMEM,
 * -ENOSPC. */
must_check int mesh_measure(struct mesh_measure *out, const struct mesh *mesh, uint32_t jobs);

#endif
