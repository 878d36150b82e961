/* Joins the patches of a group to one mesh for the encoder. */
#include "format/patch_source.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* Hash table (open addressing) of the vertices of earlier patches and of this one. */
struct vertex_table {
	uint32_t *slots; /* vertex; SOURCE_NONE: free */
	uint8_t *users;  /* for each vertex of the group: the last patch that has it, plus one */
	uint32_t mask;
};

static uint32_t table_size(uint32_t entries)
{
	uint32_t size = 16;

	while (size < 2 * entries)
		size *= 2;
	return size;
}

static uint32_t vertex_hash(const struct patch_vertex *vertex)
{
	uint32_t words[sizeof(*vertex) / sizeof(uint32_t)], hash = 0;

	memcpy(words, vertex, sizeof(words));
	for (size_t i = 0; i < ARRAY_COUNT(words); i++)
		hash = (hash ^ words[i]) * 2654435761u;
	return hash ^ hash >> 15;
}

static uint32_t add_vertex(struct patch_source *source, const struct patch_vertex *vertex)
{
	source->vertices[source->vertex_count] = *vertex;
	return source->vertex_count++;
}

/* Returns the vertex of the group that equals this one, or adds it. Two vertices of one patch stay
 * two, equal or not. */
static uint32_t join_vertex(struct patch_source *source, struct vertex_table *table,
			    const struct patch_vertex *vertex, uint32_t patch)
{
	uint32_t at = vertex_hash(vertex) & table->mask, joined;

	while (table->slots[at] != SOURCE_NONE &&
	       memcmp(&source->vertices[table->slots[at]], vertex, sizeof(*vertex)) != 0)
		at = (at + 1) & table->mask;
	joined = table->slots[at];
	if (joined == SOURCE_NONE || table->users[joined] == patch + 1) {
		joined = add_vertex(source, vertex);
		table->slots[at] = joined;
	}
	table->users[joined] = (uint8_t)(patch + 1);
	return joined;
}

/* Adds a patch. names has room for all its vertices. */
static void join_patch(struct patch_source *source, struct vertex_table *table, uint32_t *names,
		       const struct patch_mesh *mesh, uint32_t patch)
{
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		names[v] = SOURCE_NONE;
	for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++) {
		uint32_t v = mesh->indices[i];

		if (names[v] == SOURCE_NONE)
			names[v] = join_vertex(source, table, &mesh->vertices[v], patch);
		source->triangles[source->triangle_count + i / 3][i % 3] = names[v];
	}
	memset(source->patches + source->triangle_count, (int)patch, mesh->triangle_count);
	source->triangle_count += mesh->triangle_count;
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		if (names[v] == SOURCE_NONE)
			source->loose[source->loose_count++] =
				add_vertex(source, &mesh->vertices[v]);
}

static uint32_t *edge_head(const struct patch_source *source, uint32_t from, uint32_t to)
{
	uint32_t hash = (from * 2654435761u) ^ (to * 2246822519u);

	return &source->heads[(hash ^ hash >> 15) & source->mask];
}

/* From the last triangle to the first, so that chains begin with the first. */
static void chain_edges(struct patch_source *source)
{
	memset(source->heads, 0xff, ((size_t)source->mask + 1) * sizeof(*source->heads));
	for (uint32_t i = 3 * source->triangle_count; i-- > 0;) {
		const uint32_t *triangle = source->triangles[i / 3];
		uint32_t *head = edge_head(source, triangle[i % 3], triangle[(i + 1) % 3]);

		source->nexts[i] = *head;
		*head = i;
	}
}

static int allocate(struct patch_source *source, uint32_t vertices, uint32_t triangles)
{
	source->mask = table_size(3 * triangles) - 1;
	source->vertices = malloc(vertices * sizeof(*source->vertices));
	source->loose = malloc(vertices * sizeof(*source->loose));
	source->triangles = malloc(triangles * sizeof(*source->triangles));
	source->patches = malloc(triangles);
	source->coded = calloc(triangles, sizeof(*source->coded));
	source->heads = malloc(((size_t)source->mask + 1) * sizeof(*source->heads));
	source->nexts = malloc(3 * (size_t)triangles * sizeof(*source->nexts));
	return source->vertices && source->loose && source->triangles && source->patches &&
			       source->coded && source->heads && source->nexts
		       ? 0
		       : -ENOMEM;
}

int patch_source_init(struct patch_source *out, const struct patch_mesh *patches,
		      uint32_t patch_count)
{
	uint32_t vertices = 0, triangles = 0;
	struct vertex_table table = { 0 };
	uint32_t *names;
	int rc;

	*out = (struct patch_source){ .patch_count = patch_count };
	for (uint32_t p = 0; p < patch_count; p++) {
		vertices += patches[p].vertex_count;
		triangles += patches[p].triangle_count;
	}
	rc = allocate(out, vertices, triangles);
	table.mask = table_size(vertices) - 1;
	table.slots = malloc(((size_t)table.mask + 1) * sizeof(*table.slots));
	table.users = calloc(vertices, 1);
	names = malloc(PATCH_VERTICES_MAX * sizeof(*names));
	if (!table.slots || !table.users || !names)
		rc = -ENOMEM;
	if (rc == 0) {
		memset(table.slots, 0xff, ((size_t)table.mask + 1) * sizeof(*table.slots));
		for (uint32_t p = 0; p < patch_count; p++)
			join_patch(out, &table, names, &patches[p], p);
		chain_edges(out);
	}
	free(names);
	free(table.slots);
	free(table.users);
	return rc;
}

void patch_source_finish(struct patch_source *source)
{
	free(source->vertices);
	free(source->loose);
	free(source->triangles);
	free(source->patches);
	free(source->coded);
	free(source->heads);
	free(source->nexts);
	*source = (struct patch_source){ 0 };
}

/* Takes edges of coded triangles out of the chain on its way. */
uint32_t patch_source_find(struct patch_source *source, uint32_t from, uint32_t to)
{
	uint32_t *at = edge_head(source, from, to);

	while (*at != SOURCE_NONE) {
		const uint32_t *triangle = source->triangles[*at / 3];
		uint32_t corner = *at % 3;

		if (source->coded[*at / 3])
			*at = source->nexts[*at];
		else if (triangle[corner] == from && triangle[(corner + 1) % 3] == to)
			return *at;
		else
			at = &source->nexts[*at];
	}
	return SOURCE_NONE;
}
