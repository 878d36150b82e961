/* Adds points to the corners around them. */
#include "pipeline/octree/corner_field.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "base/spill.h"
#include "geometry/vec.h"

/* All corners of a cube that the surface crosses lie within sqrt(3) of it. */
static const double reach_out = 2.5;
/* A tangent plane soon leaves the surface, above all at edges: it ends not far beyond the next
 * point. */
static const double reach_aside_least = 1.5, reach_aside_spacings = 1.5, reach_aside_most = 4;

void corner_field_finish(struct corner_field *field)
{
	if (!field)
		return;
	map_finish(&field->map);
	spill_free(field->blocks);
	spill_free(field->corners);
	spill_free(field->colours);
	*field = (struct corner_field){ 0 };
}

uint32_t corner_field_find(const struct corner_field *field, const int32_t block[3])
{
	const uint64_t found =
		field->map.capacity ? map_get(&field->map, field_key(block)) : MAP_NONE;

	return found == MAP_NONE ? UINT32_MAX : (uint32_t)found;
}

static int grow(struct corner_field *field)
{
	const uint32_t room = field->room + field->room / 2 + 256;
	int rc = field->room >= FIELD_BLOCKS_MAX ? -EFBIG : 0;

	if (rc == 0)
		rc = SPILL_RESIZE(field->blocks, field->room, room);
	if (rc == 0)
		rc = SPILL_RESIZE(field->corners, field->room, room);
	if (rc == 0 && field->has_colour)
		rc = SPILL_RESIZE(field->colours, field->room, room);
	if (rc == 0)
		field->room = room;
	return rc;
}

static int find_or_add(struct corner_field *field, const int32_t block[3], uint32_t *out)
{
	int rc;

	*out = corner_field_find(field, block);
	if (*out != UINT32_MAX)
		return 0;
	if (field->block_count == field->room) {
		rc = grow(field);
		if (rc < 0)
			return rc;
	}
	rc = map_set(&field->map, field_key(block), field->block_count);
	if (rc < 0)
		return rc;
	memcpy(field->blocks[field->block_count], block, sizeof(field->blocks[0]));
	*out = field->block_count++;
	return 0;
}

/* Distance of places on a face, in cells. */
static const double face_step = 0.7;

enum { FACE_CELLS_MAX = 1 << 16 };

/* A point in cells from corner 0 0 0. */
struct splat {
	struct range_point point;
	double at[3];
	double reach_aside, reach; /* along the tangent plane; in any direction */
	int32_t low[3], high[3];   /* corners within reach */
};

/* Points are collected, and added by several threads: each has blocks of its own, and goes through
 * the points in their order. So the result does not depend on the number of threads. */
enum { BATCH_SPLATS = 1 << 15 };

struct batch {
	struct corner_field *field;
	struct splat *splats; /* owned */
	uint32_t count, workers;
};

/* Mixes a colour with those before. Scans without colours have added to the corner's weight, not to
 * its colour. */
static void add_colour(struct corner_field *field, uint32_t block, uint32_t index,
		       const uint8_t added[4], float weight)
{
	uint16_t *colour = field->colours[block][index];
	const float all = colour[0] > 0 ? field->corners[block][index].weight : weight;

	for (int k = 0; k < 3 && all > 0; k++) {
		const float step = (256.0f * added[k] - colour[k]) * weight;

		colour[k] = (uint16_t)fmaxf(1, rintf(colour[k] + step / all));
	}
}

static void add_to_corner(struct corner_field *field, uint32_t block, uint32_t index,
			  const struct splat *splat, const double from[3])
{
	struct field_corner *corner = &field->corners[block][index];
	const float *normal = splat->point.normal;
	const double out = from[0] * (double)normal[0] + from[1] * (double)normal[1] +
			   from[2] * (double)normal[2];
	const double aside = from[0] * from[0] + from[1] * from[1] + from[2] * from[2] - out * out;
	const float near = 1 - (float)(aside / (splat->reach_aside * splat->reach_aside) +
				       out * out / (reach_out * reach_out));
	const float weight = splat->point.weight * near * near * near * near;

	if (!(near > 0))
		return;
	corner->sum += weight * (float)out;
	corner->weight += weight;
	if (field->has_colour && splat->point.colour[3] > 0)
		add_colour(field, block, index, splat->point.colour, weight);
}

/* Adds to the corners of one block, from first to last in each direction. */
static void add_to_block(struct corner_field *field, uint32_t block, const int32_t first[3],
			 const int32_t last[3], const struct splat *splat)
{
	const double most = splat->reach * splat->reach;
	double from[3];

	for (int32_t z = first[2]; z <= last[2]; z++) {
		from[2] = z - splat->at[2];
		for (int32_t y = first[1]; y <= last[1]; y++) {
			const double part =
				(y - splat->at[1]) * (y - splat->at[1]) + from[2] * from[2];

			from[1] = y - splat->at[1];
			for (int32_t x = first[0]; x <= last[0] && part < most; x++) {
				const int32_t mask = FIELD_BLOCK_SIDE - 1;
				const uint32_t index =
					(uint32_t)(((z & mask) * FIELD_BLOCK_SIDE + (y & mask)) *
							   FIELD_BLOCK_SIDE +
						   (x & mask));

				from[0] = x - splat->at[0];
				if (from[0] * from[0] + part < most)
					add_to_corner(field, block, index, splat, from);
			}
		}
	}
}

static int32_t least(int32_t a, int32_t b)
{
	return a < b ? a : b;
}

static int32_t most(int32_t a, int32_t b)
{
	return a > b ? a : b;
}

static bool same_blocks(const struct splat *a, const struct splat *b)
{
	for (int k = 0; k < 3; k++)
		if (a->low[k] >> FIELD_BLOCK_SHIFT != b->low[k] >> FIELD_BLOCK_SHIFT ||
		    a->high[k] >> FIELD_BLOCK_SHIFT != b->high[k] >> FIELD_BLOCK_SHIFT)
			return false;
	return true;
}

/* Visits the blocks within reach of a point. Returns the first error of visit. */
static int each_block(const struct splat *splat, int (*visit)(void *data, const int32_t block[3]),
		      void *data)
{
	int32_t first[3], last[3], block[3];
	int rc = 0;

	for (int k = 0; k < 3; k++) {
		first[k] = splat->low[k] >> FIELD_BLOCK_SHIFT;
		last[k] = splat->high[k] >> FIELD_BLOCK_SHIFT;
	}
	for (block[2] = first[2]; block[2] <= last[2]; block[2]++)
		for (block[1] = first[1]; block[1] <= last[1]; block[1]++)
			for (block[0] = first[0]; block[0] <= last[0] && rc == 0; block[0]++)
				rc = visit(data, block);
	return rc;
}

static int add_block(void *data, const int32_t block[3])
{
	uint32_t found;

	return find_or_add(data, block, &found);
}

/* What one thread does with one point. */
struct turn {
	struct corner_field *field;
	const struct splat *splat;
	uint32_t piece, piece_count;
};

static int splat_block(void *data, const int32_t block[3])
{
	const struct turn *turn = data;
	const uint32_t sum = (uint32_t)block[0] + (uint32_t)block[1] + (uint32_t)block[2];
	int32_t first[3], last[3];

	if (sum % turn->piece_count != turn->piece)
		return 0;
	for (int k = 0; k < 3; k++) {
		const int32_t start = block[k] * FIELD_BLOCK_SIDE;

		first[k] = most(turn->splat->low[k], start);
		last[k] = least(turn->splat->high[k], start + FIELD_BLOCK_SIDE - 1);
	}
	add_to_block(turn->field, corner_field_find(turn->field, block), first, last, turn->splat);
	return 0;
}

static int add_splats(void *user, uint32_t piece, uint32_t worker)
{
	const struct batch *batch = user;
	struct turn turn = { batch->field, NULL, piece, batch->workers };
	int rc = 0;

	(void)worker;

	for (uint32_t i = 0; i < batch->count && rc == 0; i++) {
		turn.splat = &batch->splats[i];
		rc = each_block(turn.splat, splat_block, &turn);
	}
	return rc;
}

/* Adds the collected points. Blocks are made before, because only one thread may do that. */
static int flush(struct batch *batch)
{
	int rc = 0;

	for (uint32_t i = 0; i < batch->count && rc == 0; i++)
		if (i == 0 || !same_blocks(&batch->splats[i], &batch->splats[i - 1]))
			rc = each_block(&batch->splats[i], add_block, batch->field);
	if (rc == 0)
		rc = parallel_run(batch->workers, batch->workers, add_splats, batch);
	batch->count = 0;
	spill_breathe();
	return rc;
}

static int add_scan_point(struct batch *batch, const struct range_point *point)
{
	const struct corner_field *field = batch->field;
	const double spacing = (double)point->spacing / field->cell;
	struct splat *splat = &batch->splats[batch->count];

	splat->point = *point;
	splat->reach_aside =
		fmin(reach_aside_most, fmax(reach_aside_least, reach_aside_spacings * spacing));
	splat->reach = fmax(reach_out, splat->reach_aside);
	for (int k = 0; k < 3; k++) {
		splat->at[k] = (point->at[k] - field->origin[k]) / field->cell;
		if (!(fabs(splat->at[k]) < 1e9))
			return -EFBIG;
		splat->low[k] = (int32_t)ceil(splat->at[k] - splat->reach);
		splat->high[k] = (int32_t)floor(splat->at[k] + splat->reach);
	}
	return ++batch->count < BATCH_SPLATS ? 0 : flush(batch);
}

/* ---- faces of meshes */

/* Sets the normal of a face. Returns the length of its longest edge in cells, or 0 if it has no
 * area. */
static double measure_face(const struct corner_field *field,
			   const struct range_point *const corners[3], float normal[3])
{
	double edges[3][3], squared = 0, cross[3], largest = 0;

	for (int i = 0; i < 3; i++) {
		double sum = 0;

		for (int k = 0; k < 3; k++) {
			edges[i][k] =
				(corners[(i + 1) % 3]->at[k] - corners[i]->at[k]) / field->cell;
			sum += edges[i][k] * edges[i][k];
		}
		squared = fmax(squared, sum);
	}
	for (int k = 0; k < 3; k++) {
		const int a = (k + 1) % 3, b = (k + 2) % 3;

		cross[k] = edges[0][a] * edges[1][b] - edges[0][b] * edges[1][a];
		largest = fmax(largest, fabs(cross[k]));
	}
	for (int k = 0; k < 3; k++)
		normal[k] = largest > 0 ? (float)(cross[k] / largest) : 0;
	return vec_normalise(normal) > 0 ? sqrt(squared) : 0;
}

/* Adds the place of a face with these shares of its corners. */
static int add_face_point(struct batch *batch, const struct range_point *const corners[3],
			  const float normal[3], const double shares[3])
{
	struct range_point point = { .weight = 1, .spacing = 0 };

	vec_copy(point.normal, normal);
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			point.at[k] += shares[i] * corners[i]->at[k];
	point.colour[3] = corners[0]->colour[3];
	for (int k = 0; k < 3; k++)
		point.colour[k] = (uint8_t)(shares[0] * corners[0]->colour[k] +
					    shares[1] * corners[1]->colour[k] +
					    shares[2] * corners[2]->colour[k] + 0.5);
	return add_scan_point(batch, &point);
}

/* Adds places on a face, less than a cell apart: the middle of a small one. */
static int add_face(struct batch *batch, const struct range_scan *scan, uint32_t face)
{
	const struct range_point *corners[3];
	float normal[3];
	double longest;
	uint32_t n;
	int rc = 0;

	for (int i = 0; i < 3; i++)
		corners[i] = &scan->points[scan->triangles[face][i]];
	longest = fmin(measure_face(batch->field, corners, normal), FACE_CELLS_MAX);
	n = (uint32_t)ceil(longest / face_step);
	if (n == 1)
		return add_face_point(batch, corners, normal,
				      (double[3]){ 1 / 3., 1 / 3., 1 / 3. });
	for (uint32_t a = 0; a <= n && n > 0 && rc == 0; a++)
		for (uint32_t b = 0; a + b <= n && rc == 0; b++)
			rc = add_face_point(batch, corners, normal,
					    (double[3]){ (double)(n - a - b) / n, (double)a / n,
							 (double)b / n });
	return rc;
}

int corner_field_add(struct corner_field *field, const struct range_scan *scan)
{
	struct batch batch = { .field = field,
			       .splats = malloc(BATCH_SPLATS * sizeof(*batch.splats)),
			       .workers = parallel_cores() };
	int rc = batch.splats ? 0 : -ENOMEM;

	for (uint32_t i = 0; i < scan->count && !scan->triangles && rc == 0; i++)
		rc = add_scan_point(&batch, &scan->points[i]);
	for (uint32_t i = 0; i < scan->triangle_count && rc == 0; i++)
		rc = add_face(&batch, scan, i);
	if (rc == 0)
		rc = flush(&batch);
	free(batch.splats);
	return rc;
}

int corner_field_want(struct corner_field *field, const int32_t corner[3], uint32_t *out_block,
		      struct field_corner **out)
{
	const int32_t mask = FIELD_BLOCK_SIDE - 1;
	const int32_t index =
		((corner[2] & mask) * FIELD_BLOCK_SIDE + (corner[1] & mask)) * FIELD_BLOCK_SIDE +
		(corner[0] & mask);
	int32_t block[3];
	int rc;

	for (int k = 0; k < 3; k++)
		block[k] = corner[k] >> FIELD_BLOCK_SHIFT;
	rc = find_or_add(field, block, out_block);
	*out = rc == 0 ? &field->corners[*out_block][index] : NULL;
	return rc;
}

int corner_field_set(struct corner_field *field, const int32_t corner[3], float distance)
{
	struct field_corner *found;
	uint32_t block;
	const int rc = corner_field_want(field, corner, &block, &found);

	if (rc == 0)
		*found = (struct field_corner){ distance, 1 };
	return rc;
}
