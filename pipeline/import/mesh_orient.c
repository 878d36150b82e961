/* Makes the faces of a surface show the same side.
 *
 * A sheet is a set of faces connected by edges whose two faces agree. Where two sheets meet, their
 * faces disagree by definition, and the smaller sheet follows the larger. Each sheet follows its
 * largest neighbour, which may follow its own, up to a sheet that is larger than all its neighbours
 * and stays as it is. A flood fill over the faces would be shorter, but where a surface cannot be
 * oriented consistently (two skins joined at one spot) it turns half of the correct faces. */
#include "pipeline/import/mesh_orient.h"

#include <errno.h>
#include <stdlib.h>

#include "base/spill.h"

struct sheets {
	/* disjoint sets: parent of each face, up to the root of its sheet; owned */
	uint32_t *parent;
	uint32_t *size;   /* number of faces; valid for roots; owned */
	uint32_t *leader; /* root of the sheet that this root follows, or itself; owned */
};

static uint32_t root_of(const struct sheets *sheets, uint32_t face)
{
	while (sheets->parent[face] != face) {
		sheets->parent[face] = sheets->parent[sheets->parent[face]];
		face = sheets->parent[face];
	}
	return face;
}

/* A total order, so that sheets never follow each other in a circle. */
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
		return; /* the sheet disagrees with itself there */
	if (is_larger(sheets, a, sheets->leader[b]))
		sheets->leader[b] = a;
	if (is_larger(sheets, b, sheets->leader[a]))
		sheets->leader[a] = b;
}

/* Returns whether the sheet must be turned. Each step to a leader reverses the orientation. */
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

		spill_pass(i);
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
	struct sheets sheets = { spill_alloc(bytes), spill_alloc(bytes), spill_alloc(bytes) };
	int rc = sheets.parent && sheets.size && sheets.leader ? 0 : -errno;

	*turned_faces = 0;
	for (uint32_t i = 0; i < mesh->triangle_count && rc == 0; i++) {
		sheets.parent[i] = sheets.leader[i] = i;
		sheets.size[i] = 1;
		spill_pass(i);
	}
	if (rc == 0)
		rc = mesh_edges_each(edges, join_agreeing, &sheets);
	if (rc == 0)
		rc = mesh_edges_each(edges, find_leaders, &sheets);
	if (rc == 0)
		turn_faces(mesh, &sheets, turned_faces);
	spill_free(sheets.parent);
	spill_free(sheets.size);
	spill_free(sheets.leader);
	return rc;
}
