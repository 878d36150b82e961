/* Blends two neighbouring shapes of a mesh, and colours its vertices. */
#include "render/scenery/bent_meshes.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "format/normal.h"
#include "geometry/vec.h"

int bend_init(struct bend *bend, const struct scenery *scenery)
{
	*bend = (struct bend){ .count = scenery->mesh_count };
	bend->meshes = calloc((size_t)scenery->mesh_count + 1, sizeof(*bend->meshes));
	for (uint32_t i = 0; bend->meshes && i < scenery->mesh_count; i++) {
		const struct scenery_mesh *mesh = &scenery->meshes[i];
		const size_t bytes = mesh->vertex_count * sizeof(*mesh->vertices);

		bend->meshes[i].glows = scenery_sets(scenery, mesh->node, SCENERY_GLOW);
		if (mesh->shape_count == 0 && !scenery_sets(scenery, mesh->node, SCENERY_COLOUR))
			continue;
		bend->meshes[i].vertices = malloc(bytes);
		if (!bend->meshes[i].vertices)
			return -ENOMEM;
		memcpy(bend->meshes[i].vertices, mesh->vertices, bytes);
	}
	return bend->meshes ? 0 : -ENOMEM;
}

void bend_finish(struct bend *bend)
{
	for (uint32_t i = 0; bend->meshes && i < bend->count; i++)
		free(bend->meshes[i].vertices);
	free(bend->meshes);
	*bend = (struct bend){ 0 };
}

static void blend(struct scenery_vertex *out, const struct scenery_shape_vertex *a,
		  const struct scenery_shape_vertex *b, float share)
{
	float from[3], to[3];

	for (int k = 0; k < 3; k++)
		out->place[k] = (uint16_t)lrintf((float)a->place[k] +
						 share * (float)(b->place[k] - a->place[k]));
	memcpy(out->normal, a->normal, sizeof(out->normal));
	if (memcmp(a->normal, b->normal, sizeof(a->normal)) == 0)
		return;
	normal_decode(from, a->normal);
	normal_decode(to, b->normal);
	vec_mix(from, from, to, share);
	normal_encode(out->normal, from);
}

/* Puts the vertices where the mesh has them. */
static void set_rest(struct scenery_vertex *vertices, const struct scenery_mesh *mesh)
{
	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		memcpy(vertices[v].place, mesh->vertices[v].place, sizeof(vertices[v].place));
		memcpy(vertices[v].normal, mesh->vertices[v].normal, sizeof(vertices[v].normal));
	}
}

static void set_shape(struct scenery_vertex *vertices, const struct scenery_mesh *mesh, float shape)
{
	const float at = vec_least(shape, (float)(mesh->shape_count - 1));
	const uint32_t low = (uint32_t)at, high = low + 1 < mesh->shape_count ? low + 1 : low;
	const struct scenery_shape_vertex *a = &mesh->shapes[(size_t)low * mesh->vertex_count];
	const struct scenery_shape_vertex *b = &mesh->shapes[(size_t)high * mesh->vertex_count];

	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		blend(&vertices[v], &a[v], &b[v], at - (float)low);
}

static void set_colours(struct scenery_vertex *vertices, const struct scenery_mesh *mesh,
			const struct bend_look *look)
{
	uint8_t rgb[3];

	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)lrintf(look->colour[k] * 255);
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		memcpy(vertices[v].rgb, look->has_colour ? rgb : mesh->vertices[v].rgb,
		       sizeof(vertices[v].rgb));
}

void bend_update(struct bend *bend, const struct scenery *scenery, const struct bend_look *looks)
{
	for (uint32_t i = 0; i < bend->count; i++) {
		const struct scenery_mesh *mesh = &scenery->meshes[i];
		const struct bend_look *look = &looks[mesh->node];
		struct bend_mesh *own = &bend->meshes[i];
		const bool is_bent =
			mesh->shape_count > 0 &&
			(look->has_shape != own->look.has_shape || look->shape != own->look.shape);
		const bool is_coloured =
			look->has_colour != own->look.has_colour ||
			memcmp(look->colour, own->look.colour, sizeof(look->colour)) != 0;

		if (!own->vertices || (!is_bent && !is_coloured))
			continue;
		if (is_bent && look->has_shape)
			set_shape(own->vertices, mesh, look->shape);
		else if (is_bent)
			set_rest(own->vertices, mesh);
		if (is_coloured)
			set_colours(own->vertices, mesh, look);
		own->look = *look;
		own->version++;
	}
}

const struct scenery_vertex *bend_vertices(const struct bend *bend, const struct scenery *scenery,
					   uint32_t mesh)
{
	const struct scenery_vertex *own = bend->meshes[mesh].vertices;

	return own ? own : scenery->meshes[mesh].vertices;
}
