/* Builds the hierarchy level by level: groups patches, runs a job for each group, and collects the
 * coarser patches, until the coarsest cut is small enough. */
#include "pipeline/hierarchy/multires.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/array.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "format/patch.h"
#include "pipeline/hierarchy/graph.h"
#include "pipeline/hierarchy/multires_job.h"
#include "pipeline/hierarchy/partition.h"

enum {
	PATCHES = 256, /* a scan has at least so many, unless they get too small */
	PATCH_TRIANGLES = 1000,
	PATCH_TRIANGLES_MIN = 256,
	FINEST_PATCHES_MAX = 1 << 19, /* all levels together have up to twice as many */
	GROUP_PATCHES = 8,
	REDUCTION = 4, /* factor by which triangles decrease per level */
	TOP_TRIANGLES = 6000,
	TOP_PART = 40, /* a small scan's top has 1/40 of it, far less than is published */
	BLOCK_TRIANGLES = 1 << 19,
	VOXEL_TRIANGLES = 256,
	CHUNK_TRIANGLES = 1 << 20,
	TOUCH_WEIGHT = 4, /* for each vertex that two patches share */
	NEIGHBOURS = 6,   /* nearest patches to which each patch gets an edge */
	NEAR_WEIGHT = 10  /* weight of each such edge */
};

struct builder {
	struct multires_options options;
	const struct multires_node *node;
	struct lattice_mesh *mesh; /* the node's */
	struct multires_stats *stats;
	const struct multires_sink *sink;
	struct job_site site;
	struct partition partition;
	struct live_patches level;
	struct group_job *jobs; /* jobs of the current level */
	uint32_t job_count;
	struct progress *progress; /* counts triangles of all levels */
	/* The hierarchy made so far, in the order of making. */
	struct hierarchy made;
	uint32_t group_room, patch_room;
};

/* Patches are small enough that a view can choose among them, in small scans too; docs/hierarchy.md
 * has the figures. */
static uint32_t patch_triangles_for(uint64_t triangle_count)
{
	uint64_t some = triangle_count / PATCHES;

	return some > PATCH_TRIANGLES       ? PATCH_TRIANGLES
	       : some < PATCH_TRIANGLES_MIN ? PATCH_TRIANGLES_MIN
					    : (uint32_t)some;
}

void multires_set_defaults(struct multires_options *options, uint64_t triangle_count)
{
	long processors = sysconf(_SC_NPROCESSORS_ONLN);
	const uint32_t least = (uint32_t)(triangle_count / FINEST_PATCHES_MAX);

	if (options->patch_triangles == 0)
		options->patch_triangles = patch_triangles_for(triangle_count);
	/* hierarchy_check would refuse more patches, after all the work. */
	if (options->patch_triangles < least)
		options->patch_triangles = least;
	if (options->patch_triangles > PATCH_TRIANGLES_MAX)
		options->patch_triangles = PATCH_TRIANGLES_MAX;
	if (options->group_patches < 2 || options->group_patches > GROUP_PATCHES_MAX / 2)
		options->group_patches = GROUP_PATCHES;
	if (options->top_triangles == 0)
		options->top_triangles = triangle_count / TOP_PART < TOP_TRIANGLES
						 ? (uint32_t)(triangle_count / TOP_PART) + 1
						 : TOP_TRIANGLES;
	if (options->block_triangles == 0)
		options->block_triangles = BLOCK_TRIANGLES;
	if (options->step_max_m <= 0)
		options->step_max_m = LATTICE_STEP_MAX_M;
	/* The paper's tree has its halves from the whole scan at once. */
	if (options->kind == MULTIRES_TREE)
		options->block_triangles = UINT32_MAX;
	if (options->jobs == 0)
		options->jobs = processors > 0 ? (uint32_t)processors : 1;
}

/* ---- the finest level */

static int make_leaves(struct builder *builder)
{
	struct lattice_mesh *mesh = builder->mesh;
	struct partition *partition = &builder->partition;
	const float coarse = 1.0f / (float)(1 << mesh->lattice.fine_bits);
	uint32_t *counts = calloc(partition->leaf_count, sizeof(*counts));
	int rc = counts ? 0 : -ENOMEM;

	for (uint32_t t = 0; rc == 0 && t < mesh->triangle_count; t++)
		counts[partition->leaf_of[t]]++;
	for (uint32_t leaf = 0; rc == 0 && leaf < partition->leaf_count; leaf++) {
		struct live_patch patch = {
			.triangles = malloc(counts[leaf] * sizeof(*patch.triangles)),
			.finer = NO_GROUP,
		};

		rc = patch.triangles ? live_patches_add(&builder->level, patch) : -ENOMEM;
	}
	for (uint32_t t = 0; rc == 0 && t < mesh->triangle_count; t++) {
		struct live_patch *patch = &builder->level.items[partition->leaf_of[t]];
		uint32_t count = counts[partition->leaf_of[t]];

		memcpy(patch->triangles[patch->triangle_count++], mesh->triangles[t],
		       sizeof(*patch->triangles));
		for (int corner = 0; corner < 3; corner++)
			for (int i = 0; i < 3; i++)
				patch->centre[i] +=
					coarse *
					(float)mesh->vertices[mesh->triangles[t][corner]]
						.position[i] /
					(3.0f * (float)count);
	}
	free(counts);
	free(mesh->triangles);
	mesh->triangles = NULL;
	return rc;
}

static int partition_scan(struct builder *builder)
{
	struct lattice_mesh *mesh = builder->mesh;
	const struct partition_options options = {
		.voxel_triangles = VOXEL_TRIANGLES,
		.chunk_triangles = CHUNK_TRIANGLES,
		.patch_triangles = builder->options.patch_triangles,
		.binary = builder->options.kind == MULTIRES_TREE,
		.fine_bits = mesh->lattice.fine_bits,
	};
	int rc = partition_create(&builder->partition, mesh->vertices, mesh->vertex_count,
				  mesh->triangles, mesh->triangle_count, &options);

	return rc < 0 ? rc : make_leaves(builder);
}

/* ---- users of a vertex */

static void forget_users(struct builder *builder)
{
	memset(builder->site.lows, 0xff, builder->mesh->vertex_count * sizeof(*builder->site.lows));
	memset(builder->site.highs, 0, builder->mesh->vertex_count * sizeof(*builder->site.highs));
}

static void note_user(struct builder *builder, const struct live_patch *patch, uint32_t user)
{
	for (uint32_t t = 0; t < patch->triangle_count; t++)
		for (int corner = 0; corner < 3; corner++) {
			uint32_t *low = &builder->site.lows[patch->triangles[t][corner]];
			uint32_t *high = &builder->site.highs[patch->triangles[t][corner]];

			*low = user < *low ? user : *low;
			*high = user > *high ? user : *high;
		}
}

/* ---- groups of one level */

static uint64_t level_triangles(const struct live_patches *level)
{
	uint64_t count = 0;

	for (uint32_t p = 0; p < level->count; p++)
		count += level->items[p].triangle_count;
	return count;
}

/* Each vertex connects the last patch that used it to the next. The weights in the graph of patches
 * then grow with the length of the shared border. */
static int add_touching(struct graph *graph, const struct builder *builder)
{
	uint32_t *last = malloc((builder->mesh->vertex_count + 1) * sizeof(*last));
	int rc = last ? 0 : -ENOMEM;

	if (last)
		memset(last, 0xff, (builder->mesh->vertex_count + 1) * sizeof(*last));
	for (uint32_t p = 0; rc == 0 && p < builder->level.count; p++) {
		const struct live_patch *patch = &builder->level.items[p];

		for (uint32_t c = 0; rc == 0 && c < 3 * patch->triangle_count; c++) {
			uint32_t vertex = patch->triangles[c / 3][c % 3];

			if (last[vertex] != NO_GROUP && last[vertex] != p)
				rc = graph_add(graph, last[vertex], p, TOUCH_WEIGHT);
			last[vertex] = p;
		}
	}
	free(last);
	return rc;
}

/* Connects patches that are near each other even if they do not touch: scans of temples consist of
 * many pieces. */
static int add_near(struct graph *graph, float (*centres)[3])
{
	int rc = 0;

	for (uint32_t p = 0; rc == 0 && p < graph->node_count; p++) {
		float best[NEIGHBOURS];
		uint32_t who[NEIGHBOURS], count = 0;

		for (uint32_t q = 0; q < graph->node_count; q++) {
			float x = centres[p][0] - centres[q][0], y = centres[p][1] - centres[q][1];
			float z = centres[p][2] - centres[q][2], square = x * x + y * y + z * z;
			uint32_t at = count < NEIGHBOURS ? count : NEIGHBOURS - 1;

			if (q == p || (count == NEIGHBOURS && square >= best[at]))
				continue;
			for (; at > 0 && best[at - 1] > square; at--) {
				best[at] = best[at - 1];
				who[at] = who[at - 1];
			}
			best[at] = square;
			who[at] = q;
			count += count < NEIGHBOURS;
		}
		for (uint32_t i = 0; rc == 0 && i < count; i++)
			rc = graph_add(graph, p, who[i], NEAR_WEIGHT);
	}
	return rc;
}

/* Sets labels[patch] to its group. Groups hold about group_patches patches. */
static int group_level(uint32_t *labels, uint32_t *group_count, const struct builder *builder,
		       uint32_t group_patches)
{
	const struct live_patches *level = &builder->level;
	float(*centres)[3] = malloc((level->count + 1) * sizeof(*centres));
	struct graph graph;
	int rc = graph_init(&graph, level->count);

	*group_count = (level->count + group_patches - 1) / group_patches;
	if (!centres)
		rc = -ENOMEM;
	for (uint32_t p = 0; rc == 0 && p < level->count; p++) {
		graph.node_weights[p] = (int32_t)level->items[p].triangle_count;
		memcpy(centres[p], level->items[p].centre, sizeof(*centres));
	}
	if (rc == 0)
		rc = add_touching(&graph, builder);
	if (rc == 0)
		rc = add_near(&graph, centres);
	if (rc == 0)
		rc = graph_connect(&graph, centres, 1);
	if (rc == 0)
		rc = graph_divide(labels, &graph, *group_count, NULL);
	graph_finish(&graph);
	free(centres);
	return rc;
}

static int compare_u64(const void *left, const void *right)
{
	uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;

	return a < b ? -1 : a > b;
}

/* Sorts the patches of the level by group and makes a job for each group. */
static int sort_into_jobs(struct builder *builder, const uint32_t *labels)
{
	struct live_patches *level = &builder->level;
	uint64_t *order = malloc((level->count + 1) * sizeof(*order));
	struct live_patch *sorted = malloc((level->count + 1) * sizeof(*sorted));
	struct group_job *job = NULL;

	builder->jobs = calloc(level->count + 1, sizeof(*builder->jobs));
	builder->job_count = 0;
	if (!order || !sorted || !builder->jobs) {
		free(order);
		free(sorted);
		return -ENOMEM;
	}
	for (uint32_t p = 0; p < level->count; p++)
		order[p] = (uint64_t)labels[p] << 32 | p;
	qsort(order, level->count, sizeof(*order), compare_u64);
	for (uint32_t i = 0; i < level->count; i++) {
		sorted[i] = level->items[(uint32_t)order[i]];
		if (!job || order[i] >> 32 != order[i - 1] >> 32 ||
		    job->patch_count == GROUP_PATCHES_MAX) {
			job = &builder->jobs[builder->job_count];
			job->low = job->high = builder->job_count++;
		}
		job->patch_count++;
		note_user(builder, &sorted[i], builder->job_count - 1);
	}
	free(order);
	free(level->items);
	level->items = sorted;
	level->room = level->count + 1;
	for (uint32_t j = 0, at = 0; j < builder->job_count; j++) {
		builder->jobs[j].patches = &level->items[at];
		at += builder->jobs[j].patch_count;
	}
	return 0;
}

/* ---- results */

static int make_room(struct builder *builder, uint32_t groups, uint32_t patches)
{
	struct hierarchy *made = &builder->made;
	int rc = ARRAY_RESERVE(made->groups, builder->group_room,
			       (uint64_t)made->group_count + groups, UINT32_MAX);

	return rc < 0 ? rc
		      : ARRAY_RESERVE(made->patches, builder->patch_room,
				      (uint64_t)made->patch_count + patches, UINT32_MAX);
}

static int keep_job(struct builder *builder, struct group_job *job)
{
	struct hierarchy *made = &builder->made;
	struct multires_stats *stats = builder->stats;
	int rc = make_room(builder, 1, job->patch_count);

	if (rc < 0)
		return rc;
	job->group.first_patch = made->patch_count;
	job->group.patch_count = job->patch_count;
	made->groups[made->group_count++] = job->group;
	memcpy(made->patches + made->patch_count, job->made, job->patch_count * sizeof(*job->made));
	made->patch_count += job->patch_count;
	stats->object_bytes += job->object.size;
	stats->vertex_count += job->vertex_count;
	return builder->sink->put(builder->sink->user, buffer_bytes(&job->object), job->loss_m4);
}

static int run_job(void *user, uint32_t piece, uint32_t worker)
{
	struct builder *builder = user;
	struct group_job *job = &builder->jobs[piece];
	uint64_t triangles = 0;
	int rc;

	for (uint32_t p = 0; p < job->patch_count;
	     p++) /* counted before, because the job frees its patches */
		triangles += job->patches[p].triangle_count;
	rc = group_job_run(&builder->site, job, worker);
	progress_add(builder->progress, triangles);
	return rc;
}

/* Runs the level's jobs. next receives the coarser patches in the order of the jobs. */
static int run_level(struct builder *builder, struct live_patches *next)
{
	struct multires_stats *stats = builder->stats;
	struct multires_level *level = &stats->levels[stats->level_count];
	int rc;

	if (stats->level_count == MULTIRES_LEVELS_MAX)
		return -E2BIG;
	stats->level_count++;
	level->group_count = builder->job_count;
	for (uint32_t j = 0; j < builder->job_count; j++) {
		builder->jobs[j].number =
			builder->node->first_number + builder->made.group_count + j;
		level->patch_count += builder->jobs[j].patch_count;
		for (uint32_t p = 0; p < builder->jobs[j].patch_count; p++)
			level->triangle_count += builder->jobs[j].patches[p].triangle_count;
	}
	rc = parallel_run(builder->options.jobs, builder->job_count, run_job, builder);
	for (uint32_t j = 0; j < builder->job_count; j++) {
		struct group_job *job = &builder->jobs[j];

		if (rc == 0)
			rc = keep_job(builder, job);
		for (uint32_t p = 0; rc == 0 && p < job->coarser.count; p++) {
			rc = live_patches_add(next, job->coarser.items[p]);
			job->coarser.items[p].triangles = NULL;
		}
		group_job_finish(job);
	}
	free(builder->jobs);
	builder->jobs = NULL;
	builder->job_count = 0;
	return rc;
}

static uint32_t target_of(const struct group_job *job)
{
	uint32_t count = 0;

	for (uint32_t p = 0; p < job->patch_count; p++)
		count += job->patches[p].triangle_count;
	return count / REDUCTION > 1 ? count / REDUCTION : 1;
}

static int one_group(struct builder *builder)
{
	uint32_t *labels = calloc(builder->level.count + 1, sizeof(*labels));
	int rc = labels ? 0 : -ENOMEM;

	if (builder->level.count > GROUP_PATCHES_MAX)
		rc = -E2BIG;
	forget_users(builder);
	if (rc == 0)
		rc = sort_into_jobs(builder, labels);
	free(labels);
	return rc;
}

static int coarser_level(struct builder *builder, uint32_t group_patches)
{
	uint32_t *labels = malloc((builder->level.count + 1) * sizeof(*labels)), group_count;
	struct live_patches next = { 0 };
	int rc = labels ? group_level(labels, &group_count, builder, group_patches) : -ENOMEM;

	forget_users(builder);
	if (rc == 0)
		rc = sort_into_jobs(builder, labels);
	free(labels);
	for (uint32_t j = 0; rc == 0 && j < builder->job_count; j++) {
		builder->jobs[j].target_triangles = target_of(&builder->jobs[j]);
		builder->jobs[j].is_whole = builder->node->is_root && builder->job_count == 1;
	}
	if (rc == 0)
		rc = run_level(builder, &next);
	live_patches_finish(&builder->level);
	builder->level = next;
	return rc;
}

static int top_level(struct builder *builder)
{
	struct live_patches none = { 0 };
	int rc = one_group(builder);

	if (rc == 0)
		rc = run_level(builder, &none);
	live_patches_finish(&none);
	return rc;
}

/* A node that has a parent makes one level. The parent's groups lie elsewhere, so a border of
 * blocks is locked for one level only, as a border of groups is. */
static int build_groups(struct builder *builder)
{
	uint32_t group_patches = builder->options.group_patches;
	uint64_t before = level_triangles(&builder->level), after;
	int rc = 0;

	if (!builder->node->is_root)
		return coarser_level(builder, group_patches);
	while (rc == 0 && (before > builder->options.top_triangles ||
			   builder->level.count > GROUP_PATCHES_MAX)) {
		/* Close to the top, locked borders dominate: use a single group, which has none. */
		if (before <= REDUCTION * (uint64_t)builder->options.top_triangles)
			group_patches = GROUP_PATCHES_MAX;
		rc = coarser_level(builder, group_patches);
		after = level_triangles(&builder->level);
		/* Locked borders prevent collapses. Fewer and larger groups have less of them. */
		if (after >= before || after > before - before / 5) {
			if (group_patches == GROUP_PATCHES_MAX && after >= before)
				break;
			group_patches = group_patches > GROUP_PATCHES_MAX / 2 ? GROUP_PATCHES_MAX
									      : 2 * group_patches;
		}
		before = after;
	}
	return rc < 0 ? rc : top_level(builder);
}

/* ---- the binary tree */

/* For each node of the tree: its patches, once the level of its height has run. */
struct tree {
	uint32_t *heights;            /* for each node */
	struct live_patches *patches; /* for each node */
};

static void tree_finish(struct tree *tree, uint32_t node_count)
{
	for (uint32_t n = 0; tree->patches && n < node_count; n++)
		live_patches_finish(&tree->patches[n]);
	free(tree->patches);
	free(tree->heights);
}

/* Leaves get their patch. Children come after their parents, so heights are found backwards. */
static int tree_init(struct tree *tree, struct builder *builder)
{
	const struct partition *partition = &builder->partition;
	int rc = 0;

	*tree = (struct tree){
		.heights = calloc(partition->node_count, sizeof(*tree->heights)),
		.patches = calloc(partition->node_count, sizeof(*tree->patches)),
	};
	if (!tree->heights || !tree->patches)
		return -ENOMEM;
	for (uint32_t n = partition->node_count; rc == 0 && n-- > 0;) {
		const struct partition_node *node = &partition->nodes[n];

		if (node->children[0] == PARTITION_NONE) {
			struct live_patch *leaf = &builder->level.items[node->first_leaf];

			note_user(builder, leaf, node->first_leaf);
			rc = live_patches_add(&tree->patches[n], *leaf);
			leaf->triangles = NULL;
			continue;
		}
		for (int c = 0; c < 2; c++)
			if (tree->heights[n] <= tree->heights[node->children[c]])
				tree->heights[n] = tree->heights[node->children[c]] + 1;
	}
	return rc;
}

static int add_tree_job(struct builder *builder, struct tree *tree, uint32_t n)
{
	const struct partition_node *node = &builder->partition.nodes[n];
	struct group_job *job = &builder->jobs[builder->job_count];
	struct live_patches *left = &tree->patches[node->children[0]];
	struct live_patches *right = &tree->patches[node->children[1]];
	int rc = 0;

	/* The left child's list takes over the patches of the right one. */
	for (uint32_t p = 0; rc == 0 && p < right->count; p++) {
		rc = live_patches_add(left, right->items[p]);
		right->items[p].triangles = NULL;
	}
	*job = (struct group_job){
		.patches = left->items,
		.patch_count = left->count,
		.low = node->first_leaf,
		.high = node->first_leaf + node->leaf_count - 1,
		.target_triangles = builder->options.patch_triangles,
		.is_whole = true, /* the paper simplifies to the target without an error limit */
	};
	builder->job_count++;
	return rc == 0 && left->count > GROUP_PATCHES_MAX ? -E2BIG : rc;
}

/* Runs all nodes of one height; they are independent of each other. */
static int tree_level(struct builder *builder, struct tree *tree, uint32_t height)
{
	uint32_t node_count = builder->partition.node_count, at = 0;
	uint32_t *nodes = malloc(node_count * sizeof(*nodes));
	struct live_patches next = { 0 };
	int rc = nodes ? 0 : -ENOMEM;

	builder->jobs = calloc(node_count, sizeof(*builder->jobs));
	if (!builder->jobs)
		rc = -ENOMEM;
	for (uint32_t n = 0; rc == 0 && n < node_count; n++)
		if (tree->heights[n] == height) {
			nodes[builder->job_count] = n;
			rc = add_tree_job(builder, tree, n);
		}
	if (rc == 0)
		rc = run_level(builder, &next);
	/* The patches of a job carry its number, and the numbers increase with the nodes. */
	for (uint32_t p = 0; rc == 0 && p < next.count; p++) {
		if (p > 0 && next.items[p].finer != next.items[p - 1].finer)
			at++;
		rc = live_patches_add(&tree->patches[nodes[at]], next.items[p]);
		next.items[p].triangles = NULL;
	}
	live_patches_finish(&next);
	free(builder->jobs);
	builder->jobs = NULL;
	builder->job_count = 0;
	free(nodes);
	return rc;
}

static int build_tree(struct builder *builder)
{
	struct tree tree;
	int rc;

	forget_users(builder);
	rc = tree_init(&tree, builder);
	for (uint32_t height = 1; rc == 0 && height <= tree.heights[0]; height++)
		rc = tree_level(builder, &tree, height);
	live_patches_finish(&builder->level);
	if (rc == 0) {
		builder->level = tree.patches[0];
		tree.patches[0] = (struct live_patches){ 0 };
		rc = top_level(builder);
	}
	tree_finish(&tree, builder->partition.node_count);
	return rc;
}

/* ---- the whole */

static int site_init(struct builder *builder)
{
	struct job_site *site = &builder->site;
	size_t bytes = (builder->mesh->vertex_count + (size_t)1) * sizeof(uint32_t);

	*site = (struct job_site){
		.mesh = builder->mesh,
		.pinned = builder->node->pinned,
		.lows = malloc(bytes),
		.highs = malloc(bytes),
		.simplifier = builder->options.simplifier,
		.patch_triangles = builder->options.patch_triangles,
		.local_of = calloc(builder->options.jobs, sizeof(*site->local_of)),
	};
	if (!site->lows || !site->highs || !site->local_of)
		return -ENOMEM;
	for (uint32_t j = 0; j < builder->options.jobs; j++) {
		site->local_of[j] = malloc(bytes);
		if (!site->local_of[j])
			return -ENOMEM;
		memset(site->local_of[j], 0xff, bytes);
	}
	return 0;
}

static void builder_finish(struct builder *builder)
{
	free(builder->site.lows);
	free(builder->site.highs);
	for (uint32_t j = 0; builder->site.local_of && j < builder->options.jobs; j++)
		free(builder->site.local_of[j]);
	free(builder->site.local_of);
	partition_finish(&builder->partition);
	live_patches_finish(&builder->level);
	hierarchy_finish(&builder->made);
}

/* Estimates the triangles of all levels together, for the progress display. */
static uint64_t all_triangles(enum multires_kind kind, uint64_t finest)
{
	uint64_t reduction = kind == MULTIRES_TREE ? 2 : REDUCTION;

	return finest * reduction / (reduction - 1);
}

static int run_node(struct builder *builder, struct multires_node *node)
{
	int rc = site_init(builder);

	if (rc < 0)
		return rc;
	if (node->patches.count > 0) {
		builder->level = node->patches;
		node->patches = (struct live_patches){ 0 };
	} else {
		rc = partition_scan(builder);
	}
	if (rc == 0)
		rc = builder->options.kind == MULTIRES_TREE ? build_tree(builder)
							    : build_groups(builder);
	if (rc == 0 && !node->is_root) {
		node->patches = builder->level;
		builder->level = (struct live_patches){ 0 };
	}
	return rc;
}

int multires_build(struct hierarchy *made, struct multires_stats *stats, struct multires_node *node,
		   const struct multires_options *options, const struct multires_sink *sink)
{
	struct builder builder = {
		.options = *options,
		.node = node,
		.mesh = &node->mesh,
		.stats = stats,
		.sink = sink,
	};
	const uint64_t triangles = node->patches.count > 0 ? level_triangles(&node->patches)
							   : node->mesh.triangle_count;
	int rc;

	*made = (struct hierarchy){ 0 };
	*stats = (struct multires_stats){ .level_count = node->level };
	/* Only the root shows its own progress: the others are pieces of the whole. */
	if (node->is_root)
		builder.progress = progress_start("simplifying", "triangles",
						  all_triangles(options->kind, triangles));
	rc = run_node(&builder, node);
	if (rc == 0) {
		*made = builder.made;
		builder.made = (struct hierarchy){ 0 };
	}
	progress_end(builder.progress);
	builder_finish(&builder);
	return rc;
}

void multires_node_finish(struct multires_node *node)
{
	if (!node)
		return;
	lattice_mesh_finish(&node->mesh);
	free(node->pinned);
	live_patches_finish(&node->patches);
	*node = (struct multires_node){ 0 };
}
