/* Copies the marked triangles of a block, each with vertices of its own. */
#include "curator/region/region_model.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { CORNERS = 3 * FACE_BLOCK_TRIANGLES };

struct region_model {
	struct model model;           /* first */
	const struct region_set *set; /* borrowed */
	const struct mesh *mesh;      /* borrowed */
	struct model_vertex vertices[CORNERS];
	uint16_t indices[CORNERS];
};

static uint32_t end_of(const struct region_model *model, uint32_t block)
{
	const uint32_t left = model->mesh->triangle_count - block * FACE_BLOCK_TRIANGLES;

	return block * FACE_BLOCK_TRIANGLES +
	       (left < FACE_BLOCK_TRIANGLES ? left : FACE_BLOCK_TRIANGLES);
}

static uint32_t choose(const struct model *base, const float eye_m[3], float detail_rad,
		       uint32_t *pieces)
{
	const struct region_model *model = (const struct region_model *)base;
	const uint32_t words = FACE_BLOCK_TRIANGLES / 64;
	uint32_t count = 0;

	(void)eye_m;
	(void)detail_rad;
	for (uint32_t block = 0; block < base->piece_count; block++) {
		const uint32_t end = end_of(model, block);

		for (uint32_t w = block * words; 64 * w < end; w++)
			if (model->set->bits[w]) {
				pieces[count++] = block;
				break;
			}
	}
	return count;
}

static int load(struct model *base, uint32_t piece, struct model_mesh *out)
{
	struct region_model *model = (struct region_model *)base;
	const struct mesh *mesh = model->mesh;
	uint32_t corners = 0;

	for (uint32_t t = piece * FACE_BLOCK_TRIANGLES; t < end_of(model, piece); t++)
		for (int k = 0; region_set_has(model->set, t) && k < 3; k++)
			memcpy(model->vertices[corners++].position_m,
			       mesh->positions[mesh->triangles[t][k]], sizeof(float[3]));
	*out = (struct model_mesh){ .vertex_count = corners,
				    .index_count = corners,
				    .vertices = model->vertices,
				    .indices = model->indices };
	return 0;
}

static void destroy(struct model *base)
{
	free(base->pieces);
	free(base);
}

int region_model_create(struct model **out, const struct region_set *set, const struct mesh *mesh,
			const struct face_blocks *blocks)
{
	static const struct model_methods methods = { choose, load, destroy };
	struct region_model *model = calloc(1, sizeof(*model));

	*out = NULL;
	if (!model)
		return -ENOMEM;
	model->model.pieces = calloc(blocks->count + 1, sizeof(*model->model.pieces));
	if (!model->model.pieces) {
		free(model);
		return -ENOMEM;
	}
	model->model.methods = &methods;
	model->model.piece_count = blocks->count;
	model->set = set;
	model->mesh = mesh;
	for (uint32_t n = 0; n < CORNERS; n++)
		model->indices[n] = (uint16_t)n;
	for (uint32_t n = 0; n < blocks->count; n++) {
		memcpy(model->model.pieces[n].low_m, blocks->boxes_m[n][0], sizeof(float[3]));
		memcpy(model->model.pieces[n].high_m, blocks->boxes_m[n][1], sizeof(float[3]));
		model->model.pieces[n].radius_m = -1;
	}
	mesh_box(mesh, model->model.low_m, model->model.high_m);
	*out = &model->model;
	return 0;
}
