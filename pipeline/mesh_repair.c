#include "pipeline/mesh_repair.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/mesh_edges.h"
#include "pipeline/mesh_orient.h"

#define NO_VERTEX UINT32_MAX

/* ---- equal vertices, by open addressing */

static uint64_t mix(uint64_t hash, uint64_t word)
{
	hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
	return hash ^ (hash >> 32);
}

static uint64_t hash_words(uint64_t hash, const void *words, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		uint32_t word;

		memcpy(&word, (const uint8_t *)words + 4 * i, sizeof(word));
		hash = mix(hash, word);
	}
	return hash;
}

static uint64_t hash_vertex(const struct mesh *mesh, uint32_t i, bool place_only)
{
	uint64_t hash = hash_words(0, mesh->positions[i], 3);

	if (!place_only && mesh->colours)
		hash = hash_words(hash, mesh->colours[i], 1);
	if (!place_only && mesh->uvs)
		hash = hash_words(hash, mesh->uvs[i], 2);
	return hash;
}

static bool same_vertex(const struct mesh *mesh, uint32_t a, uint32_t b, bool place_only)
{
	if (memcmp(mesh->positions[a], mesh->positions[b], sizeof(mesh->positions[a])) != 0)
		return false;
	if (place_only)
		return true;
	return (!mesh->colours || memcmp(mesh->colours[a], mesh->colours[b], 4) == 0) &&
	       (!mesh->uvs || memcmp(mesh->uvs[a], mesh->uvs[b], sizeof(mesh->uvs[a])) == 0);
}

/* first[i] is the first vertex that equals i. Owned by the caller; NULL: no memory. */
static uint32_t *find_first_equals(const struct mesh *mesh, bool place_only)
{
	size_t slots = 16;
	uint32_t *table, *first = malloc(((size_t)mesh->vertex_count + 1) * sizeof(*first));

	while (slots < (size_t)mesh->vertex_count + mesh->vertex_count / 2)
		slots *= 2;
	table = malloc(slots * sizeof(*table));
	if (!table || !first) {
		free(table);
		free(first);
		return NULL;
	}
	memset(table, 0xff, slots * sizeof(*table));
	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		size_t at = hash_vertex(mesh, i, place_only) & (slots - 1);

		while (table[at] != NO_VERTEX && !same_vertex(mesh, table[at], i, place_only))
			at = (at + 1) & (slots - 1);
		if (table[at] == NO_VERTEX)
			table[at] = i;
		first[i] = table[at];
	}
	free(table);
	return first;
}

/* Minus zero is zero, or equal places would differ in their bytes. */
static void settle_zeros(struct mesh *mesh)
{
	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		for (int k = 0; k < 3; k++)
			mesh->positions[i][k] += 0.0f;
		for (int k = 0; k < 2 && mesh->uvs; k++)
			mesh->uvs[i][k] += 0.0f;
	}
}

/* ---- faces */

static bool is_finite_vertex(const struct mesh *mesh, uint32_t i)
{
	return isfinite(mesh->positions[i][0]) && isfinite(mesh->positions[i][1]) &&
	       isfinite(mesh->positions[i][2]);
}

static bool is_degenerate(const struct mesh *mesh, const uint32_t t[3])
{
	return same_vertex(mesh, t[0], t[1], true) || same_vertex(mesh, t[1], t[2], true) ||
	       same_vertex(mesh, t[2], t[0], true);
}

static void filter_faces(struct mesh *mesh, const uint32_t *first, struct mesh_repairs *repairs)
{
	uint32_t kept = 0;

	for (uint32_t i = 0; i < mesh->triangle_count; i++) {
		const uint32_t *t = mesh->triangles[i];
		uint32_t merged[3] = { first[t[0]], first[t[1]], first[t[2]] };

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
		kept++;
	}
	mesh->triangle_count = kept;
}

/* Moves the used vertices to the front; first becomes the map from old to new. */
static void drop_unused_vertices(struct mesh *mesh, uint32_t *first, struct mesh_repairs *repairs)
{
	uint32_t kept = 0;

	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		if (first[i] != i)
			repairs->merged_vertices++;
		first[i] = NO_VERTEX;
	}
	for (uint32_t i = 0; i < mesh->triangle_count; i++)
		for (int k = 0; k < 3; k++)
			first[mesh->triangles[i][k]] = 0;
	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
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
	for (uint32_t i = 0; i < mesh->triangle_count; i++)
		for (int k = 0; k < 3; k++)
			mesh->triangles[i][k] = first[mesh->triangles[i][k]];
}

/* ---- edges */

static void count_edge(void *data, const struct mesh_edge *edge)
{
	struct mesh_repairs *repairs = data;

	repairs->border_edges += edge->face_count == 1;
	repairs->non_manifold_edges += edge->face_count > 2;
	repairs->turned_edges += edge->turned;
}

/* Only edges whose faces disagree need the work of finding out who is right. */
static int settle_edges(struct mesh *mesh, struct mesh_repairs *repairs)
{
	struct mesh_edges edges;
	int rc = mesh_edges_init(&edges, mesh);

	if (rc < 0)
		return rc;
	mesh_edges_each(&edges, count_edge, repairs);
	if (repairs->turned_edges > 0)
		rc = mesh_orient(mesh, &edges, &repairs->turned_faces);
	mesh_edges_finish(&edges);
	if (rc < 0 || repairs->turned_faces == 0)
		return rc;
	rc = mesh_edges_init(&edges, mesh);
	if (rc < 0)
		return rc;
	repairs->border_edges = repairs->non_manifold_edges = repairs->turned_edges = 0;
	mesh_edges_each(&edges, count_edge, repairs);
	mesh_edges_finish(&edges);
	return 0;
}

uint32_t *mesh_places(const struct mesh *mesh)
{
	return find_first_equals(mesh, true);
}

int mesh_repair(struct mesh *mesh, struct mesh_repairs *repairs)
{
	uint32_t *first;

	*repairs = (struct mesh_repairs){ 0 };
	settle_zeros(mesh);
	first = find_first_equals(mesh, false);
	if (!first)
		return -ENOMEM;
	filter_faces(mesh, first, repairs);
	drop_unused_vertices(mesh, first, repairs);
	free(first);
	return mesh->vertex_count >> 31 ? 0 : settle_edges(mesh, repairs);
}
