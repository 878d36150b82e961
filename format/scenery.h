/* Scenery: what stands beside a scan and is no part of it. A reconstructed roof, a door that opens
 * at a touch. One object of a release holds all of it: small meshes, the nodes that place them, the
 * motions that move nodes, and layers, of which a visitor sees one at a time. The form is the same
 * whichever file the scenery came from. docs/scenery.md describes the bytes. */
#ifndef GOPURA_FORMAT_SCENERY_H
#define GOPURA_FORMAT_SCENERY_H

#include <stdbool.h>

#include "base/bytes.h"

enum {
	SCENERY_NODES_MAX = 4096,
	SCENERY_DEPTH_MAX = 64, /* of nodes below each other */
	SCENERY_MESHES_MAX = 4096,
	SCENERY_MATERIALS_MAX = 256,
	SCENERY_TEXTURES_MAX = SCENERY_MATERIALS_MAX,
	SCENERY_TEXTURE_PX_MAX = 2048, /* a side of a picture */
	SCENERY_TEXELS_MAX = 1 << 22,  /* pixels of all pictures */
	SCENERY_SUBSTANCES = 5, /* as many as enum substance_kind of geometry/substance.h has */
	SCENERY_VERTICES_MAX = 65535,          /* of a mesh */
	SCENERY_TRIANGLES_MAX = 1 << 18,       /* of a mesh */
	SCENERY_ALL_TRIANGLES_MAX = 1 << 19,   /* of all meshes */
	SCENERY_CLEAR_TRIANGLES_MAX = 1 << 14, /* of all with an opacity below 1: they are sorted */
	SCENERY_MOTIONS_MAX = 256,
	SCENERY_TOUCHES_MAX = 1024,
	SCENERY_TRACKS_MAX = 1024,            /* of all motions */
	SCENERY_NUMBERS_MAX = 1 << 20,        /* of all tracks */
	SCENERY_SHAPES_MAX = 4096,            /* of a mesh */
	SCENERY_SHAPE_VERTICES_MAX = 1 << 20, /* in all shapes of all meshes */
	/* Of all meshes whose vertices motions change: so many are changed for a frame at most. */
	SCENERY_BENT_VERTICES_MAX = 1 << 17,
	SCENERY_DRAGS_MAX = 256,
	SCENERY_LAYERS_MAX = 8,
	SCENERY_TITLES_MAX = 512,    /* of all layers */
	SCENERY_LANGUAGE_BYTES = 12, /* with the final zero; so is the next */
	SCENERY_TITLE_BYTES = 128,
};

#define SCENERY_NONE      UINT32_MAX
#define SCENERY_PLACE_MAX 65535

/* Where a node puts what is below it, as VRML97 6.52 has it: a point is moved by -centre, turned by
 * -stretch, scaled, turned by stretch, turned, moved by centre, moved. glTF's nodes have no centre
 * and no stretch. */
struct scenery_place {
	float move_m[3];
	float turn[4]; /* unit quaternion x y z w; stretch too */
	float scale[3];
	float centre_m[3];
	float stretch[4]; /* axes of the scale */
};

/* A node's sight: what the place of the eye does to it. */
enum scenery_sight_kind {
	SCENERY_SIGHT_NONE,
	SCENERY_SIGHT_FACES, /* z of the node turns towards the eye: VRML97's Billboard */
	SCENERY_SIGHT_LEVEL, /* it is seen from some distances alone: a level of VRML97's LOD */
	SCENERY_SIGHT_KINDS
};

/* Its numbers are in the node's own coordinates, as its place sets them. */
struct scenery_sight {
	enum scenery_sight_kind kind;
	/* Faces: the axis that it turns about, a unit vector; 0 0 0: its z points at the eye, and
	 * its y up in the picture. Level: from where the distance is measured. */
	float at[3];
	/* Level: seen while the eye is at least `from` and less than `to` away; `to` may be
	 * infinite. Else 0. */
	float from, to;
};

struct scenery_node {
	uint32_t parent; /* a node before this one, or SCENERY_NONE */
	/* Of a node without parent: its layer, or SCENERY_NONE, which is always shown. All others
	 * are in the layer of their parent and have SCENERY_NONE here. */
	uint32_t layer;
	struct scenery_place place;
	struct scenery_sight sight;
};

/* What light does on a surface; geometry/appearance.h has the formulas. Zeroed, with an opacity of
 * 1, is dull, with the colours of the vertices. */
struct scenery_material {
	bool has_two_sides; /* its back is seen too; else it is left out */
	/* Light is computed at each pixel (Phong); else at the vertices (Gouraud), which is flat
	 * where each face has normals of its own. */
	bool by_pixel;
	float opacity;       /* above 0; below 1 shows what is behind */
	uint8_t emissive[3]; /* sRGB; added to the colour, whatever the light */
	uint8_t specular[3]; /* sRGB; of the highlight of the sun */
	float shininess;     /* 1 to 128: exponent of the highlight, if specular is not black */
	/* The next five need by_pixel. */
	uint16_t texture; /* 1 + index of a picture, by which the colours are multiplied; 0: none */
	/* 1 + index of a normal map: a picture whose red, green and blue, 0 to 1, are the normal
	 * along the picture's right, its top and the mesh's own normal, -1 to 1; 0: none */
	uint16_t normals;
	uint8_t substance; /* enum substance_kind: its pattern is on the colours; 0: none */
	/* Up to 0.1: how deep the dark places of the substance lie below the light ones; without a
	 * substance, the hollows of hewn stone. */
	float relief_m;
	float mirror;   /* 0 to 1: share of what is around it in its colour */
	float grain[3]; /* unit vector in the node: the substance's axis, as that of a tree */
};

/* A picture on surfaces. */
struct scenery_texture {
	uint16_t width, height; /* powers of two */
	bool repeats;           /* else its outermost pixels go on beyond its sides */
	uint32_t jpeg_bytes;
	uint8_t *jpeg; /* owned: its file */
	uint8_t *rgba; /* owned: 4 bytes a pixel, row 0 on top; NULL: not decoded */
};

/* What is far away fades into a colour, the scan too. */
struct scenery_fog {
	float range_m; /* nothing is seen beyond; 0: there is no fog */
	bool is_exponential;
	uint8_t rgb[3]; /* sRGB */
	uint32_t layer; /* with which it is seen, or SCENERY_NONE: always */
};

struct scenery_vertex {
	uint16_t place[3]; /* metres in the node = origin_m + step_m * place */
	int8_t normal[2];  /* format/normal.h */
	uint8_t rgb[3];    /* sRGB */
};

/* A vertex of a shape: where it is, and its normal, instead of those of the mesh. */
struct scenery_shape_vertex {
	uint16_t place[3]; /* these two as in struct scenery_vertex */
	int8_t normal[2];
};

struct scenery_mesh {
	uint32_t node;
	float origin_m[3], step_m;
	uint32_t material;
	uint32_t vertex_count, triangle_count;
	struct scenery_vertex *vertices; /* owned */
	uint16_t (*triangles)[3];        /* owned; counter-clockwise seen from outside */
	/* Of each vertex where the pictures of the material lie: a place from its left and from its
	 * top, each 1 wide = uv_origin + uv_step * uvs. Owned; NULL: the material has none. */
	uint16_t (*uvs)[2];
	float uv_origin[2], uv_step[2];
	/* What SCENERY_SHAPE of its node chooses from; 0: it is stiff. Each has all vertices. */
	uint32_t shape_count;
	struct scenery_shape_vertex *shapes; /* owned; shape by shape */
};

/* What a track sets, and the numbers of one key. */
enum scenery_target {
	SCENERY_MOVE,    /* 3: move_m */
	SCENERY_TURN,    /* 4: turn */
	SCENERY_SCALE,   /* 3: scale */
	SCENERY_OPACITY, /* 1: 0 is invisible, 1 solid; for the node and all below */
	/* The next ones are for the meshes of the node itself, and not for those below. */
	SCENERY_COLOUR, /* 3: of all vertices; sRGB, 0 to 1 */
	SCENERY_GLOW,   /* 3: instead of the material's emissive; sRGB, 0 to 1 */
	/* 1: 0 is the first shape, 1 the second, 1.5 the middle between the second and the third;
	 * beyond the last one it is the last one */
	SCENERY_SHAPE,
	SCENERY_TARGETS
};

/* The values of one node over a motion. Between two keys, numbers change evenly. */
struct scenery_track {
	uint32_t node;
	enum scenery_target target;
	uint32_t key_count; /* at least 1 */
	/* Index into numbers: first the times of the keys as shares of the motion, ascending from
	 * 0 to 1, then their values. */
	uint32_t first;
};

/* A motion that no touch starts runs always. Its tracks set their nodes while it runs; after it,
 * they stay as it left them. */
struct scenery_motion {
	float duration_s; /* above 0, at most an hour */
	bool loops;       /* begins again, until it is touched again; so does what runs always */
	bool returns;     /* a touch after its end runs it backwards, and the next one forwards */
	uint32_t first_track, track_count; /* at least 1 */
};

/* A touch on a mesh of the node, or below it, starts the motion. */
struct scenery_touch {
	uint32_t node, motion;
};

/* What a finger moves as long as it holds it: VRML97's PlaneSensor, CylinderSensor, SphereSensor.
 */
enum scenery_drag_kind {
	SCENERY_DRAG_PLANE,    /* sets move_m, along x and y of the handle */
	SCENERY_DRAG_CYLINDER, /* sets turn, about y of the handle */
	SCENERY_DRAG_SPHERE,   /* sets turn, about the handle's origin */
	SCENERY_DRAG_KINDS
};

struct scenery_drag {
	uint32_t handle; /* a finger that drags a mesh of this node, or below it, holds it */
	uint32_t node;   /* what it moves: a node below the handle, or another one */
	enum scenery_drag_kind kind;
	/* The next drag goes on where this one ended; else each begins at the offset. */
	bool keeps;
	/* Before the first drag. Plane: metres along x, y and z; cylinder: radians in [0]; sphere:
	 * a unit quaternion. */
	float offset[4];
	/* Plane: metres along x and y; cylinder: radians in [0]. Where low is above high there is
	 * no limit. */
	float low[2], high[2];
	/* Cylinder: looked at along its axis, within this angle in radians, it is turned as a disc;
	 * else as a roller. 0 to pi / 2. */
	float disc_rad;
};

struct scenery_title {
	char language[SCENERY_LANGUAGE_BYTES]; /* as in temple.ini */
	char text[SCENERY_TITLE_BYTES];        /* UTF-8 */
};

/* One of several states of the site. The first is shown until a visitor chooses another. */
struct scenery_layer {
	uint32_t first_title, title_count; /* at least 1; the first is in the default language */
};

/* The arrays are owned. Zeroed is no scenery. */
struct scenery {
	uint32_t node_count, mesh_count, motion_count, touch_count, track_count, number_count;
	uint32_t layer_count; /* 0, or at least 2 */
	uint32_t title_count, material_count, texture_count, drag_count;
	struct scenery_node *nodes;
	struct scenery_material *materials;
	struct scenery_texture *textures;
	struct scenery_mesh *meshes;
	struct scenery_motion *motions;
	struct scenery_touch *touches;
	struct scenery_drag *drags;
	struct scenery_track *tracks; /* motion by motion */
	float *numbers;               /* track by track */
	struct scenery_layer *layers;
	struct scenery_title *titles; /* layer by layer */
	struct scenery_fog fog;
};

/* Returns whether the material has a picture or a normal map, so that its meshes have uvs. */
bool scenery_is_painted(const struct scenery_material *material);
/* Returns how many numbers a key of the target has. */
uint32_t scenery_width(enum scenery_target target);
/* Returns whether the scenery keeps all rules of this header. */
bool scenery_is_sane(const struct scenery *scenery);
/* Returns whether a track of some motion sets the target for a node. */
bool scenery_sets(const struct scenery *scenery, uint32_t node, enum scenery_target target);
/* Returns whether no more vertices change, and no more are in shapes, than may. */
bool scenery_bends_fit(const struct scenery *scenery);
/* Returns the pixels of all pictures. */
uint32_t scenery_texels(const struct scenery *scenery);
/* Returns the triangles of all meshes. */
uint32_t scenery_triangles(const struct scenery *scenery);

void scenery_finish(struct scenery *scenery); /* NULL and zeroed are fine */

#endif
