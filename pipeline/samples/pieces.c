/* Keeps the decoded pieces that were asked for last. */
#include "pipeline/samples/pieces.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/samples/recency.h"

/* How much is kept, in bytes. */
enum { KEPT_BYTES = 256 << 20 };

struct kept {
	void *data; /* owned: vertices, then indices; NULL: the piece is not kept */
	uint32_t vertex_count, index_count;
};

struct pieces {
	struct model *model; /* borrowed */
	struct kept *kept;   /* owned; of each piece */
	struct recency recency;
	uint64_t bytes;
};

int pieces_create(struct pieces **out, struct model *model)
{
	struct pieces *pieces = calloc(1, sizeof(*pieces));
	int rc = -ENOMEM;

	*out = NULL;
	if (!pieces)
		return -ENOMEM;
	pieces->model = model;
	pieces->kept = calloc(model->piece_count, sizeof(*pieces->kept));
	if (pieces->kept)
		rc = recency_init(&pieces->recency, model->piece_count);
	if (rc < 0) {
		pieces_destroy(pieces);
		return rc;
	}
	*out = pieces;
	return 0;
}

void pieces_destroy(struct pieces *pieces)
{
	if (!pieces)
		return;
	for (uint32_t piece = 0; pieces->kept && piece < pieces->model->piece_count; piece++)
		free(pieces->kept[piece].data);
	recency_finish(&pieces->recency);
	free(pieces->kept);
	free(pieces);
}

static size_t vertex_bytes(const struct kept *kept)
{
	return kept->vertex_count * sizeof(struct model_vertex);
}

static size_t bytes_of(const struct kept *kept)
{
	return vertex_bytes(kept) + kept->index_count * sizeof(uint16_t);
}

static void drop_oldest(struct pieces *pieces)
{
	uint32_t piece = pieces->recency.oldest;

	recency_remove(&pieces->recency, piece);
	pieces->bytes -= bytes_of(&pieces->kept[piece]);
	free(pieces->kept[piece].data);
	pieces->kept[piece].data = NULL;
}

static int keep(struct pieces *pieces, uint32_t piece)
{
	struct kept *kept = &pieces->kept[piece];
	struct model_mesh mesh;
	int rc = model_load(pieces->model, piece, &mesh);

	if (rc < 0)
		return rc;
	kept->vertex_count = mesh.vertex_count;
	kept->index_count = mesh.index_count;
	kept->data = malloc(bytes_of(kept) + 1);
	if (!kept->data)
		return -ENOMEM;
	memcpy(kept->data, mesh.vertices, vertex_bytes(kept));
	memcpy((char *)kept->data + vertex_bytes(kept), mesh.indices,
	       mesh.index_count * sizeof(*mesh.indices));
	pieces->bytes += bytes_of(kept);
	return 0;
}

int pieces_get(struct pieces *pieces, uint32_t piece, struct model_mesh *out)
{
	const struct kept *kept = &pieces->kept[piece];

	if (kept->data) {
		recency_remove(&pieces->recency, piece);
	} else {
		int rc = keep(pieces, piece);

		if (rc < 0)
			return rc;
	}
	recency_add(&pieces->recency, piece);
	while (pieces->bytes > KEPT_BYTES && pieces->recency.oldest != piece)
		drop_oldest(pieces);
	*out = (struct model_mesh){ .vertex_count = kept->vertex_count,
				    .index_count = kept->index_count,
				    .vertices = kept->data,
				    .indices = (const uint16_t *)((const char *)kept->data +
								  vertex_bytes(kept)) };
	return 0;
}
