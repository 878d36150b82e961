/* Processes one group of a level: writes its object, merges its patches, simplifies them and
 * divides them again. */
#include "pipeline/hierarchy/multires_job.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "format/patch.h"
#include "pipeline/hierarchy/multires_write.h"
#include "pipeline/hierarchy/partition.h"
#include "pipeline/hierarchy/simplify.h"
#include "pipeline/hierarchy/simplify_features.h"

/* The error that one level may add, as a multiple of the error so far. */
#define ERROR_GROWTH 9.0

void live_patch_finish(struct live_patch *patch)
{
	free(patch->triangles);
	patch->triangles = NULL;
}

void live_patches_finish(struct live_patches *patches)
{
	if (!patches)
		return;
	for (uint32_t p = 0; p < patches->count; p++)
		live_patch_finish(&patches->items[p]);
	free(patches->items);
	*patches = (struct live_patches){ 0 };
}

int live_patches_add(struct live_patches *patches, struct live_patch patch)
{
	int rc = ARRAY_RESERVE(patches->items, patches->room, patches->count + 1, UINT32_MAX);

	if (rc == 0)
		patches->items[patches->count++] = patch;
	else
		live_patch_finish(&patch);
	return rc;
}

/* The group's patches merged into one surface with local vertex indices. */
struct merged {
	struct simplify_surface surface; /* owned */
	uint32_t *globals;               /* owned; for each vertex, its index in the scan */
};

static void merged_finish(struct merged *merged)
{
	free(merged->surface.vertices);
	free(merged->surface.locked);
	free(merged->surface.triangles);
	free(merged->globals);
}

static uint32_t triangles_of(const struct group_job *job)
{
	uint32_t count = 0;

	for (uint32_t p = 0; p < job->patch_count; p++)
		count += job->patches[p].triangle_count;
	return count;
}

static void name_corners(struct merged *merged, const struct group_job *job, uint32_t *local_of)
{
	struct simplify_surface *surface = &merged->surface;

	for (uint32_t p = 0; p < job->patch_count; p++)
		for (uint32_t t = 0; t < job->patches[p].triangle_count; t++) {
			const uint32_t *from = job->patches[p].triangles[t];

			for (int corner = 0; corner < 3; corner++) {
				uint32_t *name = &local_of[from[corner]];

				if (*name == NO_GROUP) {
					merged->globals[surface->vertex_count] = from[corner];
					*name = surface->vertex_count++;
				}
				surface->triangles[surface->triangle_count][corner] = *name;
			}
			surface->triangle_count++;
		}
	for (uint32_t v = 0; v < surface->vertex_count; v++)
		local_of[merged->globals[v]] = NO_GROUP;
}

static int merge(struct merged *merged, const struct job_site *site, const struct group_job *job,
		 uint32_t *local_of)
{
	struct simplify_surface *surface = &merged->surface;
	size_t count = triangles_of(job);

	*merged = (struct merged){ .globals = malloc(3 * count * sizeof(*merged->globals)) };
	surface->triangles = malloc(count * sizeof(*surface->triangles));
	if (!surface->triangles || !merged->globals)
		return -ENOMEM;
	name_corners(merged, job, local_of);
	surface->vertices = malloc(surface->vertex_count * sizeof(*surface->vertices));
	surface->locked = malloc(surface->vertex_count);
	surface->fine_bits = site->mesh->lattice.fine_bits;
	if (!surface->vertices || !surface->locked)
		return -ENOMEM;
	for (uint32_t v = 0; v < surface->vertex_count; v++) {
		uint32_t global = merged->globals[v];

		surface->vertices[v] = site->mesh->vertices[global];
		surface->locked[v] = (site->pinned && site->pinned[global]) ||
				     site->lows[global] < job->low ||
				     site->highs[global] > job->high;
	}
	return 0;
}

/* Unlocked vertices are used by this group only, so they may change in place. */
static void give_back_vertices(const struct merged *merged, const struct job_site *site)
{
	for (uint32_t v = 0; v < merged->surface.vertex_count; v++)
		if (!merged->surface.locked[v])
			site->mesh->vertices[merged->globals[v]] = merged->surface.vertices[v];
}

static int add_coarser(struct group_job *job, const struct merged *merged, const uint32_t *chosen,
		       uint32_t count)
{
	struct live_patch patch = {
		.triangles = malloc(count * sizeof(*patch.triangles)),
		.triangle_count = count,
		.finer = job->number,
		.error_m = job->group.error_m,
		.loss_m4 = job->loss_m4,
		.finer_sphere = { .radius = job->group.radius_m },
	};
	const float coarse = 1.0f / (float)(1 << merged->surface.fine_bits);

	if (!patch.triangles)
		return -ENOMEM;
	for (int i = 0; i < 3; i++)
		patch.finer_sphere.centre[i] = job->group.centre_m[i];
	for (uint32_t t = 0; t < count; t++)
		for (int corner = 0; corner < 3; corner++) {
			uint32_t local = merged->surface.triangles[chosen[t]][corner];

			patch.triangles[t][corner] = merged->globals[local];
			for (int i = 0; i < 3; i++)
				patch.centre[i] +=
					coarse *
					(float)merged->surface.vertices[local].position[i] /
					(3.0f * (float)count);
		}
	return live_patches_add(&job->coarser, patch);
}

static int divide(struct group_job *job, const struct merged *merged, uint32_t patch_triangles)
{
	const struct simplify_surface *surface = &merged->surface;
	const struct partition_options options = {
		.voxel_triangles = patch_triangles,
		.chunk_triangles = UINT32_MAX,
		.patch_triangles = patch_triangles,
		.fine_bits = surface->fine_bits,
	};
	struct partition partition;
	uint32_t *sorted = malloc(surface->triangle_count * sizeof(*sorted));
	int rc = partition_create(&partition, surface->vertices, surface->vertex_count,
				  surface->triangles, surface->triangle_count, &options);

	if (!sorted)
		rc = rc < 0 ? rc : -ENOMEM;
	for (uint32_t leaf = 0; rc == 0 && leaf < partition.leaf_count; leaf++) {
		uint32_t count = 0;

		for (uint32_t t = 0; t < surface->triangle_count; t++)
			if (partition.leaf_of[t] == leaf)
				sorted[count++] = t;
		rc = add_coarser(job, merged, sorted, count);
	}
	partition_finish(&partition);
	free(sorted);
	return rc;
}

/* Limits the error of a simplification. If a locked border hinders a group, few collapses are
 * better than wild ones: on the next level the border is elsewhere. The first level has no earlier
 * error to go by, and the last one has no locked border. */
static double error_most(const struct job_site *site, const struct group_job *job, double error_m)
{
	if (job->is_whole || error_m <= 0.0)
		return INFINITY;
	return ERROR_GROWTH * error_m / site->mesh->lattice.step_m;
}

/* Of features, none is stronger than that a level must become coarser. */
static int simplify_group(const struct job_site *site, const struct group_job *job, double error_m,
			  struct simplify_surface *surface, struct simplify_result *result)
{
	const double most = error_most(site, job, error_m);

	if (site->simplifier == MULTIRES_FEATURES)
		return simplify_features(surface, job->target_triangles, most, -1.0, result);
	return simplify(surface, job->target_triangles, most, result);
}

int group_job_run(const struct job_site *site, struct group_job *job, uint32_t worker)
{
	struct simplify_result result;
	struct merged merged = { 0 };
	const double step_m = site->mesh->lattice.step_m;
	double error = 0.0, loss = 0.0;
	int rc = group_job_write(site, job, site->local_of[worker]);

	for (uint32_t p = 0; p < job->patch_count; p++) {
		error = fmax(error, job->patches[p].error_m);
		loss = fmax(loss, job->patches[p].loss_m4);
	}
	job->group.error_m = job->loss_m4 = INFINITY;
	if (rc == 0 && job->target_triangles > 0) {
		rc = merge(&merged, site, job, site->local_of[worker]);
		if (rc == 0)
			rc = simplify_group(site, job, error, &merged.surface, &result);
		if (rc == 0) {
			/* The errors of the levels add up. */
			error += result.error_steps * step_m;
			job->group.error_m = (float)error;
			job->loss_m4 = (float)fmax(loss, result.loss_steps4 * pow(step_m, 4));
			give_back_vertices(&merged, site);
			rc = divide(job, &merged, site->patch_triangles);
		}
		merged_finish(&merged);
	}
	for (uint32_t p = 0; p < job->patch_count; p++)
		live_patch_finish(&job->patches[p]);
	return rc;
}

void group_job_finish(struct group_job *job)
{
	buffer_finish(&job->object);
	free(job->made);
	job->made = NULL;
	live_patches_finish(&job->coarser);
}
