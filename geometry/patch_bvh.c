/* Builds the BVH of a patch, cuts it into pieces and runs the ray queries over it. */
#include "geometry/patch_bvh.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/bvh.h"
#include "geometry/vec.h"

static const float flat_enough = 0.8f;

static void vertex_m(const struct patch_bvh *bvh, uint32_t vertex, float out[3])
{
	float steps[3];
	double at[3];
	patch_bvh_corner(bvh, vertex, steps);
	lattice_metres(at, &bvh->lattice,
		       (const int32_t[3]){ bvh->base[0] + (int32_t)steps[0],
					   bvh->base[1] + (int32_t)steps[1],
					   bvh->base[2] + (int32_t)steps[2] });
	for (int i = 0; i < 3; i++)
		out[i] = (float)at[i];
}

/* What building needs for a moment. */
struct scratch {
	struct bvh_node *nodes;
	float (*places_m)[3];     /* of the vertices */
	uint16_t (*triangles)[3]; /* in the mesh's order */
	struct bvh_items items;
};

/* ---- the tree */

/* The keys by which triangles are sorted: three times the centre, then the unit normal. */
enum { NORMAL_KEY = 3, KEYS = 6 };

static void set_keys(const float (*places_m)[3], const uint16_t index[3], float keys[KEYS])
{
	const float *a = places_m[index[0]], *b = places_m[index[1]], *c = places_m[index[2]];
	float ab[3], ac[3];
	for (int i = 0; i < 3; i++)
		keys[i] = a[i] + b[i] + c[i];
	vec_sub(ab, b, a);
	vec_sub(ac, c, a);
	vec_cross(&keys[NORMAL_KEY], ab, ac);
	vec_normalise(&keys[NORMAL_KEY]);
}

static void extend_by_triangle(const void *data, uint32_t triangle, float low[3], float high[3])
{
	const struct patch_bvh *bvh = data;
	for (int c = 0; c < 3; c++) {
		float at[3];
		patch_bvh_corner(bvh, bvh->indices[3 * triangle + (uint32_t)c], at);
		for (int i = 0; i < 3; i++) {
			low[i] = vec_least(low[i], at[i]);
			high[i] = vec_most(high[i], at[i]);
		}
	}
}

/* Returns the length of the mean normal of a range: 1 flat, 0 facing all directions. */
static float flatness_of(const struct bvh_items *items, uint32_t first, uint32_t count)
{
	float sum[3] = { 0 };
	for (uint32_t t = first; t < first + count; t++)
		vec_add(sum, sum, &items->keys[KEYS * t + NORMAL_KEY]);
	return vec_length(sum) / (float)count;
}

/* Returns the key along which a range is longest. In a range larger than a piece the normals count
 * too, so that the sides of a pillar go to different pieces. */
static int longest_key(const struct bvh_items *items, uint32_t first, uint32_t count)
{
	float longest = 0;
	int key = 0;
	bool bends = count > PIECE_TRIANGLES_BENT && count <= 8 * PIECE_TRIANGLES_MAX &&
		     flatness_of(items, first, count) < flat_enough;
	for (int k = 0; k < NORMAL_KEY; k++) {
		float extent = bvh_extent(items, first, count, k);
		if (extent > longest) {
			longest = extent;
			key = k;
		}
	}
	/* A bend of 90 degrees counts as much as the length of the range. */
	float scale = longest / 1.4f;
	for (int k = NORMAL_KEY; k < KEYS && bends; k++) {
		float extent = bvh_extent(items, first, count, k) * scale;
		if (extent > longest) {
			longest = extent;
			key = k;
		}
	}
	return key;
}

/* Keeps a node's box in lattice units, where it is exact; in a wide patch, in larger ones, rounded
 * outwards. */
static struct patch_bvh_node pack_node(const struct bvh_node *node, uint8_t shift)
{
	struct patch_bvh_node out = { .first = (uint16_t)node->first,
				      .count = (uint16_t)node->count,
				      .right = (uint16_t)node->right };
	for (int i = 0; i < 3; i++) {
		out.low[i] = (uint16_t)((int32_t)node->low[i] >> shift);
		out.high[i] = (uint16_t)(((int32_t)node->high[i] + (1 << shift) - 1) >> shift);
	}
	return out;
}

/* ---- pieces */

static void measure_piece(const struct patch_bvh *bvh, const float (*places_m)[3],
			  struct piece *piece)
{
	float area2 = 0;
	for (uint32_t t = piece->first_triangle; t < piece->first_triangle + piece->triangle_count;
	     t++) {
		const float *a = places_m[bvh->indices[3 * t]];
		float ab[3], ac[3], n[3];
		vec_sub(ab, places_m[bvh->indices[3 * t + 1]], a);
		vec_sub(ac, places_m[bvh->indices[3 * t + 2]], a);
		vec_cross(n, ab, ac);
		vec_add(piece->normal, piece->normal, n);
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

static void set_extents(const struct patch_bvh *bvh, const float (*places_m)[3],
			struct piece *piece)
{
	uint32_t first = 3 * piece->first_triangle, end = first + 3 * piece->triangle_count;
	for (uint32_t k = first; k < end; k++) {
		const float *at = places_m[bvh->indices[k]];
		for (int i = 0; i < 6; i++) {
			const float *was = piece->extent_m[i];
			bool farther = i & 1 ? at[i / 2] > was[i / 2] : at[i / 2] < was[i / 2];
			if (k == first || farther)
				memcpy(piece->extent_m[i], at, sizeof(piece->extent_m[i]));
		}
	}
}

/* Returns whether one choice of samples may suit all triangles of the node. */
static bool is_one_piece(const struct patch_bvh *bvh, const struct bvh_items *items,
			 const struct patch_bvh_node *node)
{
	const int32_t most = ((1 << (LATTICE_BITS + bvh->lattice.fine_bits)) - 1) / PIECES_ACROSS;

	if (!node->right || node->count <= PIECE_TRIANGLES_MIN)
		return true;
	bool wide = false;
	for (int i = 0; i < 3; i++)
		wide |= (node->high[i] - node->low[i]) << bvh->box_shift > most;
	if (node->count > PIECE_TRIANGLES_MAX || wide)
		return false;
	return node->count <= PIECE_TRIANGLES_BENT ||
	       flatness_of(items, node->first, node->count) >= flat_enough;
}

static void collect_pieces(struct patch_bvh *bvh, const struct scratch *scratch, uint32_t at)
{
	const struct bvh_items *items = &scratch->items;
	const struct patch_bvh_node *node = &bvh->nodes[at];
	if (!is_one_piece(bvh, items, node)) {
		collect_pieces(bvh, scratch, at + 1);
		collect_pieces(bvh, scratch, node->right);
		return;
	}
	struct piece *piece = &bvh->pieces[bvh->piece_count++];
	*piece = (struct piece){ .first_triangle = node->first,
				 .triangle_count = node->count,
				 .flatness = flatness_of(items, node->first, node->count) };
	const float unit = (float)(1 << bvh->box_shift);
	float diagonal[3];
	for (int i = 0; i < 3; i++) {
		double middle = bvh->base[i] + unit * (float)(node->low[i] + node->high[i]) / 2;
		piece->centre_m[i] =
			(float)(bvh->lattice.origin_m[i] + bvh->lattice.step_m * middle);
		diagonal[i] = unit * (float)(node->high[i] - node->low[i]);
	}
	piece->radius_m = vec_length(diagonal) / 2 * (float)bvh->lattice.step_m;
	measure_piece(bvh, (const float(*)[3])scratch->places_m, piece);
	set_extents(bvh, (const float(*)[3])scratch->places_m, piece);
}

/* Allocates for the worst case and gives back what is left over. */
static int find_pieces(struct patch_bvh *bvh, const struct scratch *scratch)
{
	bvh->pieces =
		calloc(scratch->items.count / (PIECE_TRIANGLES_MIN / 2) + 1, sizeof(*bvh->pieces));
	if (!bvh->pieces)
		return -ENOMEM;
	collect_pieces(bvh, scratch, 0);
	struct piece *smaller = realloc(bvh->pieces, bvh->piece_count * sizeof(*bvh->pieces));
	if (smaller)
		bvh->pieces = smaller;
	return 0;
}

/* ---- building */

static void scratch_finish(struct scratch *scratch)
{
	free(scratch->nodes);
	free(scratch->places_m);
	free(scratch->triangles);
	free(scratch->items.order);
	free(scratch->items.keys);
}

static int scratch_init(struct scratch *scratch, const struct patch_bvh *bvh, uint32_t count)
{
	*scratch = (struct scratch){ .items = { .count = count,
						.key_count = KEYS,
						.extend = extend_by_triangle,
						.choose_key = longest_key,
						.data = bvh } };
	scratch->nodes = malloc(bvh_nodes_max(count) * sizeof(*scratch->nodes));
	scratch->places_m = malloc(bvh->vertex_count * sizeof(*scratch->places_m));
	scratch->triangles = malloc(count * sizeof(*scratch->triangles));
	scratch->items.order = malloc(count * sizeof(*scratch->items.order));
	scratch->items.keys = malloc(count * KEYS * sizeof(*scratch->items.keys));
	if (!scratch->nodes || !scratch->places_m || !scratch->triangles || !scratch->items.order ||
	    !scratch->items.keys) {
		scratch_finish(scratch);
		return -ENOMEM;
	}
	memcpy(scratch->triangles, bvh->indices, count * sizeof(*scratch->triangles));
	for (uint32_t v = 0; v < bvh->vertex_count; v++)
		vertex_m(bvh, v, scratch->places_m[v]);
	for (uint32_t t = 0; t < count; t++) {
		scratch->items.order[t] = t;
		set_keys((const float(*)[3])scratch->places_m, scratch->triangles[t],
			 &scratch->items.keys[KEYS * t]);
	}
	return 0;
}

/* Sets base and box_shift. Returns whether the patch is wider than 65535 steps. */
static bool find_base(struct patch_bvh *bvh, const struct patch_mesh *mesh)
{
	int32_t low[3] = { INT32_MAX, INT32_MAX, INT32_MAX }, high[3] = { 0 }, extent = 0, last = 0;
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		for (int i = 0; i < 3; i++) {
			int32_t at = mesh->vertices[v].position[i];
			low[i] = at < low[i] ? at : low[i];
			high[i] = at > high[i] ? at : high[i];
		}
	for (int i = 0; i < 3; i++)
		last = high[i] > last ? high[i] : last;
	if (last <= UINT16_MAX)
		return false;
	memcpy(bvh->base, low, sizeof(low));
	for (int i = 0; i < 3; i++)
		extent = high[i] - low[i] > extent ? high[i] - low[i] : extent;
	while (extent >> bvh->box_shift >= UINT16_MAX)
		bvh->box_shift++;
	return extent > UINT16_MAX;
}

static int copy_positions(struct patch_bvh *bvh, const struct patch_mesh *mesh)
{
	bool wide = find_base(bvh, mesh);
	if (wide)
		bvh->wide = malloc(mesh->vertex_count * sizeof(*bvh->wide));
	else
		bvh->positions = malloc(mesh->vertex_count * sizeof(*bvh->positions));
	if (!bvh->wide && !bvh->positions)
		return -ENOMEM;
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		for (int i = 0; i < 3; i++) {
			int32_t steps = mesh->vertices[v].position[i] - bvh->base[i];
			if (wide)
				bvh->wide[v][i] = (float)steps;
			else
				bvh->positions[v][i] = (uint16_t)steps;
		}
	bvh->vertex_count = mesh->vertex_count;
	return 0;
}

/* Takes over the sorted triangles and the nodes. */
static int keep(struct patch_bvh *bvh, struct patch_mesh *mesh, const struct scratch *scratch)
{
	const uint32_t *order = scratch->items.order;
	bvh->order = malloc(mesh->triangle_count * sizeof(*bvh->order));
	bvh->nodes = malloc(bvh->node_count * sizeof(*bvh->nodes));
	if (!bvh->order || !bvh->nodes)
		return -ENOMEM;
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		bvh->order[t] = (uint16_t)order[t];
		memcpy(&mesh->indices[3 * t], scratch->triangles[order[t]],
		       sizeof(*scratch->triangles));
	}
	for (uint32_t n = 0; n < bvh->node_count; n++)
		bvh->nodes[n] = pack_node(&scratch->nodes[n], bvh->box_shift);
	return 0;
}

int patch_bvh_init(struct patch_bvh *out, struct patch_mesh *mesh, const struct lattice *lattice)
{
	struct scratch scratch;
	*out = (struct patch_bvh){ .indices = mesh->indices, .lattice = *lattice };
	if (mesh->triangle_count == 0)
		return 0;
	if (copy_positions(out, mesh) < 0 ||
	    scratch_init(&scratch, out, mesh->triangle_count) < 0) {
		patch_bvh_finish(out);
		return -ENOMEM;
	}
	out->node_count = bvh_build(scratch.nodes, &scratch.items);
	int rc = keep(out, mesh, &scratch);
	if (rc == 0)
		rc = find_pieces(out, &scratch);
	scratch_finish(&scratch);
	if (rc < 0)
		patch_bvh_finish(out);
	return rc;
}

void patch_bvh_finish(struct patch_bvh *bvh)
{
	free(bvh->nodes);
	free(bvh->pieces);
	free(bvh->positions);
	free(bvh->wide);
	free(bvh->order);
	memset(bvh, 0, sizeof(*bvh));
}

size_t patch_bvh_bytes(const struct patch_bvh *bvh)
{
	return bvh->node_count * sizeof(*bvh->nodes) + bvh->piece_count * sizeof(*bvh->pieces) +
	       bvh->vertex_count * (bvh->wide ? sizeof(*bvh->wide) : sizeof(*bvh->positions)) +
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

/* A ray in lattice units from the base, where vertices are whole numbers. */
struct cast {
	const struct patch_bvh *bvh;
	float from[3], direction[3], inverse[3];
	float least, distance;
	float unit; /* of boxes, lattice steps */
	struct patch_bvh_hit hit;
};

static bool meets_box(const struct cast *cast, const struct patch_bvh_node *node)
{
	float low = 0, high = cast->distance;
	for (int i = 0; i < 3; i++) {
		float a = (cast->unit * (float)node->low[i] - cast->from[i]) * cast->inverse[i];
		float b = (cast->unit * (float)node->high[i] - cast->from[i]) * cast->inverse[i];
		low = vec_most(low, vec_least(a, b));
		high = vec_least(high, vec_most(a, b));
	}
	return low <= high;
}

/* Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997. */
static bool meets_triangle(struct cast *cast, uint32_t triangle)
{
	const uint16_t *index = &cast->bvh->indices[3 * triangle];
	float a[3], ab[3], ac[3], p[3], t[3], q[3];
	patch_bvh_corner(cast->bvh, index[0], a);
	patch_bvh_corner(cast->bvh, index[1], ab);
	patch_bvh_corner(cast->bvh, index[2], ac);
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
	uint32_t stack[BVH_STACK_MAX], depth = 0;
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
	struct cast cast = { .bvh = bvh, .unit = (float)(1 << bvh->box_shift) };
	for (int i = 0; i < 3; i++) {
		cast.from[i] =
			(float)((from_m[i] - bvh->lattice.origin_m[i]) / bvh->lattice.step_m -
				bvh->base[i]);
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
