/* The promise of the hierarchy: no cut has a crack. */
#include "pipeline/hierarchy/block_build.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "format/patch.h"
#include "pipeline/import/import.h"
#include "tests/check.h"
#include "tests/pipeline/on_lattice.h"
#include "tests/pipeline/shapes.h"

/* Sizes of the scans. Sanitized, which is ten times slower, the smaller ones go through the same
 * code. */
#ifdef __SANITIZE_ADDRESS__
enum { CUTS = 200, TEMPLE = 60, RELIEF = 80, FEATURES = 50, TREE = 40, STONES = 1000 };
#else
enum { CUTS = 1000, TEMPLE = 90, RELIEF = 120, FEATURES = 80, TREE = 60, STONES = 2000 };
#endif

struct objects {
	struct buffer *items;
	uint32_t count;
};

static int keep_object(void *user, struct bytes object, float loss_m4)
{
	struct objects *objects = user;

	CHECK(loss_m4 >= 0);
	objects->items = realloc(objects->items, (objects->count + 1) * sizeof(*objects->items));
	buffer_init(&objects->items[objects->count], 64 << 20);
	buffer_put(&objects->items[objects->count++], object.data, object.size);
	return 0;
}

static void objects_finish(struct objects *objects)
{
	for (uint32_t i = 0; i < objects->count; i++)
		buffer_finish(&objects->items[i]);
	free(objects->items);
}

/* ---- a folder for the files of a build */

struct folder {
	char path[64];
};

static struct folder folder_make(void)
{
	struct folder folder = { "/tmp/gopura-blocks-XXXXXX" };

	CHECK(mkdtemp(folder.path) != NULL);
	return folder;
}

static int remove_entry(const struct folder *folder, const char *name)
{
	int fd = open(folder->path, O_DIRECTORY | O_RDONLY | O_CLOEXEC);
	int rc = unlinkat(fd, name, 0);

	close(fd);
	return rc;
}

/* Removes files whose name begins so; "" for all. Returns how many. */
static uint32_t remove_files(const struct folder *folder, const char *start)
{
	DIR *entries = opendir(folder->path);
	struct dirent *entry;
	uint32_t count = 0;

	while ((entry = readdir(entries)))
		if (entry->d_name[0] != '.' && strncmp(entry->d_name, start, strlen(start)) == 0)
			count += remove_entry(folder, entry->d_name) == 0;
	closedir(entries);
	return count;
}

static void folder_remove(const struct folder *folder)
{
	remove_files(folder, "");
	CHECK(rmdir(folder->path) == 0);
}

/* An edge of a patch's border; net: how often it runs from the smaller to the greater end, less the
 * other way. An edge inside the patch cancels. */
struct border {
	uint32_t edge;
	int32_t net;
};

struct patch_border {
	struct border *items;
	uint32_t count;
};

/* Everything the walk over cuts needs, and nothing of how it was built. */
struct model {
	struct hierarchy hierarchy;
	struct patch_mesh *patches; /* in the order of the hierarchy */
	struct patch_border *borders;
	uint64_t *edges; /* sorted, distinct */
	size_t edge_count;
	struct patch_vertex *vertices; /* sorted, distinct */
	size_t vertex_count;
	uint64_t *open; /* places on the scan's open edges, sorted */
	size_t open_count;
	int32_t *nets, *uses; /* of each edge, in the cut at hand */
};

/* Of places with at most 21 bits an axis. */
static uint64_t place_key(const int32_t place[3])
{
	return (uint64_t)place[0] | (uint64_t)place[1] << 21 | (uint64_t)place[2] << 42;
}

static int compare_vertices(const void *a, const void *b)
{
	return memcmp(a, b, sizeof(struct patch_vertex));
}

static int compare_keys(const void *left, const void *right)
{
	uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;

	return a < b ? -1 : a > b;
}

static size_t sort_distinct(void *items, size_t count, size_t size,
			    int (*compare)(const void *, const void *))
{
	char *at = items;
	size_t kept = 0;

	qsort(items, count, size, compare);
	for (size_t i = 0; i < count; i++)
		if (kept == 0 || compare(at + (kept - 1) * size, at + i * size) != 0)
			memmove(at + kept++ * size, at + i * size, size);
	return kept;
}

/* Vertices are the same when every bit is: place, normal and colour. */
static uint32_t name_of(const struct model *model, const struct patch_vertex *vertex)
{
	const struct patch_vertex *found = bsearch(vertex, model->vertices, model->vertex_count,
						   sizeof(*vertex), compare_vertices);

	return (uint32_t)(found - model->vertices);
}

static uint64_t edge_between(uint32_t a, uint32_t b)
{
	return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

static void collect_vertices(struct model *model)
{
	size_t total = 0, at = 0;

	for (uint32_t p = 0; p < model->hierarchy.patch_count; p++)
		total += model->patches[p].vertex_count;
	model->vertices = malloc(total * sizeof(*model->vertices));
	for (uint32_t p = 0; p < model->hierarchy.patch_count; p++) {
		memcpy(model->vertices + at, model->patches[p].vertices,
		       model->patches[p].vertex_count * sizeof(*model->vertices));
		at += model->patches[p].vertex_count;
	}
	model->vertex_count =
		sort_distinct(model->vertices, total, sizeof(*model->vertices), compare_vertices);
}

struct directed {
	uint64_t edge;
	int32_t net;
};

static int compare_directed(const void *left, const void *right)
{
	return compare_keys(&((const struct directed *)left)->edge,
			    &((const struct directed *)right)->edge);
}

/* Distinct edges whose runs do not cancel; edge is the pair of names here. */
static uint32_t border_of(struct directed **out, const struct model *model,
			  const struct patch_mesh *patch)
{
	uint32_t count = 3 * patch->triangle_count, kept = 0;
	struct directed *edges = malloc(count * sizeof(*edges));

	for (uint32_t i = 0; i < count; i++) {
		uint32_t next = i % 3 == 2 ? i - 2 : i + 1;
		uint32_t a = name_of(model, &patch->vertices[patch->indices[i]]);
		uint32_t b = name_of(model, &patch->vertices[patch->indices[next]]);

		edges[i] = (struct directed){ edge_between(a, b), a == b ? 0 : a < b ? 1 : -1 };
	}
	qsort(edges, count, sizeof(*edges), compare_directed);
	for (uint32_t i = 0; i < count;) {
		struct directed sum = edges[i++];

		while (i < count && edges[i].edge == sum.edge)
			sum.net += edges[i++].net;
		if (sum.net != 0)
			edges[kept++] = sum;
	}
	*out = edges;
	return kept;
}

static void find_borders(struct model *model)
{
	uint32_t patch_count = model->hierarchy.patch_count;
	struct directed **directed = calloc(patch_count, sizeof(*directed));
	uint32_t *counts = calloc(patch_count, sizeof(*counts));
	size_t total = 0, at = 0;

	for (uint32_t p = 0; p < patch_count; p++)
		total += counts[p] = border_of(&directed[p], model, &model->patches[p]);
	model->edges = malloc((total + 1) * sizeof(*model->edges));
	for (uint32_t p = 0; p < patch_count; p++)
		for (uint32_t i = 0; i < counts[p]; i++)
			model->edges[at++] = directed[p][i].edge;
	model->edge_count = sort_distinct(model->edges, total, sizeof(*model->edges), compare_keys);
	model->borders = calloc(patch_count, sizeof(*model->borders));
	for (uint32_t p = 0; p < patch_count; p++) {
		model->borders[p].count = counts[p];
		model->borders[p].items = malloc((counts[p] + 1) * sizeof(struct border));
		for (uint32_t i = 0; i < counts[p]; i++) {
			const uint64_t *found =
				bsearch(&directed[p][i].edge, model->edges, model->edge_count,
					sizeof(*model->edges), compare_keys);

			model->borders[p].items[i] =
				(struct border){ (uint32_t)(found - model->edges),
						 directed[p][i].net };
		}
		free(directed[p]);
	}
	free(directed);
	free(counts);
	model->nets = calloc(model->edge_count + 1, sizeof(*model->nets));
	model->uses = calloc(model->edge_count + 1, sizeof(*model->uses));
}

static void forget_borders(struct model *model)
{
	for (uint32_t p = 0; p < model->hierarchy.patch_count; p++)
		free(model->borders[p].items);
	free(model->borders);
	free(model->vertices);
	free(model->edges);
	free(model->nets);
	free(model->uses);
}

static void model_finish(struct model *model)
{
	forget_borders(model);
	for (uint32_t p = 0; p < model->hierarchy.patch_count; p++)
		patch_mesh_finish(&model->patches[p]);
	free(model->patches);
	free(model->open);
	hierarchy_finish(&model->hierarchy);
}

static void find_open_places(struct model *model, const struct lattice_mesh *mesh)
{
	model->open = malloc((mesh->vertex_count + 1) * sizeof(*model->open));
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		if (mesh->vertices[v].border)
			model->open[model->open_count++] = place_key(mesh->vertices[v].position);
	qsort(model->open, model->open_count, sizeof(*model->open), compare_keys);
}

static void take_patches(struct model *model, const struct objects *objects)
{
	struct patch_mesh group[GROUP_PATCHES_MAX];

	model->patches = calloc(model->hierarchy.patch_count, sizeof(*model->patches));
	for (uint32_t g = 0; g < model->hierarchy.group_count; g++) {
		const struct hierarchy_group *row = &model->hierarchy.groups[g];
		uint32_t count;

		CHECK(patch_group_decode(group, &count,
					 buffer_bytes(&objects->items[objects->count - 1 - g])) ==
		      0);
		CHECK(count == row->patch_count);
		memcpy(model->patches + row->first_patch, group, count * sizeof(*group));
	}
}

static struct multires_stats model_build(struct model *model, struct mesh mesh,
					 const struct multires_options *options)
{
	struct folder folder = folder_make();
	struct objects objects = { 0 };
	const struct multires_sink sink = { keep_object, &objects };
	struct lattice_mesh lattice_mesh;
	struct lattice_counts counts;
	struct block_build build;
	uint32_t finest = 0;

	memset(model, 0, sizeof(*model));
	CHECK(on_lattice(&lattice_mesh, &counts, &mesh) == 0);
	find_open_places(model, &lattice_mesh);
	CHECK(block_build(&build, folder.path, &mesh, options, false, SUBSTANCE_NONE, &sink) == 0);
	model->hierarchy = build.hierarchy;
	CHECK(hierarchy_check(&model->hierarchy) == 0);
	CHECK(objects.count == model->hierarchy.group_count);
	for (uint32_t p = 0; p < model->hierarchy.patch_count; p++)
		if (model->hierarchy.patches[p].finer == HIERARCHY_NONE)
			finest += model->hierarchy.patches[p].triangle_count;
	CHECK(finest == lattice_mesh.triangle_count);
	take_patches(model, &objects);
	collect_vertices(model);
	find_borders(model);
	objects_finish(&objects);
	lattice_mesh_finish(&lattice_mesh);
	mesh_finish(&mesh);
	folder_remove(&folder);
	return build.stats;
}

/* ---- cuts */

static uint32_t random_state = 1;

static uint32_t random_below(uint32_t end)
{
	random_state ^= random_state << 13;
	random_state ^= random_state >> 17;
	random_state ^= random_state << 5;
	return random_state % end;
}

/* Refines a group and all it depends on: groups that hold a patch it replaces come before it. */
static void refine(const struct hierarchy *hierarchy, bool *refined, uint32_t group)
{
	refined[group] = true;
	for (uint32_t p = 0; p < hierarchy->groups[group].first_patch; p++)
		if (hierarchy->patches[p].finer == group && !refined[hierarchy->patches[p].group])
			refine(hierarchy, refined, hierarchy->patches[p].group);
}

/* By turns: one group to the bottom with nothing else (neighbours as far apart as they can be), a
 * few, and everything with gaps. */
static void choose_cut(const struct hierarchy *hierarchy, bool *refined, uint32_t cut)
{
	uint32_t count = hierarchy->group_count, wanted = 1;

	memset(refined, 0, count);
	refined[0] = true;
	if (cut % 3 == 1)
		wanted = 1 + random_below(5);
	if (cut % 3 == 2)
		wanted = random_below(count);
	if (cut % 3 == 0 && count > 1) {
		refine(hierarchy, refined, count - 1 - random_below((count + 1) / 2));
		return;
	}
	for (uint32_t i = 0; i < wanted; i++)
		refine(hierarchy, refined, random_below(count));
}

static bool is_shown(const struct hierarchy *hierarchy, const bool *refined, uint32_t p)
{
	const struct hierarchy_patch *patch = &hierarchy->patches[p];

	return refined[patch->group] && (patch->finer == HIERARCHY_NONE || !refined[patch->finer]);
}

struct verdict {
	uint32_t cracks;  /* border edges that nothing meets and that are no border of the scan */
	uint32_t crowded; /* met by more than one */
	uint32_t shared;  /* met by exactly one, as it should be */
	uint32_t open;    /* borders of the scan */
};

static bool is_open_place(const struct model *model, uint32_t vertex)
{
	uint64_t key = place_key(model->vertices[vertex].position);

	return bsearch(&key, model->open, model->open_count, sizeof(key), compare_keys) != NULL;
}

static struct verdict judge_cut(struct model *model, const bool *refined)
{
	const struct hierarchy *hierarchy = &model->hierarchy;
	struct verdict verdict = { 0 };

	memset(model->nets, 0, model->edge_count * sizeof(*model->nets));
	memset(model->uses, 0, model->edge_count * sizeof(*model->uses));
	for (uint32_t p = 0; p < hierarchy->patch_count; p++) {
		const struct patch_border *border = &model->borders[p];

		for (uint32_t i = 0; is_shown(hierarchy, refined, p) && i < border->count; i++) {
			model->nets[border->items[i].edge] += border->items[i].net;
			model->uses[border->items[i].edge]++;
		}
	}
	for (size_t e = 0; e < model->edge_count; e++) {
		if (model->uses[e] == 0)
			continue;
		if (model->nets[e] != 0) {
			bool open = is_open_place(model, (uint32_t)(model->edges[e] >> 32)) &&
				    is_open_place(model, (uint32_t)model->edges[e]);

			verdict.open += open;
			verdict.cracks += !open;
		} else if (model->uses[e] == 2) {
			verdict.shared++;
		} else {
			verdict.crowded++;
		}
	}
	return verdict;
}

static struct verdict walk_cuts(struct model *model, uint32_t cuts)
{
	bool *refined = calloc(model->hierarchy.group_count, sizeof(*refined));
	struct verdict sum = { 0 };

	random_state = 1;
	for (uint32_t cut = 0; cut < cuts; cut++) {
		struct verdict verdict;

		choose_cut(&model->hierarchy, refined, cut);
		verdict = judge_cut(model, refined);
		sum.cracks += verdict.cracks;
		sum.crowded += verdict.crowded;
		sum.shared += verdict.shared;
		sum.open += verdict.open;
	}
	free(refined);
	return sum;
}

static const struct multires_options small_groups = {
	.kind = MULTIRES_GROUPS,
	.patch_triangles = 256,
	.group_patches = 4,
	.top_triangles = 600,
	.jobs = 2,
};

/* The same in blocks of few triangles: tens of them, and several stages. */
static const struct multires_options small_blocks = {
	.kind = MULTIRES_GROUPS,
	.patch_triangles = 256,
	.group_patches = 4,
	.top_triangles = 600,
	.block_triangles = 2000,
	.jobs = 2,
};

/* The same, with levels that keep features. */
static const struct multires_options small_features = {
	.kind = MULTIRES_GROUPS,
	.simplifier = MULTIRES_FEATURES,
	.patch_triangles = 256,
	.group_patches = 4,
	.top_triangles = 600,
	.block_triangles = 2000,
	.jobs = 2,
};

/* ---- a large site */

#define SITE_M 290.0f
#define HUT_M  2.0f

/* A tetrahedron of side_m with a corner at x, y, z. */
static void add_stone(struct mesh *mesh, float x, float y, float z, float side_m)
{
	uint32_t a = shape_vertex(mesh, x, y, z), b = shape_vertex(mesh, x + side_m, y, z);
	uint32_t c = shape_vertex(mesh, x, y + side_m, z), d = shape_vertex(mesh, x, y, z + side_m);

	shape_triangle(mesh, a, c, b);
	shape_triangle(mesh, a, b, d);
	shape_triangle(mesh, a, d, c);
	shape_triangle(mesh, b, c, d);
}

/* The temple with a radius of 290 m, one of 2 m inside it, and at a corner of its box two stones of
 * 6 mm, 2 mm apart. */
static struct mesh shape_site(uint32_t n, float stones[2][3])
{
	struct mesh mesh = shape_temple(n), hut = shape_temple(n), pair;
	float low[3], high[3];

	for (uint32_t v = 0; v < mesh.vertex_count; v++)
		for (int i = 0; i < 3; i++) {
			mesh.positions[v][i] *= SITE_M;
			hut.positions[v][i] *= HUT_M;
		}
	mesh_box(&mesh, low, high);
	shape_room(&pair, 8, 8);
	for (int s = 0; s < 2; s++) {
		memcpy(stones[s], high, sizeof(high));
		stones[s][0] += 0.008f * (float)s;
		add_stone(&pair, stones[s][0], stones[s][1], stones[s][2], 0.006f);
	}
	CHECK(mesh_append(&mesh, &hut) == 0 && mesh_append(&mesh, &pair) == 0);
	mesh_finish(&hut);
	mesh_finish(&pair);
	return mesh;
}

/* Returns whether the finest level has a vertex within a millimetre of a place, and where in x. */
static bool finest_has(const struct model *model, const struct lattice *lattice,
		       const float at_m[3], double *x_m)
{
	for (uint32_t p = 0; p < model->hierarchy.patch_count; p++)
		for (uint32_t v = 0; model->hierarchy.patches[p].finer == HIERARCHY_NONE &&
				     v < model->patches[p].vertex_count;
		     v++) {
			double place[3], off = 0;

			lattice_metres(place, lattice, model->patches[p].vertices[v].position);
			for (int i = 0; i < 3; i++)
				off = fmax(off, fabs(place[i] - (double)at_m[i]));
			*x_m = place[0];
			if (off < 0.001)
				return true;
		}
	return false;
}

/* How many patches have a base, and how many of them are wider than 16 bits. */
static void count_placed(const struct model *model, uint32_t *placed, uint32_t *wide)
{
	*placed = *wide = 0;
	for (uint32_t p = 0; p < model->hierarchy.patch_count; p++) {
		int32_t low = INT32_MAX, high = 0;

		for (uint32_t v = 0; v < model->patches[p].vertex_count; v++) {
			int32_t at = model->patches[p].vertices[v].position[0];

			low = at < low ? at : low;
			high = at > high ? at : high;
		}
		*placed += low > UINT16_MAX;
		*wide += high - low > UINT16_MAX;
	}
}

static void no_cut_of_a_site_of_a_kilometre_has_a_crack_and_a_millimetre_stays_one(void **state)
{
	const struct multires_options *ways[] = { &small_groups, &small_blocks };

	(void)state;
	for (size_t w = 0; w < ARRAY_COUNT(ways); w++) {
		float stones[2][3], low[3], high[3];
		struct mesh mesh = shape_site(60, stones);
		struct lattice lattice;
		struct model model;
		struct verdict verdict;
		uint32_t placed, wide;
		double x_m[2];

		mesh_box(&mesh, low, high);
		CHECK(lattice_of_box(&lattice, low, high, LATTICE_STEP_MAX_M) == 0);
		CHECK(lattice.fine_bits == 4 && lattice.step_m < 0.001 && lattice.step_m > 0.0009);
		model_build(&model, mesh, ways[w]);
		count_placed(&model, &placed, &wide);
		CHECK(placed > 20 && wide > 5 && wide < model.hierarchy.patch_count);
		for (int s = 0; s < 2; s++)
			CHECK(finest_has(&model, &lattice, stones[s], &x_m[s]));
		CHECK(fabs(x_m[1] - x_m[0] - 0.008) < 0.001);
		verdict = walk_cuts(&model, 200);
		print_message(
			"site: %u placed, %u wide of %u patches; %u shared edges, %u cracks\n",
			placed, wide, model.hierarchy.patch_count, verdict.shared, verdict.cracks);
		CHECK(verdict.cracks == 0 && verdict.crowded == 0 && verdict.open == 0 &&
		      verdict.shared > 10000);
		model_finish(&model);
	}
}

static void no_cut_across_blocks_has_a_crack(void **state)
{
	struct model model;
	struct verdict verdict;
	struct multires_stats stats = model_build(&model, shape_temple(TEMPLE), &small_blocks);

	(void)state;
	CHECK(stats.level_count >= 4);
	CHECK(stats.levels[stats.level_count - 1].triangle_count <= 600);
	verdict = walk_cuts(&model, CUTS);
	CHECK(verdict.shared > 100 * CUTS);
	CHECK(verdict.cracks == 0);
	CHECK(verdict.crowded == 0);
	model_finish(&model);
}

static void no_cut_across_blocks_of_an_open_scan_has_a_crack(void **state)
{
	struct model model;
	struct verdict verdict;

	(void)state;
	model_build(&model, shape_relief(RELIEF), &small_blocks);
	verdict = walk_cuts(&model, CUTS);
	CHECK(verdict.shared > 100 * CUTS && verdict.open > 10 * CUTS);
	CHECK(verdict.cracks == 0);
	CHECK(verdict.crowded == 0);
	model_finish(&model);
}

static void no_cut_of_the_temple_has_a_crack(void **state)
{
	struct model model;
	struct verdict verdict;
	struct multires_stats stats = model_build(&model, shape_temple(TEMPLE), &small_groups);

	(void)state;
	CHECK(stats.level_count >= 4);
	CHECK(stats.levels[stats.level_count - 1].triangle_count <= 600);
	CHECK(model.open_count == 0);
	verdict = walk_cuts(&model, CUTS);
	CHECK(verdict.shared > 100 * CUTS);
	CHECK(verdict.cracks == 0);
	CHECK(verdict.crowded == 0);
	model_finish(&model);
}

static void no_cut_of_an_open_scan_has_a_crack(void **state)
{
	struct model model;
	struct verdict verdict;
	struct multires_stats stats = model_build(&model, shape_relief(RELIEF), &small_groups);

	(void)state;
	CHECK(stats.levels[stats.level_count - 1].triangle_count <= 600);
	verdict = walk_cuts(&model, CUTS);
	CHECK(verdict.shared > 100 * CUTS && verdict.open > 10 * CUTS);
	CHECK(verdict.cracks == 0);
	CHECK(verdict.crowded == 0);
	model_finish(&model);
}

/* Real scans, where they lie beside the tree: open, with holes and with what scanners make. */
static void no_cut_of_a_real_scan_has_a_crack(void **state)
{
	static const char *const paths[] = {
		"../shared/scans/lionstatue/lionstatue.obj",
		"../shared/scans/stanford-bunny/reconstruction/bun_zipper.ply",
	};
	uint32_t seen = 0;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(paths); i++) {
		const struct import_options options = { .up = IMPORT_Y_UP };
		struct diagnostics diagnostics = { 0 };
		struct verdict verdict;
		struct model model;
		struct mesh mesh;

		if (import_scan(&mesh, paths[i], &options, NULL, &diagnostics) < 0)
			continue;
		seen++;
		model_build(&model, mesh, &small_blocks);
		verdict = walk_cuts(&model, CUTS);
		CHECK(verdict.shared > 100 * CUTS);
		CHECK(verdict.cracks == 0);
		print_message("%s: %u edges shared by two patches, %u by more, %u open\n", paths[i],
			      verdict.shared, verdict.crowded, verdict.open);
		model_finish(&model);
	}
	if (seen == 0)
		skip();
}

static void no_cut_that_keeps_features_has_a_crack(void **state)
{
	(void)state;
	for (int open = 0; open < 2; open++) {
		struct model model;
		struct verdict verdict;

		model_build(&model, open ? shape_relief(FEATURES) : shape_temple(FEATURES),
			    &small_features);
		verdict = walk_cuts(&model, CUTS);
		CHECK(verdict.shared > 100 * CUTS);
		CHECK(verdict.cracks == 0);
		model_finish(&model);
	}
}

static void no_cut_of_the_binary_tree_has_a_crack(void **state)
{
	const struct multires_options options = { .kind = MULTIRES_TREE,
						  .patch_triangles = 400,
						  .jobs = 2 };
	struct model model;
	struct verdict verdict;

	(void)state;
	model_build(&model, shape_temple(TREE), &options);
	verdict = walk_cuts(&model, CUTS);
	CHECK(verdict.shared > 100 * CUTS);
	CHECK(verdict.cracks == 0);
	CHECK(verdict.crowded == 0);
	model_finish(&model);
}

static void loose_stones_become_few(void **state)
{
	struct model model;
	struct verdict verdict;
	struct multires_stats stats = model_build(&model, shape_stones(STONES), &small_groups);

	(void)state;
	CHECK(stats.levels[stats.level_count - 1].triangle_count <= 600);
	verdict = walk_cuts(&model, CUTS);
	CHECK(verdict.cracks == 0);
	model_finish(&model);
}

/* It cannot get coarser, and is built all the same. */
static void a_tetrahedron_stays_one(void **state)
{
	struct mesh mesh = { .vertex_count = 4,
			     .triangle_count = 4,
			     .positions = calloc(4, sizeof(*mesh.positions)),
			     .triangles = calloc(4, sizeof(*mesh.triangles)) };
	const uint32_t faces[4][3] = { { 0, 2, 1 }, { 0, 1, 3 }, { 0, 3, 2 }, { 1, 2, 3 } };
	struct multires_stats stats;
	struct model model;

	(void)state;
	CHECK(mesh.positions && mesh.triangles);
	for (int i = 0; i < 3; i++)
		mesh.positions[i + 1][i] = 1;
	memcpy(mesh.triangles, faces, sizeof(faces));
	stats = model_build(&model, mesh, &(struct multires_options){ .jobs = 1 });
	CHECK(stats.levels[stats.level_count - 1].triangle_count == 4);
	model_finish(&model);
}

/* A cut that shows the patch: its group with all it depends on. */
static void show_patch(const struct hierarchy *hierarchy, bool *refined, uint32_t p)
{
	memset(refined, 0, hierarchy->group_count);
	refined[0] = true;
	refine(hierarchy, refined, hierarchy->patches[p].group);
}

static uint32_t vertex_on_border(const struct model *model, uint32_t p)
{
	uint32_t name = (uint32_t)model->edges[model->borders[p].items[0].edge];

	for (uint32_t v = 0; v < model->patches[p].vertex_count; v++)
		if (compare_vertices(&model->patches[p].vertices[v], &model->vertices[name]) == 0)
			return v;
	fail_msg("the border has no vertex");
	return 0;
}

static uint32_t cracks_after(struct model *model, const bool *refined)
{
	uint32_t cracks;

	forget_borders(model);
	collect_vertices(model);
	find_borders(model);
	cracks = judge_cut(model, refined).cracks;
	return cracks;
}

static void one_lattice_step_is_found(void **state)
{
	struct model model;
	bool *refined;

	(void)state;
	model_build(&model, shape_temple(40), &small_groups);
	refined = calloc(model.hierarchy.group_count, sizeof(*refined));
	for (uint32_t p = 0; p < model.hierarchy.patch_count; p += 3) {
		struct patch_vertex *vertex, before;

		show_patch(&model.hierarchy, refined, p);
		CHECK(judge_cut(&model, refined).cracks == 0);
		if (model.borders[p].count == 0)
			continue;
		vertex = &model.patches[p].vertices[vertex_on_border(&model, p)];
		before = *vertex;
		vertex->position[p % 3] ^= 1;
		CHECK(cracks_after(&model, refined) > 0);
		*vertex = before;
		vertex->colour[p % 4] ^= 1; /* a seam of colour is one too */
		CHECK(cracks_after(&model, refined) > 0);
		*vertex = before;
		CHECK(cracks_after(&model, refined) == 0);
	}
	free(refined);
	model_finish(&model);
}

/* ---- the same bytes */

static int build_objects(struct objects *objects, const struct folder *folder, uint32_t jobs,
			 uint32_t block_triangles, enum multires_simplifier simplifier)
{
	const struct multires_sink sink = { keep_object, objects };
	struct multires_options options = small_blocks;
	struct mesh mesh = shape_temple(60);
	struct block_build build;
	int rc;

	options.jobs = jobs;
	options.simplifier = simplifier;
	options.block_triangles = block_triangles;
	rc = block_build(&build, folder->path, &mesh, &options, true, SUBSTANCE_NONE, &sink);
	block_build_finish(&build);
	mesh_finish(&mesh);
	return rc;
}

static void check_equal(const struct objects *a, const struct objects *b)
{
	CHECK(a->count == b->count && a->count > 20);
	for (uint32_t i = 0; i < a->count; i++)
		CHECK(a->items[i].size == b->items[i].size &&
		      memcmp(a->items[i].data, b->items[i].data, a->items[i].size) == 0);
}

static void any_number_of_jobs_makes_the_same_bytes(void **state)
{
	static const uint32_t jobs[] = { 1, 2, 5 };

	(void)state;
	for (int round = 0; round < 3; round++) {
		const uint32_t blocks = round == 1 ? 200000 : 2000;
		struct objects objects[ARRAY_COUNT(jobs)] = { 0 };

		for (size_t i = 0; i < ARRAY_COUNT(jobs); i++) {
			struct folder folder = folder_make();

			CHECK(build_objects(&objects[i], &folder, jobs[i], blocks,
					    round == 2 ? MULTIRES_FEATURES : MULTIRES_QUADRIC) ==
			      0);
			folder_remove(&folder);
			check_equal(&objects[0], &objects[i]);
		}
		for (size_t i = 0; i < ARRAY_COUNT(jobs); i++)
			objects_finish(&objects[i]);
	}
}

static void what_is_missing_is_made_again(void **state)
{
	static const char *const starts[] = { "node-1", "border-", "left-", "digest-",
					      "node-",  "split-",  "" };
	struct objects first = { 0 };
	struct folder folder = folder_make();

	(void)state;
	CHECK(build_objects(&first, &folder, 2, 2000, MULTIRES_QUADRIC) == 0);
	for (size_t i = 0; i < ARRAY_COUNT(starts); i++) {
		struct objects again = { 0 };

		CHECK(remove_files(&folder, starts[i]) > 0);
		CHECK(build_objects(&again, &folder, 2, 2000, MULTIRES_QUADRIC) == 0);
		check_equal(&first, &again);
		objects_finish(&again);
	}
	objects_finish(&first);
	folder_remove(&folder);
}

/* The first child of a process, or 0. */
static pid_t child_of(pid_t parent)
{
	char path[64], text[32] = "";
	FILE *file;
	long pid = 0;

	snprintf(path, sizeof(path), "/proc/%d/task/%d/children", (int)parent, (int)parent);
	file = fopen(path, "r");
	if (file && fgets(text, sizeof(text), file))
		pid = strtol(text, NULL, 10);
	if (file)
		fclose(file);
	return (pid_t)pid;
}

static bool has_file(const struct folder *folder, const char *name)
{
	char path[96];

	snprintf(path, sizeof(path), "%s/%s", folder->path, name);
	return access(path, F_OK) == 0;
}

/* Begins a build, waits until blocks are done, and kills every worker that it meets. Returns how
 * the build ended. */
static int build_with_a_murder(const struct folder *folder)
{
	pid_t builder = fork(), worker;
	int status = 0;

	if (builder == 0) {
		struct objects objects = { 0 };

		_exit(-build_objects(&objects, folder, 2, 2000, MULTIRES_QUADRIC));
	}
	while (waitpid(builder, &status, WNOHANG) == 0) {
		worker = has_file(folder, "node-3") ? child_of(builder) : 0;
		if (worker > 0)
			kill(worker, SIGKILL);
		usleep(100);
	}
	return WEXITSTATUS(status);
}

static void a_killed_worker_costs_only_its_piece(void **state)
{
	struct objects whole = { 0 }, resumed = { 0 };
	struct folder folder = folder_make();

	(void)state;
	CHECK(build_with_a_murder(&folder) == EIO);
	CHECK(has_file(&folder, "node-3"));
	CHECK(build_objects(&resumed, &folder, 2, 2000, MULTIRES_QUADRIC) == 0);
	remove_files(&folder, "");
	CHECK(build_objects(&whole, &folder, 2, 2000, MULTIRES_QUADRIC) == 0);
	check_equal(&whole, &resumed);
	objects_finish(&whole);
	objects_finish(&resumed);
	folder_remove(&folder);
}

static void refuses_what_is_no_mesh(void **state)
{
	struct mesh mesh = shape_temple(20);
	struct folder folder = folder_make();
	struct objects objects = { 0 };
	const struct multires_sink sink = { keep_object, &objects };
	struct block_build build;
	float was = mesh.positions[2][1];
	uint32_t index = mesh.triangles[5][1];

	(void)state;
	mesh.positions[2][1] = NAN;
	CHECK(block_build(&build, folder.path, &mesh, &small_blocks, false, SUBSTANCE_NONE,
			  &sink) == -EINVAL);
	mesh.positions[2][1] = was;
	mesh.triangles[5][1] = mesh.vertex_count;
	CHECK(block_build(&build, folder.path, &mesh, &small_blocks, false, SUBSTANCE_NONE,
			  &sink) == -EINVAL);
	mesh.triangles[5][1] = index;
	mesh.triangle_count = 0;
	CHECK(block_build(&build, folder.path, &mesh, &small_blocks, false, SUBSTANCE_NONE,
			  &sink) == -EINVAL);
	CHECK(!build.hierarchy.groups && objects.count == 0);
	mesh_finish(&mesh);
	folder_remove(&folder);
}

/* test_hierarchy_file [NAME]: that test alone. */
int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(no_cut_of_the_temple_has_a_crack),
		cmocka_unit_test(no_cut_of_an_open_scan_has_a_crack),
		cmocka_unit_test(no_cut_across_blocks_has_a_crack),
		cmocka_unit_test(no_cut_across_blocks_of_an_open_scan_has_a_crack),
		cmocka_unit_test(
			no_cut_of_a_site_of_a_kilometre_has_a_crack_and_a_millimetre_stays_one),
		cmocka_unit_test(no_cut_of_a_real_scan_has_a_crack),
		cmocka_unit_test(no_cut_that_keeps_features_has_a_crack),
		cmocka_unit_test(no_cut_of_the_binary_tree_has_a_crack),
		cmocka_unit_test(loose_stones_become_few),
		cmocka_unit_test(a_tetrahedron_stays_one),
		cmocka_unit_test(one_lattice_step_is_found),
		cmocka_unit_test(any_number_of_jobs_makes_the_same_bytes),
		cmocka_unit_test(what_is_missing_is_made_again),
		cmocka_unit_test(a_killed_worker_costs_only_its_piece),
		cmocka_unit_test(refuses_what_is_no_mesh),
	};

	if (argc > 1)
		cmocka_set_test_filter(argv[1]);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
