/* How scenery stands at a moment: which motions run, where each node is, also for the eye, and
 * which layer and levels are seen. Pure: no GL, no clock. */
#ifndef GOPURA_RENDER_SCENERY_POSE_H
#define GOPURA_RENDER_SCENERY_POSE_H

#include "format/scenery.h"
#include "render/scenery/bent_meshes.h"
#include "render/scenery/drag.h"

struct pose_node {
	float matrix[16]; /* column-major; from the node to metres of the model */
	/* Drawn in the pixels whose fixed number lies in this range of 0 to 1 (struct
	 * dissolve_range); layers that dissolve into each other share it. */
	float low, high;
};

struct pose_motion {
	float share; /* of its time, 0 to 1 */
	bool runs, is_backwards;
};

struct pose {
	const struct scenery *scenery; /* borrowed */
	struct pose_node *nodes;       /* this and the next five are owned */
	struct scenery_place *places;
	float *opacity;
	struct pose_motion *motions;
	struct bend_look *looks; /* of the meshes of each node */
	struct drag *drags;
	struct bend bend; /* owned */
	uint32_t held;    /* the handle that a finger drags; SCENERY_NONE: none */
	bool was_set;     /* by a finger or a reset, since the last step */
	uint32_t layer;   /* the chosen one */
	float layer_shares[SCENERY_LAYERS_MAX]; /* their sum is 1 */
	float appeared;                         /* all of it, 0 to 1 */
	float eye_m[3], up[3];                  /* as pose_look has them; zero before */
	bool has_sights;                        /* some node depends on them */
};

/* Stands as the content says, with the first layer; nothing has appeared yet. scenery is borrowed
 * for the lifetime. -ENOMEM; *pose is then zeroed. */
must_check int pose_init(struct pose *pose, const struct scenery *scenery);
void pose_finish(struct pose *pose); /* NULL and zeroed are fine */

/* Places nodes for an eye: where it is, and the direction that is up in its picture. Call it before
 * a picture is drawn; rays meet what was drawn last. */
void pose_look(struct pose *pose, const float eye_m[3], const float up[3]);
/* Lets time pass. Returns whether anything that is drawn changed. */
bool pose_step(struct pose *pose, float passed_ms);
/* Returns whether pose_step would change anything. */
bool pose_moves(const struct pose *pose);
/* A finger touched a mesh of that node. Starts or stops what the touch is for; returns whether it
 * is for anything. */
bool pose_touch(struct pose *pose, uint32_t node);
/* A finger begins to drag at a place on a mesh of that node, in metres of the model; direction: of
 * the ray from the eye to it. Returns whether something is held: the innermost node that is a
 * handle is. */
bool pose_grab(struct pose *pose, uint32_t node, const float point_m[3], const float direction[3]);
/* The finger is where this ray goes. Moves what is held. */
void pose_drag(struct pose *pose, const float from_m[3], const float direction[3]);
/* The finger is lifted, or has become one of two. Nothing held is fine. */
void pose_let_go(struct pose *pose);
/* Dissolves to a layer, less than layer_count. */
void pose_choose(struct pose *pose, uint32_t layer);
/* For the next visitor: doors close, what was dragged is where it was, and the first layer comes
 * back. */
void pose_reset(struct pose *pose);

/* Returns the material of a mesh with what motions did to it. */
struct scenery_material pose_material(const struct pose *pose, uint32_t mesh);
/* Sets out to the value of a track at a share of its motion; scenery_width() numbers. */
void pose_value(const struct scenery *scenery, const struct scenery_track *track, float share,
		float *out);
/* Sets out to the matrix of a place, from the node to its parent. */
void pose_matrix(float out[16], const struct scenery_place *place);

#endif
