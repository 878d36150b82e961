/* The surface in one node of a cut through the octree, as closed polygons, without holes towards
 * neighbours of half its size (paper P1, section 5.3).
 *
 * The paper moves the points of a finer neighbour onto the edges of the coarse one, which leaves
 * vertices on the middle of edges. Here the coarse node takes over the finer crossings on a shared
 * face or edge instead, so that both sides have the same edges, and every edge two triangles. No
 * point is computed: only numbers of vertices are compared. */
#ifndef GOPURA_PIPELINE_OCTREE_LOD_POLYGON_H
#define GOPURA_PIPELINE_OCTREE_LOD_POLYGON_H

#include "pipeline/octree/lod_tree.h"

enum { LOD_SEGMENTS_MAX = 64 };

/* The polygons of a node: each begins after the end of the one before. */
struct lod_polygons {
	uint32_t count;
	uint8_t ends[LOD_SEGMENTS_MAX / 3 + 1]; /* after the last corner of each */
	uint32_t corners[LOD_SEGMENTS_MAX];     /* vertices, counter-clockwise seen from outside */
	uint8_t faces[LOD_SEGMENTS_MAX]; /* faces of the node on which each lies, a bit each */
};

/* Finds the polygons of a node at a time: once that many nodes of the LOD array were opened, it
 * itself not, its parent among them. */
void lod_polygons_find(struct lod_polygons *out, const struct lod_tree *tree,
		       const struct lod_node *node, uint32_t opened);
/* Returns the number of triangles of all polygons, each cut as below. */
uint32_t lod_polygons_triangles(const struct lod_polygons *polygons);

/* Cuts polygon i into triangles with no diagonal that another node may have too. triangles has room
 * for LOD_SEGMENTS_MAX; they are positions in polygons->corners. Returns their number; 0: there is
 * no such way, so it must be cut from a point in its middle, into as many triangles as corners. */
uint32_t lod_polygon_cut(uint8_t (*triangles)[3], const struct lod_polygons *polygons, uint32_t i);

#endif
