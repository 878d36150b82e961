/* A scan with fewer triangles that keeps its pictures: edges are collapsed by meshoptimizer in the
 * order of their quadric error. Every vertex that is left is one of the scan's, with its place and
 * its texture coordinates, and both sides of a seam between two charts lose the same ones, so that
 * no seam opens. */
#ifndef GOPURA_PIPELINE_TEXMESH_REDUCED_MESH_H
#define GOPURA_PIPELINE_TEXMESH_REDUCED_MESH_H

#include <stdbool.h>

#include "geometry/substance.h"
#include "pipeline/import/mesh.h"

/* Vertices belong to one material each. Arrays are owned. */
struct reduced_mesh {
	uint32_t vertex_count, triangle_count;
	float (*positions)[3]; /* metres, z up */
	float (*normals)[3];   /* unit vectors: means of the whole scan's triangles, by area */
	float (*uvs)[2];       /* as struct mesh has them; NULL: no textures */
	uint8_t (*colours)[4]; /* as struct mesh; NULL: textures, or one colour */
	uint32_t *origins;     /* of a mesh that was made: the vertex of the whole that each was */
	uint8_t colour[3];     /* that colour, sRGB; white: of a mesh without any */
	uint32_t (*triangles)[3];
	/* Texture of each vertex; NULL: no textures. Triangles are in the order of their textures:
	 * those of texture t are firsts[t] to firsts[t + 1] - 1. */
	uint16_t *materials;
	uint32_t material_count; /* 1 without textures */
	uint32_t *firsts;        /* material_count + 1 */
};

/* What a scan looks like. */
struct reduced_look {
	bool is_stone; /* of a substance, in place of its own pictures and colours */
	enum substance_kind substance; /* SUBSTANCE_NONE: the demo's stone */
};

/* Copies the whole scan, with that look: a substance gives each vertex a colour. *out is owned by
 * the caller (reduced_mesh_finish); zeroed on failure. Returns -ENOMEM, or -EFBIG for more than
 * 2^31 corners. */
must_check int reduced_mesh_copy(struct reduced_mesh *out, const struct mesh *mesh,
				 struct reduced_look look);
/* Makes *out of whole, which is a copy of the scan, with about as many triangles: more where seams
 * do not let go of them. Triangles and vertices are in an order that GPUs like. As above. */
must_check int reduced_mesh_make(struct reduced_mesh *out, const struct reduced_mesh *whole,
				 uint32_t triangle_count);
void reduced_mesh_finish(struct reduced_mesh *mesh); /* NULL and zeroed are fine */

#endif
