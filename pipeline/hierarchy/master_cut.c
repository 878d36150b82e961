/* Selects the part of a master that is published, by greedy choice of the groups with the largest
 * loss. */
#include "pipeline/hierarchy/master_cut.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

struct ranked {
	float loss_m4;
	uint32_t group;
};

/* Largest loss first. Losses are saturated, so a group never comes before those it depends on. */
static int compare_ranked(const void *left, const void *right)
{
	const struct ranked *a = left, *b = right;

	if (a->loss_m4 != b->loss_m4)
		return a->loss_m4 > b->loss_m4 ? -1 : 1;
	return a->group < b->group ? -1 : a->group > b->group;
}

static uint64_t group_triangles(const struct hierarchy *hierarchy, uint32_t group)
{
	const struct hierarchy_group *row = &hierarchy->groups[group];
	uint64_t count = 0;

	for (uint32_t p = row->first_patch; p < row->first_patch + row->patch_count; p++)
		count += hierarchy->patches[p].triangle_count;
	return count;
}

/* missing[g] is the number of patches that g replaces and that are not chosen yet. */
static void choose_group(const struct hierarchy *hierarchy, uint32_t group, uint32_t *missing)
{
	const struct hierarchy_group *row = &hierarchy->groups[group];

	for (uint32_t p = row->first_patch; p < row->first_patch + row->patch_count; p++)
		if (hierarchy->patches[p].finer != HIERARCHY_NONE)
			missing[hierarchy->patches[p].finer]--;
}

/* Chooses groups with at most `most` triangles. Returns the number of triangles chosen. */
static uint64_t choose(bool *chosen, struct ranked *ranked, uint32_t *missing,
		       const struct master *master, uint64_t most)
{
	const struct hierarchy *hierarchy = &master->hierarchy;
	uint64_t total = 0;

	for (uint32_t p = 0; p < hierarchy->patch_count; p++)
		if (hierarchy->patches[p].finer != HIERARCHY_NONE)
			missing[hierarchy->patches[p].finer]++;
	for (uint32_t g = 0; g < hierarchy->group_count; g++)
		ranked[g] = (struct ranked){ master->losses_m4[g], g };
	qsort(ranked, hierarchy->group_count, sizeof(*ranked), compare_ranked);
	for (uint32_t i = 0; i < hierarchy->group_count; i++) {
		uint32_t group = ranked[i].group;
		uint64_t triangles = group_triangles(hierarchy, group);

		if (missing[group] > 0 || total + triangles > most)
			continue;
		chosen[group] = true;
		total += triangles;
		choose_group(hierarchy, group, missing);
	}
	return total;
}

static void copy_group(struct master_cut *out, const struct hierarchy *from, uint32_t group,
		       const uint32_t *names)
{
	const struct hierarchy_group *row = &from->groups[group];
	uint32_t name = out->hierarchy.group_count++;

	out->groups[name] = group;
	out->hierarchy.groups[name] = *row;
	out->hierarchy.groups[name].first_patch = out->hierarchy.patch_count;
	for (uint32_t p = row->first_patch; p < row->first_patch + row->patch_count; p++) {
		struct hierarchy_patch *patch =
			&out->hierarchy.patches[out->hierarchy.patch_count++];

		*patch = from->patches[p];
		patch->group = name;
		if (patch->finer != HIERARCHY_NONE)
			patch->finer = names[patch->finer];
	}
}

static int copy_chosen(struct master_cut *out, const struct hierarchy *from, const bool *chosen)
{
	uint32_t *names = malloc(from->group_count * sizeof(*names)), count = 0;

	out->groups = calloc(from->group_count, sizeof(*out->groups));
	out->hierarchy.groups = calloc(from->group_count, sizeof(*out->hierarchy.groups));
	out->hierarchy.patches = calloc(from->patch_count, sizeof(*out->hierarchy.patches));
	if (!names || !out->groups || !out->hierarchy.groups || !out->hierarchy.patches) {
		free(names);
		return -ENOMEM;
	}
	for (uint32_t g = 0; g < from->group_count; g++)
		names[g] = chosen[g] ? count++ : HIERARCHY_NONE;
	for (uint32_t g = 0; g < from->group_count; g++)
		if (chosen[g])
			copy_group(out, from, g, names);
	free(names);
	return 0;
}

int master_cut_create(struct master_cut *out, const struct master *master, double share)
{
	const struct hierarchy *hierarchy = &master->hierarchy;
	bool *chosen = calloc(hierarchy->group_count, sizeof(*chosen));
	struct ranked *ranked = calloc(hierarchy->group_count, sizeof(*ranked));
	uint32_t *missing = calloc(hierarchy->group_count, sizeof(*missing));
	/* All levels together have about twice the triangles of the scan, so 1 means no limit. */
	uint64_t most =
		share >= 1 ? UINT64_MAX : (uint64_t)(share * (double)master->source_triangles);
	int rc = chosen && ranked && missing ? 0 : -ENOMEM;

	*out = (struct master_cut){ 0 };
	if (rc == 0) {
		out->triangle_count = choose(chosen, ranked, missing, master, most);
		rc = chosen[0] ? copy_chosen(out, hierarchy, chosen) : -ERANGE;
	}
	free(chosen);
	free(ranked);
	free(missing);
	if (rc < 0)
		master_cut_finish(out);
	return rc;
}

void master_cut_finish(struct master_cut *cut)
{
	if (!cut)
		return;
	hierarchy_finish(&cut->hierarchy);
	free(cut->groups);
	*cut = (struct master_cut){ 0 };
}
