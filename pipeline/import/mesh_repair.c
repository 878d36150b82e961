/* Removes unusable faces and duplicate vertices, counts edges, and orients the faces. */
#include "pipeline/import/mesh_repair.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/spill.h"
#include "pipeline/import/mesh_edges.h"
#include "pipeline/import/mesh_orient.h"
#include "pipeline/import/mesh_places.h"

#define NO_VERTEX UINT32_MAX

/* Turns minus zero into zero; otherwise equal places would differ in their bytes. */
static void settle_zeros(struct mesh *mesh)
{
	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		for (int k = 0; k < 3; k++)
			mesh->positions[i][k] += 0.0f;
		for (int k = 0; k < 2 && mesh->uvs; k++)
			mesh->uvs[i][k] += 0.0f;
		spill_pass(i);
	}
}

/* ---- faces */

static bool is_finite_vertex(const struct mesh *mesh, uint32_t i)
{
	return isfinite(mesh->positions[i][0]) && isfinite(mesh->positions[i][1]) &&
	       isfinite(mesh->positions[i][2]);
}

static bool same_place(const struct mesh *mesh, uint32_t a, uint32_t b)
{
	return memcmp(mesh->positions[a], mesh->positions[b], sizeof(mesh->positions[a])) == 0;
}

static bool is_degenerate(const struct mesh *mesh, const uint32_t t[3])
{
	return same_place(mesh, t[0], t[1]) || same_place(mesh, t[1], t[2]) ||
	       same_place(mesh, t[2], t[0]);
}

static void filter_faces(struct mesh *mesh, const uint32_t *first, struct mesh_repairs *repairs)
{
	uint32_t kept = 0;

	for (uint32_t i = 0; i < mesh->triangle_count; i++) {
		const uint32_t *t = mesh->triangles[i];
		uint32_t merged[3] = { first[t[0]], first[t[1]], first[t[2]] };

		spill_pass(i);
		if (!is_finite_vertex(mesh, t[0]) || !is_finite_vertex(mesh, t[1]) ||
		    !is_finite_vertex(mesh, t[2])) {
			repairs->lost_faces++;
			continue;
		}
		if (is_degenerate(mesh, merged)) {
			repairs->degenerate_faces++;
			continue;
		}
		memcpy(mesh->triangles[kept], merged, sizeof(merged));
		if (mesh->materials)
			mesh->materials[kept] = mesh->materials[i];
		if (mesh->faces)
			mesh->faces[kept] = mesh->faces[i];
		kept++;
	}
	mesh->triangle_count = kept;
}

/* Moves the used vertices to the front. `first` becomes the map from old to new indices. */
static void drop_unused_vertices(struct mesh *mesh, uint32_t *first, struct mesh_repairs *repairs)
{
	uint32_t kept = 0;

	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		if (first[i] != i)
			repairs->merged_vertices++;
		first[i] = NO_VERTEX;
		spill_pass(i);
	}
	for (uint32_t i = 0; i < mesh->triangle_count; i++) {
		for (int k = 0; k < 3; k++)
			first[mesh->triangles[i][k]] = 0;
		spill_pass(i);
	}
	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		spill_pass(i);
		if (first[i] == NO_VERTEX)
			continue;
		memmove(mesh->positions[kept], mesh->positions[i], sizeof(mesh->positions[i]));
		if (mesh->colours)
			memmove(mesh->colours[kept], mesh->colours[i], sizeof(mesh->colours[i]));
		if (mesh->uvs)
			memmove(mesh->uvs[kept], mesh->uvs[i], sizeof(mesh->uvs[i]));
		first[i] = kept++;
	}
	repairs->unused_vertices = mesh->vertex_count - kept - repairs->merged_vertices;
	mesh->vertex_count = kept;
	for (uint32_t i = 0; i < mesh->triangle_count; i++) {
		for (int k = 0; k < 3; k++)
			mesh->triangles[i][k] = first[mesh->triangles[i][k]];
		spill_pass(i);
	}
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
static int settle_edges(struct mesh *mesh, struct mesh_repairs *repairs)
{
	struct mesh_edges edges;
	int rc = mesh_edges_init(&edges, mesh);

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

int mesh_repair(struct mesh *mesh, struct mesh_repairs *repairs)
{
	uint32_t *first;

	*repairs = (struct mesh_repairs){ 0 };
	settle_zeros(mesh);
	first = mesh_equals(mesh);
	if (!first)
		return -errno;
	filter_faces(mesh, first, repairs);
	drop_unused_vertices(mesh, first, repairs);
	spill_free(first);
	return mesh->vertex_count >> 31 ? 0 : settle_edges(mesh, repairs);
}
