/* Cuts contours into slabs at the v of every corner; in a slab, edges only lie side by side. */
#include "pipeline/scene/vrml_trim.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/array.h"

struct trapezoid {
	uint32_t slab;    /* between levels slab and slab + 1 */
	double low_u[2];  /* left and right end at the lower level */
	double high_u[2]; /* at the upper one */
};

/* A corner of a trapezoid on a level. */
struct level_point {
	uint32_t level;
	double u;
};

struct trim {
	const struct trim_edge *edges; /* borrowed */
	uint32_t edge_count;
	double *levels; /* rising; owned */
	uint32_t level_count;
	struct trapezoid *traps; /* owned */
	uint32_t trap_count, trap_room;
	struct level_point *points; /* by level, then by u; owned */
	uint32_t point_count;
};

static int compare_numbers(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static int find_levels(struct trim *trim)
{
	uint32_t n = 0;

	trim->levels = malloc(((size_t)trim->edge_count + 1) * sizeof(*trim->levels));
	if (!trim->levels)
		return -ENOMEM;
	for (uint32_t i = 0; i < trim->edge_count; i++)
		trim->levels[i] = trim->edges[i].from[1];
	qsort(trim->levels, trim->edge_count, sizeof(*trim->levels), compare_numbers);
	for (uint32_t i = 0; i < trim->edge_count; i++)
		if (n == 0 || trim->levels[i] > trim->levels[n - 1])
			trim->levels[n++] = trim->levels[i];
	trim->level_count = n;
	return 0;
}

/* Computes where an edge is at a level; at its ends exactly there. */
static double edge_at(const struct trim_edge *edge, double v)
{
	const double *low = edge->from[1] < edge->to[1] ? edge->from : edge->to;
	const double *high = low == edge->from ? edge->to : edge->from;

	if (v <= low[1])
		return low[0];
	if (v >= high[1])
		return high[0];
	return low[0] + (high[0] - low[0]) * ((v - low[1]) / (high[1] - low[1]));
}

/* An edge that crosses a slab. */
struct crossing {
	double middle, low_u, high_u;
};

static int compare_crossings(const void *a, const void *b)
{
	return compare_numbers(&((const struct crossing *)a)->middle,
			       &((const struct crossing *)b)->middle);
}

static int cut_slab(struct trim *trim, uint32_t slab, struct crossing *crossings)
{
	const double low = trim->levels[slab], high = trim->levels[slab + 1];
	uint32_t count = 0;

	for (uint32_t i = 0; i < trim->edge_count; i++) {
		const struct trim_edge *edge = &trim->edges[i];
		const double a = edge->from[1], b = edge->to[1];

		if ((a < b ? a : b) > low || (a < b ? b : a) < high || (a >= b && a <= b))
			continue;
		crossings[count].low_u = edge_at(edge, low);
		crossings[count].high_u = edge_at(edge, high);
		crossings[count].middle = crossings[count].low_u + crossings[count].high_u;
		count++;
	}
	qsort(crossings, count, sizeof(*crossings), compare_crossings);
	for (uint32_t i = 0; i + 1 < count; i += 2) {
		int rc = ARRAY_RESERVE(trim->traps, trim->trap_room, trim->trap_count + 1,
				       UINT32_MAX / 4);

		if (rc < 0)
			return rc;
		trim->traps[trim->trap_count++] = (struct trapezoid){
			slab,
			{ crossings[i].low_u, crossings[i + 1].low_u },
			{ crossings[i].high_u, crossings[i + 1].high_u },
		};
	}
	return 0;
}

static int compare_points(const void *a, const void *b)
{
	const struct level_point *p = a, *q = b;

	return p->level != q->level ? (p->level > q->level) - (p->level < q->level)
				    : (p->u > q->u) - (p->u < q->u);
}

static int collect_points(struct trim *trim)
{
	trim->points = malloc(((size_t)trim->trap_count * 4 + 1) * sizeof(*trim->points));
	if (!trim->points)
		return -ENOMEM;
	for (uint32_t i = 0; i < trim->trap_count; i++)
		for (int side = 0; side < 2; side++) {
			const struct trapezoid *t = &trim->traps[i];

			trim->points[trim->point_count++] =
				(struct level_point){ t->slab, t->low_u[side] };
			trim->points[trim->point_count++] =
				(struct level_point){ t->slab + 1, t->high_u[side] };
		}
	qsort(trim->points, trim->point_count, sizeof(*trim->points), compare_points);
	return 0;
}

/* The points of a level from one u to another, both included; each once. */
struct chain {
	const struct trim *trim;
	uint32_t level, at; /* the point */
	double end;
};

static struct chain begin_chain(const struct trim *trim, uint32_t level, const double u[2])
{
	const struct level_point first = { level, u[0] };
	uint32_t low = 0, high = trim->point_count;

	while (low < high) { /* the first point that is not before */
		const uint32_t middle = (low + high) / 2;

		if (compare_points(&trim->points[middle], &first) < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return (struct chain){ trim, level, low, u[1] };
}

static void chain_place(const struct chain *chain, double out[2])
{
	out[0] = chain->trim->points[chain->at].u;
	out[1] = chain->trim->levels[chain->level];
}

/* Goes on to the next point with a larger u. Returns false at the end. */
static bool step_chain(struct chain *chain)
{
	const struct level_point *points = chain->trim->points;

	for (uint32_t i = chain->at + 1; i < chain->trim->point_count; i++) {
		if (points[i].level != chain->level || points[i].u > chain->end)
			return false;
		if (points[i].u > points[chain->at].u) {
			chain->at = i;
			return true;
		}
	}
	return false;
}

static int fill(const struct trim *trim, const struct trapezoid *t, trim_visit visit, void *data)
{
	struct chain low = begin_chain(trim, t->slab, t->low_u);
	struct chain high = begin_chain(trim, t->slab + 1, t->high_u);
	int rc = 0;

	while (rc == 0) {
		struct chain next_low = low, next_high = high;
		const bool has_low = step_chain(&next_low), has_high = step_chain(&next_high);
		double a[2], b[2], c[2];

		if (!has_low && !has_high)
			break;
		chain_place(&low, a);
		chain_place(&high, c);
		if (has_low &&
		    (!has_high || trim->points[next_low.at].u <= trim->points[next_high.at].u)) {
			chain_place(&next_low, b);
			low = next_low;
		} else {
			chain_place(&next_high, b);
			high = next_high;
		}
		rc = visit(data, a, b, c);
	}
	return rc;
}

int trim_triangles(const struct trim_edge *edges, uint32_t count, trim_visit visit, void *data)
{
	struct trim trim = { .edges = edges, .edge_count = count };
	struct crossing *crossings = malloc(((size_t)count + 1) * sizeof(*crossings));
	int rc = crossings ? find_levels(&trim) : -ENOMEM;

	for (uint32_t slab = 0; slab + 1 < trim.level_count && rc == 0; slab++)
		rc = cut_slab(&trim, slab, crossings);
	if (rc == 0)
		rc = collect_points(&trim);
	for (uint32_t i = 0; i < trim.trap_count && rc == 0; i++)
		rc = fill(&trim, &trim.traps[i], visit, data);
	free(crossings);
	free(trim.levels);
	free(trim.traps);
	free(trim.points);
	return rc;
}
