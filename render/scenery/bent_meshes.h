/* The vertices of meshes that motions bend or colour, as they are at a moment. Meshes that are
 * stiff and keep their colours have none here and cost nothing. Pure: no GL. */
#ifndef GOPURA_RENDER_SCENERY_BENT_MESHES_H
#define GOPURA_RENDER_SCENERY_BENT_MESHES_H

#include "format/scenery.h"

/* What motions did to the meshes of a node. Zeroed: nothing. */
struct bend_look {
	bool has_colour, has_glow, has_shape; /* else as the mesh and its material have it */
	float colour[3], glow[3];             /* sRGB, 0 to 1 */
	float shape;                          /* as SCENERY_SHAPE */
};

struct bend_mesh {
	struct scenery_vertex *vertices; /* owned; NULL: those of the scenery never change */
	struct bend_look look;           /* that they have */
	uint32_t version;                /* grows with each change */
	bool glows;                      /* some motion makes it glow */
};

struct bend {
	struct bend_mesh *meshes; /* owned; as many as the scenery has */
	uint32_t count;
};

/* Copies the vertices that may change. -ENOMEM; *bend is then good for bend_finish. */
must_check int bend_init(struct bend *bend, const struct scenery *scenery);
void bend_finish(struct bend *bend); /* zeroed is fine */

/* Gives all meshes the looks of their nodes, one look for each node. */
void bend_update(struct bend *bend, const struct scenery *scenery, const struct bend_look *looks);
/* Returns the vertices of a mesh; borrowed until the next update. */
const struct scenery_vertex *bend_vertices(const struct bend *bend, const struct scenery *scenery,
					   uint32_t mesh);

#endif
