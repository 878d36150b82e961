/* The triangles of a model's pieces, decoded when they are asked for. Those asked for last are kept
 * in memory, up to a limit. */
#ifndef GOPURA_PIPELINE_SAMPLES_PIECES_H
#define GOPURA_PIPELINE_SAMPLES_PIECES_H

#include "pipeline/samples/model.h"

struct pieces;

/* *out is owned by the caller; NULL on failure. The model is borrowed for its lifetime. Texture
 * coordinates are left out. Returns -ENOMEM. */
must_check int pieces_create(struct pieces **out, struct model *model);
void pieces_destroy(struct pieces *pieces); /* NULL is fine */
/* *out is borrowed until the next call. Errors as model_load. */
must_check int pieces_get(struct pieces *pieces, uint32_t piece, struct model_mesh *out);

#endif
