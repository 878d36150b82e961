/* The sampling repository (paper P0 5.2) as pages and tiles.
 *
 * Points lie on a regular grid: point (x, y, z) is at origin + spacing * (x, y, z). At each point
 * six faces (format/cube.h) were rendered from the full hierarchy, at finest_px pixels a side and
 * at every half of that down to one tile. A level is cut into tiles of SAMPLE_TILE_PX pixels, each
 * stored with an apron of SAMPLE_APRON_PX on every side (what lies there on the neighbouring tile
 * or, outside the face, on the 90 degree face's own plane continued), so that bilinear filtering
 * never needs a neighbour; both together are whole blocks of the coding (docs/samples.md). A tile
 * that shows nothing of the model is absent.
 *
 * Three kinds of page: PAGE_SAMPLES (one; the grid; children: bricks that hold anything) ->
 * PAGE_BRICK (4 x 4 x 4 points; children: faces that show anything)
 * -> PAGE_FACE (children: tiles that are there, level by level from the coarsest, each in
 * Morton's order). */
#ifndef GOPURA_FORMAT_SAMPLES_H
#define GOPURA_FORMAT_SAMPLES_H

#include "format/cube.h"
#include "format/page.h"

enum {
	SAMPLE_TILE_PX = 126,
	SAMPLE_APRON_PX = 1,
	SAMPLE_IMAGE_PX = SAMPLE_TILE_PX + 2 * SAMPLE_APRON_PX, /* what a tile holds: 128 */
	SAMPLE_LEVELS_MAX = 6, /* 126, 252, 504, 1008, 2016, 4032 pixels a side */
	SAMPLE_GRID_MAX = 64,  /* points a side */
	BRICK_SIDE = 4,        /* points */
	BRICK_POINTS = BRICK_SIDE * BRICK_SIDE * BRICK_SIDE,
	FACE_TILES_MAX = 1 + 4 + 16 + 64 + 256 + 1024
};

struct samples_page {
	float origin_m[3], spacing_m[3];
	uint8_t count[3];    /* points a side */
	uint8_t level_count; /* level l has SAMPLE_TILE_PX << l pixels a side */
	/* Child of the page that is brick (bx, by, bz), or HIERARCHY_NONE's twin SAMPLE_NONE:
	 * nothing was sampled there. Index: (bz * bricks[1] + by) * bricks[0] + bx. Owned. */
	uint32_t bricks[3];
	uint32_t *brick_child;
};

/* In all three pages children are numbered in the order of their index here, without gaps: the
 * bytes hold only which are there (docs/samples.md). The decoders number them so; whoever follows
 * a number first holds it against the page's child_count. */

#define SAMPLE_NONE UINT32_MAX

/* Appends the payload, for page.payload, as the other two encoders do. Failures are out->error. */
void samples_page_encode(struct buffer *out, const struct samples_page *samples);
/* *out is finished by the caller; on failure it is zeroed. -EBADMSG, -ENOMEM. */
must_check int samples_page_decode(struct samples_page *out, struct bytes payload);
void samples_page_finish(struct samples_page *samples);

/* A brick, per point p = (z * 4 + y) * 4 + x within it, and face f. */
struct brick_page {
	/* Child that is the face's page, or SAMPLE_NONE. */
	uint32_t face_child[BRICK_POINTS][CUBE_FACES];
	/* Which of the 4 x 4 sixteenths of the face show the model: bit row * 4 + column. */
	uint16_t coverage[BRICK_POINTS][CUBE_FACES];
	/* Distance along the face's axis, of what it shows, metres. On the wire 16 bits each: near
	 * comes back up to 1/128 nearer, far up to 1/128 farther. */
	float near_m[BRICK_POINTS][CUBE_FACES], far_m[BRICK_POINTS][CUBE_FACES];
};

void brick_page_encode(struct buffer *out, const struct brick_page *brick);
/* -EBADMSG: *out is of no use then. The same of face_page_decode; neither allocates. */
must_check int brick_page_decode(struct brick_page *out, struct bytes payload);

struct face_page {
	uint8_t level_count;
	/* Child that is the tile, or SAMPLE_NONE; index face_tile_index(). */
	uint32_t tile_child[FACE_TILES_MAX];
};

void face_page_encode(struct buffer *out, const struct face_page *face);
must_check int face_page_decode(struct face_page *out, struct bytes payload);

/* Index of a tile among all of a face: coarsest level first, and each level in Morton's order (by
 * the bits of row and column in turn), so that what is near on the face is near in the pack, and
 * what a view asks for lies in few ranges. */
uint32_t face_tile_index(uint32_t level, uint32_t row, uint32_t column);
/* Where the tile of such an index lies; the level must be the index's own. */
void face_tile_place(uint32_t level, uint32_t index, uint32_t *row, uint32_t *column);

#endif
