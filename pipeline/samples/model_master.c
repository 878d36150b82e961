/* Chooses patches of the master by their detail, and decodes their groups when they are asked for.
 */
#include "pipeline/samples/model_master.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/normal.h"
#include "format/patch.h"

/* Decoded groups that are kept: patches of a group are near each other, so they are asked for one
 * soon after the other. */
enum { GROUPS_KEPT = 16 };

struct decoded {
	uint32_t group; /* HIERARCHY_NONE: the slot is empty */
	uint32_t patch_count;
	struct patch_mesh patches[GROUP_PATCHES_MAX]; /* owned */
	uint64_t used;                                /* when it was used last, counted in uses */
};

struct model_master {
	struct model model;
	const struct master *master;
	float *detail_m; /* owned; of each group, see find_details */
	struct decoded kept[GROUPS_KEPT];
	uint64_t uses;
	struct model_vertex vertices[PATCH_VERTICES_MAX]; /* of the patch asked for last */
	struct buffer object;
};

/* ---- choosing */

/* About the distance of the vertices of a patch: the side of as many equal triangles as fill the
 * disc of its sphere. A patch that is long or bent fills less, so its vertices are nearer than this
 * says. */
static float spacing_of(const struct hierarchy_patch *patch)
{
	return patch->radius_m * sqrtf(7.26f / (float)(patch->triangle_count + 1));
}

/* The detail of a group is the size of what its absence changes in the picture: twice its error, or
 * the distance of vertices in the patches that it replaces. Like an error it is saturated: it is no
 * less than that of any group that depends on the group. */
static void find_details(struct model_master *model)
{
	const struct hierarchy *hierarchy = &model->master->hierarchy;

	for (uint32_t g = 0; g < hierarchy->group_count; g++)
		model->detail_m[g] = 2 * hierarchy->groups[g].error_m;
	for (uint32_t p = 0; p < hierarchy->patch_count; p++) {
		const struct hierarchy_patch *patch = &hierarchy->patches[p];

		if (patch->finer != HIERARCHY_NONE)
			model->detail_m[patch->finer] =
				fmaxf(model->detail_m[patch->finer], spacing_of(patch));
	}
	/* Patches are sorted by group, and a group comes after those that it refines. */
	for (uint32_t p = hierarchy->patch_count; p-- > 0;) {
		const struct hierarchy_patch *patch = &hierarchy->patches[p];

		if (patch->finer != HIERARCHY_NONE)
			model->detail_m[patch->group] =
				fmaxf(model->detail_m[patch->group], model->detail_m[patch->finer]);
	}
}

/* Whether the eye could tell that the group is not refined. */
static bool shows(const struct model_master *model, uint32_t g, const float eye_m[3],
		  float detail_rad)
{
	const struct hierarchy_group *group = &model->master->hierarchy.groups[g];
	float away = 0;

	for (int i = 0; i < 3; i++)
		away += (group->centre_m[i] - eye_m[i]) * (group->centre_m[i] - eye_m[i]);
	away = sqrtf(away) - group->radius_m;
	return model->detail_m[g] > detail_rad * fmaxf(away, 0);
}

static uint32_t choose(const struct model *base, const float eye_m[3], float detail_rad,
		       uint32_t *pieces)
{
	const struct model_master *model = (const struct model_master *)base;
	const struct hierarchy *hierarchy = &model->master->hierarchy;
	uint32_t count = 0;

	for (uint32_t p = 0; p < hierarchy->patch_count; p++) {
		const struct hierarchy_patch *patch = &hierarchy->patches[p];

		if ((patch->group == 0 || shows(model, patch->group, eye_m, detail_rad)) &&
		    (patch->finer == HIERARCHY_NONE ||
		     !shows(model, patch->finer, eye_m, detail_rad)))
			pieces[count++] = p;
	}
	return count;
}

/* ---- loading */

static void forget(struct decoded *decoded)
{
	for (uint32_t i = 0; i < decoded->patch_count; i++)
		patch_mesh_finish(&decoded->patches[i]);
	decoded->patch_count = 0;
	decoded->group = HIERARCHY_NONE;
}

static int decode(struct model_master *model, uint32_t group, struct decoded *out)
{
	const struct hierarchy_group *row = &model->master->hierarchy.groups[group];
	int rc;

	forget(out);
	buffer_clear(&model->object);
	rc = master_read_group(model->master, group, &model->object);
	if (rc == 0)
		rc = patch_group_decode(out->patches, &out->patch_count,
					buffer_bytes(&model->object));
	if (rc < 0) {
		out->patch_count = 0;
		return rc;
	}
	if (out->patch_count != row->patch_count) {
		forget(out);
		return -EBADMSG;
	}
	out->group = group;
	return 0;
}

/* Returns the decoded group, from those that are kept or in place of the one used longest ago. */
static int get_group(struct model_master *model, uint32_t group, struct decoded **out)
{
	struct decoded *oldest = &model->kept[0];
	int rc = 0;

	*out = NULL;
	for (int i = 0; i < GROUPS_KEPT && !*out; i++) {
		struct decoded *kept = &model->kept[i];

		if (kept->group == group)
			*out = kept;
		else if (kept->used < oldest->used)
			oldest = kept;
	}
	if (!*out) {
		rc = decode(model, group, oldest);
		*out = oldest;
	}
	(*out)->used = ++model->uses;
	return rc;
}

static void convert(struct model_master *model, const struct patch_mesh *patch)
{
	const struct lattice *lattice = &model->master->lattice;

	for (uint32_t i = 0; i < patch->vertex_count; i++) {
		const struct patch_vertex *from = &patch->vertices[i];
		struct model_vertex *to = &model->vertices[i];
		float normal[3];
		double at[3];

		*to = (struct model_vertex){ 0 };
		normal_decode(normal, from->normal);
		lattice_metres(at, lattice, from->position);
		for (int k = 0; k < 3; k++) {
			to->position_m[k] = (float)at[k];
			to->normal[k] = (int8_t)lrintf(normal[k] * 127);
		}
		memcpy(to->colour, from->colour, sizeof(to->colour));
	}
}

static int load(struct model *base, uint32_t piece, struct model_mesh *out)
{
	struct model_master *model = (struct model_master *)base;
	const struct hierarchy *hierarchy = &model->master->hierarchy;
	uint32_t group = hierarchy->patches[piece].group;
	const struct patch_mesh *patch;
	struct decoded *decoded;
	int rc = get_group(model, group, &decoded);

	if (rc < 0)
		return rc;
	patch = &decoded->patches[piece - hierarchy->groups[group].first_patch];
	convert(model, patch);
	*out = (struct model_mesh){ .vertex_count = patch->vertex_count,
				    .index_count = 3 * patch->triangle_count,
				    .vertices = model->vertices,
				    .indices = patch->indices };
	if (base->pieces[piece].radius_m < 0)
		model_sum(&base->pieces[piece], out);
	return 0;
}

static void destroy(struct model *base)
{
	struct model_master *model = (struct model_master *)base;

	for (int i = 0; i < GROUPS_KEPT; i++)
		forget(&model->kept[i]);
	buffer_finish(&model->object);
	free(model->detail_m);
	free(base->pieces);
	free(model);
}

int model_of_master(struct model **out, const struct master *master)
{
	static const struct model_methods methods = { choose, load, destroy };
	const struct hierarchy *hierarchy = &master->hierarchy;
	struct model_master *model = calloc(1, sizeof(*model));

	*out = NULL;
	if (!model)
		return -ENOMEM;
	model->master = master;
	buffer_init(&model->object, OBJECT_BYTES_MAX);
	for (int i = 0; i < GROUPS_KEPT; i++)
		model->kept[i].group = HIERARCHY_NONE;
	model->detail_m = malloc(hierarchy->group_count * sizeof(*model->detail_m));
	model->model.pieces = malloc(hierarchy->patch_count * sizeof(struct model_piece));
	if (!model->detail_m || !model->model.pieces) {
		destroy(&model->model);
		return -ENOMEM;
	}
	model->model.methods = &methods;
	model->model.piece_count = hierarchy->patch_count;
	memcpy(model->model.low_m, master->box_min_m, sizeof(master->box_min_m));
	memcpy(model->model.high_m, master->box_max_m, sizeof(master->box_max_m));
	for (uint32_t p = 0; p < hierarchy->patch_count; p++) {
		const struct hierarchy_patch *patch = &hierarchy->patches[p];
		struct model_piece *piece = &model->model.pieces[p];

		*piece = (struct model_piece){ .radius_m = -1 };
		for (int i = 0; i < 3; i++) {
			piece->low_m[i] = patch->centre_m[i] - patch->radius_m;
			piece->high_m[i] = patch->centre_m[i] + patch->radius_m;
		}
	}
	find_details(model);
	*out = &model->model;
	return 0;
}
