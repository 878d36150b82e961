/* The surface whose edges are collapsed: its quadrics, and the checks before a collapse. */
#include "pipeline/hierarchy/collapse.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BORDER_WEIGHT 20.0 /* of planes that hold open edges, times the edge's squared length */
#define UNSEEN_WEIGHT 0.03 /* of invisible surface, relative to surface seen from all sides */

/* Counts the triangles at an edge; *forth is how many of them run from a to b. */
uint32_t collapse_triangles_at(struct collapse_mesh *mesh, uint32_t a, uint32_t b, uint32_t *forth)
{
	uint32_t count = 0;

	*forth = 0;
	COLLAPSE_EACH_CORNER(mesh, a, corner)
	{
		count += collapse_after(mesh, corner) == b || collapse_before(mesh, corner) == b;
		*forth += collapse_after(mesh, corner) == b;
	}
	return count;
}

bool collapse_edge_is_open(struct collapse_mesh *mesh, uint32_t a, uint32_t b)
{
	uint32_t forth, count = collapse_triangles_at(mesh, a, b, &forth);

	return 2 * forth != count;
}

/* ---- quadrics */

/* Errors are weighted by visibility: "Visibility-guided simplification", Zhang and Turk 2002. */
double collapse_importance(const struct lattice_vertex *vertex)
{
	return UNSEEN_WEIGHT + (1.0 - UNSEEN_WEIGHT) * vertex->seen / 255.0;
}

static void add_open_edge(struct collapse_mesh *mesh, uint32_t a, uint32_t b,
			  const double normal[3], double weight)
{
	const double *at = mesh->nodes[a].at;
	double along[3], side[3], length;

	for (int i = 0; i < 3; i++)
		along[i] = mesh->nodes[b].at[i] - at[i];
	for (int i = 0; i < 3; i++)
		side[i] = along[(i + 1) % 3] * normal[(i + 2) % 3] -
			  along[(i + 2) % 3] * normal[(i + 1) % 3];
	length = sqrt(collapse_dot(side, side));
	if (length <= 0.0)
		return;
	for (int i = 0; i < 3; i++)
		side[i] /= length;
	weight *= BORDER_WEIGHT * collapse_dot(along, along);
	quadric_add_plane(&mesh->nodes[a].quadric, side, at, weight);
	quadric_add_plane(&mesh->nodes[b].quadric, side, at, weight);
}

static void add_triangle(struct collapse_mesh *mesh, uint32_t t)
{
	const uint32_t *corners = mesh->faces[t].corners;
	double normal[3], length, weight = 0.0;

	collapse_cross_of_triangle(normal, mesh, corners);
	length = sqrt(collapse_dot(normal, normal));
	if (length <= 0.0)
		return;
	for (int i = 0; i < 3; i++)
		normal[i] /= length;
	for (int corner = 0; corner < 3; corner++)
		weight += mesh->nodes[corners[corner]].importance / 3.0;
	for (int corner = 0; corner < 3; corner++) {
		uint32_t a = corners[corner], b = corners[(corner + 1) % 3];
		struct collapse_node *node = &mesh->nodes[a];

		quadric_add_plane(&node->quadric, normal, mesh->nodes[corners[0]].at,
				  weight * length / 6.0);
		node->area += length / 6.0;
		if (node->border && mesh->nodes[b].border && collapse_edge_is_open(mesh, a, b))
			add_open_edge(mesh, a, b, normal, weight);
	}
}

/* Returns true if gone may be removed while keep stays. Open edges are only shortened along
 * themselves. */
bool collapse_may_leave(const struct collapse_node *gone, const struct collapse_node *keep,
			bool open)
{
	return !gone->locked && (!gone->border || (keep->border && open));
}

/* ---- validity of a collapse */

static void mark_neighbours(struct collapse_mesh *mesh, uint32_t vertex)
{
	mesh->mark++;
	COLLAPSE_EACH_CORNER(mesh, vertex, corner)
	{
		for (int i = 0; i < 3; i++)
			mesh->nodes[collapse_corners_of(mesh, corner)[i]].mark = mesh->mark;
	}
}

/* The link condition (Dey et al. 1999): the two ends have no common neighbours except those
 * opposite their edge. */
bool collapse_link_is_sound(struct collapse_mesh *mesh, uint32_t a, uint32_t b)
{
	uint32_t across = 0, common = 0;

	mark_neighbours(mesh, a);
	COLLAPSE_EACH_CORNER(mesh, b, corner)
	{
		const uint32_t others[2] = { collapse_after(mesh, corner),
					     collapse_before(mesh, corner) };

		across += others[0] == a || others[1] == a;
		for (int i = 0; i < 2; i++) {
			struct collapse_node *other = &mesh->nodes[others[i]];

			if (others[i] == a || other->mark != mesh->mark)
				continue;
			common++;
			other->mark = mesh->mark - 1; /* count it once */
		}
	}
	return common <= across;
}

bool collapse_is_cancelled(struct collapse_mesh *mesh, uint32_t corner, uint32_t other_end)
{
	uint32_t p = collapse_after(mesh, corner), q = collapse_before(mesh, corner);

	COLLAPSE_EACH_CORNER(mesh, other_end, facing)
	{
		if (collapse_after(mesh, facing) == q && collapse_before(mesh, facing) == p)
			return true;
	}
	return false;
}

/* Returns true if a triangle faces the same way as the scan did there, by the normals of its
 * corners. Small rotations add up over many collapses; this test does not drift. */
static bool faces_as_scan(const struct collapse_mesh *mesh, const uint32_t triangle[3],
			  const double normal[3])
{
	double sum = 0.0;

	for (int corner = 0; corner < 3; corner++)
		for (int i = 0; i < 3; i++)
			sum += normal[i] * mesh->surface->vertices[triangle[corner]].normal[i];
	return sum > 0.0;
}

/* Returns true if a triangle at vertex would turn over when the vertex moves to at. */
bool collapse_folds(struct collapse_mesh *mesh, uint32_t vertex, uint32_t other_end,
		    const double at[3], double cosine)
{
	COLLAPSE_EACH_CORNER(mesh, vertex, corner)
	{
		const uint32_t *triangle = collapse_corners_of(mesh, corner);
		uint32_t p = collapse_after(mesh, corner), q = collapse_before(mesh, corner);
		double was[3], becomes[3], turned, square;

		if (p == other_end || q == other_end)
			continue;
		collapse_cross_of_triangle(was, mesh, triangle);
		collapse_cross(becomes, at, mesh->nodes[p].at, mesh->nodes[q].at);
		turned = collapse_dot(was, becomes);
		square = collapse_dot(was, was);
		if (turned > 0.0 &&
		    turned * turned > cosine * cosine * square * collapse_dot(becomes, becomes) &&
		    (faces_as_scan(mesh, triangle, becomes) || !faces_as_scan(mesh, triangle, was)))
			continue;
		if (square > 0.0 && !collapse_is_cancelled(mesh, corner, other_end))
			return true;
	}
	return false;
}

static void kill(struct collapse_mesh *mesh, uint32_t corner)
{
	mesh->faces[corner / 4].dead = true;
	mesh->alive_count--;
}

/* Two triangles back to back enclose nothing: removes both. */
static void cancel_pairs(struct collapse_mesh *mesh, uint32_t vertex)
{
	COLLAPSE_EACH_CORNER(mesh, vertex, corner)
	{
		uint32_t p = collapse_after(mesh, corner), q = collapse_before(mesh, corner);

		for (uint32_t other = *collapse_next_of(mesh, corner); other != COLLAPSE_NONE;
		     other = *collapse_next_of(mesh, other)) {
			if (collapse_after(mesh, other) != q || collapse_before(mesh, other) != p ||
			    mesh->faces[other / 4].dead)
				continue;
			if (mesh->alive_count <= 2)
				return; /* at least one triangle must stay */
			kill(mesh, corner);
			kill(mesh, other);
			break;
		}
	}
}

void collapse_join(struct collapse_mesh *mesh, uint32_t keep, uint32_t gone)
{
	uint32_t *end = &mesh->nodes[keep].first;

	COLLAPSE_EACH_CORNER(mesh, gone, corner)
	{
		if (collapse_after(mesh, corner) == keep || collapse_before(mesh, corner) == keep)
			kill(mesh, corner);
		else
			collapse_corners_of(mesh, corner)[corner % 4] = keep;
	}
	while (*end != COLLAPSE_NONE)
		end = collapse_next_of(mesh, *end);
	*end = mesh->nodes[gone].first;
	mesh->nodes[gone].first = COLLAPSE_NONE;
	quadric_add(&mesh->nodes[keep].quadric, &mesh->nodes[gone].quadric);
	mesh->nodes[keep].area += mesh->nodes[gone].area;
	cancel_pairs(mesh, keep);
}

/* Returns true if the collapse would leave no triangle. */
bool collapse_is_last(struct collapse_mesh *mesh, uint32_t a, uint32_t b)
{
	uint32_t forth;

	return mesh->alive_count <= collapse_triangles_at(mesh, a, b, &forth) + 2;
}

static void node_init(struct collapse_node *node, const struct lattice_vertex *vertex,
		      uint8_t locked)
{
	*node = (struct collapse_node){
		.importance = collapse_importance(vertex),
		.first = COLLAPSE_NONE,
		.locked = locked,
		.border = vertex->border,
	};
	for (int i = 0; i < 3; i++)
		node->at[i] = vertex->position[i];
}

int collapse_mesh_init(struct collapse_mesh *mesh, struct simplify_surface *surface)
{
	size_t vertices = (size_t)surface->vertex_count + 1;
	size_t triangles = (size_t)surface->triangle_count + 1;

	*mesh = (struct collapse_mesh){
		.surface = surface,
		.nodes = malloc(vertices * sizeof(*mesh->nodes)),
		.faces = malloc(triangles * sizeof(*mesh->faces)),
		.alive_count = surface->triangle_count,
	};
	if (!mesh->nodes || !mesh->faces)
		return -ENOMEM;
	for (uint32_t v = 0; v < surface->vertex_count; v++)
		node_init(&mesh->nodes[v], &surface->vertices[v], surface->locked[v]);
	for (uint32_t t = 0; t < surface->triangle_count; t++) {
		struct collapse_face *face = &mesh->faces[t];

		face->dead = false;
		for (uint32_t i = 0; i < 3; i++) {
			struct collapse_node *node = &mesh->nodes[surface->triangles[t][i]];

			face->corners[i] = surface->triangles[t][i];
			face->next[i] = node->first;
			node->first = 4 * t + i;
		}
	}
	for (uint32_t t = 0; t < surface->triangle_count; t++)
		add_triangle(mesh, t);
	return 0;
}

void collapse_mesh_finish(struct collapse_mesh *mesh)
{
	free(mesh->nodes);
	free(mesh->faces);
}

void collapse_mesh_give_back(const struct collapse_mesh *mesh)
{
	struct simplify_surface *surface = mesh->surface;
	uint32_t kept = 0;

	for (uint32_t t = 0; t < surface->triangle_count; t++)
		if (!mesh->faces[t].dead)
			memcpy(surface->triangles[kept++], mesh->faces[t].corners,
			       sizeof(*surface->triangles));
	surface->triangle_count = kept;
}
