/* Gathers scenery: arrays that grow. */
#include "pipeline/scene/scenery_maker.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "geometry/vec.h"
#include "pipeline/scene/scenery_bend.h"
#include "pipeline/scene/scenery_mesh.h"
#include "pipeline/scene/scenery_texture.h"

const struct scenery_material scenery_plain = { .opacity = 1, .grain = { 0, 0, 1 } };
const struct scenery_place scenery_at_rest = { .turn = { 0, 0, 0, 1 },
					       .scale = { 1, 1, 1 },
					       .stretch = { 0, 0, 0, 1 } };

int scenery_add_node(struct scenery_maker *maker, const struct scenery_node *node, uint32_t *number)
{
	struct scenery *out = &maker->out;
	int rc = ARRAY_RESERVE(out->nodes, maker->node_room, (uint64_t)out->node_count + 1,
			       SCENERY_NODES_MAX);

	if (rc < 0)
		return rc;
	*number = out->node_count;
	out->nodes[out->node_count++] = *node;
	return 0;
}

static bool are_equal(const struct scenery_material *a, const struct scenery_material *b)
{
	return a->texture == b->texture && a->normals == b->normals &&
	       a->has_two_sides == b->has_two_sides && a->by_pixel == b->by_pixel &&
	       a->opacity == b->opacity && a->shininess == b->shininess &&
	       a->substance == b->substance && a->relief_m == b->relief_m &&
	       a->mirror == b->mirror && vec_dot(a->grain, b->grain) > 0.99999f &&
	       memcmp(a->emissive, b->emissive, sizeof(a->emissive)) == 0 &&
	       memcmp(a->specular, b->specular, sizeof(a->specular)) == 0;
}

static int find_material(struct scenery_maker *maker, const struct scenery_material *material,
			 uint32_t *number)
{
	struct scenery *out = &maker->out;
	int rc;

	for (*number = 0; *number < out->material_count; (*number)++)
		if (are_equal(&out->materials[*number], material))
			return 0;
	rc = ARRAY_RESERVE(out->materials, maker->material_room, (uint64_t)*number + 1,
			   SCENERY_MATERIALS_MAX);
	if (rc == 0)
		out->materials[out->material_count++] = *material;
	return rc;
}

static int find_sheet(struct scenery_maker *maker, uint32_t node, uint32_t material,
		      struct scenery_sheet **found)
{
	int rc;

	for (uint32_t i = maker->sheet_count; i-- > 0;) {
		*found = &maker->sheets[i];
		if ((*found)->node == node && (*found)->material == material)
			return 0;
	}
	rc = ARRAY_RESERVE(maker->sheets, maker->sheet_room, (uint64_t)maker->sheet_count + 1,
			   SCENERY_MESHES_MAX);
	if (rc < 0)
		return rc;
	*found = &maker->sheets[maker->sheet_count++];
	**found = (struct scenery_sheet){
		.node = node,
		.material = material,
		.has_picture = scenery_is_painted(&maker->out.materials[material]),
	};
	return 0;
}

/* Whether the picture is seen beyond its sides. */
static bool leaves_picture(const struct soup_triangle *triangles, uint32_t count)
{
	const float edge = 1e-4f;

	for (uint32_t i = 0; i < 6 * count; i++) {
		const float at = triangles[i / 6].corners[i % 6 / 2].uv[i % 2];

		if (at < -edge || at > 1 + edge)
			return true;
	}
	return false;
}

/* Finds or adds a picture; *number counts from 1. */
static int find_texture(struct scenery_maker *maker, const struct picture *picture, bool repeats,
			bool is_map, uint16_t *number)
{
	const struct scenery_source source = scenery_source_of(picture, repeats, is_map);
	struct scenery *out = &maker->out;
	uint32_t left = SCENERY_TEXELS_MAX - scenery_texels(out), i;
	int rc;

	for (i = 0; i < out->texture_count; i++)
		if (scenery_source_equals(&maker->sources[i], &source)) {
			*number = (uint16_t)(i + 1);
			return 0;
		}
	rc = ARRAY_RESERVE(out->textures, maker->texture_room, (uint64_t)i + 1,
			   SCENERY_TEXTURES_MAX);
	if (rc == 0)
		rc = ARRAY_RESERVE(maker->sources, maker->source_room, (uint64_t)i + 1,
				   SCENERY_TEXTURES_MAX);
	if (rc == 0 && left < 2)
		rc = -EFBIG;
	if (rc == 0)
		rc = scenery_texture_make(&out->textures[i], picture, repeats, is_map, left / 2);
	if (rc < 0)
		return rc;
	maker->sources[out->texture_count++] = source;
	*number = (uint16_t)out->texture_count;
	return 0;
}

/* Puts pictures on a material. */
static int add_paint(struct scenery_maker *maker, struct scenery_material *material,
		     const struct scenery_paint *paint, const struct soup_triangle *triangles,
		     uint32_t count)
{
	const bool repeats = leaves_picture(triangles, count);
	int rc = 0;

	if (paint->picture)
		rc = find_texture(maker, paint->picture, repeats, false, &material->texture);
	if (rc == 0 && paint->normals)
		rc = find_texture(maker, paint->normals, repeats, true, &material->normals);
	material->by_pixel = material->by_pixel || scenery_is_painted(material);
	return rc;
}

int scenery_add_surface(struct scenery_maker *maker, uint32_t node,
			const struct scenery_material *material,
			const struct soup_triangle *triangles, uint32_t count, float crease_rad,
			const struct scenery_paint *paint)
{
	struct scenery_material kept = *material;
	struct scenery_sheet *sheet = NULL;
	uint32_t number;
	int rc = 0;

	if (count == 0)
		return 0;
	if (count > SCENERY_ALL_TRIANGLES_MAX - maker->triangle_count ||
	    (material->opacity < 1 && count > SCENERY_CLEAR_TRIANGLES_MAX - maker->clear_count))
		rc = -EFBIG;
	if (rc == 0)
		rc = add_paint(maker, &kept, paint, triangles, count);
	if (rc == 0)
		rc = find_material(maker, &kept, &number);
	if (rc == 0)
		rc = find_sheet(maker, node, number, &sheet);
	if (rc == 0)
		rc = scenery_sheet_add(sheet, triangles, count, crease_rad);
	if (rc == 0) {
		maker->clear_count += material->opacity < 1 ? count : 0;
		maker->triangle_count += count;
	}
	return rc;
}

int scenery_add_bent(struct scenery_maker *maker, uint32_t node,
		     const struct scenery_material *material, const struct soup *soup,
		     float crease_rad, const struct scenery_paint *paint,
		     const struct scenery_bend *bend)
{
	struct scenery_material kept = *material;
	struct scenery_mesh mesh = { .node = node };
	struct scenery *out = &maker->out;
	int rc = 0;

	if (soup->count == 0)
		return 0;
	if (soup->count > SCENERY_ALL_TRIANGLES_MAX - maker->triangle_count ||
	    (material->opacity < 1 &&
	     soup->count > SCENERY_CLEAR_TRIANGLES_MAX - maker->clear_count))
		rc = -EFBIG;
	if (rc == 0)
		rc = add_paint(maker, &kept, paint, soup->triangles, soup->count);
	if (rc == 0)
		rc = find_material(maker, &kept, &mesh.material);
	if (rc == 0)
		rc = ARRAY_RESERVE(out->meshes, maker->mesh_room, (uint64_t)out->mesh_count + 1,
				   SCENERY_MESHES_MAX);
	if (rc == 0)
		rc = scenery_bend_mesh(&mesh, soup, crease_rad, scenery_is_painted(&kept), bend);
	if (rc < 0)
		return rc;
	maker->clear_count += material->opacity < 1 ? soup->count : 0;
	maker->triangle_count += soup->count;
	out->meshes[out->mesh_count++] = mesh;
	return 0;
}

int scenery_add_motion(struct scenery_maker *maker, const struct scenery_motion *motion,
		       uint32_t *number)
{
	struct scenery *out = &maker->out;
	int rc = ARRAY_RESERVE(out->motions, maker->motion_room, (uint64_t)out->motion_count + 1,
			       SCENERY_MOTIONS_MAX);

	if (rc < 0)
		return rc;
	*number = out->motion_count;
	out->motions[out->motion_count] = *motion;
	out->motions[out->motion_count].first_track = out->track_count;
	out->motions[out->motion_count++].track_count = 0;
	return 0;
}

int scenery_add_track(struct scenery_maker *maker, uint32_t node, enum scenery_target target,
		      const float *times, uint32_t key_count, float **values)
{
	struct scenery *out = &maker->out;
	uint64_t needed = (uint64_t)key_count * (1 + scenery_width(target));
	int rc = ARRAY_RESERVE(out->tracks, maker->track_room, (uint64_t)out->track_count + 1,
			       SCENERY_TRACKS_MAX);

	if (rc == 0)
		rc = ARRAY_RESERVE(out->numbers, maker->number_room, out->number_count + needed,
				   SCENERY_NUMBERS_MAX);
	if (rc < 0)
		return rc;
	out->tracks[out->track_count++] = (struct scenery_track){
		.node = node, .target = target, .key_count = key_count, .first = out->number_count
	};
	out->motions[out->motion_count - 1].track_count++;
	memcpy(&out->numbers[out->number_count], times, key_count * sizeof(*times));
	*values = &out->numbers[out->number_count + key_count];
	out->number_count += (uint32_t)needed;
	return 0;
}

int scenery_add_touch(struct scenery_maker *maker, uint32_t node, uint32_t motion)
{
	struct scenery *out = &maker->out;
	int rc = ARRAY_RESERVE(out->touches, maker->touch_room, (uint64_t)out->touch_count + 1,
			       SCENERY_TOUCHES_MAX);

	if (rc == 0)
		out->touches[out->touch_count++] = (struct scenery_touch){ node, motion };
	return rc;
}

int scenery_add_drag(struct scenery_maker *maker, const struct scenery_drag *drag)
{
	struct scenery *out = &maker->out;
	int rc = ARRAY_RESERVE(out->drags, maker->drag_room, (uint64_t)out->drag_count + 1,
			       SCENERY_DRAGS_MAX);

	if (rc == 0)
		out->drags[out->drag_count++] = *drag;
	return rc;
}

/* ---- motions that return */

static bool is_set_by_another(const struct scenery *scenery, uint32_t motion,
			      const struct scenery_track *track)
{
	const struct scenery_motion *own = &scenery->motions[motion];

	for (uint32_t t = 0; t < scenery->track_count; t++)
		if ((t < own->first_track || t >= own->first_track + own->track_count) &&
		    scenery->tracks[t].node == track->node &&
		    scenery->tracks[t].target == track->target)
			return true;
	return false;
}

void scenery_find_returns(struct scenery_maker *maker, uint32_t first)
{
	struct scenery *scenery = &maker->out;

	for (uint32_t m = first; m < scenery->motion_count; m++) {
		struct scenery_motion *motion = &scenery->motions[m];
		bool ends_elsewhere = false, is_alone = true;

		for (uint32_t t = 0; t < motion->track_count; t++) {
			const struct scenery_track *track =
				&scenery->tracks[motion->first_track + t];
			const uint32_t width = scenery_width(track->target);
			const float *values = &scenery->numbers[track->first + track->key_count];

			is_alone = is_alone && !is_set_by_another(scenery, m, track);
			for (uint32_t k = 0; k < width; k++)
				ends_elsewhere =
					ends_elsewhere ||
					fabsf(values[k] -
					      values[(track->key_count - 1) * width + k]) > 1e-4f;
		}
		motion->returns = !motion->loops && is_alone && ends_elsewhere;
	}
}

/* ---- the end */

int scenery_maker_end(struct scenery_maker *maker, struct scenery *out)
{
	int rc = 0;

	if (!(maker->out.fog.range_m > 0))
		maker->out.fog.layer = SCENERY_NONE;

	for (uint32_t i = 0; i < maker->sheet_count && rc == 0; i++)
		rc = scenery_sheet_meshes(&maker->sheets[i], &maker->out, &maker->mesh_room);
	if (rc == 0 && !scenery_bends_fit(&maker->out))
		rc = -EFBIG;
	if (rc < 0)
		return rc;
	*out = maker->out;
	maker->out = (struct scenery){ 0 };
	scenery_maker_finish(maker);
	return 0;
}

void scenery_maker_finish(struct scenery_maker *maker)
{
	if (!maker)
		return;
	for (uint32_t i = 0; i < maker->sheet_count; i++)
		scenery_sheet_finish(&maker->sheets[i]);
	free(maker->sheets);
	free(maker->sources);
	scenery_finish(&maker->out);
	*maker = (struct scenery_maker){ 0 };
}
