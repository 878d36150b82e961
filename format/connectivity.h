/* Codes which vertices the triangles of a patch group connect, by the cut-border machine (Gumhold
 * and Strasser 1998, "Real time compression of triangle mesh connectivity"): triangles are added
 * one by one to the edges of those before, and a symbol says where the third corner is. Private to
 * format/.
 *
 * Encoder and decoder run the same machine; only what the encoder looks up in its source differs.
 * Any mesh can be coded: what does not fit (a third triangle at an edge, a separate piece) takes
 * more bits. */
#ifndef GOPURA_FORMAT_CONNECTIVITY_H
#define GOPURA_FORMAT_CONNECTIVITY_H

#include "format/patch.h"
#include "format/patch_source.h"
#include "format/predict.h"
#include "format/symbol_coder.h"

/* The vertices of a group are numbered in the order in which they are coded. */
struct connectivity {
	uint32_t patch_count;
	/* of each patch; set by the caller */
	uint32_t patch_vertices[GROUP_PATCHES_MAX], patch_triangles[GROUP_PATCHES_MAX];
	uint32_t vertex_count;      /* distinct ones of the group */
	struct predict_step *steps; /* owned; from what each vertex is predicted */
	uint32_t *members;          /* owned; the vertices of each patch, patch after patch */
	uint16_t *indices;          /* owned; 3 per triangle: numbers within the patch's members */
	/* owned; encoding: the vertex of the source behind each vertex */
	uint32_t *sources;
};

/* Codes the triangles of a group whose counts are set. source is NULL when decoding; when encoding
 * its triangles are marked as coded. End it with connectivity_finish, after a failure too. Returns
 * -EBADMSG if what is decoded does not fit the counts or itself, or -ENOMEM. */
must_check int connectivity_code(struct connectivity *mesh, struct symbol_coder *coder,
				 struct patch_source *source);
void connectivity_finish(struct connectivity *mesh);

#endif
