/* Runs motions, and places nodes by them. */
#include "render/scenery/pose.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/turn.h"
#include "geometry/vec.h"

static const float dissolve_ms = 900, appear_ms = 600;

/* ---- values */

void pose_value(const struct scenery *scenery, const struct scenery_track *track, float share,
		float *out)
{
	const uint32_t width = scenery_width(track->target);
	const float *times = &scenery->numbers[track->first];
	const float *values = times + track->key_count;
	uint32_t after = 0;
	float span, part;

	while (after < track->key_count && times[after] <= share)
		after++;
	if (after == 0 || after == track->key_count) {
		memcpy(out, &values[(after > 0 ? after - 1 : 0) * width], width * sizeof(*out));
		return;
	}
	span = times[after] - times[after - 1];
	part = span > 0 ? (share - times[after - 1]) / span : 1;
	if (track->target == SCENERY_TURN) {
		turn_between(out, &values[(after - 1) * 4], &values[after * 4], part);
		return;
	}
	for (uint32_t k = 0; k < width; k++) {
		const float from = values[(after - 1) * width + k], to = values[after * width + k];

		out[k] = from + part * (to - from);
	}
}

void pose_matrix(float out[16], const struct scenery_place *place)
{
	float turn[16] = { [15] = 1 }, stretch[16] = { [15] = 1 }, back[16] = { [15] = 1 };
	float scaled[16];
	const float *c = place->centre_m;

	turn_matrix(turn, place->turn);
	turn_matrix(stretch, place->stretch);
	for (int column = 0; column < 3; column++)
		for (int row = 0; row < 3; row++)
			back[4 * column + row] = place->scale[row] * stretch[4 * row + column];
	matrix_multiply(scaled, stretch, back);
	matrix_multiply(out, turn, scaled);
	for (int row = 0; row < 3; row++)
		out[12 + row] = place->move_m[row] + c[row] - out[row] * c[0] -
				out[4 + row] * c[1] - out[8 + row] * c[2];
}

/* ---- nodes */

/* The range of a root's pixels: that of its layer. */
static void root_range(const struct pose *pose, uint32_t layer, float *low, float *high)
{
	*low = 0;
	*high = 1;
	if (layer == SCENERY_NONE)
		return;
	for (uint32_t i = 0; i < layer; i++)
		*low += pose->layer_shares[i];
	*high = *low + pose->layer_shares[layer];
}

/* Turns what stands in a node about the axis until z is in the plane of axis and eye. VRML97 6.6.
 */
static void face_about(float turn[16], const float axis[3], const float eye[3])
{
	const float across = axis[1] * eye[0] - axis[0] * eye[1]; /* axis . (z x eye) */
	float q[4];

	turn_about(q, axis, atan2f(across, eye[2] - axis[2] * vec_dot(axis, eye)));
	turn_matrix(turn, q);
}

/* Turns it until z points at the eye and y is up in its picture, as far as it can be. */
static void face_fully(float turn[16], const float eye[3], const float up[3])
{
	float axes[3][3]; /* x, y, z */

	vec_copy(axes[2], eye);
	vec_cross(axes[0], up, eye);
	if (!(vec_normalise(axes[2]) > 0) || !(vec_normalise(axes[0]) > 0))
		return;
	vec_cross(axes[1], axes[2], axes[0]);
	for (int k = 0; k < 3; k++)
		vec_copy(&turn[4 * k], axes[k]);
}

static void face(float matrix[16], const struct scenery_sight *sight, const float eye[3],
		 const float up[3])
{
	float turn[16] = { [0] = 1, [5] = 1, [10] = 1, [15] = 1 }, turned[16];

	if (vec_length(sight->at) > 0)
		face_about(turn, sight->at, eye);
	else
		face_fully(turn, eye, up);
	matrix_multiply(turned, matrix, turn);
	memcpy(matrix, turned, sizeof(turned));
}

/* How far the eye is beyond a distance, 0 to 1: two levels share the pixels 3 % before and after
 * it, so that none appears at once, and a hand that trembles makes nothing flicker. */
static float share_beyond(float distance, float border)
{
	const float half = 0.03f;

	if (distance >= (1 + half) * border)
		return 1;
	if (distance <= (1 - half) * border)
		return 0;
	return (distance / border - (1 - half)) / (2 * half);
}

/* Does to a node what the place of the eye does. */
static void look(const struct pose *pose, const struct scenery_sight *sight, struct pose_node *node)
{
	float to_node[16], eye[3], up[3];

	if (sight->kind == SCENERY_SIGHT_NONE || !matrix_invert(to_node, node->matrix))
		return;
	matrix_place(eye, to_node, pose->eye_m);
	matrix_direction(up, to_node, pose->up);
	if (sight->kind == SCENERY_SIGHT_LEVEL) {
		const float distance = vec_distance(eye, sight->at), low = node->low;
		const float width = node->high - low;

		node->low = low + width * (1 - share_beyond(distance, sight->from));
		node->high = low + width * (1 - share_beyond(distance, sight->to));
	} else {
		face(node->matrix, sight, eye, up);
	}
}

static void place_nodes(struct pose *pose)
{
	for (uint32_t i = 0; i < pose->scenery->node_count; i++) {
		const struct scenery_node *from = &pose->scenery->nodes[i];
		struct pose_node *node = &pose->nodes[i];
		float own[16];

		pose_matrix(own, &pose->places[i]);
		if (from->parent == SCENERY_NONE) {
			memcpy(node->matrix, own, sizeof(own));
			root_range(pose, from->layer, &node->low, &node->high);
			node->high = node->low + (node->high - node->low) * pose->appeared;
		} else {
			const struct pose_node *parent = &pose->nodes[from->parent];

			matrix_multiply(node->matrix, parent->matrix, own);
			node->low = parent->low;
			node->high = parent->high;
		}
		look(pose, &from->sight, node);
		node->high = node->low + (node->high - node->low) * pose->opacity[i];
	}
}

static void apply(struct pose *pose, const struct scenery_motion *motion, float share)
{
	for (uint32_t t = 0; t < motion->track_count; t++) {
		const struct scenery_track *track = &pose->scenery->tracks[motion->first_track + t];
		struct scenery_place *place = &pose->places[track->node];
		struct bend_look *look = &pose->looks[track->node];

		switch (track->target) {
		case SCENERY_MOVE:
			pose_value(pose->scenery, track, share, place->move_m);
			break;
		case SCENERY_TURN:
			pose_value(pose->scenery, track, share, place->turn);
			break;
		case SCENERY_SCALE:
			pose_value(pose->scenery, track, share, place->scale);
			break;
		case SCENERY_COLOUR:
			look->has_colour = true;
			pose_value(pose->scenery, track, share, look->colour);
			break;
		case SCENERY_GLOW:
			look->has_glow = true;
			pose_value(pose->scenery, track, share, look->glow);
			break;
		case SCENERY_SHAPE:
			look->has_shape = true;
			pose_value(pose->scenery, track, share, &look->shape);
			break;
		default:
			pose_value(pose->scenery, track, share, &pose->opacity[track->node]);
			break;
		}
	}
}

/* Everything as the places, opacities and looks of the nodes have it. */
static void settle(struct pose *pose)
{
	place_nodes(pose);
	bend_update(&pose->bend, pose->scenery, pose->looks);
}

static bool is_touched(const struct scenery *scenery, uint32_t motion)
{
	for (uint32_t i = 0; i < scenery->touch_count; i++)
		if (scenery->touches[i].motion == motion)
			return true;
	return false;
}

int pose_init(struct pose *pose, const struct scenery *scenery)
{
	const uint32_t nodes = scenery->node_count;

	*pose = (struct pose){ .scenery = scenery, .layer_shares = { 1 }, .held = SCENERY_NONE };
	pose->nodes = calloc(nodes + 1, sizeof(*pose->nodes));
	pose->places = calloc(nodes + 1, sizeof(*pose->places));
	pose->opacity = calloc(nodes + 1, sizeof(*pose->opacity));
	pose->motions = calloc(scenery->motion_count + 1, sizeof(*pose->motions));
	pose->looks = calloc(nodes + 1, sizeof(*pose->looks));
	pose->drags = calloc(scenery->drag_count + 1, sizeof(*pose->drags));
	if (!pose->nodes || !pose->places || !pose->opacity || !pose->motions || !pose->looks ||
	    !pose->drags || bend_init(&pose->bend, scenery) < 0) {
		pose_finish(pose);
		return -ENOMEM;
	}
	for (uint32_t i = 0; i < nodes; i++) {
		pose->places[i] = scenery->nodes[i].place;
		pose->opacity[i] = 1;
		pose->has_sights |= scenery->nodes[i].sight.kind != SCENERY_SIGHT_NONE;
	}
	for (uint32_t i = 0; i < scenery->motion_count; i++)
		pose->motions[i].runs = !is_touched(scenery, i);
	for (uint32_t i = 0; i < scenery->drag_count; i++)
		drag_init(&pose->drags[i], &scenery->drags[i]);
	settle(pose);
	return 0;
}

void pose_finish(struct pose *pose)
{
	if (!pose)
		return;
	free(pose->nodes);
	free(pose->places);
	free(pose->opacity);
	free(pose->motions);
	free(pose->looks);
	free(pose->drags);
	bend_finish(&pose->bend);
	*pose = (struct pose){ 0 };
}

void pose_look(struct pose *pose, const float eye_m[3], const float up[3])
{
	if (!pose->has_sights || (memcmp(pose->eye_m, eye_m, sizeof(pose->eye_m)) == 0 &&
				  memcmp(pose->up, up, sizeof(pose->up)) == 0))
		return;
	vec_copy(pose->eye_m, eye_m);
	vec_copy(pose->up, up);
	place_nodes(pose);
}

/* ---- time */

static void step_motion(struct pose *pose, uint32_t i, float passed_ms)
{
	const struct scenery_motion *motion = &pose->scenery->motions[i];
	struct pose_motion *now = &pose->motions[i];
	const float passed = passed_ms / (1000 * motion->duration_s);

	now->share += now->is_backwards ? -passed : passed;
	if (motion->loops) {
		now->share -= floorf(now->share);
	} else if (now->share >= 1 || now->share <= 0) {
		now->share = now->is_backwards ? 0 : 1;
		now->runs = false;
	}
	apply(pose, motion, now->share);
}

/* Raises the share of the chosen layer; the others keep their proportions. */
static void step_layers(struct pose *pose, float passed_ms)
{
	float *chosen = &pose->layer_shares[pose->layer];
	const float share = vec_least(*chosen + passed_ms / dissolve_ms, 1);
	const float others = *chosen < 1 ? (1 - share) / (1 - *chosen) : 0;

	for (uint32_t i = 0; i < pose->scenery->layer_count; i++)
		pose->layer_shares[i] *= others;
	*chosen = share;
}

struct scenery_material pose_material(const struct pose *pose, uint32_t mesh)
{
	const struct scenery_mesh *of = &pose->scenery->meshes[mesh];
	const struct bend_look *look = &pose->looks[of->node];
	struct scenery_material material = pose->scenery->materials[of->material];

	for (int k = 0; k < 3 && look->has_glow; k++)
		material.emissive[k] = (uint8_t)lrintf(look->glow[k] * 255);
	/* What will glow has the program of what does: none is built while it begins. */
	if (pose->bend.meshes[mesh].glows && material.emissive[2] == 0)
		material.emissive[2] = 1;
	return material;
}

bool pose_moves(const struct pose *pose)
{
	if (pose->scenery->node_count == 0)
		return false;
	for (uint32_t i = 0; i < pose->scenery->motion_count; i++)
		if (pose->motions[i].runs)
			return true;
	return pose->was_set || pose->appeared < 1 || pose->layer_shares[pose->layer] < 1;
}

bool pose_step(struct pose *pose, float passed_ms)
{
	if (!pose_moves(pose))
		return false;
	for (uint32_t i = 0; i < pose->scenery->motion_count; i++)
		if (pose->motions[i].runs)
			step_motion(pose, i, passed_ms);
	step_layers(pose, passed_ms);
	pose->appeared = vec_least(pose->appeared + passed_ms / appear_ms, 1);
	pose->was_set = false;
	settle(pose);
	return true;
}

/* ---- visitors */

/* What began is not begun again while it runs, as VRML97 4.6.9 has it; but it turns back. */
static void start(struct pose *pose, uint32_t i)
{
	const struct scenery_motion *motion = &pose->scenery->motions[i];
	struct pose_motion *now = &pose->motions[i];

	if (motion->loops) {
		now->runs = !now->runs;
	} else if (motion->returns) {
		now->is_backwards = now->runs ? !now->is_backwards : now->share > 0;
		now->runs = true;
	} else if (!now->runs) {
		now->share = 0;
		now->runs = true;
	}
}

bool pose_touch(struct pose *pose, uint32_t node)
{
	const struct scenery *scenery = pose->scenery;
	bool answers = false;

	/* The innermost node that a touch is for. */
	for (; node != SCENERY_NONE && !answers; node = scenery->nodes[node].parent)
		for (uint32_t i = 0; i < scenery->touch_count; i++)
			if (scenery->touches[i].node == node) {
				start(pose, scenery->touches[i].motion);
				answers = true;
			}
	return answers;
}

bool pose_grab(struct pose *pose, uint32_t node, const float point_m[3], const float direction[3])
{
	const struct scenery *scenery = pose->scenery;

	pose->held = SCENERY_NONE;
	for (; node != SCENERY_NONE && pose->held == SCENERY_NONE;
	     node = scenery->nodes[node].parent)
		for (uint32_t i = 0; i < scenery->drag_count; i++)
			if (scenery->drags[i].handle == node &&
			    drag_begin(&pose->drags[i], &scenery->drags[i],
				       pose->nodes[node].matrix, point_m, direction))
				pose->held = node;
	return pose->held != SCENERY_NONE;
}

void pose_drag(struct pose *pose, const float from_m[3], const float direction[3])
{
	const struct scenery *scenery = pose->scenery;

	for (uint32_t i = 0; i < scenery->drag_count; i++) {
		const struct scenery_drag *of = &scenery->drags[i];
		struct scenery_place *place = &pose->places[of->node];
		float value[4];

		if (pose->held == SCENERY_NONE || of->handle != pose->held)
			continue;
		drag_move(&pose->drags[i], of, from_m, direction);
		drag_value(&pose->drags[i], of, value);
		if (of->kind == SCENERY_DRAG_PLANE)
			vec_copy(place->move_m, value);
		else
			memcpy(place->turn, value, sizeof(place->turn));
		pose->was_set = true;
	}
	settle(pose);
}

void pose_let_go(struct pose *pose)
{
	const struct scenery *scenery = pose->scenery;

	for (uint32_t i = 0; i < scenery->drag_count; i++)
		if (pose->held != SCENERY_NONE && scenery->drags[i].handle == pose->held)
			drag_end(&pose->drags[i], &scenery->drags[i]);
	pose->held = SCENERY_NONE;
}

void pose_choose(struct pose *pose, uint32_t layer)
{
	pose->layer = layer;
}

static void reset_drags(struct pose *pose)
{
	const struct scenery *scenery = pose->scenery;

	pose->held = SCENERY_NONE;
	for (uint32_t i = 0; i < scenery->drag_count; i++) {
		const struct scenery_drag *of = &scenery->drags[i];
		const struct scenery_place *rest = &scenery->nodes[of->node].place;

		drag_init(&pose->drags[i], of);
		if (of->kind == SCENERY_DRAG_PLANE)
			vec_copy(pose->places[of->node].move_m, rest->move_m);
		else
			memcpy(pose->places[of->node].turn, rest->turn, sizeof(rest->turn));
	}
}

void pose_reset(struct pose *pose)
{
	const struct scenery *scenery = pose->scenery;

	pose->layer = 0;
	for (uint32_t i = 0; i < scenery->motion_count; i++) {
		struct pose_motion *now = &pose->motions[i];

		if (!is_touched(scenery, i))
			continue;
		if (scenery->motions[i].returns && now->share > 0) {
			now->runs = now->is_backwards = true;
			continue;
		}
		*now = (struct pose_motion){ 0 };
		for (uint32_t t = 0; t < scenery->motions[i].track_count; t++) {
			uint32_t node = scenery->tracks[scenery->motions[i].first_track + t].node;

			pose->places[node] = scenery->nodes[node].place;
			pose->opacity[node] = 1;
			pose->looks[node] = (struct bend_look){ 0 };
		}
	}
	reset_drags(pose);
	pose->was_set = true;
	settle(pose);
}
