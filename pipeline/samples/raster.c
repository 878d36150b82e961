/* Draws triangles into blocks of samples, eight samples of a row at once. */
#include "pipeline/samples/raster.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "base/array.h"
#include "base/parallel.h"

enum {
	SUBPIXELS = 256, /* places of corners are rounded to this part of a sample */
	CORNERS_MAX = 65536,
	/* Triangles that reach farther than this from the middle of the frame are clipped, so that
	 * 64 bits hold their edges, and 32 bits those of a block. */
	GUARD_PX = 8192,
	POLYGON_MAX = 3 + 5
};

typedef float floats __attribute__((vector_size(32)));
typedef int32_t ints __attribute__((vector_size(32)));

static const ints lanes = { 0, 1, 2, 3, 4, 5, 6, 7 };

/* What a corner has, and the middle of a triangle is interpolated from: the normal's three axes as
 * they are stored, the share of open sky 0..1, three colours; one is unused. */
enum { AT_NORMAL, AT_OPEN = 3, AT_COLOUR, CHANNELS = 8 };

struct corner {
	floats channels;
	int32_t x, y; /* in the frame, subpixels */
	float inverse_m;
	uint32_t outside; /* OUTSIDE bits; others than 0: x and y are not set */
};

/* How a corner is outside of what can have a place in the frame. */
enum {
	OUTSIDE_NEAR = 1,
	OUTSIDE_LEFT = 2,
	OUTSIDE_RIGHT = 4,
	OUTSIDE_TOP = 8,
	OUTSIDE_BOTTOM = 16
};

/* What is known of a block: its samples have no values yet; `farthest` is exact; or more, as many
 * triangles may have changed it since then. At BLOCK_STALE, `farthest` is found again. */
enum { BLOCK_EMPTY, BLOCK_KNOWN, BLOCK_STALE = BLOCK_KNOWN + 12 };

/* What raster_draw_meshes keeps between its two steps, and its arrays for the next time. */
struct crowd {
	const struct model_mesh *meshes; /* borrowed, while it draws */
	uint32_t count, threads;
	struct corner *corners;   /* owned, as all arrays; of all meshes */
	uint32_t *triangles;      /* numbers within their mesh; of each thread and mesh */
	struct crowd_part *parts; /* of each mesh */
	uint32_t corner_room, triangle_room, part_room, triangle_count;
};

struct crowd_part {
	uint32_t first_corner, first_triangle;
	uint32_t counts[RASTER_THREADS_MAX]; /* of triangles, for each thread */
};

struct raster {
	uint32_t side_px, side_blocks;
	float *inverse_m; /* owned, as all arrays; of each block one after the other */
	uint32_t *surface, *colour;
	/* Of each block, the least inverse_m of its samples, or less. */
	float *farthest;
	uint8_t *states;
	struct corner *corners;
	struct crowd crowd;
	/* the camera */
	float eye_m[3], right[3], up[3], forward[3], px_per_radian, near_m;
};

/* Large arrays are read and written here and there, so they ask for large pages. */
static void *make_array(size_t count, size_t bytes)
{
	const size_t page = 2 << 20;
	size_t size = (count * bytes + page - 1) / page * page;
	void *array = aligned_alloc(page, size);

	if (array)
		madvise(array, size, MADV_HUGEPAGE);
	return array;
}

int raster_create(struct raster **out, uint32_t side_px, bool colours)
{
	struct raster *raster = calloc(1, sizeof(*raster));
	uint32_t side = side_px / RASTER_BLOCK_PX;
	size_t blocks = (size_t)side * side, samples = blocks * RASTER_BLOCK_SAMPLES;

	*out = NULL;
	if (!raster)
		return -ENOMEM;
	raster->side_px = side_px;
	raster->side_blocks = side;
	raster->inverse_m = make_array(samples, sizeof(*raster->inverse_m));
	raster->surface = make_array(samples, sizeof(*raster->surface));
	raster->colour = colours ? make_array(samples, sizeof(*raster->colour)) : NULL;
	raster->farthest = make_array(blocks, sizeof(*raster->farthest));
	raster->states = make_array(blocks, sizeof(*raster->states));
	raster->corners = make_array(CORNERS_MAX, sizeof(*raster->corners));
	if (!raster->inverse_m || !raster->surface || (colours && !raster->colour) ||
	    !raster->farthest || !raster->states || !raster->corners) {
		raster_destroy(raster);
		return -ENOMEM;
	}
	*out = raster;
	return 0;
}

void raster_destroy(struct raster *raster)
{
	if (!raster)
		return;
	free(raster->inverse_m);
	free(raster->surface);
	free(raster->colour);
	free(raster->farthest);
	free(raster->states);
	free(raster->corners);
	free(raster->crowd.corners);
	free(raster->crowd.triangles);
	free(raster->crowd.parts);
	free(raster);
}

void raster_begin(struct raster *raster, const struct camera *camera)
{
	size_t blocks = (size_t)raster->side_blocks * raster->side_blocks;
	float view[16];

	camera_view(camera, view);
	for (int i = 0; i < 3; i++) {
		raster->eye_m[i] = camera->eye_m[i];
		raster->right[i] = view[4 * i];
		raster->up[i] = view[4 * i + 1];
		raster->forward[i] = -view[4 * i + 2];
	}
	raster->px_per_radian = camera_px_per_radian(camera);
	raster->near_m = camera->near_m;
	memset(raster->states, BLOCK_EMPTY, blocks * sizeof(*raster->states));
	memset(raster->farthest, 0, blocks * sizeof(*raster->farthest));
}

/* ---- corners */

/* From the eye: to the right, upwards, ahead. */
vector_inline void turn(const struct raster *raster, const float position_m[3], float out[3])
{
	float x = position_m[0] - raster->eye_m[0], y = position_m[1] - raster->eye_m[1],
	      z = position_m[2] - raster->eye_m[2];

	out[0] = x * raster->right[0] + y * raster->right[1] + z * raster->right[2];
	out[1] = x * raster->up[0] + y * raster->up[1] + z * raster->up[2];
	out[2] = x * raster->forward[0] + y * raster->forward[1] + z * raster->forward[2];
}

vector_inline floats channels_of(const struct model_vertex *vertex)
{
	const int8_t *n = vertex->normal;
	const uint8_t *c = vertex->colour;
	ints bytes = { n[0], n[1], n[2], c[3], c[0], c[1], c[2], 0 };
	const floats scale = { 127.5f / 127, 127.5f / 127, 127.5f / 127, 1 / 255.0f, 1, 1, 1, 1 };
	const floats offset = { 127.5f, 127.5f, 127.5f };

	return __builtin_convertvector(bytes, floats) * scale + offset;
}

/* Sets the place of a corner from where it is seen. */
vector_inline void place_corner(const struct raster *raster, struct corner *corner,
				const float seen[3])
{
	float scale, x, y;

	corner->outside = OUTSIDE_NEAR;
	if (seen[2] < raster->near_m)
		return;
	corner->inverse_m = 1 / seen[2];
	scale = raster->px_per_radian * corner->inverse_m;
	x = seen[0] * scale;
	y = -seen[1] * scale;
	corner->outside = (x < -GUARD_PX ? OUTSIDE_LEFT : 0) | (x > GUARD_PX ? OUTSIDE_RIGHT : 0) |
			  (y < -GUARD_PX ? OUTSIDE_TOP : 0) | (y > GUARD_PX ? OUTSIDE_BOTTOM : 0);
	if (corner->outside)
		return;
	corner->x = (int32_t)lrintf((x + (float)raster->side_px / 2) * SUBPIXELS);
	corner->y = (int32_t)lrintf((y + (float)raster->side_px / 2) * SUBPIXELS);
}

/* ---- triangles */

/* A triangle whose corners go clockwise in the frame. The edge k is opposite to the corner k. Its
 * function is positive inside: where it begins, and what it grows by per sample. The functions of
 * the edges 1 and 2, divided by the area, are the shares of the corners 1 and 2. */
struct triangle {
	int64_t edges[3]; /* at the sample 0, 0 */
	int32_t steps_x[3], steps_y[3];
	int32_t bias[3]; /* -1: samples on the edge are not inside */
	double per_area;
	float inverse_m[3], nearest; /* of the corners; the largest of them */
	floats channels, towards[2]; /* of corner 0, and the differences to the others */
	bool colours;
};

/* Whether samples on an edge belong to its triangle: the upper and left ones do. */
vector_inline bool owns_edge(int32_t x, int32_t y)
{
	return y < 0 || (y == 0 && x > 0);
}

vector_inline void set_edge(struct triangle *t, int k, const struct corner *from,
			    const struct corner *to)
{
	int32_t x = to->x - from->x, y = to->y - from->y;

	t->steps_x[k] = -y;
	t->steps_y[k] = x;
	t->edges[k] =
		(int64_t)x * (SUBPIXELS / 2 - from->y) - (int64_t)y * (SUBPIXELS / 2 - from->x);
	t->bias[k] = owns_edge(x, y) ? 0 : -1;
}

vector_inline bool any(ints mask)
{
	typedef int64_t longs __attribute__((vector_size(32)));
	longs wide = (longs)mask;

	return (wide[0] | wide[1] | wide[2] | wide[3]) != 0;
}

/* Packs four of the channels, the first lowest. weights: of the corners 1 and 2. */
vector_inline ints pack(const struct triangle *t, int first, floats weight1, floats weight2)
{
	ints out = { 0 };

	for (int k = 3; k >= 0; k--) {
		floats value = t->channels[first + k] + weight1 * t->towards[0][first + k] +
			       weight2 * t->towards[1][first + k];

		out = out << 8 | __builtin_convertvector(value + 0.5f, ints);
	}
	return out;
}

/* Stores the lanes of the mask. */
vector_inline void store(void *row, ints mask, ints value)
{
	ints before;

	memcpy(&before, row, sizeof(before));
	before = (before & ~mask) | (value & mask);
	memcpy(row, &before, sizeof(before));
}

/* Sets the least inverse distance of a block's samples. */
vector_inline void find_farthest(struct raster *raster, size_t block)
{
	const float *at = raster->inverse_m + block * RASTER_BLOCK_SAMPLES;
	floats farthest;
	float result = INFINITY;

	memcpy(&farthest, at, sizeof(farthest));
	for (int y = 1; y < RASTER_BLOCK_PX; y++) {
		floats row;
		ints less;

		memcpy(&row, at + (size_t)y * RASTER_BLOCK_PX, sizeof(row));
		less = row < farthest;
		farthest = (floats)(((ints)row & less) | ((ints)farthest & ~less));
	}
	for (int x = 0; x < RASTER_BLOCK_PX; x++)
		result = farthest[x] < result ? farthest[x] : result;
	raster->farthest[block] = result;
	raster->states[block] = BLOCK_KNOWN;
}

/* Draws the part of a triangle in the rows from..to of a block. */
vector_inline void draw_in_block(struct raster *raster, const struct triangle *t, uint32_t column,
				 uint32_t row, int from, int to)
{
	size_t block = (size_t)row * raster->side_blocks + column;
	int64_t edges[3];
	ints inside[3];
	floats share[2], step_x = __builtin_convertvector(lanes, floats);
	float step_y[2];

	for (int k = 0; k < 3; k++) {
		int64_t first;
		int32_t reach = 0;

		edges[k] = t->edges[k] +
			   SUBPIXELS * (t->steps_x[k] * (int64_t)(column * RASTER_BLOCK_PX) +
					t->steps_y[k] *
						(int64_t)(row * RASTER_BLOCK_PX + (uint32_t)from));
		/* A sample is inside if the function's 256th, rounded down, is not negative. */
		first = (edges[k] + t->bias[k]) >> 8;
		reach += t->steps_x[k] > 0 ? 7 * t->steps_x[k] : 0;
		reach += t->steps_y[k] > 0 ? (to - from) * t->steps_y[k] : 0;
		if (first + reach < 0)
			return;
		inside[k] = (int32_t)(first < 1 << 30 ? first : 1 << 30) + lanes * t->steps_x[k];
	}
	for (int k = 0; k < 2; k++) {
		float step = (float)(SUBPIXELS * t->steps_x[k + 1] * t->per_area);

		share[k] = (float)((double)edges[k + 1] * t->per_area) + step_x * step;
		step_y[k] = (float)(SUBPIXELS * t->steps_y[k + 1] * t->per_area);
	}
	if (raster->states[block] == BLOCK_EMPTY)
		memset(raster->inverse_m + block * RASTER_BLOCK_SAMPLES, 0,
		       RASTER_BLOCK_SAMPLES * sizeof(*raster->inverse_m));
	raster->states[block] += raster->states[block] == BLOCK_EMPTY ? BLOCK_KNOWN + 1 : 1;
	for (int y = from; y <= to; y++) {
		size_t at = block * RASTER_BLOCK_SAMPLES + (size_t)y * RASTER_BLOCK_PX;
		floats inverse_m = t->inverse_m[0] +
				   share[0] * (t->inverse_m[1] - t->inverse_m[0]) +
				   share[1] * (t->inverse_m[2] - t->inverse_m[0]);
		ints mask = ~((inside[0] | inside[1] | inside[2]) >> 31);
		floats before;

		memcpy(&before, raster->inverse_m + at, sizeof(before));
		mask &= inverse_m > before;
		if (any(mask)) {
			/* What is linear on the surface is so in the frame when it is divided by
			 * the distance. */
			floats weight1 = share[0] * (t->inverse_m[1] / inverse_m);
			floats weight2 = share[1] * (t->inverse_m[2] / inverse_m);

			store(raster->inverse_m + at, mask, (ints)inverse_m);
			store(raster->surface + at, mask, pack(t, AT_NORMAL, weight1, weight2));
			if (t->colours)
				store(raster->colour + at, mask,
				      pack(t, AT_COLOUR, weight1, weight2));
		}
		for (int k = 0; k < 3; k++)
			inside[k] += t->steps_y[k];
		for (int k = 0; k < 2; k++)
			share[k] += step_y[k];
	}
}

vector_inline int32_t least(int32_t a, int32_t b)
{
	return a < b ? a : b;
}

vector_inline int32_t most(int32_t a, int32_t b)
{
	return a > b ? a : b;
}

vector_inline void set_channels(struct triangle *t, const struct corner *const corners[3],
				bool back)
{
	floats scale = { 1, 1, 1, back ? 126 : 127, 1, 1, 1, 1 };
	floats offset = { 0, 0, 0, back ? 1 : 128 };

	t->channels = corners[0]->channels * scale + offset;
	for (int k = 0; k < 2; k++)
		t->towards[k] = (corners[k + 1]->channels - corners[0]->channels) * scale;
	for (int k = 0; k < 3; k++)
		t->inverse_m[k] = corners[k]->inverse_m;
	t->nearest = fmaxf(t->inverse_m[0], fmaxf(t->inverse_m[1], t->inverse_m[2]));
}

/* Rows of blocks that are drawn: of `every`, a power of two, the one numbered `first`. */
struct rows {
	uint32_t first, every;
};

/* The samples whose middles lie in the bounding box of a triangle. */
struct bounds {
	int32_t low_x, low_y, high_x, high_y;
};

/* Returns false if there are none. */
vector_inline bool find_bounds(const struct raster *raster, const struct corner *a,
			       const struct corner *b, const struct corner *c, struct bounds *out)
{
	const int32_t half = SUBPIXELS / 2, last = (int32_t)raster->side_px - 1;

	out->low_x = most((least(a->x, least(b->x, c->x)) + half - 1) >> 8, 0);
	out->low_y = most((least(a->y, least(b->y, c->y)) + half - 1) >> 8, 0);
	out->high_x = least((most(a->x, most(b->x, c->x)) - half) >> 8, last);
	out->high_y = least((most(a->y, most(b->y, c->y)) - half) >> 8, last);
	return out->low_x <= out->high_x && out->low_y <= out->high_y;
}

vector_inline void draw_triangle(struct raster *raster, struct rows rows, const struct corner *a,
				 const struct corner *b, const struct corner *c)
{
	struct bounds box;
	struct triangle t;
	int32_t first_row;
	int64_t area;

	if (!find_bounds(raster, a, b, c, &box))
		return;
	first_row = box.low_y / 8 +
		    (int32_t)((rows.first - (uint32_t)box.low_y / 8) & (rows.every - 1));
	if (first_row > box.high_y / 8)
		return;
	area = (int64_t)(b->x - a->x) * (c->y - a->y) - (int64_t)(b->y - a->y) * (c->x - a->x);
	if (area == 0)
		return;
	/* A front's corners go anticlockwise, seen from outside. */
	const struct corner *const corners[3] = { a, area > 0 ? b : c, area > 0 ? c : b };

	t.per_area = 1.0 / (double)(area > 0 ? area : -area);
	t.colours = raster->colour != NULL;
	set_edge(&t, 0, corners[1], corners[2]);
	set_edge(&t, 1, corners[2], corners[0]);
	set_edge(&t, 2, corners[0], corners[1]);
	set_channels(&t, corners, area > 0);
	for (int32_t row = first_row; row <= box.high_y / 8; row += (int32_t)rows.every) {
		int from = most(box.low_y - 8 * row, 0), to = least(box.high_y - 8 * row, 7);

		for (int32_t column = box.low_x / 8; column <= box.high_x / 8; column++) {
			size_t block = (size_t)row * raster->side_blocks + (size_t)column;

			if (raster->states[block] >= BLOCK_STALE)
				find_farthest(raster, block);
			if (t.nearest <= raster->farthest[block])
				continue;
			draw_in_block(raster, &t, (uint32_t)column, (uint32_t)row, from, to);
		}
	}
}

/* ---- triangles that reach behind the eye or far beyond the frame */

struct seen_corner {
	float seen[3];
	floats channels;
};

/* Returns how far inside the plane a corner is: the near plane, and four sides that are as far from
 * the frame as corners may be. */
static float inside_by(const struct raster *raster, int plane, const float seen[3])
{
	float side = 0.999f * GUARD_PX / raster->px_per_radian * seen[2];

	if (plane == 0)
		return seen[2] - 1.0001f * raster->near_m;
	return side + (plane % 2 ? 1.0f : -1.0f) * seen[(plane - 1) / 2];
}

/* Cuts a polygon by a plane (Sutherland and Hodgman 1974). Returns how many corners are left. */
static int clip(const struct raster *raster, int plane, const struct seen_corner *from, int count,
		struct seen_corner *to)
{
	int kept = 0;

	for (int i = 0; i < count; i++) {
		const struct seen_corner *a = &from[i], *b = &from[(i + 1) % count];
		float da = inside_by(raster, plane, a->seen),
		      db = inside_by(raster, plane, b->seen);

		if (da >= 0)
			to[kept++] = *a;
		if ((da >= 0) != (db >= 0)) {
			float share = da / (da - db);

			for (int k = 0; k < 3; k++)
				to[kept].seen[k] = a->seen[k] + share * (b->seen[k] - a->seen[k]);
			to[kept++].channels = a->channels + share * (b->channels - a->channels);
		}
	}
	return kept;
}

static vector_clones void draw_clipped(struct raster *raster, struct rows rows,
				       const struct model_mesh *mesh, const uint16_t *indices)
{
	struct seen_corner polygons[2][POLYGON_MAX];
	struct corner corners[POLYGON_MAX];
	int count = 3;

	for (int k = 0; k < 3; k++) {
		const struct model_vertex *vertex = &mesh->vertices[indices[k]];

		turn(raster, vertex->position_m, polygons[0][k].seen);
		polygons[0][k].channels = channels_of(vertex);
	}
	for (int plane = 0; plane < 5; plane++)
		count = clip(raster, plane, polygons[plane % 2], count, polygons[1 - plane % 2]);
	for (int k = 0; k < count; k++) {
		corners[k].channels = polygons[1][k].channels;
		place_corner(raster, &corners[k], polygons[1][k].seen);
		if (corners[k].outside) /* by rounding, at the very edge */
			return;
	}
	for (int k = 2; k < count; k++)
		draw_triangle(raster, rows, &corners[0], &corners[k - 1], &corners[k]);
}

vector_inline void place_corners(const struct raster *raster, const struct model_mesh *mesh,
				 struct corner *corners)
{
	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		float seen[3];

		turn(raster, mesh->vertices[i].position_m, seen);
		corners[i].channels = channels_of(&mesh->vertices[i]);
		place_corner(raster, &corners[i], seen);
	}
}

vector_inline void draw_indices(struct raster *raster, struct rows rows,
				const struct model_mesh *mesh, const struct corner *corners,
				const uint16_t *indices)
{
	const struct corner *a = &corners[indices[0]], *b = &corners[indices[1]],
			    *c = &corners[indices[2]];

	if (!(a->outside | b->outside | c->outside))
		draw_triangle(raster, rows, a, b, c);
	else if (!(a->outside & b->outside & c->outside))
		draw_clipped(raster, rows, mesh, indices);
}

vector_clones void raster_draw(struct raster *raster, const struct model_mesh *mesh)
{
	place_corners(raster, mesh, raster->corners);
	for (uint32_t i = 0; i < mesh->index_count; i += 3)
		draw_indices(raster, (struct rows){ 0, 1 }, mesh, raster->corners,
			     mesh->indices + i);
}

/* ---- by several threads
 *
 * First each mesh's corners are placed and its triangles given to the threads in whose rows they
 * are, then each thread draws its own. A thread has every so-manieth row of blocks, so all have
 * about as much to do wherever the model is in the frame. */

/* Returns a bit for each thread that draws some of the triangle. */
vector_inline uint32_t threads_of(const struct raster *raster, const struct corner *a,
				  const struct corner *b, const struct corner *c)
{
	const uint32_t threads = raster->crowd.threads;
	struct bounds box;
	uint32_t bits = 0;

	if (a->outside & b->outside & c->outside)
		return 0;
	if (a->outside | b->outside | c->outside)
		return (1u << threads) - 1;
	if (!find_bounds(raster, a, b, c, &box))
		return 0;
	for (int32_t row = box.low_y / 8; row <= box.high_y / 8; row++)
		bits |= 1u << ((uint32_t)row & (threads - 1));
	return bits;
}

vector_inline uint32_t *triangles_of(const struct crowd *crowd, uint32_t thread,
				     const struct crowd_part *part)
{
	return crowd->triangles + (size_t)thread * crowd->triangle_count + part->first_triangle;
}

static vector_clones int give_out(void *user, uint32_t piece, uint32_t worker)
{
	const struct raster *raster = user;
	const struct crowd *crowd = &raster->crowd;
	const struct model_mesh *mesh = &crowd->meshes[piece];
	struct crowd_part *part = &crowd->parts[piece];
	struct corner *corners = crowd->corners + part->first_corner;

	(void)worker;
	place_corners(raster, mesh, corners);
	for (uint32_t i = 0; i < mesh->index_count / 3; i++) {
		const uint16_t *indices = mesh->indices + 3 * (size_t)i;
		const uint32_t bits = threads_of(raster, &corners[indices[0]], &corners[indices[1]],
						 &corners[indices[2]]);

		for (uint32_t thread = 0; bits >> thread; thread++)
			if (bits >> thread & 1)
				triangles_of(crowd, thread, part)[part->counts[thread]++] = i;
	}
	return 0;
}

static vector_clones int draw_own(void *user, uint32_t thread, uint32_t worker)
{
	struct raster *raster = user;
	const struct crowd *crowd = &raster->crowd;

	(void)worker;
	for (uint32_t m = 0; m < crowd->count; m++) {
		const struct crowd_part *part = &crowd->parts[m];
		const uint32_t *triangles = triangles_of(crowd, thread, part);

		for (uint32_t i = 0; i < part->counts[thread]; i++)
			draw_indices(raster, (struct rows){ thread, crowd->threads },
				     &crowd->meshes[m], crowd->corners + part->first_corner,
				     crowd->meshes[m].indices + 3 * (size_t)triangles[i]);
	}
	return 0;
}

static int make_room(struct crowd *crowd)
{
	uint64_t corners = 0, triangles = 0;
	int rc = ARRAY_RESERVE(crowd->parts, crowd->part_room, crowd->count, UINT32_MAX);

	for (uint32_t m = 0; m < crowd->count && rc == 0; m++) {
		crowd->parts[m] = (struct crowd_part){ .first_corner = (uint32_t)corners,
						       .first_triangle = (uint32_t)triangles };
		corners += crowd->meshes[m].vertex_count;
		triangles += crowd->meshes[m].index_count / 3;
	}
	if (rc == 0)
		rc = ARRAY_RESERVE(crowd->triangles, crowd->triangle_room,
				   triangles * crowd->threads, UINT32_MAX);
	crowd->triangle_count = (uint32_t)triangles;
	if (rc == 0 && corners > crowd->corner_room) {
		/* vectors need more than malloc's alignment */
		free(crowd->corners);
		crowd->corners = make_array(corners, sizeof(*crowd->corners));
		crowd->corner_room = crowd->corners ? (uint32_t)corners : 0;
		rc = crowd->corners ? 0 : -ENOMEM;
	}
	return rc;
}

int raster_draw_meshes(struct raster *raster, const struct model_mesh *meshes, uint32_t count,
		       uint32_t threads)
{
	struct crowd *crowd = &raster->crowd;
	int rc;

	if (threads == 1) {
		for (uint32_t m = 0; m < count; m++)
			raster_draw(raster, &meshes[m]);
		return 0;
	}
	crowd->meshes = meshes;
	crowd->count = count;
	crowd->threads = threads;
	rc = make_room(crowd);
	if (rc == 0)
		rc = parallel_run(threads, count, give_out, raster);
	if (rc == 0)
		rc = parallel_run(threads, threads, draw_own, raster);
	crowd->meshes = NULL;
	return rc == -EFBIG ? -ENOMEM : rc;
}

/* ---- what is hidden */

static bool block_hides(struct raster *raster, size_t block, float nearest)
{
	if (nearest < raster->farthest[block])
		return true;
	if (raster->states[block] <= BLOCK_KNOWN)
		return false;
	find_farthest(raster, block);
	return nearest < raster->farthest[block];
}

/* Sets the square of the frame where a box appears, in samples, and the inverse distance of its
 * nearest corner. Returns false if it reaches behind the near plane. */
static bool find_square(const struct raster *raster, const float low_m[3], const float high_m[3],
			float low[2], float high[2], float *nearest)
{
	low[0] = low[1] = INFINITY;
	high[0] = high[1] = -INFINITY;
	*nearest = 0;
	for (int k = 0; k < 8; k++) {
		const float position_m[3] = { k & 1 ? high_m[0] : low_m[0],
					      k & 2 ? high_m[1] : low_m[1],
					      k & 4 ? high_m[2] : low_m[2] };
		float seen[3], place[2];

		turn(raster, position_m, seen);
		if (seen[2] < raster->near_m)
			return false;
		place[0] = seen[0] / seen[2];
		place[1] = -seen[1] / seen[2];
		for (int i = 0; i < 2; i++) {
			place[i] = place[i] * raster->px_per_radian + (float)raster->side_px / 2;
			low[i] = fminf(low[i], place[i]);
			high[i] = fmaxf(high[i], place[i]);
		}
		*nearest = fmaxf(*nearest, 1 / seen[2]);
	}
	*nearest *= 1.00001f; /* for rounding */
	return true;
}

bool raster_hides(struct raster *raster, const float low_m[3], const float high_m[3])
{
	const float last = (float)(raster->side_px - 1);
	float low[2], high[2], nearest;
	uint32_t from[2], to[2];

	if (!find_square(raster, low_m, high_m, low, high, &nearest))
		return false;
	for (int i = 0; i < 2; i++) {
		if (high[i] + 1 < 0 || low[i] - 1 > last)
			return true;
		from[i] = (uint32_t)fmaxf(low[i] - 1, 0) / RASTER_BLOCK_PX;
		to[i] = (uint32_t)fminf(high[i] + 1, last) / RASTER_BLOCK_PX;
	}
	for (uint32_t row = from[1]; row <= to[1]; row++)
		for (uint32_t column = from[0]; column <= to[0]; column++)
			if (!block_hides(raster, (size_t)row * raster->side_blocks + column,
					 nearest))
				return false;
	return true;
}

/* ---- what was drawn */

/* Adds the samples of a block to the largest of the inverse distances and to the least above 0. */
vector_inline void add_range(const float *at, floats *nearest, floats *farthest)
{
	for (int y = 0; y < RASTER_BLOCK_PX; y++) {
		floats row;
		ints nearer, farther;

		memcpy(&row, at + (size_t)y * RASTER_BLOCK_PX, sizeof(row));
		nearer = row > *nearest;
		farther = (row > 0) & (row < *farthest);
		*nearest = (floats)(((ints)row & nearer) | ((ints)*nearest & ~nearer));
		*farthest = (floats)(((ints)row & farther) | ((ints)*farthest & ~farther));
	}
}

vector_clones bool raster_range(const struct raster *raster, float *near_m, float *far_m)
{
	size_t blocks = (size_t)raster->side_blocks * raster->side_blocks;
	floats nearest = { 0 }, farthest = nearest + INFINITY;
	float near = 0, far = INFINITY;

	for (size_t block = 0; block < blocks; block++)
		if (raster->states[block] != BLOCK_EMPTY)
			add_range(raster->inverse_m + block * RASTER_BLOCK_SAMPLES, &nearest,
				  &farthest);
	for (int x = 0; x < RASTER_BLOCK_PX; x++) {
		near = nearest[x] > near ? nearest[x] : near;
		far = farthest[x] < far ? farthest[x] : far;
	}
	if (near <= 0)
		return false;
	*near_m = 0.9999f / near;
	*far_m = 1.0001f / far;
	return true;
}

bool raster_get_block(const struct raster *raster, uint32_t column, uint32_t row,
		      struct raster_block *out)
{
	size_t block = (size_t)row * raster->side_blocks + column;
	size_t at = block * RASTER_BLOCK_SAMPLES;

	if (raster->states[block] == BLOCK_EMPTY)
		return false;
	out->inverse_m = raster->inverse_m + at;
	out->surface = raster->surface + at;
	out->colour = raster->colour ? raster->colour + at : NULL;
	return true;
}
