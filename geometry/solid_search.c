/* A* over the free cells of an octree. Two cells that share a part of a side are neighbours. The
 * line between their centres lies in the two: it crosses their common side nearer to the centre of
 * the larger cell than the smaller cell's centre is, and so within the smaller one's side. */
#include "geometry/solid_search.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "geometry/search_queue.h"

/* Near stone cells are small. A way through them costs more, so that it keeps to the middle. */
#define STONE_COST 2.0f
/* Above 1, the way that is found is not always the shortest, but is found in a tenth of the time.
 */
#define EAGERNESS 2.5f

struct visit {
	struct solid_cell cell;
	uint32_t from; /* index of the visit before */
	float cost;    /* of the way so far, in smallest cells */
	bool done;
};

struct search {
	const struct solid *solid;
	float to[3]; /* the centre of the last cell, in smallest cells */
	struct visit *visits;
	uint32_t visit_count, visit_room;
	struct search_queue queue; /* by cost, and EAGERNESS times the distance that is left */
	uint32_t *visit_of;        /* of each cell's id: its visit + 1 */
};

static void centre_of(const struct solid_cell *cell, float out[3])
{
	for (int axis = 0; axis < 3; axis++)
		out[axis] = (float)cell->low[axis] + (float)cell->side / 2;
}

static float apart(const float a[3], const float b[3])
{
	float sum = 0;

	for (int axis = 0; axis < 3; axis++)
		sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
	return sqrtf(sum);
}

/* ---- the search */

/* Comes to a cell with a cost; keeps the cheapest way. */
static int visit(struct search *search, const struct solid_cell *cell, uint32_t from, float cost)
{
	uint32_t *of = &search->visit_of[cell->id];
	float centre[3];

	centre_of(cell, centre);
	if (*of == 0) {
		if (search->visit_count == SOLID_SEARCH_CELLS_MAX)
			return -ENOENT;
		if (ARRAY_RESERVE(search->visits, search->visit_room, search->visit_count + 1,
				  UINT32_MAX) < 0)
			return -ENOMEM;
		search->visits[search->visit_count++] = (struct visit){ .cost = INFINITY };
		*of = search->visit_count;
	}
	if (search->visits[*of - 1].cost <= cost)
		return 0;
	search->visits[*of - 1] = (struct visit){ .cell = *cell, .from = from, .cost = cost };
	return search_queue_add(&search->queue, cost + EAGERNESS * apart(centre, search->to),
				*of - 1);
}

static int step(struct search *search, uint32_t at, const struct solid_cell *cell)
{
	const struct visit *here = &search->visits[at];
	float from[3], to[3], dear;

	centre_of(&here->cell, from);
	centre_of(cell, to);
	dear = 1 +
	       STONE_COST / (float)(cell->side < here->cell.side ? cell->side : here->cell.side);
	return visit(search, cell, at, here->cost + dear * apart(from, to));
}

/* Steps to the free cells that have a part of a square on their side. place: its low corner, just
 * beyond the side. axis: across it. */
static int step_across(struct search *search, uint32_t at, const int32_t place[3], int32_t side,
		       int axis)
{
	struct solid_cell cell;
	int rc = 0;

	solid_find(search->solid, place, &cell);
	if (cell.side >= side)
		return cell.state == SOLID_FREE ? step(search, at, &cell) : 0;
	for (int quarter = 0; rc == 0 && quarter < 4; quarter++) {
		int32_t corner[3] = { place[0], place[1], place[2] };

		corner[(axis + 1) % 3] += quarter & 1 ? side / 2 : 0;
		corner[(axis + 2) % 3] += quarter & 2 ? side / 2 : 0;
		rc = step_across(search, at, corner, side / 2, axis);
	}
	return rc;
}

static int step_out(struct search *search, uint32_t at)
{
	const struct solid_cell cell = search->visits[at].cell;
	const int32_t end = 1 << search->solid->depth;
	int rc = 0;

	for (int axis = 0; axis < 3; axis++) {
		int32_t place[3] = { cell.low[0], cell.low[1], cell.low[2] };

		place[axis] = cell.low[axis] - 1;
		if (rc == 0 && place[axis] >= 0)
			rc = step_across(search, at, place, cell.side, axis);
		place[axis] = cell.low[axis] + cell.side;
		if (rc == 0 && place[axis] < end)
			rc = step_across(search, at, place, cell.side, axis);
	}
	return rc;
}

/* Returns the visit of the cell `to`, or an error. */
static int64_t find(struct search *search, const struct solid_cell *from,
		    const struct solid_cell *to)
{
	int rc;

	centre_of(to, search->to);
	search->visit_of =
		calloc(search->solid->node_count, SOLID_CHILDREN * sizeof(*search->visit_of));
	rc = search->visit_of ? visit(search, from, 0, 0) : -ENOMEM;
	while (rc == 0 && search->queue.count > 0) {
		const uint32_t at = search_queue_take(&search->queue);

		if (search->visits[at].cell.id == to->id)
			return at;
		if (search->visits[at].done)
			continue;
		search->visits[at].done = true;
		rc = step_out(search, at);
	}
	return rc < 0 ? rc : -ENOENT;
}

static int take_points(const struct search *search, uint32_t at, float (**points_m)[3],
		       uint32_t *count)
{
	const struct solid *solid = search->solid;
	uint32_t length = 1;

	for (uint32_t v = at; v != 0; v = search->visits[v].from)
		length++;
	*points_m = malloc(length * sizeof(**points_m));
	if (!*points_m)
		return -ENOMEM;
	*count = length;
	for (uint32_t v = at; length-- > 0; v = search->visits[v].from) {
		float centre[3];

		centre_of(&search->visits[v].cell, centre);
		for (int axis = 0; axis < 3; axis++)
			(*points_m)[length][axis] =
				solid->low_m[axis] + solid->cell_m * centre[axis];
	}
	return 0;
}

int solid_search(const struct solid *solid, const int32_t from[3], const int32_t to[3],
		 float (**points_m)[3], uint32_t *count)
{
	struct search search = { .solid = solid };
	struct solid_cell first, last;
	int64_t at = -ENOENT;

	*points_m = NULL;
	*count = 0;
	solid_find(solid, from, &first);
	solid_find(solid, to, &last);
	if (first.state == SOLID_FREE && last.state == SOLID_FREE)
		at = find(&search, &first, &last);
	if (at >= 0)
		at = take_points(&search, (uint32_t)at, points_m, count);
	free(search.visits);
	search_queue_finish(&search.queue);
	free(search.visit_of);
	return (int)at;
}
