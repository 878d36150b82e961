/* Prepares the mesh of a node, builds its levels and keeps what is left. */
#include "pipeline/hierarchy/block_work.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "pipeline/hierarchy/block_node.h"

enum { PIECE_VERTICES = 4096 };

/* A node while it is worked on. */
struct worker {
	const struct block_site *site;
	uint32_t number;
	const struct block_node *node;
	struct multires_node work;
	uint32_t *borders; /* for each vertex of the work, its border vertex or BORDER_NONE */
	struct block_result result;
	uint32_t size_room, other_room;
};

static bool is_used_outside(const struct worker *worker, uint32_t border)
{
	const struct border_vertex *vertex = &worker->site->border.vertices[border];

	return vertex->low < worker->node->first_leaf || vertex->high > worker->node->last_leaf;
}

/* ---- a leaf */

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

static int name_borders(struct worker *worker)
{
	const struct block_site *site = worker->site;
	const struct lattice_mesh *mesh = &worker->work.mesh;

	worker->borders = malloc((mesh->vertex_count + (size_t)1) * sizeof(*worker->borders));
	worker->work.pinned = calloc(mesh->vertex_count + (size_t)1, 1);
	if (!worker->borders || !worker->work.pinned)
		return -ENOMEM;
	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		uint32_t border =
			block_border_find(&site->border, &site->tree, mesh->vertices[v].position);

		worker->borders[v] = border;
		worker->work.pinned[v] = border != BORDER_NONE && is_used_outside(worker, border);
	}
	return 0;
}

/* What other blocks use too looks as it was settled for all. */
static void take_borders(struct worker *worker)
{
	struct lattice_mesh *mesh = &worker->work.mesh;

	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		if (worker->borders[v] != BORDER_NONE)
			mesh->vertices[v] =
				worker->site->border.vertices[worker->borders[v]].vertex;
}

static int put_on_lattice(struct worker *worker)
{
	const struct block_site *site = worker->site;
	struct block_triangles triangles;
	struct mesh mesh = { 0 };
	int rc = block_triangles_read(&triangles, &site->scan, &site->tree, site->folder,
				      worker->number);

	if (rc == 0)
		rc = block_mesh(&mesh, &site->scan, triangles.items, triangles.own_count);
	block_triangles_finish(&triangles);
	if (rc == 0)
		rc = lattice_mesh_create(&worker->work.mesh, &worker->result.counts, &mesh,
					 &site->scan.lattice, site->look.plain_colour);
	mesh_finish(&mesh);
	return rc;
}

static int prepare_leaf(struct worker *worker, uint32_t jobs)
{
	struct lattice_mesh *mesh = &worker->work.mesh;
	struct looker looker = { worker->site, mesh };
	int rc = put_on_lattice(worker);

	if (rc == 0)
		rc = name_borders(worker);
	if (rc == 0)
		rc = lattice_mesh_find_borders(mesh, &worker->result.counts, worker->work.pinned);
	if (rc == 0)
		rc = parallel_run(jobs, (mesh->vertex_count + PIECE_VERTICES - 1) / PIECE_VERTICES,
				  look_at_piece, &looker);
	if (rc == 0)
		take_borders(worker);
	return rc;
}

/* ---- an inner node */

static int add_other(struct worker *worker, struct block_group group, uint32_t *number)
{
	struct block_result *result = &worker->result;

	if (result->other_count == worker->other_room) {
		uint32_t room = 2 * worker->other_room + 64;
		struct block_group *grown = realloc(result->others, room * sizeof(*grown));

		if (!grown)
			return -ENOMEM;
		result->others = grown;
		worker->other_room = room;
	}
	*number = result->other_count++;
	result->others[*number] = group;
	return 0;
}

/* Gives the groups that the child's patches name their numbers in this node. */
static int rename_groups(struct worker *worker, struct block_result *child, uint32_t child_number)
{
	uint32_t count = child->other_count + child->made.group_count;
	uint32_t *numbers = malloc((count + (size_t)1) * sizeof(*numbers));
	int rc = numbers ? 0 : -ENOMEM;

	if (numbers)
		memset(numbers, 0xff, count * sizeof(*numbers));
	for (uint32_t p = 0; rc == 0 && p < child->left.count; p++) {
		uint32_t *finer = &child->left.items[p].finer, was = *finer;
		struct block_group own = { child_number, was - child->other_count };

		if (was == NO_GROUP)
			continue;
		if (was >= count)
			rc = -EBADMSG;
		else if (numbers[was] == NO_GROUP)
			rc = add_other(worker, was < child->other_count ? child->others[was] : own,
				       &numbers[was]);
		if (rc == 0)
			*finer = numbers[was];
	}
	free(numbers);
	return rc;
}

/* Moves the child's patches here. The children's border vertices become one again. */
static int join_child(struct worker *worker, struct block_result *child, uint32_t *name_of_border)
{
	struct lattice_mesh *mesh = &worker->work.mesh;
	size_t room = mesh->vertex_count + (size_t)child->vertex_count + 1;
	struct lattice_vertex *vertices = realloc(mesh->vertices, room * sizeof(*vertices));
	uint32_t *borders = realloc(worker->borders, room * sizeof(*borders));
	uint32_t *names = malloc((child->vertex_count + (size_t)1) * sizeof(*names));
	int rc = vertices && borders && names ? 0 : -ENOMEM;

	mesh->vertices = vertices ? vertices : mesh->vertices;
	worker->borders = borders ? borders : worker->borders;
	for (uint32_t v = 0; rc == 0 && v < child->vertex_count; v++) {
		uint32_t border = child->borders[v];

		if (border != BORDER_NONE && name_of_border[border] != NO_GROUP) {
			names[v] = name_of_border[border];
			continue;
		}
		names[v] = mesh->vertex_count++;
		vertices[names[v]] = child->vertices[v];
		borders[names[v]] = border;
		if (border != BORDER_NONE)
			name_of_border[border] = names[v];
	}
	for (uint32_t p = 0; rc == 0 && p < child->left.count; p++) {
		struct live_patch *patch = &child->left.items[p];

		for (uint32_t c = 0; c < 3 * patch->triangle_count; c++)
			patch->triangles[c / 3][c % 3] = names[patch->triangles[c / 3][c % 3]];
		rc = live_patches_add(&worker->work.patches, *patch);
		patch->triangles = NULL;
	}
	free(names);
	return rc;
}

static int take_child(struct worker *worker, uint32_t number, uint32_t *name_of_border)
{
	const struct block_border *border = &worker->site->border;
	struct block_result child;
	int rc = block_result_read(&child, worker->site->folder, number);

	for (uint32_t v = 0; rc == 0 && v < child.vertex_count; v++)
		if (child.borders[v] != BORDER_NONE &&
		    child.borders[v] >= border->first[border->leaf_count])
			rc = -EBADMSG;
	if (rc == 0)
		rc = rename_groups(worker, &child, number);
	if (rc == 0)
		rc = join_child(worker, &child, name_of_border);
	if (rc == 0 && child.stats.level_count > worker->work.level)
		worker->work.level = child.stats.level_count;
	block_result_finish(&child);
	return rc;
}

static int prepare_inner(struct worker *worker)
{
	const struct block_site *site = worker->site;
	uint32_t border_count = site->border.first[site->border.leaf_count];
	uint32_t *name_of_border = malloc((border_count + (size_t)1) * sizeof(*name_of_border));
	int rc = name_of_border ? 0 : -ENOMEM;

	worker->work.mesh.lattice = site->scan.lattice;
	if (name_of_border)
		memset(name_of_border, 0xff, border_count * sizeof(*name_of_border));
	for (uint32_t n = 0; rc == 0 && n < worker->number; n++)
		if (site->tree.nodes[n].parent == worker->number)
			rc = take_child(worker, n, name_of_border);
	free(name_of_border);
	if (rc == 0)
		worker->work.pinned = calloc(worker->work.mesh.vertex_count + (size_t)1, 1);
	if (rc == 0 && !worker->work.pinned)
		rc = -ENOMEM;
	for (uint32_t v = 0; rc == 0 && v < worker->work.mesh.vertex_count; v++)
		worker->work.pinned[v] = worker->borders[v] != BORDER_NONE &&
					 is_used_outside(worker, worker->borders[v]);
	worker->work.first_number = worker->result.other_count;
	return rc;
}

/* ---- the result */

static int keep_object(void *user, struct bytes object, float loss_m4)
{
	struct worker *worker = user;
	struct block_result *result = &worker->result;
	uint32_t count = result->made.group_count;

	if (count == worker->size_room) {
		uint32_t room = 2 * worker->size_room + 64;
		uint32_t *sizes = realloc(result->sizes, room * sizeof(*sizes));
		float *losses = realloc(result->losses_m4, room * sizeof(*losses));

		result->sizes = sizes ? sizes : result->sizes;
		result->losses_m4 = losses ? losses : result->losses_m4;
		if (!sizes || !losses)
			return -ENOMEM;
		worker->size_room = room;
	}
	result->sizes[count] = (uint32_t)object.size;
	result->losses_m4[count] = loss_m4;
	result->made.group_count++; /* the rows come at the end */
	buffer_put(&result->objects, object.data, object.size);
	return result->objects.error;
}

/* Copies the vertices that the patches still use, and names them anew. */
static int keep_left(struct worker *worker)
{
	struct block_result *result = &worker->result;
	const struct lattice_mesh *mesh = &worker->work.mesh;
	uint32_t *names = malloc((mesh->vertex_count + (size_t)1) * sizeof(*names));

	result->left = worker->work.patches;
	worker->work.patches = (struct live_patches){ 0 };
	result->vertices = malloc((mesh->vertex_count + (size_t)1) * sizeof(*result->vertices));
	result->borders = malloc((mesh->vertex_count + (size_t)1) * sizeof(*result->borders));
	if (!names || !result->vertices || !result->borders) {
		free(names);
		return -ENOMEM;
	}
	memset(names, 0xff, mesh->vertex_count * sizeof(*names));
	for (uint32_t p = 0; p < result->left.count; p++)
		for (uint32_t c = 0; c < 3 * result->left.items[p].triangle_count; c++) {
			uint32_t *corner = &result->left.items[p].triangles[c / 3][c % 3];
			uint32_t v = *corner;

			if (names[v] == NO_GROUP) {
				names[v] = result->vertex_count++;
				result->vertices[names[v]] = mesh->vertices[v];
				/* What nobody else uses may have moved. */
				result->borders[names[v]] =
					worker->work.pinned[v] ? worker->borders[v] : BORDER_NONE;
			}
			*corner = names[v];
		}
	free(names);
	return 0;
}

static int build_node(struct worker *worker, uint32_t jobs)
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

int block_work(const struct block_site *site, uint32_t number, uint32_t jobs)
{
	const struct block_node *node = &site->tree.nodes[number];
	struct worker worker = {
		.site = site,
		.number = number,
		.node = node,
		.work = { .scan_triangles = site->scan.mesh->triangle_count,
			  .is_root = node->parent == BLOCK_NONE },
	};
	int rc;

	if (block_result_exists(site->folder, number))
		return 0;
	block_result_init(&worker.result);
	rc = number < site->tree.leaf_count ? prepare_leaf(&worker, jobs) : prepare_inner(&worker);
	if (rc == 0)
		rc = build_node(&worker, jobs);
	if (rc == 0)
		rc = block_result_write(&worker.result, site->folder, number);
	multires_node_finish(&worker.work);
	free(worker.borders);
	block_result_finish(&worker.result);
	return rc;
}
