/* A mesh in memory as import gives it: metres, z up, counter-clockwise from outside. */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_H
#define GOPURA_PIPELINE_IMPORT_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"

enum { MESH_TEXTURES_MAX = UINT16_MAX, MESH_SCANS_MAX = 64 };

#define MESH_NO_FACE UINT32_MAX

/* sRGB, row 0 on top, 3 bytes a pixel. A material without a picture is a texture of one pixel. */
struct mesh_texture {
	uint32_t width, height;
	uint8_t *rgb; /* owned */
};

/* One of the files a mesh was made from; its triangles come after those of the one before. */
struct mesh_scan {
	uint32_t triangle_count;
	uint32_t face_count; /* as the file counts them; 0: its faces have no numbers */
};

struct mesh {
	uint32_t vertex_count, triangle_count;
	float (*positions)[3];
	uint8_t (*colours)[4]; /* sRGB and open sky (255: all); NULL: the scan has none */
	float (*uvs)[2];       /* v = 0 at the picture's bottom; NULL: no texture. A vertex with
				* two places in the picture is two vertices. */
	uint32_t (*triangles)[3];
	uint16_t *materials; /* index of the texture of each triangle; NULL: no texture */
	uint32_t texture_count;
	struct mesh_texture *textures;
	uint32_t *faces; /* of each triangle, the number of its face in its scan's file, from 0, or
			  * MESH_NO_FACE; NULL: no scan says */
	uint32_t scan_count; /* 0: not from files */
	struct mesh_scan scans[MESH_SCANS_MAX];
};

void mesh_finish(struct mesh *mesh); /* frees what it owns, zeroes; NULL is fine */

/* Of all vertices; zeros for an empty mesh. */
void mesh_box(const struct mesh *mesh, float low[3], float high[3]);

/* Behind what mesh holds; other is unchanged. What one of the two lacks is filled in: colours
 * white, uvs 0 on a texture of one pixel, in the colour of its first vertex, no face. -ENOMEM;
 * -EFBIG past 32-bit counts, MESH_TEXTURES_MAX or MESH_SCANS_MAX. On failure mesh is as it was.
 */
must_check int mesh_append(struct mesh *mesh, const struct mesh *other);

/* Colour of the texture at uv: nearest pixel, repeating. */
void mesh_texel(const struct mesh_texture *texture, const float uv[2], uint8_t rgb[3]);

#endif
