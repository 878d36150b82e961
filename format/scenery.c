/* The rules that scenery keeps, which encoder and decoder check. */
#include "format/scenery.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"

/* Places, sizes and scales beyond this are mistakes. */
static const float far_m = 1e6f;
static const float longest_s = 3600;

uint32_t scenery_width(enum scenery_target target)
{
	static const uint8_t widths[SCENERY_TARGETS] = {
		[SCENERY_MOVE] = 3,    [SCENERY_TURN] = 4,   [SCENERY_SCALE] = 3,
		[SCENERY_OPACITY] = 1, [SCENERY_COLOUR] = 3, [SCENERY_GLOW] = 3,
		[SCENERY_SHAPE] = 1,
	};

	return widths[target];
}

uint32_t scenery_triangles(const struct scenery *scenery)
{
	uint32_t count = 0;

	for (uint32_t i = 0; i < scenery->mesh_count; i++)
		count += scenery->meshes[i].triangle_count;
	return count;
}

bool scenery_sets(const struct scenery *scenery, uint32_t node, enum scenery_target target)
{
	for (uint32_t i = 0; i < scenery->track_count; i++)
		if (scenery->tracks[i].node == node && scenery->tracks[i].target == target)
			return true;
	return false;
}

bool scenery_is_painted(const struct scenery_material *material)
{
	return material->texture > 0 || material->normals > 0;
}

uint32_t scenery_texels(const struct scenery *scenery)
{
	uint32_t count = 0;

	for (uint32_t i = 0; i < scenery->texture_count; i++)
		count += (uint32_t)scenery->textures[i].width * scenery->textures[i].height;
	return count;
}

/* ---- nodes and meshes */

static bool are_near(const float *numbers, int count)
{
	for (int i = 0; i < count; i++)
		if (!(fabsf(numbers[i]) <= far_m))
			return false;
	return true;
}

static bool is_unit(const float *numbers, int count)
{
	float square = 0;

	for (int i = 0; i < count; i++)
		square += numbers[i] * numbers[i];
	return fabsf(square - 1) < 1e-3f;
}

static bool place_is_sane(const struct scenery_place *place)
{
	return are_near(place->move_m, 3) && are_near(place->scale, 3) &&
	       are_near(place->centre_m, 3) && is_unit(place->turn, 4) &&
	       is_unit(place->stretch, 4);
}

static bool sight_is_sane(const struct scenery_sight *sight)
{
	const float *at = sight->at;
	const bool is_zero = at[0] == 0 && at[1] == 0 && at[2] == 0;

	if (sight->kind == SCENERY_SIGHT_LEVEL)
		return are_near(at, 3) && sight->from >= 0 && sight->to > sight->from;
	return (unsigned)sight->kind < SCENERY_SIGHT_KINDS && sight->from == 0 && sight->to == 0 &&
	       (is_zero || (sight->kind == SCENERY_SIGHT_FACES && is_unit(at, 3)));
}

static bool nodes_are_sane(const struct scenery *scenery)
{
	uint8_t depth[SCENERY_NODES_MAX];

	if (scenery->node_count > SCENERY_NODES_MAX)
		return false;
	for (uint32_t i = 0; i < scenery->node_count; i++) {
		const struct scenery_node *node = &scenery->nodes[i];
		bool is_root = node->parent == SCENERY_NONE;

		if (!is_root && node->parent >= i)
			return false;
		if (node->layer != SCENERY_NONE &&
		    (!is_root || node->layer >= scenery->layer_count))
			return false;
		depth[i] = is_root ? 1 : (uint8_t)(depth[node->parent] + 1);
		if (depth[i] > SCENERY_DEPTH_MAX || !place_is_sane(&node->place) ||
		    !sight_is_sane(&node->sight))
			return false;
	}
	return true;
}

/* Whether a number is at least `least` and at most `most`; not a number is not. */
static bool is_within(float number, float least, float most)
{
	return number >= least && number <= most;
}

static bool is_side(uint16_t px)
{
	return px > 0 && px <= SCENERY_TEXTURE_PX_MAX && (px & (px - 1)) == 0;
}

static bool textures_are_sane(const struct scenery *scenery)
{
	uint32_t texels = 0;

	if (scenery->texture_count > SCENERY_TEXTURES_MAX)
		return false;
	for (uint32_t i = 0; i < scenery->texture_count; i++) {
		const struct scenery_texture *texture = &scenery->textures[i];

		texels += (uint32_t)texture->width * texture->height;
		if (!is_side(texture->width) || !is_side(texture->height) ||
		    texels > SCENERY_TEXELS_MAX || texture->jpeg_bytes == 0)
			return false;
	}
	return true;
}

static bool materials_are_sane(const struct scenery *scenery)
{
	if (scenery->material_count > SCENERY_MATERIALS_MAX)
		return false;
	for (uint32_t i = 0; i < scenery->material_count; i++) {
		const struct scenery_material *material = &scenery->materials[i];
		const uint8_t *rgb = material->specular;
		const bool needs_pixels = material->substance || material->relief_m > 0 ||
					  material->mirror > 0 || scenery_is_painted(material);

		if (!is_within(material->opacity, 1.0f / 255, 1) ||
		    !is_within(material->shininess, rgb[0] || rgb[1] || rgb[2] ? 1 : 0, 128) ||
		    material->substance >= SCENERY_SUBSTANCES ||
		    material->texture > scenery->texture_count ||
		    material->normals > scenery->texture_count ||
		    !is_within(material->relief_m, 0, 0.1f) || !is_within(material->mirror, 0, 1) ||
		    !is_unit(material->grain, 3) || (needs_pixels && !material->by_pixel))
			return false;
	}
	return true;
}

static bool fog_is_sane(const struct scenery *scenery)
{
	const struct scenery_fog *fog = &scenery->fog;

	return is_within(fog->range_m, 0, far_m) &&
	       (fog->layer == SCENERY_NONE || fog->layer < scenery->layer_count ||
		fog->range_m == 0);
}

static bool mesh_is_sane(const struct scenery *scenery, const struct scenery_mesh *mesh)
{
	if (mesh->node >= scenery->node_count || mesh->material >= scenery->material_count ||
	    !are_near(mesh->origin_m, 3) || !(mesh->step_m > 0 && mesh->step_m <= far_m) ||
	    mesh->vertex_count < 3 || mesh->vertex_count > SCENERY_VERTICES_MAX ||
	    mesh->triangle_count < 1 || mesh->triangle_count > SCENERY_TRIANGLES_MAX ||
	    mesh->shape_count > SCENERY_SHAPES_MAX)
		return false;
	if (scenery_is_painted(&scenery->materials[mesh->material]) != (mesh->uvs != NULL) ||
	    !are_near(mesh->uv_origin, 2) || !are_near(mesh->uv_step, 2))
		return false;
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		for (int k = 0; k < 3; k++)
			if (mesh->triangles[t][k] >= mesh->vertex_count)
				return false;
	return true;
}

static bool meshes_are_sane(const struct scenery *scenery)
{
	uint32_t triangles = 0, clear = 0;

	if (scenery->mesh_count > SCENERY_MESHES_MAX)
		return false;
	for (uint32_t i = 0; i < scenery->mesh_count; i++) {
		if (!mesh_is_sane(scenery, &scenery->meshes[i]))
			return false;
		triangles += scenery->meshes[i].triangle_count;
		if (scenery->materials[scenery->meshes[i].material].opacity < 1)
			clear += scenery->meshes[i].triangle_count;
		if (triangles > SCENERY_ALL_TRIANGLES_MAX || clear > SCENERY_CLEAR_TRIANGLES_MAX)
			return false;
	}
	return true;
}

bool scenery_bends_fit(const struct scenery *scenery)
{
	uint64_t of_shapes = 0, bent = 0;

	for (uint32_t i = 0; i < scenery->mesh_count; i++) {
		const struct scenery_mesh *mesh = &scenery->meshes[i];

		of_shapes += (uint64_t)mesh->shape_count * mesh->vertex_count;
		if (mesh->shape_count > 0 || scenery_sets(scenery, mesh->node, SCENERY_COLOUR))
			bent += mesh->vertex_count;
	}
	return of_shapes <= SCENERY_SHAPE_VERTICES_MAX && bent <= SCENERY_BENT_VERTICES_MAX;
}

/* ---- motions */

/* The greatest value of a target whose values begin at 0; of all others it is 0. */
static float most_of(enum scenery_target target)
{
	switch (target) {
	case SCENERY_OPACITY:
	case SCENERY_COLOUR:
	case SCENERY_GLOW:
		return 1;
	case SCENERY_SHAPE:
		return SCENERY_SHAPES_MAX - 1;
	default:
		return 0;
	}
}

static bool values_are_sane(const struct scenery_track *track, const float *values)
{
	const uint32_t width = scenery_width(track->target);
	const float most = most_of(track->target);

	for (uint32_t k = 0; k < track->key_count; k++) {
		const float *value = &values[k * width];

		if (!are_near(value, (int)width) ||
		    (track->target == SCENERY_TURN && !is_unit(value, 4)))
			return false;
		for (uint32_t i = 0; i < width && most > 0; i++)
			if (!is_within(value[i], 0, most))
				return false;
	}
	return true;
}

/* Checks a track whose numbers begin at *next. */
static bool track_is_sane(const struct scenery *scenery, const struct scenery_track *track,
			  uint32_t *next)
{
	float before = 0;
	uint32_t left = scenery->number_count - *next, each;

	if (track->node >= scenery->node_count || (unsigned)track->target >= SCENERY_TARGETS ||
	    track->first != *next || track->key_count < 1)
		return false;
	each = 1 + scenery_width(track->target);
	if (track->key_count > left / each)
		return false;
	for (uint32_t k = 0; k < track->key_count; k++) {
		float time = scenery->numbers[track->first + k];

		if (!(time >= before && time <= 1))
			return false;
		before = time;
	}
	*next += track->key_count * each;
	return values_are_sane(track, &scenery->numbers[track->first + track->key_count]);
}

static bool touches_are_sane(const struct scenery *scenery)
{
	if (scenery->touch_count > SCENERY_TOUCHES_MAX)
		return false;
	for (uint32_t i = 0; i < scenery->touch_count; i++)
		if (scenery->touches[i].node >= scenery->node_count ||
		    scenery->touches[i].motion >= scenery->motion_count)
			return false;
	return true;
}

static bool is_touched(const struct scenery *scenery, uint32_t motion)
{
	for (uint32_t i = 0; i < scenery->touch_count; i++)
		if (scenery->touches[i].motion == motion)
			return true;
	return false;
}

static bool motions_are_sane(const struct scenery *scenery)
{
	uint32_t track = 0, number = 0;

	if (scenery->motion_count > SCENERY_MOTIONS_MAX ||
	    scenery->track_count > SCENERY_TRACKS_MAX ||
	    scenery->number_count > SCENERY_NUMBERS_MAX)
		return false;
	for (uint32_t i = 0; i < scenery->motion_count; i++) {
		const struct scenery_motion *motion = &scenery->motions[i];

		if (!(motion->duration_s > 0 && motion->duration_s <= longest_s) ||
		    motion->first_track != track || motion->track_count < 1 ||
		    motion->track_count > scenery->track_count - track ||
		    (motion->loops && motion->returns) ||
		    (!motion->loops && !is_touched(scenery, i)))
			return false;
		track += motion->track_count;
	}
	if (track != scenery->track_count)
		return false;
	for (track = 0; track < scenery->track_count; track++)
		if (!track_is_sane(scenery, &scenery->tracks[track], &number))
			return false;
	return number == scenery->number_count;
}

/* ---- drags */

static bool drag_is_sane(const struct scenery *scenery, const struct scenery_drag *drag)
{
	const bool is_sphere = drag->kind == SCENERY_DRAG_SPHERE;

	return drag->handle < scenery->node_count && drag->node < scenery->node_count &&
	       (unsigned)drag->kind < SCENERY_DRAG_KINDS && are_near(drag->offset, 4) &&
	       (!is_sphere || is_unit(drag->offset, 4)) && are_near(drag->low, 2) &&
	       are_near(drag->high, 2) && is_within(drag->disc_rad, 0, 1.5708f);
}

static bool drags_are_sane(const struct scenery *scenery)
{
	if (scenery->drag_count > SCENERY_DRAGS_MAX)
		return false;
	for (uint32_t i = 0; i < scenery->drag_count; i++)
		if (!drag_is_sane(scenery, &scenery->drags[i]))
			return false;
	return true;
}

/* ---- layers */

static bool text_is_sane(const char *text, size_t bytes)
{
	const char *end = memchr(text, '\0', bytes);
	size_t size = 1;

	if (!end || end == text)
		return false;
	for (; text < end && size > 0; text += size)
		size = utf8_bytes(text, (size_t)(end - text));
	return size > 0;
}

static bool title_is_sane(const struct scenery_title *title)
{
	return text_is_sane(title->language, sizeof(title->language)) &&
	       text_is_sane(title->text, sizeof(title->text));
}

static bool layers_are_sane(const struct scenery *scenery)
{
	uint32_t next = 0;

	if (scenery->layer_count > SCENERY_LAYERS_MAX || scenery->layer_count == 1 ||
	    scenery->title_count > SCENERY_TITLES_MAX)
		return false;
	for (uint32_t i = 0; i < scenery->layer_count; i++) {
		const struct scenery_layer *layer = &scenery->layers[i];

		if (layer->first_title != next || layer->title_count < 1 ||
		    layer->title_count > scenery->title_count - next)
			return false;
		next += layer->title_count;
	}
	for (uint32_t i = 0; i < scenery->title_count; i++)
		if (!title_is_sane(&scenery->titles[i]))
			return false;
	return next == scenery->title_count;
}

bool scenery_is_sane(const struct scenery *scenery)
{
	return nodes_are_sane(scenery) && textures_are_sane(scenery) &&
	       materials_are_sane(scenery) && fog_is_sane(scenery) && meshes_are_sane(scenery) &&
	       touches_are_sane(scenery) && motions_are_sane(scenery) &&
	       scenery_bends_fit(scenery) && drags_are_sane(scenery) && layers_are_sane(scenery);
}

void scenery_finish(struct scenery *scenery)
{
	if (!scenery)
		return;
	for (uint32_t i = 0; scenery->meshes && i < scenery->mesh_count; i++) {
		free(scenery->meshes[i].vertices);
		free(scenery->meshes[i].triangles);
		free(scenery->meshes[i].shapes);
		free(scenery->meshes[i].uvs);
	}
	for (uint32_t i = 0; scenery->textures && i < scenery->texture_count; i++) {
		free(scenery->textures[i].jpeg);
		free(scenery->textures[i].rgba);
	}
	free(scenery->textures);
	free(scenery->nodes);
	free(scenery->materials);
	free(scenery->meshes);
	free(scenery->motions);
	free(scenery->touches);
	free(scenery->drags);
	free(scenery->tracks);
	free(scenery->numbers);
	free(scenery->layers);
	free(scenery->titles);
	*scenery = (struct scenery){ 0 };
}
