/* A mesh as the import produces it: metres, z up, counter-clockwise seen from outside. Its arrays
 * may be larger than memory (base/spill.h): whoever passes over them calls spill_pass for each
 * item. */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_H
#define GOPURA_PIPELINE_IMPORT_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"

enum { MESH_TEXTURES_MAX = UINT16_MAX, MESH_SCANS_MAX = 256 };

#define MESH_NO_FACE UINT32_MAX

/* sRGB, row 0 at the top, 3 bytes per pixel. A material without a picture is a texture of one
 * pixel. */
struct mesh_texture {
	uint32_t width, height;
	uint8_t *rgb; /* owned */
};

static inline bool mesh_texture_is_colour(const struct mesh_texture *texture)
{
	return texture->width == 1 && texture->height == 1;
}

/* One of the files that a mesh was made from. Its triangles follow those of the previous scan. */
struct mesh_scan {
	uint32_t triangle_count;
	uint32_t face_count; /* as counted in the file; 0: its faces have no numbers */
};

/* The arrays are owned, of spill_alloc or malloc; those of a mesh that was loaded are read only. */
struct mesh {
	uint32_t vertex_count, triangle_count;
	float (*positions)[3];
	uint8_t (*colours)[4]; /* sRGB and open sky (255: fully open); NULL: the scan has none */
	/* v = 0 at the bottom of the picture; NULL: no texture. A vertex with two texture
	 * coordinates is stored as two vertices. */
	float (*uvs)[2];
	uint32_t (*triangles)[3];
	uint16_t *materials; /* texture index of each triangle; NULL: no texture */
	uint32_t texture_count;
	struct mesh_texture *textures;
	/* for each triangle, the number of its face in its scan's file, from 0, or MESH_NO_FACE;
	 * NULL: no scan has face numbers */
	uint32_t *faces;
	uint32_t scan_count; /* 0: the mesh does not come from files */
	struct mesh_scan scans[MESH_SCANS_MAX];
};

/* Frees everything the mesh owns and zeroes it. NULL is fine. */
void mesh_finish(struct mesh *mesh);

/* Computes the bounding box of all vertices; zeros for an empty mesh. */
void mesh_box(const struct mesh *mesh, float low[3], float high[3]);

/* Appends a copy of other, which is unchanged. The arrays of mesh must be writable. What one of the
 * two lacks is filled in: white colours; uvs of 0 on a texture of one pixel in the colour of its
 * first vertex; no face numbers. -ENOMEM. -EFBIG: beyond 32-bit counts, MESH_TEXTURES_MAX or
 * MESH_SCANS_MAX. On failure mesh may have lost its colours or textures and is only to be finished.
 */
must_check int mesh_append(struct mesh *mesh, const struct mesh *other);

/* Reads the colour of the texture at uv: nearest pixel, repeating. */
void mesh_texel(const struct mesh_texture *texture, const float uv[2], uint8_t rgb[3]);

#endif
