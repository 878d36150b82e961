/* Makes meshes of the triangles that hang on a node of scenery. Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_SCENERY_MESH_H
#define GOPURA_PIPELINE_SCENE_SCENERY_MESH_H

#include "format/scenery.h"
#include "pipeline/scene/soup.h"

struct scenery_corner {
	float position[3], normal[3], uv[2];
	uint8_t rgb[3];
	bool has_normal; /* of the file, which stays */
};

struct scenery_sheet {
	uint32_t node, material;
	bool has_picture;                      /* of its material: uv counts */
	struct scenery_corner (*triangles)[3]; /* owned */
	uint32_t count, room;
};

/* Sets the normals of corners that have none: smooth where faces meet at no more than crease_rad.
 * -ENOMEM. */
must_check int scenery_smooth(struct scenery_corner (*triangles)[3], uint32_t count,
			      float crease_rad);
/* Adds triangles, with the normals of the file, or normals that are smooth where faces meet at no
 * more than crease_rad. Triangles without an area are left out. -EFBIG, -ENOMEM. */
must_check int scenery_sheet_add(struct scenery_sheet *sheet, const struct soup_triangle *triangles,
				 uint32_t count, float crease_rad);
/* Appends the sheet's meshes to out->meshes, as many as its vertices need; all have one lattice.
 * -EFBIG, -ENOMEM. */
must_check int scenery_sheet_meshes(const struct scenery_sheet *sheet, struct scenery *out,
				    uint32_t *mesh_room);
/* Sets where the pictures lie at a corner: from their left and their top. */
void scenery_uv(float out[2], const struct soup_corner *corner);
/* Sets a mesh's lattice of such places, to hold those from low to high. */
void scenery_uv_lattice(struct scenery_mesh *mesh, const float low[2], const float high[2]);
/* Sets a place in that lattice. */
void scenery_uv_encode(uint16_t out[2], const struct scenery_mesh *mesh, const float uv[2]);
void scenery_sheet_finish(struct scenery_sheet *sheet); /* frees the triangles */

#endif
