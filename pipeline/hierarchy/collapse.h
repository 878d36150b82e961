/* A surface whose edges are collapsed: vertices with their quadrics, triangles, the corners at each
 * vertex, and the checks that every simplifier makes before it collapses an edge (simplify.h,
 * simplify_features.h). Private to these. Lengths are in lattice steps. */
#ifndef GOPURA_PIPELINE_HIERARCHY_COLLAPSE_H
#define GOPURA_PIPELINE_HIERARCHY_COLLAPSE_H

#include <stdbool.h>

#include "pipeline/hierarchy/quadric.h"
#include "pipeline/hierarchy/simplify.h"

#define COLLAPSE_NONE UINT32_MAX

/* What is asked of a vertex, in two lines of the cache. */
struct collapse_node {
	struct quadric quadric;
	double at[3];      /* its position */
	double area;       /* to average normals and colours */
	double importance; /* of what is seen of it */
	uint32_t first;    /* its first corner, or COLLAPSE_NONE */
	uint32_t version;
	uint32_t mark;
	uint8_t locked, border;
};

/* Corner 4 t + i is corner i of triangle t. The corners at a vertex are a linked list. */
struct collapse_face {
	uint32_t corners[3];
	uint32_t next[3];
	bool dead;
};

struct collapse_mesh {
	struct simplify_surface *surface; /* borrowed */
	struct collapse_node *nodes;      /* owned; for each vertex */
	struct collapse_face *faces;      /* owned; for each triangle */
	uint32_t mark;                    /* the last that was given to a node */
	uint32_t alive_count;             /* triangles that are not dead */
};

static inline uint32_t *collapse_corners_of(const struct collapse_mesh *mesh, uint32_t corner)
{
	return mesh->faces[corner / 4].corners;
}

/* The corners of its triangle that follow a corner. */
static inline uint32_t collapse_after(const struct collapse_mesh *mesh, uint32_t corner)
{
	static const uint8_t next[4] = { 1, 2, 0, 0 };

	return collapse_corners_of(mesh, corner)[next[corner % 4]];
}

static inline uint32_t collapse_before(const struct collapse_mesh *mesh, uint32_t corner)
{
	static const uint8_t next[4] = { 2, 0, 1, 0 };

	return collapse_corners_of(mesh, corner)[next[corner % 4]];
}

static inline uint32_t *collapse_next_of(const struct collapse_mesh *mesh, uint32_t corner)
{
	return &mesh->faces[corner / 4].next[corner % 4];
}

/* Returns the next living corner at a vertex, and unlinks dead ones on the way. */
static inline uint32_t collapse_living(const struct collapse_mesh *mesh, uint32_t *link)
{
	while (*link != COLLAPSE_NONE && mesh->faces[*link / 4].dead)
		*link = *collapse_next_of(mesh, *link);
	return *link;
}

#define COLLAPSE_EACH_CORNER(mesh, vertex, corner)                                                 \
	for (uint32_t *link_##corner = &(mesh)->nodes[vertex].first, corner;                       \
	     (corner = collapse_living(mesh, link_##corner)) != COLLAPSE_NONE;                     \
	     link_##corner = collapse_next_of(mesh, corner))

static inline void collapse_cross(double out[3], const double a[3], const double b[3],
				  const double c[3])
{
	double u[3], v[3];

	for (int i = 0; i < 3; i++) {
		u[i] = b[i] - a[i];
		v[i] = c[i] - a[i];
	}
	for (int i = 0; i < 3; i++)
		out[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
}

static inline double collapse_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void collapse_cross_of_triangle(double out[3], const struct collapse_mesh *mesh,
					      const uint32_t corners[3])
{
	collapse_cross(out, mesh->nodes[corners[0]].at, mesh->nodes[corners[1]].at,
		       mesh->nodes[corners[2]].at);
}

/* Sets up nodes, quadrics and faces. Returns -ENOMEM; the mesh is then only to be finished. */
must_check int collapse_mesh_init(struct collapse_mesh *mesh, struct simplify_surface *surface);
void collapse_mesh_finish(struct collapse_mesh *mesh); /* zeroed is fine */
/* Moves the living triangles to the front of the surface. */
void collapse_mesh_give_back(const struct collapse_mesh *mesh);

/* Returns how much of a vertex is seen, as the weight of its errors. */
double collapse_importance(const struct lattice_vertex *vertex);
/* Counts the triangles at an edge; *forth is how many of them run from a to b. */
uint32_t collapse_triangles_at(struct collapse_mesh *mesh, uint32_t a, uint32_t b, uint32_t *forth);
/* Returns true if more triangles use the edge in one direction than in the other. */
bool collapse_edge_is_open(struct collapse_mesh *mesh, uint32_t a, uint32_t b);
/* Returns true if gone may be removed while keep stays: it is not locked, and open edges are only
 * shortened along themselves. open: of the edge between them. */
bool collapse_may_leave(const struct collapse_node *gone, const struct collapse_node *keep,
			bool open);
/* The link condition (Dey et al. 1999): the two ends have no common neighbours except those
 * opposite their edge. */
bool collapse_link_is_sound(struct collapse_mesh *mesh, uint32_t a, uint32_t b);
/* Returns true if a triangle at vertex would turn over when the vertex moves to at: if the cosine
 * between its normals before and after is at most cosine (0 or more), or if it turned its back to
 * where the scan faced. Those that the edge to other_end takes along do not count. */
bool collapse_folds(struct collapse_mesh *mesh, uint32_t vertex, uint32_t other_end,
		    const double at[3], double cosine);
/* Returns true if after the collapse of the edge between its vertex and other_end the triangle of a
 * corner would coincide with one of the other end, facing it. */
bool collapse_is_cancelled(struct collapse_mesh *mesh, uint32_t corner, uint32_t other_end);
/* Returns true if the collapse of an edge would leave no triangle. */
bool collapse_is_last(struct collapse_mesh *mesh, uint32_t a, uint32_t b);
/* Gives the corners of gone to keep, adds its quadric and area, and drops the triangles between the
 * two, and those that lie back to back afterwards: they enclose nothing. */
void collapse_join(struct collapse_mesh *mesh, uint32_t keep, uint32_t gone);

#endif
