/* A bounding volume hierarchy (BVH) over the triangles of a patch. It answers ray queries (picking,
 * collision, which sampling point sees what) and divides the patch into the pieces that are drawn.
 * No GL and no global state; it is built on a worker thread.
 *
 * Building sorts the triangles so that every node, and so every piece, is a contiguous range of the
 * index buffer. The GPU and the ray queries therefore share one buffer. */
#ifndef GOPURA_GEOMETRY_PATCH_BVH_H
#define GOPURA_GEOMETRY_PATCH_BVH_H

#include <stdbool.h>

#include "format/patch.h"
#include "format/root_page.h"

enum {
	/* A piece is small enough that one choice of samples suits all of it: at most
	 * PIECE_TRIANGLES_MAX triangles. A piece that bends is split further, down to
	 * PIECE_TRIANGLES_BENT. A piece wider than 1 / PIECES_ACROSS of the lattice, which is as
	 * wide as the model, is split down to PIECE_TRIANGLES_MIN. */
	PIECE_TRIANGLES_MAX = 256,
	PIECE_TRIANGLES_BENT = 96,
	PIECE_TRIANGLES_MIN = 32,
	PIECES_ACROSS = 8,
	PIECE_PROBES = 8
};

/* A contiguous range of a patch's triangles that is drawn with one choice of samples. */
struct piece {
	uint32_t first_triangle, triangle_count;
	float centre_m[3], radius_m;
	float normal[3]; /* mean of the faces, unit length */
	/* length of the mean of its unit normals: 1 flat, 0 facing all directions */
	float flatness;
	float spacing_m;      /* mean distance between neighbouring vertices */
	float extent_m[6][3]; /* its vertices farthest along -x, +x, -y, +y, -z, +z */
};

/* A point on the surface of a piece, with the normal there. */
struct piece_probe {
	float at_m[3], normal[3];
};

/* Kept small: about one node exists for every three triangles in memory. */
struct patch_bvh_node {
	uint16_t low[3], high[3]; /* bounding box, in units of 2^box_shift steps from the base */
	/* range of triangles; the children of an inner node are node + 1 and right */
	uint16_t first, count;
	uint16_t right; /* index of the right child; 0: a leaf */
};

struct patch_bvh {
	struct patch_bvh_node *nodes; /* owned */
	uint32_t node_count;
	struct piece *pieces; /* owned */
	uint32_t piece_count;
	int32_t base[3]; /* a place of the lattice; all 0 unless the site is large */
	/* Owned; lattice steps from the base. One of the two is NULL: wide is only for a patch that
	 * is wider than 65535 steps. */
	uint16_t (*positions)[3];
	float (*wide)[3];
	uint8_t box_shift;
	uint32_t vertex_count;
	const uint16_t *indices; /* borrowed from the mesh, which must outlive the BVH */
	/* owned; the number each triangle had in the mesh before sorting */
	uint16_t *order;
	struct lattice lattice;
};

/* Builds the BVH and reorders the mesh's triangles; a patch has at most PATCH_TRIANGLES_MAX. The
 * caller finishes *out. Returns 0 or -ENOMEM. */
must_check int patch_bvh_init(struct patch_bvh *out, struct patch_mesh *mesh,
			      const struct lattice *lattice);
/* Frees what patch_bvh_init allocated; a BVH of zero bytes is fine. */
void patch_bvh_finish(struct patch_bvh *bvh);
/* Sets out to the position of a vertex, in lattice steps from the base: whole numbers. */
static inline void patch_bvh_corner(const struct patch_bvh *bvh, uint32_t vertex, float out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = bvh->wide ? bvh->wide[vertex][i] : (float)bvh->positions[vertex][i];
}
/* Returns the memory it holds, in bytes. */
size_t patch_bvh_bytes(const struct patch_bvh *bvh);

/* Returns one of PIECE_PROBES points spread over a piece; probe is 0 to PIECE_PROBES - 1. */
struct piece_probe patch_bvh_probe(const struct patch_bvh *bvh, const struct piece *piece,
				   int probe);

/* Where a ray hit a triangle: at (1 - u - v) a + u b + v c, with corners a, b and c. */
struct patch_bvh_hit {
	uint32_t triangle;
	float u, v;
};

/* Finds the nearest hit farther than least_m and nearer than *distance_m along the direction (a
 * unit vector); both sides of a triangle count. On a hit it returns true, sets *distance_m to the
 * distance and fills *hit (which may be NULL). */
bool patch_bvh_ray(const struct patch_bvh *bvh, const float from_m[3], const float direction[3],
		   float least_m, float *distance_m, struct patch_bvh_hit *hit);
/* Returns whether anything is hit before most_m metres. */
bool patch_bvh_blocks(const struct patch_bvh *bvh, const float from_m[3], const float direction[3],
		      float most_m);
/* Returns whether the ray hits the sphere before most_m metres. */
bool ray_meets_sphere(const float from_m[3], const float direction[3], float most_m,
		      const float centre_m[3], float radius_m);

#endif
