/* The streaming mesh of a release (format/stream.h) while it arrives and grows on the panel. Pure;
 * no GL.
 *
 * Whatever has arrived is applied in one step: each vertex that a split adds starts at the place
 * and with the colour of the vertex it splits from, so that the picture is the same as before, and
 * moves to its own (a geomorph; Hoppe 1996, "Progressive meshes"). What arrives meanwhile waits for
 * the next step. */
#ifndef GOPURA_RENDER_PATCHES_STREAM_GROWTH_H
#define GOPURA_RENDER_PATCHES_STREAM_GROWTH_H

#include "format/page.h"
#include "format/stream.h"
#include "format/stream_page.h"

enum { STREAM_GROW_MS = 300 };

/* A vertex as uploaded to the GPU. */
struct stream_vertex {
	float place[3]; /* on the lattice */
	int8_t normal[2];
	uint8_t colour[4];
	uint8_t zero[2];
};
_Static_assert(sizeof(struct stream_vertex) == 20, "the stride on the GPU");

/* A zeroed struct has no stream. */
struct stream_growth {
	struct buffer object; /* the page's bytes */
	struct page page;     /* its children are the blocks */
	struct stream_page start;
	struct buffer bytes;  /* the stream, as far as it has arrived without a gap */
	uint32_t block_count; /* so many blocks of it */
	bool damaged;         /* a block does not decode, so those after it are of no use */
	struct buffer *early; /* owned; for each block, its bytes if it came before its turn */
	uint8_t *has;         /* owned; for each block, whether it arrived */
	struct stream_decoder *decoder;
	struct stream_vertex *from, *shown;    /* owned; where vertices start, and where they are */
	uint16_t *indices;                     /* owned; of the triangles that are shown */
	uint32_t vertex_count, triangle_count; /* shown */
	uint32_t first_moving;                 /* vertices from this one on move */
	uint32_t record_count;                 /* records that are shown or on their way */
	float share;                           /* of the way, 0 to 1 */
};

/* Takes the stream page; the base is shown from the next step on. object is copied. Returns
 * -EBADMSG or -ENOMEM; it is then empty. */
must_check int stream_growth_open(struct stream_growth *growth, struct bytes object);
void stream_growth_finish(struct stream_growth *growth); /* zeroed is fine */
/* Takes a block; blocks may come in any order. Returns -EBADMSG or -ENOMEM: the mesh stays what
 * the blocks before it gave, and later blocks are ignored. */
must_check int stream_growth_give(struct stream_growth *growth, uint32_t block,
				  struct bytes object);

/* What a step has changed, for the GPU's copies. */
struct stream_change {
	bool triangles;                  /* and with them vertices from 0 on */
	uint32_t first_vertex, vertices; /* from first_vertex on */
};
/* Moves what moves. passed_ms is the time since the last step. */
void stream_growth_step(struct stream_growth *growth, float passed_ms, struct stream_change *out);
/* Returns whether vertices move, or records wait to be shown. */
bool stream_growth_moves(const struct stream_growth *growth);
/* Returns the distance in metres from the whole mesh after so many blocks. */
float stream_growth_error_m(const struct stream_growth *growth, uint32_t blocks);

#endif
