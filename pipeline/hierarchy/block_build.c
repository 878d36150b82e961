/* The order of the work: passes over the scan, borders, stage after stage, then everything in one
 * list. */
#include "pipeline/hierarchy/block_build.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/processes.h"
#include "base/progress.h"
#include "base/shared_memory.h"
#include "format/patch.h"
#include "pipeline/hierarchy/block_node.h"
#include "pipeline/hierarchy/block_work.h"

struct build {
	struct block_site site;
	uint32_t node_count; /* so far */
	struct progress *progress;
};

/* ---- before the stages */

static int find_blocks(struct build *build)
{
	const size_t size = sizeof(struct block_counts);
	struct block_site *site = &build->site;
	struct block_counts *counts = shared_memory_create(size);
	uint32_t triangles = site->scan.mesh->triangle_count;
	uint64_t edge_steps;
	int rc = counts ? block_scan_count(&site->scan, counts, site->look.exposure, &edge_steps)
			: -ENOMEM;

	if (rc == 0)
		rc = block_cells_create(&site->cells, counts, site->options.block_triangles);
	shared_memory_destroy(counts, size);
	if (rc == 0)
		rc = exposure_close(site->look.exposure);
	if (rc == 0)
		site->look.footprint_m =
			(float)((double)edge_steps / triangles * site->scan.lattice.step_m);
	return rc;
}

static int write_border(void *user, uint32_t block)
{
	const struct build *build = user;
	const struct block_site *site = &build->site;

	return block_border_write(&site->scan, &site->cells, &site->look, site->folder, block);
}

static int settle_borders(struct build *build)
{
	struct block_site *site = &build->site;
	const struct processes processes = {
		.worker_count = site->options.jobs,
		.piece_count = site->cells.block_count,
		.shard = site->options.shard,
		.work = write_border,
		.user = build,
	};
	int rc = processes_run(&processes);

	return rc < 0 ? rc : block_border_read(&site->border, &site->cells, site->folder);
}

/* ---- stages */

static int work_on_block(void *user, uint32_t block)
{
	const struct build *build = user;

	return block_work(&build->site, block, 1);
}

static void block_is_done(void *user, uint32_t block)
{
	struct build *build = user;

	if (build->site.stage.number == 0)
		progress_add(build->progress, build->site.cells.triangle_counts[block]);
}

/* A single block is worked on here, with threads. */
static int run_stage(struct build *build, uint32_t block_count)
{
	struct block_site *site = &build->site;
	const struct processes processes = {
		.worker_count = site->options.jobs,
		.piece_count = block_count,
		.shard = site->options.shard,
		.work = work_on_block,
		.done = block_is_done,
		.user = build,
	};

	site->first_node = build->node_count;
	site->is_last = block_count == 1;
	build->node_count += block_count;
	return block_count == 1 ? block_work(site, 0, site->options.jobs)
				: processes_run(&processes);
}

/* Takes stage after stage until one block is left. Where locked borders hinder a stage, larger
 * groups have less of them; where these do not help either, the rest is one block. */
static int run_stages(struct build *build)
{
	struct block_site *site = &build->site;
	uint64_t before = UINT64_MAX;
	bool whole = false;
	int rc;

	if (site->cells.block_count > 1)
		build->progress = progress_start("simplifying blocks", "triangles",
						 site->scan.mesh->triangle_count);
	rc = run_stage(build, site->cells.block_count);
	progress_end(build->progress);
	build->progress = NULL;
	while (rc == 0 && !site->is_last) {
		uint32_t number = site->stage.number + 1, first = site->first_node;

		block_stage_finish(&site->stage);
		rc = block_stage_create(&site->stage, site->folder, number, first,
					build->node_count - first, site->options.block_triangles,
					whole);
		if (rc < 0)
			break;
		if (site->stage.triangle_count > before - before / 5) {
			whole = site->options.group_patches >= GROUP_PATCHES_MAX / 2 ||
				number >= MULTIRES_LEVELS_MAX / 2;
			site->options.group_patches = GROUP_PATCHES_MAX / 2;
		}
		before = site->stage.triangle_count;
		rc = run_stage(build, site->stage.block_count);
	}
	return rc;
}

/* ---- all groups in one list */

struct collector {
	struct block_build *out;
	uint32_t *bases; /* for each node, the number of groups of the nodes before */
	struct hierarchy made;
	uint32_t group_room, patch_room;
	const struct multires_sink *sink;
};

static int make_room(struct collector *collector, const struct hierarchy *more)
{
	struct hierarchy *made = &collector->made;
	int rc = ARRAY_RESERVE(made->groups, collector->group_room,
			       (uint64_t)made->group_count + more->group_count, UINT32_MAX);

	if (rc == 0)
		rc = ARRAY_RESERVE(made->patches, collector->patch_room,
				   (uint64_t)made->patch_count + more->patch_count, UINT32_MAX);
	return rc;
}

static int resolve(uint32_t *finer, const struct collector *collector,
		   const struct block_result *result, uint32_t node)
{
	if (*finer == NO_GROUP)
		return 0;
	if (*finer >= result->other_count) {
		*finer = collector->bases[node] + *finer - result->other_count;
		return 0;
	}
	if (result->others[*finer].node >= node)
		return -EBADMSG;
	*finer = collector->bases[result->others[*finer].node] + result->others[*finer].number;
	return 0;
}

static int add_rows(struct collector *collector, const struct block_result *result, uint32_t node)
{
	struct hierarchy *made = &collector->made;
	int rc = make_room(collector, &result->made);

	if (rc < 0)
		return rc;
	for (uint32_t g = 0; g < result->made.group_count; g++) {
		struct hierarchy_group *group = &made->groups[made->group_count++];

		*group = result->made.groups[g];
		group->first_patch += made->patch_count;
	}
	for (uint32_t p = 0; rc == 0 && p < result->made.patch_count; p++) {
		struct hierarchy_patch *patch = &made->patches[made->patch_count + p];

		*patch = result->made.patches[p];
		rc = resolve(&patch->finer, collector, result, node);
	}
	made->patch_count += result->made.patch_count;
	collector->bases[node + 1] = made->group_count;
	return rc;
}

static void add_report(struct block_build *out, const struct block_result *result)
{
	const struct multires_stats *from = &result->stats;
	struct multires_stats *to = &out->stats;

	for (uint32_t l = 0; l < from->level_count; l++) {
		to->levels[l].triangle_count += from->levels[l].triangle_count;
		to->levels[l].patch_count += from->levels[l].patch_count;
		to->levels[l].group_count += from->levels[l].group_count;
	}
	if (from->level_count > to->level_count)
		to->level_count = from->level_count;
	to->object_bytes += from->object_bytes;
	to->vertex_count += from->vertex_count;
	out->counts.merged_vertices += result->counts.merged_vertices;
	out->counts.degenerate_triangles += result->counts.degenerate_triangles;
	out->counts.duplicate_triangles += result->counts.duplicate_triangles;
	out->counts.border_edges += result->counts.border_edges;
	out->counts.crowded_edges += result->counts.crowded_edges;
}

static int collect_node(struct collector *collector, const char *folder, uint32_t node)
{
	struct block_result result;
	size_t at = 0;
	int rc = block_result_read(&result, folder, node);

	if (rc == 0)
		rc = add_rows(collector, &result, node);
	if (rc == 0)
		add_report(collector->out, &result);
	for (uint32_t g = 0; rc == 0 && g < result.made.group_count; g++) {
		struct bytes object = { result.objects.data + at, result.sizes[g] };

		if (object.size > result.objects.size - at)
			rc = -EBADMSG;
		if (rc == 0)
			rc = collector->sink->put(collector->sink->user, object,
						  result.losses_m4[g]);
		at += object.size;
	}
	block_result_finish(&result);
	return rc;
}

/* Reverses the order of groups: made finest first, stored coarsest first. */
static int turn_round(struct hierarchy *out, const struct hierarchy *made)
{
	uint32_t last = made->group_count - 1;

	*out = (struct hierarchy){
		.group_count = made->group_count,
		.groups = calloc(made->group_count, sizeof(*out->groups)),
		.patches = calloc(made->patch_count, sizeof(*out->patches)),
	};
	if (!out->groups || !out->patches) {
		hierarchy_finish(out);
		return -ENOMEM;
	}
	for (uint32_t g = 0; g <= last; g++) {
		const struct hierarchy_group *from = &made->groups[last - g];

		out->groups[g] = *from;
		out->groups[g].first_patch = out->patch_count;
		for (uint32_t p = 0; p < from->patch_count; p++) {
			struct hierarchy_patch *patch = &out->patches[out->patch_count++];

			*patch = made->patches[from->first_patch + p];
			patch->group = g;
			if (patch->finer != NO_GROUP)
				patch->finer = last - patch->finer;
		}
	}
	return 0;
}

static int collect(struct block_build *out, const struct build *build,
		   const struct multires_sink *sink)
{
	uint32_t nodes = build->node_count;
	struct collector collector = {
		.out = out,
		.bases = calloc(nodes + (size_t)1, sizeof(*collector.bases)),
		.sink = sink,
	};
	int rc = collector.bases ? 0 : -ENOMEM;

	for (uint32_t n = 0; rc == 0 && n < nodes; n++)
		rc = collect_node(&collector, build->site.folder, n);
	if (rc == 0)
		rc = turn_round(&out->hierarchy, &collector.made);
	if (rc == 0)
		rc = hierarchy_check(&out->hierarchy) < 0 ? -EPROTO : 0;
	hierarchy_finish(&collector.made);
	free(collector.bases);
	return rc;
}

/* ---- the whole */

static int run(struct build *build)
{
	struct block_site *site = &build->site;
	int rc = exposure_create(&site->look.exposure);

	if (rc == 0)
		rc = find_blocks(build);
	if (rc == 0)
		rc = block_split(&site->scan, &site->cells, site->folder);
	if (rc == 0)
		rc = settle_borders(build);
	if (rc == 0)
		rc = run_stages(build);
	return rc;
}

int block_build(struct block_build *out, const char *folder, const struct mesh *mesh,
		const struct multires_options *options, bool is_stone,
		enum substance_kind substance, const struct multires_sink *sink)
{
	struct build build = {
		.site = { .look = { .plain_colour = { 184, 172, 150 },
				    .is_stone = is_stone,
				    .substance = substance },
			  .options = *options,
			  .folder = folder },
	};
	struct block_site *site = &build.site;
	int rc;

	*out = (struct block_build){ 0 };
	multires_set_defaults(&site->options, mesh->triangle_count);
	rc = block_scan_init(&site->scan, mesh, site->options.step_max_m, site->options.jobs);
	site->scan.shard = site->options.shard;
	if (rc == 0)
		rc = run(&build);
	if (rc == 0)
		rc = collect(out, &build, sink);
	out->lattice = site->scan.lattice;
	memcpy(out->box_min_m, site->scan.box_min_m, sizeof(out->box_min_m));
	memcpy(out->box_max_m, site->scan.box_max_m, sizeof(out->box_max_m));
	exposure_destroy(site->look.exposure);
	block_cells_finish(&site->cells);
	block_border_finish(&site->border);
	block_stage_finish(&site->stage);
	if (rc < 0)
		block_build_finish(out);
	return rc;
}

void block_build_finish(struct block_build *build)
{
	if (!build)
		return;
	hierarchy_finish(&build->hierarchy);
	*build = (struct block_build){ 0 };
}
