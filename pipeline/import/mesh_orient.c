/* A sheet is what hangs together by edges whose two faces agree. Where two sheets meet they
 * disagree, by definition; then the smaller follows the larger. A sheet follows its largest
 * neighbour, that one its own, up to a sheet that is the largest around, which stays as it is.
 * A flood over the faces would be shorter, but where a surface cannot agree with itself (two skins
 * glued at one spot) it turns half of what was right. */
#include "pipeline/import/mesh_orient.h"

#include <errno.h>
#include <stdlib.h>

struct sheets {
	uint32_t *parent; /* of each face, up to its sheet's root: disjoint sets; owned */
	uint32_t *size;   /* faces, of roots; owned */
	uint32_t *leader; /* root of the sheet that it follows, itself if none; owned */
};

static uint32_t root_of(const struct sheets *sheets, uint32_t face)
{
	while (sheets->parent[face] != face) {
		sheets->parent[face] = sheets->parent[sheets->parent[face]];
		face = sheets->parent[face];
	}
	return face;
}

/* A total order, so that nobody follows in a circle. */
static bool is_larger(const struct sheets *sheets, uint32_t a, uint32_t b)
{
	return sheets->size[a] != sheets->size[b] ? sheets->size[a] > sheets->size[b] : a < b;
}

static void join_agreeing(void *data, const struct mesh_edge *edge)
{
	struct sheets *sheets = data;
	uint32_t a, b;

	if (edge->face_count != 2 || edge->turned)
		return;
	a = root_of(sheets, edge->faces[0]);
	b = root_of(sheets, edge->faces[1]);
	if (a == b)
		return;
	if (!is_larger(sheets, a, b)) {
		uint32_t swap = a;

		a = b;
		b = swap;
	}
	sheets->parent[b] = a;
	sheets->size[a] += sheets->size[b];
}

static void find_leaders(void *data, const struct mesh_edge *edge)
{
	struct sheets *sheets = data;
	uint32_t a, b;

	if (!edge->turned)
		return;
	a = root_of(sheets, edge->faces[0]);
	b = root_of(sheets, edge->faces[1]);
	if (a == b)
		return; /* the sheet cannot agree with itself there */
	if (is_larger(sheets, a, sheets->leader[b]))
		sheets->leader[b] = a;
	if (is_larger(sheets, b, sheets->leader[a]))
		sheets->leader[a] = b;
}

/* Against its leader's side, whatever side that one ends up on. */
static bool is_to_be_turned(const struct sheets *sheets, uint32_t root)
{
	bool turned = false;

	for (; sheets->leader[root] != root; root = sheets->leader[root])
		turned = !turned;
	return turned;
}

static void turn_faces(struct mesh *mesh, const struct sheets *sheets, uint32_t *turned_faces)
{
	for (uint32_t i = 0; i < mesh->triangle_count; i++) {
		uint32_t *t = mesh->triangles[i], swap = t[1];

		if (!is_to_be_turned(sheets, root_of(sheets, i)))
			continue;
		t[1] = t[2];
		t[2] = swap;
		(*turned_faces)++;
	}
}

int mesh_orient(struct mesh *mesh, const struct mesh_edges *edges, uint32_t *turned_faces)
{
	size_t bytes = ((size_t)mesh->triangle_count + 1) * sizeof(uint32_t);
	struct sheets sheets = { malloc(bytes), malloc(bytes), malloc(bytes) };
	int rc = sheets.parent && sheets.size && sheets.leader ? 0 : -ENOMEM;

	*turned_faces = 0;
	for (uint32_t i = 0; i < mesh->triangle_count && rc == 0; i++) {
		sheets.parent[i] = sheets.leader[i] = i;
		sheets.size[i] = 1;
	}
	if (rc == 0) {
		mesh_edges_each(edges, join_agreeing, &sheets);
		mesh_edges_each(edges, find_leaders, &sheets);
		turn_faces(mesh, &sheets, turned_faces);
	}
	free(sheets.parent);
	free(sheets.size);
	free(sheets.leader);
	return rc;
}
