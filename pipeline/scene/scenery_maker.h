/* Puts scenery together from whatever format: nodes, triangles, motions. Surfaces are gathered by
 * node and become meshes at the end. */
#ifndef GOPURA_PIPELINE_SCENE_SCENERY_MAKER_H
#define GOPURA_PIPELINE_SCENE_SCENERY_MAKER_H

#include "format/picture.h"
#include "format/scenery.h"
#include "geometry/substance.h"
#include "pipeline/scene/soup.h"

/* The triangles of a node that become meshes, and what a picture was made of. */
struct scenery_sheet;
struct scenery_source;

/* What the content adds to the materials of a file that are called so. */
struct scenery_look {
	const char *name; /* borrowed */
	enum substance_kind substance;
	float relief_m, mirror; /* as in struct scenery_material */
	bool is_used;           /* some material is called so */
};

/* Zeroed is empty. */
struct scenery_maker {
	struct scenery out; /* its meshes are made at the end */
	uint32_t node_room, motion_room, touch_room, track_room, number_room, mesh_room;
	uint32_t drag_room;
	uint32_t material_room, clear_count, texture_room;
	struct scenery_source *sources; /* owned; of each picture, as many as out has */
	uint32_t source_room;
	struct scenery_sheet *sheets; /* owned */
	uint32_t sheet_count, sheet_room, triangle_count;
	struct scenery_look *looks; /* borrowed; of the file that is being read */
	uint32_t look_count;
};

/* What lies on triangles by their uv; zeroed: nothing. */
struct scenery_paint {
	const struct picture *picture, *normals; /* borrowed; NULL: none. A normal map has x, y and
						  * z as red, green and blue */
};

/* A dull, solid surface with one side, in the colours of its corners. */
extern const struct scenery_material scenery_plain;
/* A place that changes nothing. */
extern const struct scenery_place scenery_at_rest;

/* All return 0, -EFBIG: past a limit of format/scenery.h, or -ENOMEM. */

must_check int scenery_add_node(struct scenery_maker *maker, const struct scenery_node *node,
				uint32_t *number);
/* Adds triangles in the node's metres. Equal materials are kept once. Corners keep the normals of
 * the file; of others, edges where faces meet at more than crease_rad stay sharp; across others
 * light is smooth. Equal pictures are kept once, as large as the budget of pixels allows. */
must_check int scenery_add_surface(struct scenery_maker *maker, uint32_t node,
				   const struct scenery_material *material,
				   const struct soup_triangle *triangles, uint32_t count,
				   float crease_rad, const struct scenery_paint *paint);
/* A surface that bends: where each of the file's points is in each shape, in the node's metres. */
struct scenery_bend {
	const float (*places)[3]; /* borrowed; shape by shape */
	uint32_t point_count, shape_count;
};

/* Adds triangles that bend, as one mesh of the node. soup has their corners at rest, in the node's
 * metres, and the numbers of their points. Normals are computed for each shape. */
must_check int scenery_add_bent(struct scenery_maker *maker, uint32_t node,
				const struct scenery_material *material, const struct soup *soup,
				float crease_rad, const struct scenery_paint *paint,
				const struct scenery_bend *bend);
/* Tracks follow that are added after it. */
must_check int scenery_add_motion(struct scenery_maker *maker, const struct scenery_motion *motion,
				  uint32_t *number);
/* Adds a track to the last motion; *values is set to room for key_count values, borrowed until the
 * next call. */
must_check int scenery_add_track(struct scenery_maker *maker, uint32_t node,
				 enum scenery_target target, const float *times, uint32_t key_count,
				 float **values);
must_check int scenery_add_touch(struct scenery_maker *maker, uint32_t node, uint32_t motion);
must_check int scenery_add_drag(struct scenery_maker *maker, const struct scenery_drag *drag);

/* A motion that ends elsewhere than it began would jump when it is touched again, and no format
 * says without a program that a door closes. So each motion from `first` on that is touched runs
 * backwards at the next touch, unless another motion is there for it. */
void scenery_find_returns(struct scenery_maker *maker, uint32_t first);

/* Makes the meshes; *out is the caller's, and the maker is empty. */
must_check int scenery_maker_end(struct scenery_maker *maker, struct scenery *out);
void scenery_maker_finish(struct scenery_maker *maker); /* NULL is fine */

#endif
