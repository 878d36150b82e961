/* The sampling repository (paper P0 5.2) as pages and tiles.
 *
 * Points lie on a regular grid: point (x, y, z) is at origin + spacing * (x, y, z). Beside the grid
 * there may be vantage points, each at an eye from which many visitors look: what it sampled is
 * seen from there without parallax, whatever the mesh. At each point six faces (format/cube.h) are
 * rendered from the full hierarchy. The finest level has SAMPLE_TILE_PX << (level_count - 1) pixels
 * a side; each coarser level has half of that, down to one tile. A level is cut into tiles of
 * SAMPLE_TILE_PX pixels. Each tile is stored with an apron of SAMPLE_APRON_PX on every side, so
 * that bilinear filtering never needs a neighbour. The apron repeats the pixels of the neighbouring
 * tile or, at the edge of the face, continues the plane of the face. Tile and apron together are
 * whole blocks of the coding (docs/samples.md). A tile that shows nothing of the model is absent.
 *
 * Three kinds of page: PAGE_SAMPLES (one; the grid; children: bricks that hold anything) ->
 * PAGE_BRICK (4 x 4 x 4 points, or all vantage points; children: faces that show anything) ->
 * PAGE_FACE (children: the tiles that exist, level by level from the coarsest, each level in Morton
 * order). */
#ifndef GOPURA_FORMAT_SAMPLES_H
#define GOPURA_FORMAT_SAMPLES_H

#include "format/cube.h"
#include "format/page.h"

enum {
	SAMPLE_TILE_PX = 126,
	SAMPLE_APRON_PX = 1,
	SAMPLE_IMAGE_PX = SAMPLE_TILE_PX + 2 * SAMPLE_APRON_PX, /* side of a stored tile: 128 */
	SAMPLE_LEVELS_MAX = 6, /* 126, 252, 504, 1008, 2016, 4032 pixels a side */
	SAMPLE_GRID_MAX = 64,  /* points a side */
	BRICK_SIDE = 4,        /* points */
	BRICK_POINTS = BRICK_SIDE * BRICK_SIDE * BRICK_SIDE,
	SAMPLE_VANTAGES_MAX = BRICK_POINTS, /* they are points of one brick */
	FACE_TILES_MAX = 1 + 4 + 16 + 64 + 256 + 1024
};

struct samples_page {
	float origin_m[3], spacing_m[3];
	uint8_t count[3];    /* points a side */
	uint8_t level_count; /* level l has SAMPLE_TILE_PX << l pixels a side */
	/* The child number of brick (bx, by, bz), or SAMPLE_NONE: nothing was sampled there. Index:
	 * (bz * bricks[1] + by) * bricks[0] + bx. If there are vantage points, their brick is the
	 * last, and exists. Owned. */
	uint32_t bricks[3];
	uint32_t *brick_child;
	uint32_t vantage_count; /* 0 .. SAMPLE_VANTAGES_MAX */
	float vantage_m[SAMPLE_VANTAGES_MAX][3];
};

/* In all three pages, children are numbered in the order of their index here, without gaps. The
 * bytes only say which exist (docs/samples.md), and the decoders number them. Before a number is
 * used, it must be checked against the page's child_count. */

#define SAMPLE_NONE UINT32_MAX

/* Returns the length of brick_child. */
uint32_t samples_page_bricks(const struct samples_page *samples);

/* Appends the payload, for page.payload; so do the other two encoders. Failures are out->error.
 * Children must be numbered as described above: the encoders assert it. */
void samples_page_encode(struct buffer *out, const struct samples_page *samples);
/* The caller ends *out with samples_page_finish(); it is zeroed on failure. Returns -EBADMSG or
 * -ENOMEM. */
must_check int samples_page_decode(struct samples_page *out, struct bytes payload);
/* Frees the array and zeroes the struct. NULL and zeroed are fine. */
void samples_page_finish(struct samples_page *samples);

/* A brick, indexed by point p = (z * 4 + y) * 4 + x within it, and by face f. */
struct brick_page {
	/* The child number of the face's page, or SAMPLE_NONE. */
	uint32_t face_child[BRICK_POINTS][CUBE_FACES];
	/* Which cells of a 4 x 4 grid on the face show the model: bit row * 4 + column. */
	uint16_t coverage[BRICK_POINTS][CUBE_FACES];
	/* Range of distances along the face's axis of what the face shows, metres. The wire has 16
	 * bits for each: near decodes up to 1/128 nearer, far up to 1/128 farther. */
	float near_m[BRICK_POINTS][CUBE_FACES], far_m[BRICK_POINTS][CUBE_FACES];
};

/* See samples_page_encode. */
void brick_page_encode(struct buffer *out, const struct brick_page *brick);
/* Returns -EBADMSG; *out is then undefined. The same holds for face_page_decode. Neither
 * allocates. */
must_check int brick_page_decode(struct brick_page *out, struct bytes payload);

struct face_page {
	uint8_t level_count;
	/* The child number of the tile, or SAMPLE_NONE; indexed by face_tile_index(). */
	uint32_t tile_child[FACE_TILES_MAX];
};

/* See samples_page_encode and brick_page_decode. */
void face_page_encode(struct buffer *out, const struct face_page *face);
must_check int face_page_decode(struct face_page *out, struct bytes payload);

/* Returns the index of a tile among all tiles of a face: coarsest level first, each level in Morton
 * order (the bits of row and column interleaved). So tiles that are near each other on the face are
 * near in the pack, and the tiles of a view lie in few byte ranges. */
uint32_t face_tile_index(uint32_t level, uint32_t row, uint32_t column);
/* Returns the level of the tile with that index. */
uint32_t face_tile_level(uint32_t index);
/* The inverse: sets row and column of the tile with that index. level must be the level of the
 * index. */
void face_tile_place(uint32_t level, uint32_t index, uint32_t *row, uint32_t *column);

#endif
