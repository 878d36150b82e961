/* Prepares the mesh of a block, builds its levels and keeps what is left. */
#include "pipeline/hierarchy/block_work.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "pipeline/hierarchy/block_node.h"

enum { PIECE_VERTICES = 4096 };

/* A block while it is worked on. */
struct worker {
	const struct block_site *site;
	uint32_t block;
	struct multires_node work;
	block_key
		*keys; /* for each vertex of the work, its name as a shared one, or BLOCK_NO_KEY */
	struct block_result result;
	struct block_left left;
	uint32_t vertex_room, pinned_room, key_room, size_room, loss_room, other_room;
};

/* ---- a block of the scan */

struct looker {
	const struct block_site *site;
	struct lattice_mesh *mesh;
};

static int look_at_piece(void *user, uint32_t piece, uint32_t thread)
{
	const struct looker *looker = user;
	uint32_t first = piece * PIECE_VERTICES, left = looker->mesh->vertex_count - first;

	(void)thread;
	block_look_apply(&looker->site->look, &looker->site->scan.lattice,
			 looker->mesh->vertices + first,
			 left < PIECE_VERTICES ? left : PIECE_VERTICES);
	return 0;
}

/* Finds the vertices that other blocks use too: they get their name, and look as it was settled for
 * all. */
static int take_borders(struct worker *worker)
{
	const struct block_border *border = &worker->site->border;
	const struct lattice_mesh *mesh = &worker->work.mesh;

	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		uint32_t found = block_border_find(border, &worker->site->cells, &mesh->lattice,
						   mesh->vertices[v].position);

		if (found == BORDER_NONE)
			continue;
		mesh->vertices[v] = border->vertices[found].vertex;
		if (border->vertices[found].low == border->vertices[found].high)
			continue;
		worker->keys[v] = block_key_of(BORDER_NODE, found);
		worker->work.pinned[v] = 1;
	}
	return 0;
}

static int make_room(struct worker *worker)
{
	size_t count = worker->work.mesh.vertex_count + (size_t)1;

	worker->keys = malloc(count * sizeof(*worker->keys));
	worker->work.pinned = calloc(count, 1);
	if (!worker->keys || !worker->work.pinned)
		return -ENOMEM;
	memset(worker->keys, 0xff, count * sizeof(*worker->keys));
	return 0;
}

static int put_on_lattice(struct worker *worker)
{
	const struct block_site *site = worker->site;
	struct block_triangles triangles;
	struct mesh mesh = { 0 };
	int rc = block_triangles_read(&triangles, &site->scan, &site->cells, site->folder,
				      worker->block);

	if (rc == 0)
		rc = block_mesh(&mesh, &site->scan, triangles.items, triangles.own_count);
	block_triangles_finish(&triangles);
	if (rc == 0)
		rc = lattice_mesh_create(&worker->work.mesh, &worker->result.counts, &mesh,
					 &site->scan.lattice, site->look.plain_colour);
	mesh_finish(&mesh);
	return rc;
}

static int prepare_scan_block(struct worker *worker, uint32_t jobs)
{
	struct lattice_mesh *mesh = &worker->work.mesh;
	struct looker looker = { worker->site, mesh };
	int rc = put_on_lattice(worker);

	if (rc == 0)
		rc = make_room(worker);
	if (rc == 0)
		rc = parallel_run(jobs, (mesh->vertex_count + PIECE_VERTICES - 1) / PIECE_VERTICES,
				  look_at_piece, &looker);
	if (rc == 0)
		rc = take_borders(worker);
	if (rc == 0)
		rc = lattice_mesh_find_borders(mesh, &worker->result.counts, worker->work.pinned);
	return rc;
}

/* ---- a block of patches */

static int add_other(struct worker *worker, struct block_group group, uint32_t *number)
{
	struct block_result *result = &worker->result;
	int rc = ARRAY_RESERVE(result->others, worker->other_room, result->other_count + 1,
			       UINT32_MAX);

	if (rc < 0)
		return rc;
	*number = result->other_count++;
	result->others[*number] = group;
	return 0;
}

/* A node of the stage before, as this block sees it. */
struct source {
	struct block_left left;
	uint32_t node, first_patch; /* its number, and that of its first patch in the stage */
	uint32_t *lows, *highs;     /* for each vertex, the first and last block that use it */
	uint32_t *names;            /* for each vertex, its index in the work, or NO_GROUP */
};

static void source_finish(struct source *source)
{
	block_left_finish(&source->left);
	free(source->lows);
	free(source->highs);
	free(source->names);
}

static int source_read(struct source *source, const struct block_site *site, uint32_t n)
{
	const struct block_stage *stage = &site->stage;
	struct block_left *left = &source->left;
	size_t bytes;
	int rc;

	*source = (struct source){ .node = stage->first_node + n,
				   .first_patch = stage->first_patch[n] };
	rc = block_left_read(left, site->folder, source->node);
	if (rc == 0 && left->patches.count != stage->first_patch[n + 1] - source->first_patch)
		rc = -EBADMSG;
	if (rc < 0)
		return rc;
	bytes = (left->vertex_count + (size_t)1) * sizeof(uint32_t);
	source->lows = malloc(bytes);
	source->highs = calloc(1, bytes);
	source->names = malloc(bytes);
	if (!source->lows || !source->highs || !source->names)
		return -ENOMEM;
	memset(source->lows, 0xff, bytes);
	memset(source->names, 0xff, bytes);
	for (uint32_t p = 0; p < left->patches.count; p++) {
		const struct live_patch *patch = &left->patches.items[p];
		uint32_t block = stage->block_of_patch[source->first_patch + p];

		for (uint32_t c = 0; c < 3 * patch->triangle_count; c++) {
			uint32_t v = patch->triangles[c / 3][c % 3];

			source->lows[v] = block < source->lows[v] ? block : source->lows[v];
			source->highs[v] = block > source->highs[v] ? block : source->highs[v];
		}
	}
	return 0;
}

/* Takes over a vertex that is used here. One that several nodes had becomes one again. */
static int name_vertex(struct worker *worker, struct source *source, uint32_t v,
		       uint32_t *name_of_shared)
{
	const struct block_stage *stage = &worker->site->stage;
	block_key key = source->left.keys[v];
	uint32_t name = worker->work.mesh.vertex_count, shared = BLOCK_NONE;
	bool pinned = source->lows[v] != source->highs[v];

	if (key == BLOCK_NO_KEY) {
		key = block_key_of(source->node, v);
	} else {
		shared = block_stage_find(stage, key);
		if (shared == BLOCK_NONE)
			return -EBADMSG;
		pinned = stage->shared[shared].low != stage->shared[shared].high;
	}
	if (shared != BLOCK_NONE && name_of_shared[shared] != NO_GROUP) {
		source->names[v] = name_of_shared[shared];
		return 0;
	}
	worker->work.mesh.vertices[name] = source->left.vertices[v];
	worker->work.pinned[name] = pinned;
	worker->keys[name] = pinned ? key : BLOCK_NO_KEY;
	worker->work.mesh.vertex_count++;
	source->names[v] = name;
	if (shared != BLOCK_NONE)
		name_of_shared[shared] = name;
	return 0;
}

static int make_more_room(struct worker *worker, uint32_t more)
{
	struct multires_node *work = &worker->work;
	const uint64_t count = (uint64_t)work->mesh.vertex_count + more;
	int rc = ARRAY_RESERVE(work->mesh.vertices, worker->vertex_room, count, UINT32_MAX);

	if (rc == 0)
		rc = ARRAY_RESERVE(work->pinned, worker->pinned_room, count, UINT32_MAX);
	if (rc == 0)
		rc = ARRAY_RESERVE(worker->keys, worker->key_room, count, UINT32_MAX);
	return rc;
}

/* Moves a patch into the work. numbers[group] is what a group of the node is called here. */
static int take_patch(struct worker *worker, struct source *source, struct live_patch *patch,
		      uint32_t *name_of_shared, uint32_t *numbers)
{
	int rc = 0;

	for (uint32_t c = 0; rc == 0 && c < 3 * patch->triangle_count; c++) {
		uint32_t *corner = &patch->triangles[c / 3][c % 3];

		if (source->names[*corner] == NO_GROUP)
			rc = name_vertex(worker, source, *corner, name_of_shared);
		*corner = source->names[*corner];
	}
	if (rc == 0 && numbers[patch->finer] == NO_GROUP)
		rc = add_other(worker, (struct block_group){ source->node, patch->finer },
			       &numbers[patch->finer]);
	if (rc < 0)
		return rc;
	patch->finer = numbers[patch->finer];
	rc = live_patches_add(&worker->work.patches, *patch);
	patch->triangles = NULL; /* taken */
	return rc;
}

static int take_source(struct worker *worker, struct source *source, uint32_t *name_of_shared)
{
	const uint32_t *block_of_patch = worker->site->stage.block_of_patch;
	struct live_patches *patches = &source->left.patches;
	uint32_t *numbers, group_count = 0;
	int rc = make_more_room(worker, source->left.vertex_count);

	for (uint32_t p = 0; rc == 0 && p < patches->count; p++) {
		if (patches->items[p].finer == NO_GROUP)
			rc = -EBADMSG;
		else if (patches->items[p].finer >= group_count)
			group_count = patches->items[p].finer + 1;
	}
	numbers = rc == 0 ? malloc((group_count + (size_t)1) * sizeof(*numbers)) : NULL;
	if (rc == 0 && !numbers)
		rc = -ENOMEM;
	if (numbers)
		memset(numbers, 0xff, group_count * sizeof(*numbers));
	for (uint32_t p = 0; rc == 0 && p < patches->count; p++)
		if (block_of_patch[source->first_patch + p] == worker->block)
			rc = take_patch(worker, source, &patches->items[p], name_of_shared,
					numbers);
	free(numbers);
	return rc;
}

static bool has_patch_here(const struct worker *worker, uint32_t n)
{
	const struct block_stage *stage = &worker->site->stage;

	for (uint32_t p = stage->first_patch[n]; p < stage->first_patch[n + 1]; p++)
		if (stage->block_of_patch[p] == worker->block)
			return true;
	return false;
}

static int prepare_patch_block(struct worker *worker)
{
	const struct block_stage *stage = &worker->site->stage;
	size_t count = stage->shared_count + (size_t)1;
	uint32_t *name_of_shared = malloc(count * sizeof(*name_of_shared));
	int rc = name_of_shared ? 0 : -ENOMEM;

	worker->work.mesh.lattice = worker->site->scan.lattice;
	if (name_of_shared)
		memset(name_of_shared, 0xff, count * sizeof(*name_of_shared));
	for (uint32_t n = 0; rc == 0 && n < stage->node_count; n++) {
		struct source source;

		if (!has_patch_here(worker, n))
			continue;
		rc = source_read(&source, worker->site, n);
		if (rc == 0)
			rc = take_source(worker, &source, name_of_shared);
		source_finish(&source);
	}
	free(name_of_shared);
	worker->work.first_number = worker->result.other_count;
	return rc;
}

/* ---- the result */

static int keep_object(void *user, struct bytes object, float loss_m4)
{
	struct worker *worker = user;
	struct block_result *result = &worker->result;
	uint32_t count = result->made.group_count;
	int rc = ARRAY_RESERVE(result->sizes, worker->size_room, count + 1, UINT32_MAX);

	if (rc == 0)
		rc = ARRAY_RESERVE(result->losses_m4, worker->loss_room, count + 1, UINT32_MAX);
	if (rc < 0)
		return rc;
	result->sizes[count] = (uint32_t)object.size;
	result->losses_m4[count] = loss_m4;
	result->made.group_count++; /* the rows come at the end */
	buffer_put(&result->objects, object.data, object.size);
	return result->objects.error;
}

/* Copies the vertices that the patches still use, and names them anew. */
static int keep_left(struct worker *worker)
{
	struct block_left *left = &worker->left;
	const struct lattice_mesh *mesh = &worker->work.mesh;
	size_t count = mesh->vertex_count + (size_t)1;
	uint32_t *names = malloc(count * sizeof(*names));

	left->patches = worker->work.patches;
	worker->work.patches = (struct live_patches){ 0 };
	left->vertices = malloc(count * sizeof(*left->vertices));
	left->keys = malloc(count * sizeof(*left->keys));
	if (!names || !left->vertices || !left->keys) {
		free(names);
		return -ENOMEM;
	}
	memset(names, 0xff, count * sizeof(*names));
	for (uint32_t p = 0; p < left->patches.count; p++) {
		struct live_patch *patch = &left->patches.items[p];

		patch->finer -= worker->work.first_number; /* all are groups of this node */
		for (uint32_t c = 0; c < 3 * patch->triangle_count; c++) {
			uint32_t *corner = &patch->triangles[c / 3][c % 3], v = *corner;

			if (names[v] == NO_GROUP) {
				names[v] = left->vertex_count++;
				left->vertices[names[v]] = mesh->vertices[v];
				left->keys[names[v]] = worker->keys[v];
			}
			*corner = names[v];
		}
	}
	free(names);
	return 0;
}

static int build_levels(struct worker *worker, uint32_t jobs)
{
	const struct multires_sink sink = { keep_object, worker };
	struct multires_options options = worker->site->options;
	struct hierarchy made;
	int rc;

	options.jobs = jobs;
	rc = multires_build(&made, &worker->result.stats, &worker->work, &options, &sink);
	if (rc < 0)
		return rc;
	worker->result.made = made;
	return keep_left(worker);
}

int block_work(const struct block_site *site, uint32_t block, uint32_t jobs)
{
	uint32_t node = site->first_node + block;
	struct worker worker = {
		.site = site,
		.block = block,
		.work = { .level = site->stage.number,
			  .scan_triangles = site->scan.mesh->triangle_count,
			  .is_root = site->is_last },
	};
	int rc;

	if (block_node_exists(site->folder, node))
		return 0;
	block_result_init(&worker.result);
	rc = site->stage.number == 0 ? prepare_scan_block(&worker, jobs)
				     : prepare_patch_block(&worker);
	if (rc == 0)
		rc = build_levels(&worker, jobs);
	if (rc == 0)
		rc = block_node_write(&worker.result, &worker.left, site->folder, node);
	multires_node_finish(&worker.work);
	free(worker.keys);
	block_result_finish(&worker.result);
	block_left_finish(&worker.left);
	return rc;
}
