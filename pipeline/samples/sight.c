/* Chooses pieces, leaves out those outside the frustum, and sorts the rest. */
#include "pipeline/samples/sight.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

struct order {
	float distance;
	uint32_t piece;
};

struct sight {
	struct model *model; /* borrowed */
	uint32_t *pieces;    /* owned; chosen for the eye */
	uint32_t piece_count;
	struct order *order; /* owned; as the next, room for every piece */
	uint32_t *visible;
};

int sight_create(struct sight **out, struct model *model)
{
	struct sight *sight = calloc(1, sizeof(*sight));
	size_t count = model->piece_count;

	*out = NULL;
	if (!sight)
		return -ENOMEM;
	sight->model = model;
	sight->pieces = malloc(count * sizeof(*sight->pieces));
	sight->order = malloc(count * sizeof(*sight->order));
	sight->visible = malloc(count * sizeof(*sight->visible));
	if (!sight->pieces || !sight->order || !sight->visible) {
		sight_destroy(sight);
		return -ENOMEM;
	}
	*out = sight;
	return 0;
}

void sight_destroy(struct sight *sight)
{
	if (!sight)
		return;
	free(sight->pieces);
	free(sight->order);
	free(sight->visible);
	free(sight);
}

void sight_look(struct sight *sight, const float eye_m[3], float detail_rad)
{
	sight->piece_count = model_choose(sight->model, eye_m, detail_rad, sight->pieces);
}

const uint32_t *sight_pieces(const struct sight *sight, uint32_t *count)
{
	*count = sight->piece_count;
	return sight->pieces;
}

/* Returns the distance of the box's farthest (sign +1) or nearest (sign -1) point along
 * direction. */
static float reach(const struct model_piece *piece, const float eye_m[3], const float direction[3],
		   float sign)
{
	float sum = 0;

	for (int i = 0; i < 3; i++) {
		bool high = sign * direction[i] > 0;

		sum += ((high ? piece->high_m[i] : piece->low_m[i]) - eye_m[i]) * direction[i];
	}
	return sum;
}

bool sight_range(const struct sight *sight, const float eye_m[3], const float forward[3],
		 float *near_m, float *far_m)
{
	const struct model *model = sight->model;
	float diagonal = 0, least, nearest = INFINITY, farthest = 0;

	for (int i = 0; i < 3; i++) {
		float side = model->high_m[i] - model->low_m[i];

		diagonal += side * side;
	}
	least = fminf(0.02f, sqrtf(diagonal) / 4000);
	for (uint32_t n = 0; n < sight->piece_count; n++) {
		const struct model_piece *piece = &model->pieces[sight->pieces[n]];
		float far = reach(piece, eye_m, forward, 1);

		if (far <= 0)
			continue;
		farthest = fmaxf(farthest, far);
		nearest = fminf(nearest, reach(piece, eye_m, forward, -1));
	}
	if (farthest <= 0)
		return false;
	*near_m = fmaxf(nearest * 0.999f, least);
	*far_m = fmaxf(farthest * 1.001f, *near_m * 2);
	return true;
}

/* Returns true if all corners are outside one of the planes of clip space. */
static bool is_outside(const struct model_piece *piece, const float m[16])
{
	for (int plane = 0; plane < 6; plane++) {
		float sign = plane % 2 ? -1.0f : 1.0f, most = 0, c[4];

		for (int column = 0; column < 4; column++)
			c[column] = m[4 * column + 3] + sign * m[4 * column + plane / 2];
		most = c[3];
		for (int i = 0; i < 3; i++)
			most += c[i] * (c[i] > 0 ? piece->high_m[i] : piece->low_m[i]);
		if (most < 0)
			return true;
	}
	return false;
}

static int compare_order(const void *a, const void *b)
{
	const struct order *x = a, *y = b;

	if (x->distance != y->distance)
		return x->distance < y->distance ? -1 : 1;
	return x->piece < y->piece ? -1 : x->piece > y->piece;
}

const uint32_t *sight_visible(struct sight *sight, const float matrix[16], const float eye_m[3],
			      uint32_t *count)
{
	*count = 0;
	for (uint32_t n = 0; n < sight->piece_count; n++) {
		const struct model_piece *piece = &sight->model->pieces[sight->pieces[n]];
		float square = 0;

		if (is_outside(piece, matrix))
			continue;
		for (int i = 0; i < 3; i++) {
			float away = fmaxf(
				fmaxf(piece->low_m[i] - eye_m[i], eye_m[i] - piece->high_m[i]), 0);

			square += away * away;
		}
		sight->order[(*count)++] = (struct order){ square, sight->pieces[n] };
	}
	qsort(sight->order, *count, sizeof(*sight->order), compare_order);
	for (uint32_t n = 0; n < *count; n++)
		sight->visible[n] = sight->order[n].piece;
	return sight->visible;
}
