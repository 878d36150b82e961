/* A whole mesh as a surface: cut into chunks of triangles that are close in space. */
#ifndef GOPURA_PIPELINE_SAMPLES_CHUNKS_H
#define GOPURA_PIPELINE_SAMPLES_CHUNKS_H

#include "pipeline/import/mesh.h"
#include "pipeline/samples/model.h"

/* Indices have 16 bits (GLES2 promises no more), so each chunk has its own vertices. */
enum { CHUNK_TRIANGLES_MAX = 4096 };

/* Cuts a mesh into chunks, each with triangles of one texture. All of them are always chosen. *out
 * is owned by the caller (model_destroy); NULL on failure. colour is the sRGB colour of a mesh
 * without colours. The mesh is not needed afterwards. Returns -ENOMEM, -ENOSPC, or -EINVAL if the
 * mesh has no triangle. */
must_check int chunks_create(struct model **out, const struct mesh *mesh, const uint8_t colour[3]);

#endif
