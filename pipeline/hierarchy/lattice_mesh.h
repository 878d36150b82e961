/* A scan on the single lattice of its model, the input of partition, simplification and patches.
 * Positions are places of the lattice, whole numbers, so that "the same place" means equal bits.
 * What only needs to be near (cells, voxels, centres) counts in coarse steps: 65536 along the
 * longest side, which are the lattice's own unless the site is large. */
#ifndef GOPURA_PIPELINE_HIERARCHY_LATTICE_MESH_H
#define GOPURA_PIPELINE_HIERARCHY_LATTICE_MESH_H

#include <stdint.h>

#include "base/bytes.h"
#include "base/map.h"
#include "format/root_page.h"
#include "pipeline/import/mesh.h"

struct lattice_vertex {
	int32_t position[3];
	uint8_t border;    /* 1: on an open edge of the scan */
	uint8_t colour[4]; /* sRGB; [3] is the share of open sky */
	uint8_t seen;      /* visibility, 0: never seen; set by exposure_find, 255 before */
	float normal[3];   /* unit vector, area-weighted mean of its triangles */
};

struct lattice_mesh {
	struct lattice lattice;
	uint32_t vertex_count, triangle_count;
	struct lattice_vertex *vertices; /* owned; no two at one place, all are used */
	uint32_t (*triangles)[3]; /* owned; three different vertices each, no two with the same */
};

/* What was repaired or tolerated in the scan. */
struct lattice_counts {
	uint32_t merged_vertices;      /* they lay at the place of another vertex */
	uint32_t degenerate_triangles; /* dropped: fewer than three places */
	uint32_t duplicate_triangles;  /* dropped: the same three places, on whichever side */
	uint32_t border_edges;  /* more triangles use them in one direction than in the other */
	uint32_t crowded_edges; /* used by more than two triangles; kept */
};

/* The largest step, unless options ask for another: scans of large sites keep a millimetre. */
#define LATTICE_STEP_MAX_M 0.001

/* Sets the lattice of a model with that bounding box: 65536 steps along its longest side, or that
 * times the smallest power of two with steps of at most step_max_m, but no more than
 * LATTICE_PLACES_MAX. Returns -EINVAL if the box has no extent. */
must_check int lattice_of_box(struct lattice *out, const float min_m[3], const float max_m[3],
			      double step_max_m);
/* Sets out to the nearest place of the lattice. */
void lattice_place(int32_t out[3], const struct lattice *lattice, const float at_m[3]);
/* Sets out to the coarse steps of a place. */
void lattice_coarse(uint16_t out[3], const struct lattice *lattice, const int32_t place[3]);
/* Returns the highest place on an axis. */
int32_t lattice_last(const struct lattice *lattice);
/* Returns a number that no other place has. Places in its order go along x first, then y, then z.
 */
map_key lattice_key(const int32_t place[3]);

/* Puts a mesh, or a part of one, on its lattice. Positions must be finite and indices in range.
 * colour is for scans without colours. Open edges are not known yet. Returns -EINVAL if no triangle
 * is left, or -ENOMEM. On failure *out is zeroed. */
must_check int lattice_mesh_create(struct lattice_mesh *out, struct lattice_counts *counts,
				   const struct mesh *mesh, const struct lattice *lattice,
				   const uint8_t colour[3]);
/* Finds the open edges, and sets `border` of their vertices. shared (may be NULL) is, for each
 * vertex, whether it may have triangles that are not in this mesh: an edge between two of them is
 * not judged. Returns -ENOMEM. */
must_check int lattice_mesh_find_borders(struct lattice_mesh *mesh, struct lattice_counts *counts,
					 const uint8_t *shared);
void lattice_mesh_finish(struct lattice_mesh *mesh); /* NULL is fine */

/* A vertex in the files of a build: LATTICE_VERTEX_BYTES. A failure is kept in out or reader. */
enum { LATTICE_VERTEX_BYTES = 30 };
void lattice_vertex_put(struct buffer *out, const struct lattice_vertex *vertex);
void lattice_vertex_get(struct lattice_vertex *out, struct reader *reader);

/* The triangles at each vertex: those of vertex v are items[first[v]] to items[first[v + 1] - 1],
 * ascending. Both owned by the caller (free). */
struct incidence {
	uint32_t *first, *items;
};

/* Indices must be in range. Returns -ENOMEM. */
must_check int incidence_create(struct incidence *out, uint32_t (*triangles)[3],
				uint32_t triangle_count, uint32_t vertex_count);
/* NULL and zeroed are fine. */
void incidence_finish(struct incidence *incidence);

/* Counts the triangles that have the edge from a to b (counts[0]) and from b to a (counts[1]). */
void incidence_edge(uint32_t counts[2], const struct incidence *incidence, uint32_t (*triangles)[3],
		    uint32_t a, uint32_t b);

#endif
