/* A roof in the second of two layers, and a door on a hinge that a touch opens: scenery for tests.
 * The roof may sag, and the door be dragged, where a test adds that. */
#ifndef GOPURA_TESTS_FORMAT_LITTLE_SCENERY_H
#define GOPURA_TESTS_FORMAT_LITTLE_SCENERY_H

#include <string.h>

#include "format/scenery.h"

struct little_scenery {
	struct scenery scenery;
	struct scenery_node nodes[3];
	struct scenery_material material;
	struct scenery_mesh meshes[2];
	struct scenery_vertex vertices[2][4];
	uint16_t triangles[2][2][3];
	struct scenery_motion motion;
	struct scenery_touch touch;
	struct scenery_drag drag;
	struct scenery_shape_vertex shapes[2][4];
	struct scenery_track tracks[2];
	float numbers[2 + 8 + 2 + 2];
	struct scenery_layer layers[2];
	struct scenery_title titles[3];
};

static inline struct scenery_node little_node(uint32_t parent, uint32_t layer)
{
	return (struct scenery_node){
		.parent = parent,
		.layer = layer,
		.place = { .turn = { 0, 0, 0, 1 }, .scale = { 1, 1, 1 }, .stretch = { 0, 0, 0, 1 } }
	};
}

/* The sheets are upright squares of a metre, in x and z, that look to -y. */
static inline void little_sheet(struct little_scenery *s, int mesh, uint32_t node)
{
	static const uint16_t corners[2][3] = { { 0, 1, 2 }, { 0, 2, 3 } };

	for (int v = 0; v < 4; v++)
		s->vertices[mesh][v] = (struct scenery_vertex){
			.place = { (uint16_t)(v == 1 || v == 2 ? 1000 : 0), 0,
				   (uint16_t)(v > 1 ? 1000 : 0) },
			.normal = { 0, -127 },
			.rgb = { 120, 80, 40 },
		};
	memcpy(s->triangles[mesh], corners, sizeof(corners));
	s->meshes[mesh] = (struct scenery_mesh){ .node = node,
						 .step_m = 0.001f,
						 .vertex_count = 4,
						 .triangle_count = 2,
						 .vertices = s->vertices[mesh],
						 .triangles = s->triangles[mesh] };
}

/* The door is node 1, in node 0 without a layer; it turns by 90 degrees about z at x = 0 within two
 * seconds, and pales by half. The roof is node 2. */
static inline void little_scenery_init(struct little_scenery *s)
{
	static const float numbers[] = { 0, 1,           0,           0, 0, 1, 0,
					 0, 0.70710678f, 0.70710678f, 0, 1, 1, 0.5f };
	*s = (struct little_scenery){
		.nodes = { little_node(SCENERY_NONE, SCENERY_NONE), little_node(0, SCENERY_NONE),
			   little_node(SCENERY_NONE, 1) },
		.material = { .has_two_sides = true, .opacity = 1, .grain = { 0, 0, 1 } },
		.motion = { .duration_s = 2, .returns = true, .track_count = 2 },
		.touch = { .node = 0, .motion = 0 },
		.tracks = { { .node = 1, .target = SCENERY_TURN, .key_count = 2 },
			    { .node = 1, .target = SCENERY_OPACITY, .key_count = 2, .first = 10 } },
		.layers = { { 0, 2 }, { 2, 1 } },
		.titles = { { "en", "As found" }, { "de", "Wie gefunden" }, { "en", "As built" } },
	};
	memcpy(s->numbers, numbers, sizeof(numbers));
	s->nodes[2].place.move_m[2] = 3;
	little_sheet(s, 0, 1);
	little_sheet(s, 1, 2);
	s->scenery = (struct scenery){ .node_count = 3,
				       .material_count = 1,
				       .mesh_count = 2,
				       .motion_count = 1,
				       .touch_count = 1,
				       .track_count = 2,
				       .number_count = 14,
				       .layer_count = 2,
				       .title_count = 3,
				       .nodes = s->nodes,
				       .materials = &s->material,
				       .meshes = s->meshes,
				       .motions = &s->motion,
				       .touches = &s->touch,
				       .drags = &s->drag,
				       .tracks = s->tracks,
				       .numbers = s->numbers,
				       .layers = s->layers,
				       .titles = s->titles,
				       .fog = { .layer = SCENERY_NONE } };
}

/* A finger slides the door by up to half a metre along its width. */
static inline void little_scenery_add_drag(struct little_scenery *s)
{
	s->drag = (struct scenery_drag){
		.handle = 0, .node = 1, .kind = SCENERY_DRAG_PLANE, .keeps = true, .high = { 0.5f }
	};
	s->scenery.drag_count = 1;
}

/* Two shapes of the roof: as it is, and lower by 200 lattice steps of y, with other normals. */
static inline void little_scenery_add_shapes(struct little_scenery *s)
{
	for (int shape = 0; shape < 2; shape++)
		for (int v = 0; v < 4; v++) {
			struct scenery_shape_vertex *to = &s->shapes[shape][v];

			memcpy(to->place, s->vertices[1][v].place, sizeof(to->place));
			memcpy(to->normal, s->vertices[1][v].normal, sizeof(to->normal));
			to->place[1] = (uint16_t)(to->place[1] + 200 * shape);
			to->normal[0] = (int8_t)(127 * shape);
			to->normal[1] = (int8_t)(-127 * (1 - shape));
		}
	s->meshes[1].shape_count = 2;
	s->meshes[1].shapes = s->shapes[0];
}

#endif
