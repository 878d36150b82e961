/* Grows a cut through the patch hierarchy with a heap of errors, for what is shown and for what is
 * desired. */
#include "render/patches/cut.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"

/* ---- structure */

static int index_replaced(struct cut *cut)
{
	const struct hierarchy *h = cut->hierarchy;
	cut->replaced_first = calloc(h->group_count + 2, sizeof(uint32_t));
	cut->replaced = calloc(h->patch_count + 1, sizeof(uint32_t));
	if (!cut->replaced_first || !cut->replaced)
		return -ENOMEM;
	/* Counting sort of the patches by the group that replaces them. */
	uint32_t *first = cut->replaced_first;
	for (uint32_t p = 0; p < h->patch_count; p++)
		if (h->patches[p].finer != HIERARCHY_NONE)
			first[h->patches[p].finer + 2]++;
	for (uint32_t g = 0; g < h->group_count; g++)
		first[g + 2] += first[g + 1];
	for (uint32_t p = 0; p < h->patch_count; p++)
		if (h->patches[p].finer != HIERARCHY_NONE)
			cut->replaced[first[h->patches[p].finer + 1]++] = p;
	return 0;
}

int cut_init(struct cut *cut, const struct hierarchy *hierarchy)
{
	memset(cut, 0, sizeof(*cut));
	cut->hierarchy = hierarchy;
	size_t groups = hierarchy->group_count + 1, patches = hierarchy->patch_count + 1;
	cut->shown = calloc(groups, 1);
	cut->desired = calloc(groups, 1);
	cut->waiting = calloc(groups, sizeof(uint32_t));
	cut->heap_group = calloc(groups, sizeof(uint32_t));
	cut->heap_error = calloc(groups, sizeof(float));
	cut->patches = calloc(patches, sizeof(uint32_t));
	cut->patch_px = calloc(patches, sizeof(float));
	cut->group_px = calloc(groups, sizeof(float));
	cut->needed = calloc(groups, 1);
	cut->wants = calloc(groups, sizeof(*cut->wants));
	bool ok = cut->shown && cut->desired && cut->waiting && cut->heap_group &&
		  cut->heap_error && cut->patches && cut->wants && cut->patch_px && cut->group_px &&
		  cut->needed;
	int rc = ok ? index_replaced(cut) : -ENOMEM;
	if (rc < 0)
		cut_finish(cut);
	return rc;
}

void cut_finish(struct cut *cut)
{
	free(cut->shown);
	free(cut->desired);
	free(cut->waiting);
	free(cut->heap_group);
	free(cut->heap_error);
	free(cut->patches);
	free(cut->wants);
	free(cut->patch_px);
	free(cut->group_px);
	free(cut->needed);
	free(cut->replaced_first);
	free(cut->replaced);
	memset(cut, 0, sizeof(*cut));
}

const uint32_t *cut_replaced(const struct cut *cut, uint32_t group, uint32_t *count)
{
	*count = cut->replaced_first[group + 1] - cut->replaced_first[group];
	return cut->replaced + cut->replaced_first[group];
}

bool cut_depends(const struct cut *cut, uint32_t group, uint32_t on_group)
{
	uint32_t count;
	const uint32_t *replaced = cut_replaced(cut, group, &count);
	for (uint32_t i = 0; i < count; i++)
		if (cut->hierarchy->patches[replaced[i]].group == on_group)
			return true;
	return false;
}

/* ---- heap, largest error on top */

static void heap_push(struct cut *cut, uint32_t group, float error)
{
	uint32_t at = cut->heap_count++;
	while (at > 0 && cut->heap_error[(at - 1) / 2] < error) {
		cut->heap_error[at] = cut->heap_error[(at - 1) / 2];
		cut->heap_group[at] = cut->heap_group[(at - 1) / 2];
		at = (at - 1) / 2;
	}
	cut->heap_error[at] = error;
	cut->heap_group[at] = group;
}

static uint32_t heap_pop(struct cut *cut)
{
	uint32_t top = cut->heap_group[0];
	uint32_t group = cut->heap_group[--cut->heap_count];
	float error = cut->heap_error[cut->heap_count];
	uint32_t at = 0;
	for (;;) {
		uint32_t child = 2 * at + 1;
		if (child >= cut->heap_count)
			break;
		if (child + 1 < cut->heap_count &&
		    cut->heap_error[child + 1] > cut->heap_error[child])
			child++;
		if (cut->heap_error[child] <= error)
			break;
		cut->heap_error[at] = cut->heap_error[child];
		cut->heap_group[at] = cut->heap_group[child];
		at = child;
	}
	cut->heap_error[at] = error;
	cut->heap_group[at] = group;
	return top;
}

/* ---- growing */

float cut_group_error_px(const struct hierarchy_group *group, const float eye_m[3], float focal_px)
{
	static const float nearest_m = 1e-4f;
	const float distance_m = vec_distance(group->centre_m, eye_m) - group->radius_m;

	return group->error_m * focal_px / vec_most(distance_m, nearest_m);
}

/* The viewpoint, the allowed groups and the limits for growing a cut. */
struct growth {
	const struct view *view; /* NULL: in all directions */
	const float *eye_m;
	float focal_px;
	const uint8_t *loaded; /* only these groups may be refined */
	uint8_t *refined;
	const struct cut_options *options;
};

static float growth_error(const struct cut *cut, const struct growth *growth, uint32_t group)
{
	return cut_group_error_px(&cut->hierarchy->groups[group], growth->eye_m, growth->focal_px);
}

static uint32_t patch_cost(const struct growth *growth, const struct hierarchy_patch *patch)
{
	if (growth->view && !view_sees_sphere(growth->view, patch->centre_m, patch->radius_m))
		return 0;
	return patch->triangle_count;
}

static int64_t group_cost(const struct cut *cut, const struct growth *growth, uint32_t group)
{
	const struct hierarchy *h = cut->hierarchy;
	const struct hierarchy_group *g = &h->groups[group];
	int64_t cost = 0;
	for (uint32_t p = g->first_patch; p < g->first_patch + g->patch_count; p++)
		cost += patch_cost(growth, &h->patches[p]);
	for (uint32_t i = cut->replaced_first[group]; i < cut->replaced_first[group + 1]; i++)
		cost -= patch_cost(growth, &h->patches[cut->replaced[i]]);
	return cost;
}

/* Pushes the finer groups for which this group was the last missing dependency. */
static void release_finer(struct cut *cut, const struct growth *growth, uint32_t group)
{
	const struct hierarchy *h = cut->hierarchy;
	const struct hierarchy_group *g = &h->groups[group];
	for (uint32_t p = g->first_patch; p < g->first_patch + g->patch_count; p++) {
		uint32_t finer = h->patches[p].finer;
		if (finer == HIERARCHY_NONE || --cut->waiting[finer] > 0)
			continue;
		if (growth->loaded[finer])
			heap_push(cut, finer, growth_error(cut, growth, finer));
	}
}

static int64_t grow(struct cut *cut, const struct growth *growth)
{
	const struct hierarchy *h = cut->hierarchy;
	memset(growth->refined, 0, h->group_count);
	cut->heap_count = 0;
	for (uint32_t g = 0; g < h->group_count; g++)
		cut->waiting[g] = cut->replaced_first[g + 1] - cut->replaced_first[g];
	if (h->group_count > 0 && growth->loaded[0])
		heap_push(cut, 0, INFINITY);
	int64_t triangles = 0;
	while (cut->heap_count > 0 && cut->heap_error[0] >= growth->options->error_px) {
		uint32_t group = heap_pop(cut);
		int64_t cost = group_cost(cut, growth, group);
		if (group != 0 && triangles + cost > growth->options->triangle_budget)
			continue;
		triangles += cost;
		growth->refined[group] = 1;
		release_finer(cut, growth, group);
	}
	return triangles;
}

bool cut_shows(const struct cut *cut, uint32_t patch)
{
	const struct hierarchy_patch *p = &cut->hierarchy->patches[patch];
	return cut->shown[p->group] && (p->finer == HIERARCHY_NONE || !cut->shown[p->finer]);
}

static void list_patches(struct cut *cut)
{
	cut->patch_count = 0;
	for (uint32_t p = 0; p < cut->hierarchy->patch_count; p++)
		if (cut_shows(cut, p))
			cut->patches[cut->patch_count++] = p;
}

void cut_update(struct cut *cut, const struct view *view, const uint8_t *loaded,
		const struct cut_options *options)
{
	struct growth growth = { view, view->eye_m, view->focal_px, loaded, cut->shown, options };
	cut->triangle_count = (uint32_t)grow(cut, &growth);
	list_patches(cut);
}

/* ---- desire */

/* Computes the visible pixels of each patch and of what each group replaces. A group comes after
 * those it depends on, so the pixels of coarser patches are known before they are shared out. */
static void share_out(struct cut *cut, const struct view *view, const float *seen_px)
{
	const struct hierarchy *h = cut->hierarchy;
	const struct growth growth = { .view = view };
	for (uint32_t i = 0; i < h->patch_count; i++)
		cut->patch_px[i] = -1;
	for (uint32_t i = 0; i < cut->patch_count; i++) {
		uint32_t p = cut->patches[i];
		const struct hierarchy_patch *patch = &h->patches[p];
		cut->patch_px[p] = seen_px ? seen_px[p] : -1;
		if (!view_sees_sphere(view, patch->centre_m, patch->radius_m))
			cut->patch_px[p] = 0;
		else if (cut->patch_px[p] < 0)
			cut->patch_px[p] = view_sphere_px(view, patch->centre_m, patch->radius_m);
	}
	for (uint32_t g = 0; g < h->group_count; g++) {
		const struct hierarchy_group *group = &h->groups[g];
		uint32_t count, triangles = 0;
		const uint32_t *replaced = cut_replaced(cut, g, &count);
		cut->group_px[g] = g == 0 ? view->picture_px : 0;
		for (uint32_t i = 0; i < count; i++)
			cut->group_px[g] += vec_most(cut->patch_px[replaced[i]], 0);
		for (uint32_t p = group->first_patch; p < group->first_patch + group->patch_count;
		     p++)
			triangles += patch_cost(&growth, &h->patches[p]);
		for (uint32_t p = group->first_patch; p < group->first_patch + group->patch_count;
		     p++)
			if (cut->patch_px[p] < 0 && triangles > 0)
				cut->patch_px[p] = cut->group_px[g] *
						   (float)patch_cost(&growth, &h->patches[p]) /
						   (float)triangles;
	}
}

/* Marks the groups that are visible, and those they depend on. */
static void mark_needed(struct cut *cut, const struct view *view, float error_px)
{
	const struct hierarchy *h = cut->hierarchy;
	memset(cut->needed, 0, h->group_count);
	for (uint32_t g = h->group_count; g-- > 0;) {
		uint32_t count;
		const uint32_t *replaced = cut_replaced(cut, g, &count);
		if (cut->group_px[g] > 0 &&
		    view_sees_sphere(view, h->groups[g].centre_m, h->groups[g].radius_m) &&
		    cut_group_error_px(&h->groups[g], view->eye_m, view->focal_px) >= error_px)
			cut->needed[g] = 1;
		for (uint32_t i = 0; i < count && cut->needed[g]; i++)
			cut->needed[h->patches[replaced[i]].group] = 1;
	}
}

void cut_desire(struct cut *cut, const struct view *view, const uint8_t *loaded,
		const float *seen_px, const struct cut_options *options)
{
	share_out(cut, view, seen_px);
	mark_needed(cut, view, options->error_px);
	struct growth growth = { view,        view->eye_m,  view->focal_px,
				 cut->needed, cut->desired, options };
	grow(cut, &growth);
	cut->want_count = 0;
	for (uint32_t g = 0; g < cut->hierarchy->group_count; g++) {
		if (!cut->desired[g] || loaded[g])
			continue;
		const struct hierarchy_group *group = &cut->hierarchy->groups[g];
		cut->wants[cut->want_count++] = (struct cut_want){
			.group = g,
			.error_px = cut_group_error_px(group, view->eye_m, view->focal_px),
			.seen_px = cut->group_px[g],
		};
	}
}

void cut_update_around(struct cut *cut, const float eye_m[3], float focal_px, const uint8_t *loaded,
		       const struct cut_options *options)
{
	struct growth growth = { NULL, eye_m, focal_px, loaded, cut->shown, options };
	cut->triangle_count = (uint32_t)grow(cut, &growth);
	list_patches(cut);
}
