/* Builds the BVH of a patch by median splits, cuts it into pieces and runs the ray queries over
 * it. */
#include "geometry/patch_bvh.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"

enum { LEAF_TRIANGLES = 8, DEPTH_MAX = 48 };

static const float flat_enough = 0.8f;

static void vertex_m(const struct patch_bvh *bvh, uint32_t vertex, float out[3])
{
	const uint16_t *at = bvh->positions[vertex];
	for (int i = 0; i < 3; i++)
		out[i] = (float)(bvh->lattice.origin_m[i] + bvh->lattice.step_m * at[i]);
}

/* ---- building */

struct builder {
	struct patch_bvh *bvh;
	uint16_t *indices; /* the mesh's index buffer, sorted in place */
	/* The sort keys of each triangle: three times its centre, then its unit normal. */
	float (*key)[6];
};

static void swap_triangles(struct builder *b, uint32_t i, uint32_t j)
{
	for (int k = 0; k < 3; k++) {
		uint16_t index = b->indices[3 * i + k];
		b->indices[3 * i + k] = b->indices[3 * j + k];
		b->indices[3 * j + k] = index;
	}
	uint16_t number = b->bvh->order[i];
	b->bvh->order[i] = b->bvh->order[j];
	b->bvh->order[j] = number;
	for (int k = 0; k < 6; k++) {
		float key = b->key[i][k];
		b->key[i][k] = b->key[j][k];
		b->key[j][k] = key;
	}
}

/* Wirth's selection algorithm: moves the median triangle along an axis to the middle of the
 * range. */
static void split_at_median(struct builder *b, uint32_t first, uint32_t count, int axis)
{
	int64_t low = first, high = first + count - 1, middle = first + count / 2;
	while (low < high) {
		float pivot = b->key[middle][axis];
		int64_t i = low, j = high;
		while (i <= j) {
			while (b->key[i][axis] < pivot)
				i++;
			while (b->key[j][axis] > pivot)
				j--;
			if (i <= j)
				swap_triangles(b, (uint32_t)i++, (uint32_t)j--);
		}
		if (j < middle)
			low = i;
		if (middle < i)
			high = j;
	}
}

static void bound(const struct builder *b, struct patch_bvh_node *node)
{
	for (int i = 0; i < 3; i++) {
		node->low[i] = UINT16_MAX;
		node->high[i] = 0;
	}
	const uint32_t first = 3u * node->first, end = first + 3u * node->count;
	for (uint32_t k = first; k < end; k++) {
		const uint16_t *at = b->bvh->positions[b->indices[k]];
		for (int i = 0; i < 3; i++) {
			node->low[i] = at[i] < node->low[i] ? at[i] : node->low[i];
			node->high[i] = at[i] > node->high[i] ? at[i] : node->high[i];
		}
	}
}

/* Returns the length of the mean normal of a range: 1 flat, 0 facing all directions. */
static float flatness_of(const struct builder *b, uint32_t first, uint32_t count)
{
	float sum[3] = { 0 };
	for (uint32_t t = first; t < first + count; t++)
		for (int i = 0; i < 3; i++)
			sum[i] += b->key[t][3 + i];
	return vec_length(sum) / (float)count;
}

/* Returns the key along which a range is longest. In a range larger than a piece the normals count
 * too, so that the sides of a pillar go to different pieces. */
static int longest_axis(const struct builder *b, const struct patch_bvh_node *node)
{
	float least[6], most[6], longest = 0;
	int axis = 0;
	bool bends = node->count > PIECE_TRIANGLES_BENT &&
		     flatness_of(b, node->first, node->count) < flat_enough;
	for (int k = 0; k < 6; k++) {
		least[k] = INFINITY;
		most[k] = -INFINITY;
		for (uint32_t t = node->first; t < (uint32_t)node->first + node->count; t++) {
			least[k] = vec_least(least[k], b->key[t][k]);
			most[k] = vec_most(most[k], b->key[t][k]);
		}
		if (k < 3 && most[k] - least[k] > longest) {
			longest = most[k] - least[k];
			axis = k;
		}
	}
	/* A bend of 90 degrees counts as much as the length of the range. */
	float scale = longest / 1.4f;
	for (int k = 3; k < 6 && bends && node->count <= 8 * PIECE_TRIANGLES_MAX; k++) {
		if ((most[k] - least[k]) * scale > longest) {
			longest = (most[k] - least[k]) * scale;
			axis = k;
		}
	}
	return axis;
}

static uint32_t build_node(struct builder *b, uint32_t first, uint32_t count)
{
	uint32_t self = b->bvh->node_count++;
	struct patch_bvh_node *node = &b->bvh->nodes[self];
	*node = (struct patch_bvh_node){ .first = (uint16_t)first, .count = (uint16_t)count };
	bound(b, node);
	if (count <= LEAF_TRIANGLES)
		return self;
	split_at_median(b, first, count, longest_axis(b, node));
	build_node(b, first, count / 2);
	uint32_t right = build_node(b, first + count / 2, count - count / 2);
	b->bvh->nodes[self].right = (uint16_t)right;
	return self;
}

/* ---- pieces */

static void measure_piece(const struct patch_bvh *bvh, struct piece *piece)
{
	float area2 = 0;
	for (uint32_t t = piece->first_triangle; t < piece->first_triangle + piece->triangle_count;
	     t++) {
		float a[3], b[3], c[3], n[3];
		vertex_m(bvh, bvh->indices[3 * t], a);
		vertex_m(bvh, bvh->indices[3 * t + 1], b);
		vertex_m(bvh, bvh->indices[3 * t + 2], c);
		vec_sub(b, b, a);
		vec_sub(c, c, a);
		vec_cross(n, b, c);
		for (int i = 0; i < 3; i++)
			piece->normal[i] += n[i];
		area2 += vec_length(n);
	}
	/* There are two triangles per vertex, and each vertex stands for a cell of spacing
	 * squared. */
	piece->spacing_m = sqrtf(area2 / (float)piece->triangle_count);
	vec_normalise(piece->normal);
}

struct piece_probe patch_bvh_probe(const struct patch_bvh *bvh, const struct piece *piece,
				   int probe)
{
	struct piece_probe out;
	/* The triangles of a piece are sorted in space, so even steps spread well over it. */
	uint32_t t = piece->first_triangle +
		     (2 * (uint32_t)probe + 1) * piece->triangle_count / (2 * PIECE_PROBES);
	float corner[3][3], ab[3], ac[3];
	for (int c = 0; c < 3; c++)
		vertex_m(bvh, bvh->indices[3 * t + c], corner[c]);
	for (int i = 0; i < 3; i++)
		out.at_m[i] = (corner[0][i] + corner[1][i] + corner[2][i]) / 3;
	vec_sub(ab, corner[1], corner[0]);
	vec_sub(ac, corner[2], corner[0]);
	vec_cross(out.normal, ab, ac);
	if (vec_normalise(out.normal) <= 0)
		memcpy(out.normal, piece->normal, sizeof(piece->normal));
	return out;
}

static void set_extents(const struct patch_bvh *bvh, struct piece *piece)
{
	uint32_t first = 3 * piece->first_triangle, end = first + 3 * piece->triangle_count;
	for (uint32_t k = first; k < end; k++) {
		float at[3];
		vertex_m(bvh, bvh->indices[k], at);
		for (int i = 0; i < 6; i++) {
			const float *was = piece->extent_m[i];
			bool farther = i & 1 ? at[i / 2] > was[i / 2] : at[i / 2] < was[i / 2];
			if (k == first || farther)
				memcpy(piece->extent_m[i], at, sizeof(at));
		}
	}
}

/* Returns whether one choice of samples may suit all triangles of the node. */
static bool is_one_piece(const struct builder *b, const struct patch_bvh_node *node)
{
	if (!node->right || node->count <= PIECE_TRIANGLES_MIN)
		return true;
	bool wide = false;
	for (int i = 0; i < 3; i++)
		wide |= node->high[i] - node->low[i] > UINT16_MAX / PIECES_ACROSS;
	if (node->count > PIECE_TRIANGLES_MAX || wide)
		return false;
	return node->count <= PIECE_TRIANGLES_BENT ||
	       flatness_of(b, node->first, node->count) >= flat_enough;
}

static void collect_pieces(const struct builder *b, uint32_t at)
{
	struct patch_bvh *bvh = b->bvh;
	const struct patch_bvh_node *node = &bvh->nodes[at];
	if (!is_one_piece(b, node)) {
		collect_pieces(b, at + 1);
		collect_pieces(b, node->right);
		return;
	}
	struct piece *piece = &bvh->pieces[bvh->piece_count++];
	*piece = (struct piece){ .first_triangle = node->first,
				 .triangle_count = node->count,
				 .flatness = flatness_of(b, node->first, node->count) };
	float diagonal[3];
	for (int i = 0; i < 3; i++) {
		float middle = (float)(node->low[i] + node->high[i]) / 2;
		piece->centre_m[i] =
			(float)(bvh->lattice.origin_m[i] + bvh->lattice.step_m * middle);
		diagonal[i] = (float)(node->high[i] - node->low[i]);
	}
	piece->radius_m = vec_length(diagonal) / 2 * (float)bvh->lattice.step_m;
	measure_piece(bvh, piece);
	set_extents(bvh, piece);
}

static void set_key(const struct patch_bvh *bvh, const uint16_t index[3], float key[6])
{
	float corner[3][3], ab[3], ac[3];
	for (int c = 0; c < 3; c++)
		vertex_m(bvh, index[c], corner[c]);
	for (int i = 0; i < 3; i++)
		key[i] = corner[0][i] + corner[1][i] + corner[2][i];
	vec_sub(ab, corner[1], corner[0]);
	vec_sub(ac, corner[2], corner[0]);
	vec_cross(&key[3], ab, ac);
	vec_normalise(&key[3]);
}

/* Reduces a block, allocated for the worst case, to the bytes used. Where realloc fails the block
 * stays as it is. */
static void *shrink(void *block, size_t bytes)
{
	void *smaller = realloc(block, bytes);

	return smaller ? smaller : block;
}

int patch_bvh_init(struct patch_bvh *out, struct patch_mesh *mesh, const struct lattice *lattice)
{
	*out = (struct patch_bvh){ .indices = mesh->indices, .lattice = *lattice };
	uint32_t count = mesh->triangle_count;
	if (count == 0)
		return 0;
	struct builder builder = { .bvh = out, .indices = mesh->indices };
	builder.key = malloc(count * sizeof(*builder.key));
	out->nodes = calloc(2 * (size_t)count, sizeof(*out->nodes));
	out->pieces = calloc(count / (PIECE_TRIANGLES_MIN / 2) + 1, sizeof(*out->pieces));
	out->positions = malloc(mesh->vertex_count * sizeof(*out->positions));
	out->order = malloc(count * sizeof(*out->order));
	if (!builder.key || !out->nodes || !out->pieces || !out->positions || !out->order) {
		free(builder.key);
		patch_bvh_finish(out);
		return -ENOMEM;
	}
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		memcpy(out->positions[v], mesh->vertices[v].position, sizeof(*out->positions));
	out->vertex_count = mesh->vertex_count;
	for (uint32_t t = 0; t < count; t++) {
		set_key(out, &mesh->indices[3 * t], builder.key[t]);
		out->order[t] = (uint16_t)t;
	}
	build_node(&builder, 0, count);
	collect_pieces(&builder, 0);
	free(builder.key);
	out->nodes = shrink(out->nodes, out->node_count * sizeof(*out->nodes));
	out->pieces = shrink(out->pieces, out->piece_count * sizeof(*out->pieces));
	return 0;
}

void patch_bvh_finish(struct patch_bvh *bvh)
{
	free(bvh->nodes);
	free(bvh->pieces);
	free(bvh->positions);
	free(bvh->order);
	memset(bvh, 0, sizeof(*bvh));
}

size_t patch_bvh_bytes(const struct patch_bvh *bvh)
{
	return bvh->node_count * sizeof(*bvh->nodes) + bvh->piece_count * sizeof(*bvh->pieces) +
	       bvh->vertex_count * sizeof(*bvh->positions) +
	       (bvh->node_count ? bvh->nodes[0].count * sizeof(*bvh->order) : 0);
}

/* ---- rays */

bool ray_meets_sphere(const float from_m[3], const float direction[3], float most_m,
		      const float centre_m[3], float radius_m)
{
	float to[3];
	vec_sub(to, centre_m, from_m);
	float along = vec_dot(to, direction);
	float nearest = vec_least(vec_most(along, 0), most_m);
	float off[3];
	vec_add_scaled(off, to, -nearest, direction);
	return vec_dot(off, off) <= radius_m * radius_m;
}

/* A ray in lattice units, where vertices are whole numbers. */
struct cast {
	const struct patch_bvh *bvh;
	float from[3], direction[3], inverse[3];
	float least, distance;
	struct patch_bvh_hit hit;
};

static bool meets_box(const struct cast *cast, const struct patch_bvh_node *node)
{
	float low = 0, high = cast->distance;
	for (int i = 0; i < 3; i++) {
		float a = ((float)node->low[i] - cast->from[i]) * cast->inverse[i];
		float b = ((float)node->high[i] - cast->from[i]) * cast->inverse[i];
		low = vec_most(low, vec_least(a, b));
		high = vec_least(high, vec_most(a, b));
	}
	return low <= high;
}

static void corner_of(const struct cast *cast, uint16_t index, float out[3])
{
	const uint16_t *at = cast->bvh->positions[index];
	for (int i = 0; i < 3; i++)
		out[i] = at[i];
}

/* Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997. */
static bool meets_triangle(struct cast *cast, uint32_t triangle)
{
	const uint16_t *index = &cast->bvh->indices[3 * triangle];
	float a[3], ab[3], ac[3], p[3], t[3], q[3];
	corner_of(cast, index[0], a);
	corner_of(cast, index[1], ab);
	corner_of(cast, index[2], ac);
	vec_sub(ab, ab, a);
	vec_sub(ac, ac, a);
	vec_cross(p, cast->direction, ac);
	float determinant = vec_dot(ab, p);
	if (fabsf(determinant) < 1e-6f)
		return false;
	float inverse = 1 / determinant;
	vec_sub(t, cast->from, a);
	float u = vec_dot(t, p) * inverse;
	if (u < 0 || u > 1)
		return false;
	vec_cross(q, t, ab);
	float v = vec_dot(cast->direction, q) * inverse;
	if (v < 0 || u + v > 1)
		return false;
	float at = vec_dot(ac, q) * inverse;
	if (at < cast->least || at >= cast->distance)
		return false;
	cast->distance = at;
	cast->hit = (struct patch_bvh_hit){ triangle, u, v };
	return true;
}

static bool run_cast(struct cast *cast, bool any)
{
	const struct patch_bvh *bvh = cast->bvh;
	uint32_t stack[DEPTH_MAX], depth = 0;
	bool hit = false;
	if (bvh->node_count > 0)
		stack[depth++] = 0;
	while (depth > 0 && !(hit && any)) {
		uint32_t at = stack[--depth];
		const struct patch_bvh_node *node = &bvh->nodes[at];
		if (!meets_box(cast, node))
			continue;
		if (!node->right) {
			for (uint32_t t = node->first; t < (uint32_t)node->first + node->count; t++)
				hit |= meets_triangle(cast, t);
			continue;
		}
		stack[depth++] = node->right;
		stack[depth++] = at + 1;
	}
	return hit;
}

static struct cast begin_cast(const struct patch_bvh *bvh, const float from_m[3],
			      const float direction[3])
{
	struct cast cast = { .bvh = bvh };
	for (int i = 0; i < 3; i++) {
		cast.from[i] =
			(float)((from_m[i] - bvh->lattice.origin_m[i]) / bvh->lattice.step_m);
		cast.direction[i] = direction[i];
		cast.inverse[i] = 1 / (fabsf(direction[i]) > 1e-9f ? direction[i] : 1e-9f);
	}
	return cast;
}

bool patch_bvh_ray(const struct patch_bvh *bvh, const float from_m[3], const float direction[3],
		   float least_m, float *distance_m, struct patch_bvh_hit *hit)
{
	float step = (float)bvh->lattice.step_m;
	struct cast cast = begin_cast(bvh, from_m, direction);
	cast.least = least_m / step;
	cast.distance = *distance_m / step;
	if (!run_cast(&cast, false))
		return false;
	*distance_m = cast.distance * step;
	if (hit)
		*hit = cast.hit;
	return true;
}

bool patch_bvh_blocks(const struct patch_bvh *bvh, const float from_m[3], const float direction[3],
		      float most_m)
{
	struct cast cast = begin_cast(bvh, from_m, direction);
	cast.distance = most_m / (float)bvh->lattice.step_m;
	return run_cast(&cast, true);
}
