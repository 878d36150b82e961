/* A mesh cut into chunks of triangles that are close in space. A chunk is drawn, culled and summed
 * as one. Indices have 16 bits (GLES2 promises no more), so each chunk has its own vertices. */
#ifndef GOPURA_PIPELINE_SAMPLES_CHUNKS_H
#define GOPURA_PIPELINE_SAMPLES_CHUNKS_H

#include "pipeline/import/mesh.h"

enum { CHUNK_TRIANGLES_MAX = 4096 };

/* As uploaded: 20 bytes. */
struct chunk_vertex {
	float position_m[3];
	int8_t normal[4];  /* unit vector times 127; area-weighted mean of the adjacent triangles */
	uint8_t colour[4]; /* sRGB; [3] is the share of open sky */
};

struct chunk {
	uint32_t first_vertex, vertex_count;
	uint32_t first_index, index_count; /* 3 per triangle, relative to first_vertex */
	uint16_t texture;                  /* index into the mesh's textures */
	float low_m[3], high_m[3];
	/* For the winding number at a distance: the sum of the triangles' areas times their
	 * normals, the area-weighted centre, and the radius around it. */
	float area_m2[3], middle_m[3], radius_m;
};

struct chunks {
	uint32_t count, vertex_count, index_count;
	struct chunk *items;
	struct chunk_vertex *vertices;
	float (*uvs)[2]; /* NULL: the mesh has no texture coordinates */
	uint16_t *indices;
	float low_m[3], high_m[3]; /* bounding box of all chunks */
};

/* Cuts a mesh into chunks. *out owns its arrays: end it with chunks_finish(); zeroed on failure.
 * colour is the sRGB colour of a mesh without colours. The mesh is not needed afterwards. Returns
 * -ENOMEM, or -EINVAL if the mesh has no triangle. */
must_check int chunks_init(struct chunks *out, const struct mesh *mesh, const uint8_t colour[3]);
void chunks_finish(struct chunks *chunks); /* NULL and zeroed are fine */

/* Returns the generalised winding number of a point (Jacobson et al. 2013; distant chunks are
 * dipoles, as in Barill et al. 2018). It is about 0 outside, 1 inside, and more where pieces
 * overlap. It stays meaningful for open and self-intersecting scans. */
double chunks_winding(const struct chunks *chunks, const float point_m[3]);

#endif
