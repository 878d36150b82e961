/* A patch as solid matter: a tree of boxes over its triangles, for rays (picking, collision, which
 * sampling point sees what), and the pieces it is drawn in. Pure; built on a worker.
 *
 * Building sorts the triangles so that every node, and so every piece, is a run of the index
 * buffer: one buffer serves GPU and rays. */
#ifndef GOPURA_GEOMETRY_PATCH_BVH_H
#define GOPURA_GEOMETRY_PATCH_BVH_H

#include <stdbool.h>

#include "format/patch.h"
#include "format/root_page.h"

enum {
	/* Small enough that one choice of samples suits all of it; a piece that bends is split
	 * further, down to the second number; one that is wide (in parts of the lattice, as wide as
	 * the model), down to the third. */
	PIECE_TRIANGLES_MAX = 256,
	PIECE_TRIANGLES_BENT = 96,
	PIECE_TRIANGLES_MIN = 32,
	PIECES_ACROSS = 8,
	PIECE_PROBES = 8
};

/* A run of a patch's triangles that is drawn with one choice of samples. */
struct piece {
	uint32_t first_triangle, triangle_count;
	float centre_m[3], radius_m;
	float normal[3];      /* mean, unit */
	float flatness;       /* length of the mean of its unit normals: 1 flat, 0 all around */
	float spacing_m;      /* mean distance of neighbouring vertices */
	float extent_m[6][3]; /* its vertices farthest along -x, +x, -y, +y, -z, +z */
};

/* A place of a piece's surface. */
struct piece_probe {
	float at_m[3], normal[3];
};

/* Small, as there is one for every three triangles that are held. */
struct patch_bvh_node {
	uint16_t low[3], high[3]; /* on the lattice */
	uint16_t first, count;    /* triangles; an inner node's children are node + 1 and right */
	uint16_t right;           /* 0: a leaf */
};

struct patch_bvh {
	struct patch_bvh_node *nodes; /* owned */
	uint32_t node_count;
	struct piece *pieces; /* owned */
	uint32_t piece_count;
	uint16_t (*positions)[3]; /* owned; on the lattice */
	uint32_t vertex_count;
	const uint16_t *indices; /* borrowed from the mesh, which must keep them */
	uint16_t *order;         /* owned; of each triangle, its number in the mesh as it came */
	struct lattice lattice;
};

/* Reorders the mesh's triangles, of which a patch has at most PATCH_TRIANGLES_MAX. *out is
 * finished by the caller. -ENOMEM. */
must_check int patch_bvh_init(struct patch_bvh *out, struct patch_mesh *mesh,
			      const struct lattice *lattice);
void patch_bvh_finish(struct patch_bvh *bvh);
/* Of memory it holds. */
size_t patch_bvh_bytes(const struct patch_bvh *bvh);

/* One of PIECE_PROBES places of a piece, spread over it. */
struct piece_probe patch_bvh_probe(const struct patch_bvh *bvh, const struct piece *piece,
				   int probe);

/* Where a triangle was met: at (1 - u - v) a + u b + v c. */
struct patch_bvh_hit {
	uint32_t triangle;
	float u, v;
};

/* Nearest hit between *distance_m and least_m along the (unit) direction, either side of a
 * triangle; then *distance_m becomes it, and *hit (may be NULL) says where. */
bool patch_bvh_ray(const struct patch_bvh *bvh, const float from_m[3], const float direction[3],
		   float least_m, float *distance_m, struct patch_bvh_hit *hit);
/* Whether anything is met before most_m. */
bool patch_bvh_blocks(const struct patch_bvh *bvh, const float from_m[3], const float direction[3],
		      float most_m);
/* Whether a ray meets the sphere before most_m. */
bool ray_meets_sphere(const float from_m[3], const float direction[3], float most_m,
		      const float centre_m[3], float radius_m);

#endif
