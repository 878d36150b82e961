/* The signed distance at the corners of the leaf cubes, near the surface (paper P1, section 4.2):
 * at each corner the mean of the distances to the tangent planes of the points around it, weighted
 * by confidence and nearness. Corners lie at whole numbers times the cell; they are kept in blocks
 * of 8 x 8 x 8, only where there are points, in arrays that may be larger than memory. */
#ifndef GOPURA_PIPELINE_OCTREE_CORNER_FIELD_H
#define GOPURA_PIPELINE_OCTREE_CORNER_FIELD_H

#include "base/map.h"
#include "pipeline/octree/range_scan.h"

enum {
	FIELD_BLOCK_SHIFT = 3,
	FIELD_BLOCK_SIDE = 1 << FIELD_BLOCK_SHIFT,
	FIELD_BLOCK_CORNERS = FIELD_BLOCK_SIDE * FIELD_BLOCK_SIDE * FIELD_BLOCK_SIDE,
	FIELD_BLOCKS_MAX = 1 << 26,
	FIELD_REACH_MAX = 4, /* how far from a point corners may be, in cells */
};

struct field_corner {
	float sum;    /* of weight times distance, in cells; below 0: inside */
	float weight; /* 0: not seen */
};

struct corner_field {
	double origin[3]; /* place of corner 0 0 0 */
	double cell;      /* side of a leaf cube, in the unit of the files */
	bool has_colour;
	struct map map; /* from field_key to the block */
	uint32_t block_count, room;
	int32_t (*blocks)[3]; /* corner >> FIELD_BLOCK_SHIFT; owned */
	struct field_corner (*corners)[FIELD_BLOCK_CORNERS]; /* x first; owned */
	/* Times 256, but at least 1, because 0 means none; owned; NULL: no colours. */
	uint16_t (*colours)[FIELD_BLOCK_CORNERS][3];
};

/* Returns a number that no other block has. */
static inline map_key field_key(const int32_t block[3])
{
	return (map_key)(uint32_t)block[2] << 64 | (map_key)(uint32_t)block[1] << 32 |
	       (map_key)(uint32_t)block[0];
}

/* A zeroed field with origin, cell and has_colour set is empty. Adds all points of a scan; of a
 * mesh places on its faces instead, so that there are enough of them. All cores work, and the
 * result does not depend on their number. -ENOMEM, -ENOSPC; -EFBIG: more than FIELD_BLOCKS_MAX
 * blocks. */
must_check int corner_field_add(struct corner_field *field, const struct range_scan *scan);
void corner_field_finish(struct corner_field *field); /* NULL and zeroed are fine */

/* Finds a corner, and adds its block if that is missing. *out_block is the block's number; *out is
 * borrowed until the next block is added. Errors as corner_field_add; *out is then NULL. */
must_check int corner_field_want(struct corner_field *field, const int32_t corner[3],
				 uint32_t *out_block, struct field_corner **out);
/* Gives a corner a distance, in cells, and confidence 1, whatever was seen there. Errors as
 * corner_field_add. */
must_check int corner_field_set(struct corner_field *field, const int32_t corner[3],
				float distance);
/* Returns the number of the block with that place, or UINT32_MAX. */
uint32_t corner_field_find(const struct corner_field *field, const int32_t block[3]);

#endif
