/* Goes through the blocks in layers along the longest axis; the vertices on the edges of two layers
 * are known at a time, so that memory grows with a section of the surface, not with all of it. */
#include "pipeline/octree/cube_surface.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/spill.h"

enum {
	SIDE = FIELD_BLOCK_SIDE,
	WITH_NEXT = FIELD_BLOCK_SIDE + 1, /* corners along a block, with those of the next one */
	GATHERED = WITH_NEXT * WITH_NEXT * WITH_NEXT,
	FIRST_ROOM = 1 << 16,
};

/* What a corner must have seen; one point of full confidence gives up to 1. */
static const float weight_least = 1e-5f;
/* A vertex keeps that share of its edge from its ends. */
static const float share_least = 1.0f / 256;
/* Grey, times 256, where no scan with colours was near. */
static const float unknown_colour = 190 * 256;
/* Leaf cubes that the membrane's value 1 stands for. */
static const float distance_full = 1.5f;

struct corner {
	float value;            /* leaf cubes; below 0: inside */
	const uint16_t *colour; /* NULL: none */
	bool is_known;
};

/* A block, its place along the axis of layers last. */
struct place {
	int32_t at[3];
};

struct drawing {
	const struct corner_field *field;
	const struct coarse_fill *fill;
	const struct cube_surface_options *options;
	struct mesh mesh;
	uint32_t vertex_room, triangle_room;
	int along;              /* the axis of layers */
	struct map vertices[2]; /* on edges that begin in this layer of blocks, and in the next */
	struct place *blocks;   /* to be drawn; owned */
	uint32_t block_count, block_room;
	struct corner corners[GATHERED]; /* of the current block */
	int32_t block[3];                /* the current one */
};

/* ---- which blocks */

static int compare_blocks(const void *a, const void *b)
{
	const int32_t *x = ((const struct place *)a)->at, *y = ((const struct place *)b)->at;

	for (int k = 2; k >= 0; k--)
		if (x[k] != y[k])
			return x[k] < y[k] ? -1 : 1;
	return 0;
}

static int add_block(struct drawing *drawing, int32_t x, int32_t y, int32_t z)
{
	int rc = ARRAY_RESERVE(drawing->blocks, drawing->block_room, drawing->block_count + 1,
			       UINT32_MAX - 1);

	if (rc == 0)
		drawing->blocks[drawing->block_count++] = (struct place){ { x, y, z } };
	return rc;
}

/* Chooses the axis of layers, and moves each place along it to the end. */
static void turn_blocks(struct drawing *drawing)
{
	int32_t low[3] = { INT32_MAX, INT32_MAX, INT32_MAX };
	int32_t high[3] = { INT32_MIN, INT32_MIN, INT32_MIN };

	for (uint32_t i = 0; i < drawing->block_count; i++)
		for (int k = 0; k < 3; k++) {
			const int32_t at = drawing->blocks[i].at[k];

			low[k] = at < low[k] ? at : low[k];
			high[k] = at > high[k] ? at : high[k];
		}
	drawing->along = 2;
	for (int k = 0; k < 2; k++)
		if ((int64_t)high[k] - low[k] > (int64_t)high[drawing->along] - low[drawing->along])
			drawing->along = k;
	for (uint32_t i = 0; i < drawing->block_count; i++) {
		const struct place block = drawing->blocks[i];

		for (int k = 0; k < 3; k++)
			drawing->blocks[i].at[k] = block.at[(drawing->along + 1 + k) % 3];
	}
}

/* A cube belongs to the block of its lowest corner, so the blocks before one in the field have
 * cubes that end in it. */
static int add_seen_blocks(struct drawing *drawing)
{
	const struct corner_field *field = drawing->field;
	int rc = 0;

	for (uint32_t b = 0; b < field->block_count && rc == 0; b++)
		for (int i = 0; i < 8 && rc == 0; i++) {
			int32_t block[3];

			for (int k = 0; k < 3; k++)
				block[k] = field->blocks[b][k] - (i >> k & 1);
			if (i == 0 || corner_field_find(field, block) == UINT32_MAX)
				rc = add_block(drawing, block[0], block[1], block[2]);
		}
	return rc;
}

/* Adds the blocks of a coarse cell. */
static int add_cell_blocks(struct drawing *drawing, const int32_t cell[3])
{
	const struct coarse_fill *fill = drawing->fill;
	int32_t first[3], last[3];
	int rc = 0;

	for (int k = 0; k < 3; k++) {
		const int32_t low = fill->low[k] + cell[k] * (1 << fill->shift);

		first[k] = low >> FIELD_BLOCK_SHIFT;
		last[k] = (low + (1 << fill->shift) - 1) >> FIELD_BLOCK_SHIFT;
	}
	for (int32_t z = first[2]; z <= last[2]; z++)
		for (int32_t y = first[1]; y <= last[1]; y++)
			for (int32_t x = first[0]; x <= last[0] && rc == 0; x++)
				rc = add_block(drawing, x, y, z);
	return rc;
}

/* Where the membrane changes its sign. */
static int add_unseen_blocks(struct drawing *drawing)
{
	const struct coarse_fill *fill = drawing->fill;
	const size_t row = fill->corners[0], layer = row * fill->corners[1];
	int32_t cell[3];
	int rc = 0;

	for (cell[2] = 0; cell[2] + 1 < (int32_t)fill->corners[2]; cell[2]++)
		for (cell[1] = 0; cell[1] + 1 < (int32_t)fill->corners[1]; cell[1]++)
			for (cell[0] = 0; cell[0] + 1 < (int32_t)fill->corners[0] && rc == 0;
			     cell[0]++) {
				const float *at = fill->values + (size_t)cell[2] * layer +
						  (size_t)cell[1] * row + cell[0];
				int inside = 0;

				for (size_t i = 0; i < 8; i++)
					inside += at[(i & 1) + (i >> 1 & 1) * row +
						     (i >> 2) * layer] < 0;
				if (inside > 0 && inside < 8)
					rc = add_cell_blocks(drawing, cell);
			}
	return rc;
}

static int list_blocks(struct drawing *drawing)
{
	uint32_t kept = 0;
	int rc = add_seen_blocks(drawing);

	if (rc == 0 && drawing->options->is_closed)
		rc = add_unseen_blocks(drawing);
	if (rc < 0 || drawing->block_count == 0)
		return rc;
	turn_blocks(drawing);
	qsort(drawing->blocks, drawing->block_count, sizeof(*drawing->blocks), compare_blocks);
	for (uint32_t i = 1; i < drawing->block_count; i++)
		if (compare_blocks(&drawing->blocks[i], &drawing->blocks[kept]) != 0)
			drawing->blocks[++kept] = drawing->blocks[i];
	drawing->block_count = kept + 1;
	return 0;
}

/* ---- corners */

static struct corner read_corner(const struct drawing *drawing, uint32_t block, const int32_t at[3])
{
	const struct corner_field *field = drawing->field;
	const int32_t mask = SIDE - 1;
	const size_t index =
		(size_t)(((at[2] & mask) * SIDE + (at[1] & mask)) * SIDE + (at[0] & mask));
	struct corner corner = { 0 };

	if (block != UINT32_MAX) {
		const struct field_corner *seen = &field->corners[block][index];

		corner.is_known = seen->weight > weight_least;
		if (corner.is_known) {
			corner.value = seen->sum / seen->weight;
			if (field->has_colour && field->colours[block][index][0] > 0)
				corner.colour = field->colours[block][index];
		}
	}
	/* What another scan saw through cannot be inside. */
	if (corner.is_known && corner.value < 0 && coarse_fill_is_free(drawing->fill, at))
		corner.is_known = false;
	if (!corner.is_known && drawing->options->is_closed) {
		corner.value = coarse_fill_at(drawing->fill, at) * distance_full;
		corner.is_known = true;
	}
	return corner;
}

/* Reads the corners of the current block and the first ones of those after it. Returns whether the
 * surface may cross one of its cubes. */
static bool gather(struct drawing *drawing)
{
	uint32_t blocks[8];
	bool inside = false, outside = false;

	for (int i = 0; i < 8; i++) {
		int32_t block[3];

		for (int k = 0; k < 3; k++)
			block[k] = drawing->block[k] + (i >> k & 1);
		blocks[i] = corner_field_find(drawing->field, block);
	}
	for (int32_t i = 0; i < GATHERED; i++) {
		const int32_t in[3] = { i % WITH_NEXT, i / WITH_NEXT % WITH_NEXT,
					i / WITH_NEXT / WITH_NEXT };
		int32_t at[3];
		int which = 0;

		for (int k = 0; k < 3; k++) {
			at[k] = drawing->block[k] * SIDE + in[k];
			which |= (in[k] == SIDE) << k;
		}
		drawing->corners[i] = read_corner(drawing, blocks[which], at);
		inside |= drawing->corners[i].is_known && drawing->corners[i].value < 0;
		outside |= drawing->corners[i].is_known && !(drawing->corners[i].value < 0);
	}
	return inside && outside;
}

/* ---- vertices and triangles */

static int grow_vertices(struct drawing *drawing)
{
	struct mesh *mesh = &drawing->mesh;
	const uint32_t room = drawing->vertex_room + drawing->vertex_room / 2 + FIRST_ROOM;
	int rc = room >= UINT32_MAX - FIRST_ROOM || room < drawing->vertex_room ? -EFBIG : 0;

	if (rc == 0)
		rc = SPILL_RESIZE(mesh->positions, drawing->vertex_room, room);
	if (rc == 0 && drawing->field->has_colour)
		rc = SPILL_RESIZE(mesh->colours, drawing->vertex_room, room);
	if (rc == 0)
		drawing->vertex_room = room;
	return rc;
}

static int add_vertex(struct drawing *drawing, const int32_t at[3], int axis,
		      const struct corner *low, const struct corner *high)
{
	const struct corner_field *field = drawing->field;
	struct mesh *mesh = &drawing->mesh;
	const uint32_t vertex = mesh->vertex_count;
	float share = low->value / (low->value - high->value);
	int rc = vertex == drawing->vertex_room ? grow_vertices(drawing) : 0;

	if (rc < 0)
		return rc;
	share = fmaxf(share_least, fminf(1 - share_least, share));
	for (int k = 0; k < 3; k++)
		mesh->positions[vertex][k] =
			(float)(field->origin[k] +
				field->cell * (at[k] + (k == axis ? (double)share : 0)));
	for (int k = 0; k < 3 && field->has_colour; k++) {
		const uint16_t *a = low->colour ? low->colour : high->colour;
		const uint16_t *b = high->colour ? high->colour : low->colour;
		const float mixed = a ? a[k] + share * ((float)b[k] - a[k]) : unknown_colour;

		mesh->colours[vertex][k] = (uint8_t)fminf(255, mixed / 256 + 0.5f);
	}
	if (field->has_colour)
		mesh->colours[vertex][3] = 255;
	mesh->vertex_count++;
	return 0;
}

/* Finds or adds the vertex on an edge of the cube at in, a corner of the block. */
static int vertex_on(struct drawing *drawing, const int32_t in[3], int edge, uint32_t *out)
{
	const uint8_t corner = cube_edge_corner(edge);
	const int axis = edge / 4;
	int32_t low[3], at[3];
	size_t index;
	struct map *map;
	map_key key;
	uint64_t found;
	int rc;

	for (int k = 0; k < 3; k++) {
		low[k] = in[k] + (corner >> k & 1);
		at[k] = drawing->block[k] * SIDE + low[k];
	}
	map = &drawing->vertices[low[drawing->along] == SIDE];
	key = field_key(at) | (map_key)axis << 96;
	found = map->capacity ? map_get(map, key) : MAP_NONE;
	if (found != MAP_NONE) {
		*out = (uint32_t)found;
		return 0;
	}
	index = (size_t)((low[2] * WITH_NEXT + low[1]) * WITH_NEXT + low[0]);
	*out = drawing->mesh.vertex_count;
	rc = map_set(map, key, *out);
	if (rc == 0)
		rc = add_vertex(drawing, at, axis, &drawing->corners[index],
				&drawing->corners[index + (axis == 0   ? 1
							   : axis == 1 ? WITH_NEXT
								       : WITH_NEXT * WITH_NEXT)]);
	return rc;
}

static int add_triangle(struct drawing *drawing, const uint8_t edges[3],
			const uint32_t vertices[CUBE_EDGES])
{
	struct mesh *mesh = &drawing->mesh;

	if (mesh->triangle_count == drawing->triangle_room) {
		const uint32_t room =
			drawing->triangle_room + drawing->triangle_room / 2 + FIRST_ROOM;
		int rc = room >= UINT32_MAX - FIRST_ROOM || room < drawing->triangle_room ? -EFBIG
											  : 0;

		if (rc == 0)
			rc = SPILL_RESIZE(mesh->triangles, drawing->triangle_room, room);
		if (rc < 0)
			return rc;
		drawing->triangle_room = room;
	}
	for (int k = 0; k < 3; k++)
		mesh->triangles[mesh->triangle_count][k] = vertices[edges[k]];
	mesh->triangle_count++;
	return 0;
}

static int draw_cube(struct drawing *drawing, const int32_t in[3])
{
	const struct corner *lowest =
		&drawing->corners[(in[2] * WITH_NEXT + in[1]) * WITH_NEXT + in[0]];
	const struct cube_case *drawn;
	uint32_t vertices[CUBE_EDGES];
	uint8_t inside = 0;
	int rc = 0;

	for (int c = 0; c < 8; c++) {
		const struct corner *corner =
			lowest + ((c >> 2) * WITH_NEXT + (c >> 1 & 1)) * WITH_NEXT + (c & 1);

		if (!corner->is_known)
			return 0;
		inside |= (uint8_t)((corner->value < 0) << c);
	}
	if (inside == 0 || inside == 255)
		return 0;
	drawn = cube_case_of(inside);
	for (int edge = 0; edge < CUBE_EDGES && rc == 0; edge++) {
		vertices[edge] = UINT32_MAX;
		if (drawn->next[edge] != CUBE_NO_EDGE)
			rc = vertex_on(drawing, in, edge, &vertices[edge]);
	}
	for (int t = 0; t < drawn->triangle_count && rc == 0; t++)
		rc = add_triangle(drawing, drawn->triangles[t], vertices);
	if (rc == 0 && drawing->options->leaf) {
		int32_t cube[3];

		for (int k = 0; k < 3; k++)
			cube[k] = drawing->block[k] * SIDE + in[k];
		rc = drawing->options->leaf(drawing->options->data, cube, inside, vertices);
	}
	return rc;
}

static int draw_block(struct drawing *drawing)
{
	int32_t in[3];
	int rc = 0;

	if (!gather(drawing))
		return 0;
	for (in[2] = 0; in[2] < SIDE; in[2]++)
		for (in[1] = 0; in[1] < SIDE; in[1]++)
			for (in[0] = 0; in[0] < SIDE && rc == 0; in[0]++)
				rc = draw_cube(drawing, in);
	return rc;
}

static void next_layer(struct drawing *drawing)
{
	struct map swapped = drawing->vertices[0];

	drawing->vertices[0] = drawing->vertices[1];
	drawing->vertices[1] = swapped;
	map_clear(&drawing->vertices[1]);
}

static int draw_blocks(struct drawing *drawing)
{
	int rc = 0;

	for (uint32_t i = 0; i < drawing->block_count && rc == 0; i++) {
		const int32_t *at = drawing->blocks[i].at;
		const int32_t layers = i > 0 ? at[2] - drawing->blocks[i - 1].at[2] : 0;

		for (int32_t k = 0; k < layers && k < 2; k++)
			next_layer(drawing);
		for (int k = 0; k < 3; k++)
			drawing->block[(drawing->along + 1 + k) % 3] = at[k];
		rc = draw_block(drawing);
		spill_pass(i * 64ull);
	}
	return rc;
}

int cube_surface_draw(struct mesh *out, const struct corner_field *field,
		      const struct coarse_fill *fill, const struct cube_surface_options *options)
{
	struct drawing *drawing = calloc(1, sizeof(*drawing));
	int rc = drawing ? 0 : -ENOMEM;

	*out = (struct mesh){ 0 };
	if (rc < 0)
		return rc;
	drawing->field = field;
	drawing->fill = fill;
	drawing->options = options;
	rc = list_blocks(drawing);
	if (rc == 0)
		rc = draw_blocks(drawing);
	if (rc == 0)
		*out = drawing->mesh;
	else
		mesh_finish(&drawing->mesh);
	for (int i = 0; i < 2; i++)
		map_finish(&drawing->vertices[i]);
	free(drawing->blocks);
	free(drawing);
	return rc;
}
