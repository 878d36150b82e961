/* A scan on the one lattice of its model: what partition, simplification and patches work on.
 * Positions are lattice steps (0..65535 an axis), so that "the same place" is equality of bits. */
#ifndef GOPURA_PIPELINE_HIERARCHY_LATTICE_MESH_H
#define GOPURA_PIPELINE_HIERARCHY_LATTICE_MESH_H

#include <stdint.h>

#include "format/root_page.h"
#include "pipeline/import/mesh.h"

struct lattice_vertex {
	uint16_t position[3];
	uint8_t border;    /* 1: on an open edge of the scan */
	uint8_t colour[4]; /* sRGB, open sky */
	uint8_t seen;      /* 0: never; 255 until exposure_find (pipeline/hierarchy/exposure.h) */
	float normal[3];   /* unit, weighted by area */
};

struct lattice_mesh {
	struct lattice lattice;
	float box_min_m[3], box_max_m[3];
	uint32_t vertex_count, triangle_count;
	struct lattice_vertex *vertices; /* owned; no two at one place, each is used */
	uint32_t (*triangles)[3];        /* owned; three places each, none twice */
};

/* What was repaired or tolerated on the way. */
struct lattice_counts {
	uint32_t merged_vertices;      /* lay at the place of another */
	uint32_t degenerate_triangles; /* dropped: fewer than three places */
	uint32_t duplicate_triangles;  /* dropped: the same three places in the same order */
	uint32_t border_edges;         /* with a triangle on one side only */
	uint32_t crowded_edges;        /* with more than two triangles; kept */
};

/* colour is for scans that have none. -EINVAL: no triangle is left, a position is not a number, or
 * a triangle names a vertex that is not there. -ENOMEM. On failure *out is zeroed. */
must_check int lattice_mesh_create(struct lattice_mesh *out, struct lattice_counts *counts,
				   const struct mesh *mesh, const uint8_t colour[3]);
void lattice_mesh_finish(struct lattice_mesh *mesh); /* NULL is fine */

/* The triangles at each vertex: those of vertex v are items[first[v]] to items[first[v + 1] - 1],
 * ascending. Both owned by the caller (free). */
struct incidence {
	uint32_t *first, *items;
};

must_check int incidence_create(struct incidence *out, uint32_t (*triangles)[3],
				uint32_t triangle_count, uint32_t vertex_count);
void incidence_finish(struct incidence *incidence);

/* How many triangles run from a to b, and from b to a. */
void incidence_edge(uint32_t counts[2], const struct incidence *incidence, uint32_t (*triangles)[3],
		    uint32_t a, uint32_t b);

#endif
