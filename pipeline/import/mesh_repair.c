/* Removes unusable faces and duplicate vertices, counts edges, and orients the faces. */
#include "pipeline/import/mesh_repair.h"

#include <errno.h>
#include <math.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "base/spill.h"
#include "pipeline/import/mesh_edges.h"
#include "pipeline/import/mesh_orient.h"
#include "pipeline/import/mesh_places.h"

enum { RANGE_ITEMS = 1 << 16 /* that one thread does at a time */ };

struct repair {
	struct mesh *mesh;
	uint32_t jobs;
	atomic_bool has_strange; /* a coordinate that is not finite */
	/* The first vertex at the place of each, and the first that is equal to it. NULL: no two
	 * are at one place. Owned; first may be place. */
	uint32_t *place, *first;
	/* Set for the vertices of the faces that stay; a bit for each vertex. Owned. */
	_Atomic uint64_t *used;
	uint32_t *used_before;     /* how many are set before each word of used; owned */
	struct face_counts *faces; /* for each range of faces; owned */
	atomic_uint merged_vertices;
};

struct face_counts {
	uint32_t kept, lost, degenerate;
};

/* Turns minus zero into zero; otherwise equal places would differ in their bytes. Writes only what
 * changes, so that no other page has to be written out. */
static void settle_zero(float *number)
{
	if (*number == 0 && signbit(*number))
		*number = 0;
}

static int settle_vertices(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	struct repair *repair = user;
	struct mesh *mesh = repair->mesh;
	bool finite = true;

	(void)worker;
	spill_breathe();
	for (uint32_t i = first; i < after; i++) {
		for (int k = 0; k < 3; k++) {
			settle_zero(&mesh->positions[i][k]);
			finite &= isfinite(mesh->positions[i][k]) != 0;
		}
		for (int k = 0; k < 2 && mesh->uvs; k++)
			settle_zero(&mesh->uvs[i][k]);
	}
	if (!finite)
		atomic_store(&repair->has_strange, true);
	return 0;
}

/* ---- faces */

static bool is_finite_vertex(const struct mesh *mesh, uint32_t i)
{
	return isfinite(mesh->positions[i][0]) && isfinite(mesh->positions[i][1]) &&
	       isfinite(mesh->positions[i][2]);
}

static bool is_finite_face(const struct mesh *mesh, const uint32_t t[3])
{
	return is_finite_vertex(mesh, t[0]) && is_finite_vertex(mesh, t[1]) &&
	       is_finite_vertex(mesh, t[2]);
}

static uint32_t mapped(const uint32_t *map, uint32_t vertex)
{
	return map ? map[vertex] : vertex;
}

static bool is_degenerate(const struct repair *repair, const uint32_t t[3])
{
	const uint32_t a = mapped(repair->place, t[0]), b = mapped(repair->place, t[1]),
		       c = mapped(repair->place, t[2]);

	return a == b || b == c || c == a;
}

static bool is_used(const struct repair *repair, uint32_t vertex)
{
	return atomic_load_explicit(&repair->used[vertex >> 6], memory_order_relaxed) >>
		       (vertex & 63) &
	       1;
}

static void use(struct repair *repair, uint32_t vertex)
{
	if (!is_used(repair, vertex))
		atomic_fetch_or_explicit(&repair->used[vertex >> 6], (uint64_t)1 << (vertex & 63),
					 memory_order_relaxed);
}

/* Moves the faces that stay to the front of the range, with their merged corners. */
static int filter_faces(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	struct repair *repair = user;
	struct mesh *mesh = repair->mesh;
	struct face_counts *counts = &repair->faces[first / RANGE_ITEMS];
	const bool has_strange = atomic_load(&repair->has_strange);
	uint32_t kept = first;

	(void)worker;
	spill_breathe();
	for (uint32_t i = first; i < after; i++) {
		const uint32_t *t = mesh->triangles[i];
		uint32_t merged[3];

		if (has_strange && !is_finite_face(mesh, t)) {
			counts->lost++;
			continue;
		}
		if (is_degenerate(repair, t)) {
			counts->degenerate++;
			continue;
		}
		for (int k = 0; k < 3; k++) {
			merged[k] = mapped(repair->first, t[k]);
			use(repair, merged[k]);
		}
		if (memcmp(mesh->triangles[kept], merged, sizeof(merged)) != 0)
			memcpy(mesh->triangles[kept], merged, sizeof(merged));
		if (mesh->materials && kept != i)
			mesh->materials[kept] = mesh->materials[i];
		if (mesh->faces && kept != i)
			mesh->faces[kept] = mesh->faces[i];
		kept++;
	}
	counts->kept = kept - first;
	return 0;
}

/* Moves what stays of each range behind that of the range before. */
static void close_gaps(struct repair *repair, struct mesh_repairs *repairs)
{
	struct mesh *mesh = repair->mesh;
	uint32_t kept = 0;

	for (uint32_t from = 0; from < mesh->triangle_count;) {
		const struct face_counts *counts = &repair->faces[from / RANGE_ITEMS];
		size_t count = counts->kept;

		if (kept != from) {
			memmove(mesh->triangles[kept], mesh->triangles[from],
				count * sizeof(*mesh->triangles));
			if (mesh->materials)
				memmove(mesh->materials + kept, mesh->materials + from,
					count * sizeof(*mesh->materials));
			if (mesh->faces)
				memmove(mesh->faces + kept, mesh->faces + from,
					count * sizeof(*mesh->faces));
			spill_breathe();
		}
		kept += counts->kept;
		from += counts->kept + counts->lost + counts->degenerate;
		repairs->lost_faces += counts->lost;
		repairs->degenerate_faces += counts->degenerate;
	}
	mesh->triangle_count = kept;
}

/* ---- vertices */

static uint32_t words_of(const struct mesh *mesh)
{
	return mesh->vertex_count / 64 + 1;
}

/* Returns the number of used vertices. */
static uint32_t count_used(struct repair *repair)
{
	uint32_t sum = 0;

	for (uint32_t i = 0; i < words_of(repair->mesh); i++) {
		repair->used_before[i] = sum;
		sum += (uint32_t)__builtin_popcountll(repair->used[i]);
	}
	return sum;
}

/* The index of a used vertex once the others are removed. */
static uint32_t new_index(const struct repair *repair, uint32_t vertex)
{
	uint64_t before = repair->used[vertex >> 6] & (((uint64_t)1 << (vertex & 63)) - 1);

	return repair->used_before[vertex >> 6] + (uint32_t)__builtin_popcountll(before);
}

static int count_merged(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	struct repair *repair = user;
	uint32_t merged = 0;

	(void)worker;
	spill_breathe();
	for (uint32_t i = first; i < after; i++)
		merged += repair->first[i] != i;
	atomic_fetch_add(&repair->merged_vertices, merged);
	return 0;
}

static int renumber_corners(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	struct repair *repair = user;
	struct mesh *mesh = repair->mesh;

	(void)worker;
	spill_breathe();
	for (uint32_t i = first; i < after; i++)
		for (int k = 0; k < 3; k++)
			mesh->triangles[i][k] = new_index(repair, mesh->triangles[i][k]);
	return 0;
}

/* Where the first vertex at a place is removed, the first that stays stands for the place. */
static void replace_removed_places(struct repair *repair)
{
	uint32_t *place = repair->place;

	for (uint32_t i = 0; i < repair->mesh->vertex_count; i++) {
		uint32_t at = place[i];

		spill_pass(i);
		if (!is_used(repair, i) || at == i || is_used(repair, at))
			continue;
		if (place[at] == at)
			place[at] = i;
		place[i] = place[at];
	}
}

/* Moves the used vertices to the front. */
static void move_used(struct repair *repair)
{
	struct mesh *mesh = repair->mesh;
	uint32_t kept = 0;

	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		spill_pass(i);
		if (!is_used(repair, i))
			continue;
		if (kept != i) {
			memmove(mesh->positions[kept], mesh->positions[i],
				sizeof(mesh->positions[i]));
			if (mesh->colours)
				memmove(mesh->colours[kept], mesh->colours[i],
					sizeof(mesh->colours[i]));
			if (mesh->uvs)
				memmove(mesh->uvs[kept], mesh->uvs[i], sizeof(mesh->uvs[i]));
		}
		if (repair->place)
			repair->place[kept] = new_index(repair, repair->place[i]);
		kept++;
	}
	mesh->vertex_count = kept;
}

static int drop_unused_vertices(struct repair *repair, struct mesh_repairs *repairs)
{
	struct mesh *mesh = repair->mesh;
	uint32_t used = count_used(repair);
	int rc = 0;

	if (used == mesh->vertex_count)
		return 0;
	if (repair->first)
		rc = parallel_ranges(repair->jobs, mesh->vertex_count, RANGE_ITEMS, count_merged,
				     repair);
	repairs->merged_vertices = atomic_load(&repair->merged_vertices);
	repairs->unused_vertices = mesh->vertex_count - used - repairs->merged_vertices;
	if (rc == 0)
		rc = parallel_ranges(repair->jobs, mesh->triangle_count, RANGE_ITEMS,
				     renumber_corners, repair);
	if (rc < 0)
		return rc;
	if (repair->place)
		replace_removed_places(repair);
	move_used(repair);
	return 0;
}

/* ---- edges */

struct counting {
	const struct mesh *mesh;
	struct mesh_repairs *repairs;
	uint32_t fault_count;
};

/* Keeps every place_step-th place; when there is no more room, every second of these goes. */
static void keep_place(struct counting *counting, enum mesh_fault kind, const uint32_t ends[2])
{
	struct mesh_repairs *repairs = counting->repairs;
	const struct mesh *mesh = counting->mesh;
	struct mesh_fault_place *place;

	if (counting->fault_count++ % repairs->place_step > 0)
		return;
	if (repairs->place_count == MESH_FAULT_PLACES_MAX) {
		repairs->place_step *= 2;
		repairs->place_count /= 2;
		for (uint32_t i = 0; i < repairs->place_count; i++)
			repairs->places[i] = repairs->places[2 * i];
	}
	place = &repairs->places[repairs->place_count++];
	place->kind = kind;
	for (int k = 0; k < 3; k++)
		place->place_m[k] = (mesh->positions[ends[0]][k] + mesh->positions[ends[1]][k]) / 2;
}

static void count_edge(void *data, const struct mesh_edge *edge)
{
	struct counting *counting = data;
	struct mesh_repairs *repairs = counting->repairs;

	repairs->border_edges += edge->face_count == 1;
	repairs->non_manifold_edges += edge->face_count > 2;
	repairs->turned_edges += edge->turned;
	if (edge->face_count != 2 || edge->turned)
		keep_place(counting,
			   edge->turned            ? MESH_FAULT_TURNED
			   : edge->face_count == 1 ? MESH_FAULT_BORDER
						   : MESH_FAULT_NON_MANIFOLD,
			   edge->ends);
}

static int count_edges(const struct mesh_edges *edges, const struct mesh *mesh,
		       struct mesh_repairs *repairs)
{
	struct counting counting = { mesh, repairs, 0 };

	repairs->border_edges = repairs->non_manifold_edges = repairs->turned_edges = 0;
	repairs->place_count = 0;
	repairs->place_step = 1;
	return mesh_edges_each(edges, count_edge, &counting);
}

/* Counts the edges. Only if faces disagree must the correct orientation be found, and the edges be
 * counted again. */
static int settle_edges(struct repair *repair, struct mesh_repairs *repairs)
{
	struct mesh *mesh = repair->mesh;
	struct mesh_edges edges;
	int rc = mesh_edges_init_placed(&edges, mesh, repair->place, repair->jobs);

	repair->place = NULL;
	if (rc < 0)
		return rc;
	rc = count_edges(&edges, mesh, repairs);
	if (rc == 0 && repairs->turned_edges > 0)
		rc = mesh_orient(mesh, &edges, &repairs->turned_faces);
	if (rc == 0 && repairs->turned_faces > 0)
		rc = count_edges(&edges, mesh, repairs);
	mesh_edges_finish(&edges);
	return rc;
}

static int find_equals(struct repair *repair)
{
	int rc = parallel_ranges(repair->jobs, repair->mesh->vertex_count, RANGE_ITEMS,
				 settle_vertices, repair);

	if (rc == 0)
		rc = mesh_places(&repair->place, repair->mesh, repair->jobs);
	if (rc == 0)
		rc = mesh_equals(&repair->first, repair->mesh, repair->place, repair->jobs);
	return rc;
}

static int drop_faces_and_vertices(struct repair *repair, struct mesh_repairs *repairs)
{
	struct mesh *mesh = repair->mesh;
	const uint32_t words = words_of(mesh);
	int rc;

	repair->used = spill_alloc(words * sizeof(*repair->used));
	repair->used_before = spill_alloc(words * sizeof(*repair->used_before));
	if (!repair->used || !repair->used_before)
		return -errno;
	repair->faces = calloc(mesh->triangle_count / RANGE_ITEMS + 1, sizeof(*repair->faces));
	if (!repair->faces)
		return -ENOMEM;
	rc = parallel_ranges(repair->jobs, mesh->triangle_count, RANGE_ITEMS, filter_faces, repair);
	if (rc < 0)
		return rc;
	close_gaps(repair, repairs);
	return drop_unused_vertices(repair, repairs);
}

/* Frees what only finding and dropping needed. */
static void end_dropping(struct repair *repair)
{
	if (repair->first != repair->place)
		spill_free(repair->first);
	repair->first = NULL;
	spill_free(repair->used);
	spill_free(repair->used_before);
	free(repair->faces);
}

int mesh_repair(struct mesh *mesh, uint32_t jobs, struct mesh_repairs *repairs)
{
	struct repair repair = { .mesh = mesh, .jobs = jobs };
	int rc;

	*repairs = (struct mesh_repairs){ 0 };
	rc = find_equals(&repair);
	if (rc == 0)
		rc = drop_faces_and_vertices(&repair, repairs);
	end_dropping(&repair);
	if (rc == 0 && mesh->vertex_count >> 31 == 0)
		rc = settle_edges(&repair, repairs);
	spill_free(repair.place);
	return rc;
}
