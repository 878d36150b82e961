/* Writes the labelling of superpixels, and then of pixels near a border, as graphs with costs, and
 * reads the result of the cut.
 *
 * A superpixel that a stroke knows is not a node: what it would add is in the costs of its
 * neighbours. So the heavy lasso cuts only what lies under its stroke. */
#include "curator/select/part_cut.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "curator/select/contrast.h"
#include "curator/select/min_cut.h"
#include "curator/select/seed_ways.h"
#include "geometry/vec.h"

enum {
	TONES = 8,       /* how many colours, and how many normals, stand for all seeds of a side */
	TONE_ROUNDS = 4, /* of k-means */
	REACH_PX = 10    /* pixels that far from the border of the superpixels are cut anew */
};

/* What a pixel of the part costs in the rest, if it looks like the part or is on its side of the
 * strong borders, and the other way round; beside 1 for a pixel of a border without contrast. */
static const float colour_share = 0.03f, turn_share = 0.03f, way_share = 0.03f;
/* Differences below these tell nothing: colour in sRGB, normals by their distance, ways in strong
 * borders. */
static const float colour_blur = 10, turn_blur = 0.2f, way_blur = 0.5f;

enum side { REST, PART, SIDES };

/* The typical values of a side's seeds. */
struct tones {
	float all[TONES][3];
	uint32_t count;
};

struct problem {
	const struct view_image *image;
	struct tones colours[SIDES], normals[SIDES];
	float *ways[SIDES]; /* owned; of each superpixel, how far it is from the seeds of a side */
	struct min_cut_node *nodes; /* all arrays owned */
	struct min_cut_link *links;
	bool *in_part;
	uint32_t node_count, node_room, link_count, link_room;
};

static void problem_finish(struct problem *problem)
{
	free(problem->nodes);
	free(problem->links);
	free(problem->in_part);
	problem->nodes = NULL;
	problem->links = NULL;
	problem->in_part = NULL;
	problem->node_count = problem->node_room = problem->link_count = problem->link_room = 0;
}

static enum side side_of(uint8_t mark)
{
	return mark == MARK_PART || mark == MARK_PART_SEED ? PART : REST;
}

/* ---- how the sides look */

static uint32_t nearest_tone(const struct tones *tones, const float value[3], float *away)
{
	uint32_t best = 0;

	*away = INFINITY;
	for (uint32_t n = 0; n < tones->count; n++) {
		const float its = vec_distance(tones->all[n], value);

		if (its < *away) {
			*away = its;
			best = n;
		}
	}
	return best;
}

/* k-means over values with weights, begun at the value farthest from those before. */
static void find_tones(struct tones *out, const float (*values)[3], const float *weights,
		       uint32_t count)
{
	memset(out, 0, sizeof(*out));
	while (out->count < TONES && out->count < count) {
		float farthest = 0;
		uint32_t chosen = 0;

		for (uint32_t n = 0; n < count && out->count > 0; n++) {
			float away;

			nearest_tone(out, values[n], &away);
			if (away > farthest) {
				farthest = away;
				chosen = n;
			}
		}
		if (out->count > 0 && farthest == 0)
			break; /* all values are tones */
		vec_copy(out->all[out->count++], values[chosen]);
	}
	for (int round = 0; round < TONE_ROUNDS; round++) {
		float sums[TONES][3] = { 0 }, total[TONES] = { 0 };

		for (uint32_t n = 0; n < count; n++) {
			float away;
			const uint32_t its = nearest_tone(out, values[n], &away);

			vec_add_scaled(sums[its], sums[its], weights[n], values[n]);
			total[its] += weights[n];
		}
		for (uint32_t n = 0; n < out->count; n++)
			if (total[n] > 0)
				vec_scale(out->all[n], 1 / total[n], sums[n]);
	}
}

/* The tones of a side from the superpixels that its seeds touch. */
static int learn(struct problem *problem, const struct superpixels *superpixels,
		 const uint32_t *seeds, enum side side)
{
	float(*values)[3] = malloc((superpixels->count + 1) * sizeof(*values));
	float *weights = malloc((superpixels->count + 1) * sizeof(*weights));
	int rc = values && weights ? 0 : -ENOMEM;

	for (int what = 0; what < 2 && rc == 0; what++) {
		uint32_t count = 0;

		for (uint32_t n = 0; n < superpixels->count; n++) {
			const struct superpixel *its = &superpixels->all[n];

			if (seeds[n] == 0)
				continue;
			vec_copy(values[count], what == 0 ? its->colour : its->normal);
			weights[count++] = (float)seeds[n];
		}
		find_tones(what == 0 ? &problem->colours[side] : &problem->normals[side],
			   (const float(*)[3])values, weights, count);
	}
	free(values);
	free(weights);
	return rc;
}

/* Counts the seeds of each superpixel and learns from them. */
static int learn_sides(struct problem *problem, const struct superpixels *superpixels,
		       const uint8_t *marks)
{
	const uint32_t pixels = problem->image->width_px * problem->image->height_px;
	uint32_t *seeds = malloc((superpixels->count + 1) * sizeof(*seeds));
	int rc = seeds ? 0 : -ENOMEM;

	for (int side = REST; side < SIDES && rc == 0; side++) {
		memset(seeds, 0, superpixels->count * sizeof(*seeds));
		for (uint32_t at = 0; at < pixels; at++)
			if (superpixels->of_pixel[at] != SUPERPIXEL_NONE &&
			    (marks[at] == MARK_PART_SEED || marks[at] == MARK_REST_SEED) &&
			    (int)side_of(marks[at]) == side)
				seeds[superpixels->of_pixel[at]]++;
		rc = learn(problem, superpixels, seeds, (enum side)side);
		if (rc == 0)
			rc = seed_ways_find(&problem->ways[side], superpixels, seeds);
	}
	free(seeds);
	return rc;
}

/* ---- costs */

/* Equation 3: how much of the distances to both sides is that to one, 0 to 1. */
static float share_of(const float to[SIDES], enum side side, float blur)
{
	if (isinf(to[PART]) || isinf(to[REST]))
		return isinf(to[PART]) && isinf(to[REST]) ? 0.5f : (float)isinf(to[side]);
	return (to[side] + blur) / (to[PART] + to[REST] + 2 * blur);
}

static float unlike(const struct tones tones[SIDES], const float value[3], enum side side,
		    float blur)
{
	float to[SIDES];

	nearest_tone(&tones[PART], value, &to[PART]);
	nearest_tone(&tones[REST], value, &to[REST]);
	return share_of(to, side, blur);
}

/* Equation 2, for one pixel; the way is ours. */
static float cost_of(const struct problem *problem, uint32_t superpixel, const float colour[3],
		     const float normal[3], enum side side)
{
	const float ways[SIDES] = { problem->ways[REST][superpixel],
				    problem->ways[PART][superpixel] };

	return colour_share * unlike(problem->colours, colour, side, colour_blur) +
	       turn_share * unlike(problem->normals, normal, side, turn_blur) +
	       way_share * share_of(ways, side, way_blur);
}

/* ---- graphs */

static int add_link(struct problem *problem, uint32_t a, uint32_t b, float cost)
{
	int rc = ARRAY_RESERVE(problem->links, problem->link_room, problem->link_count + 1,
			       UINT32_MAX);

	if (rc == 0)
		problem->links[problem->link_count++] = (struct min_cut_link){ a, b, cost };
	return rc;
}

/* A node beside something known: it costs the border if it is on the other side. */
static void add_known(struct min_cut_node *node, enum side known, float cost)
{
	if (known == PART)
		node->rest_cost += cost;
	else
		node->part_cost += cost;
}

static int solve(struct problem *problem)
{
	problem->in_part = calloc(problem->node_count + 1, sizeof(*problem->in_part));
	if (!problem->in_part)
		return -ENOMEM;
	return min_cut(problem->in_part, problem->nodes, problem->node_count, problem->links,
		       problem->link_count);
}

/* ---- superpixels */

/* What is known of a superpixel: all that is known of its pixels, if that is of one side; so many
 * of its pixels are unknown. */
struct knowledge {
	uint32_t part, rest, unknown;
	uint32_t node; /* UINT32_MAX: it is known */
	enum side side;
};

static void know(struct knowledge *all, const struct superpixels *superpixels, const uint8_t *marks,
		 uint32_t pixels)
{
	for (uint32_t at = 0; at < pixels; at++) {
		struct knowledge *its;

		if (superpixels->of_pixel[at] == SUPERPIXEL_NONE)
			continue;
		its = &all[superpixels->of_pixel[at]];
		if (marks[at] == MARK_UNKNOWN)
			its->unknown++;
		else if (side_of(marks[at]) == PART)
			its->part++;
		else
			its->rest++;
	}
}

/* A superpixel of which both sides are known is undecided, but leans to where most of it is. */
static int add_superpixels(struct problem *problem, struct knowledge *all,
			   const struct superpixels *superpixels)
{
	int rc = ARRAY_RESERVE(problem->nodes, problem->node_room, superpixels->count + 1,
			       UINT32_MAX);

	for (uint32_t n = 0; n < superpixels->count && rc == 0; n++) {
		const struct superpixel *its = &superpixels->all[n];
		struct min_cut_node *node;

		all[n].node = UINT32_MAX;
		all[n].side = all[n].part > all[n].rest ? PART : REST;
		if ((all[n].part > 0) != (all[n].rest > 0))
			continue;
		all[n].node = problem->node_count;
		node = &problem->nodes[problem->node_count++];
		node->rest_cost = (float)its->pixel_count *
					  cost_of(problem, n, its->colour, its->normal, REST) +
				  (float)all[n].part;
		node->part_cost = (float)its->pixel_count *
					  cost_of(problem, n, its->colour, its->normal, PART) +
				  (float)all[n].rest;
	}
	for (uint32_t n = 0; n < superpixels->border_count && rc == 0; n++) {
		const struct superpixel_border *border = &superpixels->borders[n];
		const struct knowledge *of_a = &all[border->a], *of_b = &all[border->b];
		const float cost =
			(float)border->length_px * superpixel_border_cost(superpixels, border);

		if (of_a->node != UINT32_MAX && of_b->node != UINT32_MAX)
			rc = add_link(problem, of_a->node, of_b->node, cost);
		else if (of_a->node != UINT32_MAX)
			add_known(&problem->nodes[of_a->node], of_b->side, cost);
		else if (of_b->node != UINT32_MAX)
			add_known(&problem->nodes[of_b->node], of_a->side, cost);
	}
	return rc;
}

/* Decides for superpixels; pixels that strokes know stay what they are. */
static int cut_superpixels(uint8_t *out, struct problem *problem, const uint8_t *marks,
			   const struct superpixels *superpixels)
{
	const uint32_t pixels = problem->image->width_px * problem->image->height_px;
	struct knowledge *all = calloc(superpixels->count + 1, sizeof(*all));
	int rc = all ? 0 : -ENOMEM;

	if (rc == 0) {
		know(all, superpixels, marks, pixels);
		rc = add_superpixels(problem, all, superpixels);
	}
	if (rc == 0)
		rc = solve(problem);
	for (uint32_t at = 0; at < pixels && rc == 0; at++) {
		const uint32_t its = superpixels->of_pixel[at];

		if (its == SUPERPIXEL_NONE)
			out[at] = 0;
		else if (marks[at] != MARK_UNKNOWN)
			out[at] = side_of(marks[at]) == PART;
		else if (all[its].node != UINT32_MAX)
			out[at] = problem->in_part[all[its].node];
		else
			out[at] = all[its].side == PART;
	}
	free(all);
	problem_finish(problem);
	return rc;
}

/* ---- pixels near the border */

/* Marks with 1 the pixels within REACH_PX of a pixel of the other side: a border is spread along
 * rows, and then along columns. */
static void find_near(uint8_t *near, const uint8_t *in_part, const struct view_image *image)
{
	const uint32_t width = image->width_px, height = image->height_px;

	memset(near, 0, (size_t)width * height);
	for (uint32_t y = 0; y < height; y++) {
		for (uint32_t x = 0; x < width; x++) {
			const uint32_t at = y * width + x;
			const bool right = x + 1 < width && in_part[at] != in_part[at + 1],
				   below = y + 1 < height && in_part[at] != in_part[at + width];
			const uint32_t left = x > REACH_PX ? x - REACH_PX : 0,
				       end = x + REACH_PX < width ? x + REACH_PX : width - 1,
				       top = y > REACH_PX ? y - REACH_PX : 0,
				       bottom = y + REACH_PX < height ? y + REACH_PX : height - 1;

			if (!right && !below)
				continue;
			for (uint32_t row = top; row <= bottom; row++)
				memset(near + row * width + left, 1, end - left + 1);
		}
	}
}

/* The link between a pixel and one of its eight neighbours, of which `to` comes later. */
static int link_pixels(struct problem *problem, const uint32_t *node_of, const uint8_t *in_part,
		       uint32_t at, uint32_t to, float share)
{
	const uint32_t a = node_of[at], b = node_of[to];
	const float *w = problem->image->inverse_m;

	if ((a == UINT32_MAX && b == UINT32_MAX) || w[at] <= 0 || w[to] <= 0)
		return 0;
	const struct contrast contrast = contrast_of_pixels(problem->image, at, to);
	const float cost = share * contrast_border_cost(&contrast);
	if (a != UINT32_MAX && b != UINT32_MAX)
		return add_link(problem, a, b, cost);
	if (a != UINT32_MAX)
		add_known(&problem->nodes[a], in_part[to] ? PART : REST, cost);
	else
		add_known(&problem->nodes[b], in_part[at] ? PART : REST, cost);
	return 0;
}

static int add_pixels(struct problem *problem, uint32_t *node_of, const uint8_t *near,
		      const uint8_t *in_part, const uint8_t *marks, const uint32_t *of_pixel)
{
	const struct view_image *image = problem->image;
	const uint32_t width = image->width_px, height = image->height_px;
	int rc = 0;

	for (uint32_t at = 0; at < width * height && rc == 0; at++) {
		float colour[3], normal[3];

		node_of[at] = UINT32_MAX;
		if (!near[at] || marks[at] != MARK_UNKNOWN || image->inverse_m[at] <= 0)
			continue;
		rc = ARRAY_RESERVE(problem->nodes, problem->node_room, problem->node_count + 1,
				   UINT32_MAX);
		if (rc < 0)
			return rc;
		for (int i = 0; i < 3; i++) {
			colour[i] = image->colours[at][i];
			normal[i] = (float)image->normals[at][i] / 127;
		}
		problem->nodes[problem->node_count] =
			(struct min_cut_node){ cost_of(problem, of_pixel[at], colour, normal, REST),
					       cost_of(problem, of_pixel[at], colour, normal,
						       PART) };
		node_of[at] = problem->node_count++;
	}
	/* A straight border of eight neighbours costs 1 per pixel: it crosses one link across and
	 * two diagonal ones. */
	const float straight = 1 / (1 + sqrtf(2)), diagonal = straight / sqrtf(2);
	for (uint32_t y = 0, at = 0; y < height; y++) {
		for (uint32_t x = 0; x < width && rc == 0; x++, at++) {
			const bool below = y + 1 < height;

			if (x + 1 < width)
				rc = link_pixels(problem, node_of, in_part, at, at + 1, straight);
			if (rc == 0 && below)
				rc = link_pixels(problem, node_of, in_part, at, at + width,
						 straight);
			if (rc == 0 && below && x + 1 < width)
				rc = link_pixels(problem, node_of, in_part, at, at + width + 1,
						 diagonal);
			if (rc == 0 && below && x > 0)
				rc = link_pixels(problem, node_of, in_part, at, at + width - 1,
						 diagonal);
		}
	}
	return rc;
}

static int cut_pixels(uint8_t *in_part, struct problem *problem, const uint8_t *marks,
		      const uint32_t *of_pixel)
{
	const size_t pixels = (size_t)problem->image->width_px * problem->image->height_px;
	uint8_t *near = malloc(pixels);
	uint32_t *node_of = malloc(pixels * sizeof(*node_of));
	int rc = near && node_of ? 0 : -ENOMEM;

	if (rc == 0) {
		find_near(near, in_part, problem->image);
		rc = add_pixels(problem, node_of, near, in_part, marks, of_pixel);
	}
	if (rc == 0)
		rc = solve(problem);
	for (size_t at = 0; at < pixels && rc == 0; at++)
		if (node_of[at] != UINT32_MAX)
			in_part[at] = problem->in_part[node_of[at]];
	free(near);
	free(node_of);
	problem_finish(problem);
	return rc;
}

static bool knows_the_part(const uint8_t *marks, const struct view_image *image)
{
	for (uint32_t at = 0; at < image->width_px * image->height_px; at++)
		if (image->inverse_m[at] > 0 && marks[at] != MARK_UNKNOWN &&
		    side_of(marks[at]) == PART)
			return true;
	return false;
}

int part_cut(uint8_t *in_part, const uint8_t *marks, const struct view_image *image,
	     const struct superpixels *superpixels)
{
	const size_t pixels = (size_t)image->width_px * image->height_px;
	struct problem problem = { .image = image };
	uint8_t *out;
	int rc;

	if (!knows_the_part(marks, image))
		return -EINVAL;
	out = malloc(pixels);
	if (!out)
		return -ENOMEM;
	rc = learn_sides(&problem, superpixels, marks);
	if (rc == 0)
		rc = cut_superpixels(out, &problem, marks, superpixels);
	if (rc == 0)
		rc = cut_pixels(out, &problem, marks, superpixels->of_pixel);
	if (rc == 0)
		memcpy(in_part, out, pixels);
	free(out);
	free(problem.ways[PART]);
	free(problem.ways[REST]);
	problem_finish(&problem);
	return rc;
}
