/* A mesh cut into chunks that lie together in space: what is drawn, culled and summed at once.
 * Indices are 16 bits (GLES2 promises no more), so a chunk has vertices of its own. */
#ifndef GOPURA_PIPELINE_SAMPLES_CHUNKS_H
#define GOPURA_PIPELINE_SAMPLES_CHUNKS_H

#include "pipeline/import/mesh.h"

enum { CHUNK_TRIANGLES_MAX = 4096 };

/* As uploaded: 20 bytes. */
struct chunk_vertex {
	float position_m[3];
	int8_t normal[4];  /* unit vector times 127; area-weighted mean of the triangles around */
	uint8_t colour[4]; /* sRGB and open sky */
};

struct chunk {
	uint32_t first_vertex, vertex_count;
	uint32_t first_index, index_count; /* 3 a triangle, relative to first_vertex */
	uint16_t texture;                  /* of the mesh */
	float low_m[3], high_m[3];
	/* For the winding number far away: sum of the triangles' areas times their normals, and the
	 * area-weighted middle. */
	float area_m2[3], middle_m[3], radius_m;
};

struct chunks {
	uint32_t count, vertex_count, index_count;
	struct chunk *items;
	struct chunk_vertex *vertices;
	float (*uvs)[2]; /* NULL: the mesh has none */
	uint16_t *indices;
	float low_m[3], high_m[3]; /* of all */
};

/* *out owns its arrays; zeroed on failure. colour: sRGB of a mesh without colours. The mesh may go
 * afterwards. -ENOMEM. -EINVAL: the mesh has no triangle. */
must_check int chunks_init(struct chunks *out, const struct mesh *mesh, const uint8_t colour[3]);
void chunks_finish(struct chunks *chunks); /* NULL and zeroed are fine */

/* The generalised winding number of a point (Jacobson et al. 2013, with the far field as dipoles
 * as Barill et al. 2018): about 0 outside, 1 inside, more where pieces overlap; stays meaningful
 * for open and self-intersecting scans. */
double chunks_winding(const struct chunks *chunks, const float point_m[3]);

#endif
