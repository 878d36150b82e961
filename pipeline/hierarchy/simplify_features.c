/* Half-edge collapses in passes, the flattest edges first. */
#include "pipeline/hierarchy/simplify_features.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "geometry/vec.h"
#include "pipeline/hierarchy/feature_edges.h"

#define FOLD_COSINE   0.2   /* minimum cosine between a triangle's normals before and after */
#define LENGTH_SHARE  1e-4f /* what a long edge costs more than a short one */
#define LOOSE_EPSILON -10.0 /* below all weights: nothing is a feature */

#define COLOUR_WEIGHT 0.02 /* of black to white, relative to moving by the edge's length */
/* What a collapse may lose in the first round: the mean triangle off by a lattice step, which is
 * how exact places are. Each round may lose so many times more. */
#define LOSS_GROWTH 6.0

enum {
	BUCKETS = 1 << 15, /* of the order: the upper half of a float that is not negative */
	DRY_PART = 8,      /* a pass that removes less than this part of the triangles was dry */
	ROUNDS_MAX = 40,   /* then the loss of any collapse is small enough */
};

/* The stages of a round: a feature may go if that loses less than flat surface may lose. */
static const struct {
	double epsilon, loss_share;
} stages[] = { { 0.9, 1.0 }, { 0.5, 1.0 / 4 }, { -1.0, 1.0 / 16 } };

struct candidate {
	uint32_t gone, keep;
	float cost; /* 0 or more */
};

struct work {
	struct collapse_mesh mesh;
	struct features features;
	struct candidate *candidates, *sorted; /* owned; with room for all edges */
	uint32_t candidate_count, room, sorted_room;
	uint32_t pass;
	double loss_most;               /* of a collapse in this stage, with that of colours */
	bool was_refused;               /* a collapse lost more */
	double most;                    /* limit of the squared error, lattice steps */
	bool loose;                     /* topology may change: the surface may pinch */
	struct simplify_result *result; /* error_steps is squared until the end */
};

/* ---- candidates */

/* Returns the weight of a collapse that removes a vertex along an edge; below epsilon: not
 * allowed. */
static double weight_of(const struct work *work, const struct feature_edge *edge, int end)
{
	const uint32_t gone = edge->ends[end], keep = edge->ends[1 - end];
	const struct feature_vertex *vertex = &work->features.vertices[gone];

	if (!collapse_may_leave(&work->mesh.nodes[gone], &work->mesh.nodes[keep], edge->is_open))
		return -INFINITY;
	if (vertex->is_held)
		return -INFINITY;
	if (vertex->line_count == 0)
		return edge->weight;
	if (vertex->line_count > 2 || !edge->is_sharp)
		return work->loose ? edge->weight : -INFINITY;
	return vertex->line_count == 1
		       ? edge->weight
		       : fmin(edge->weight, features_straightness(&work->features, gone));
}

/* How flat the surface is around a vertex, 1: quite flat. */
static float flatness(const struct feature_vertex *vertex)
{
	return vertex->area > 0.0f ? vec_length(vertex->sum) / vertex->area : 0.0f;
}

static float squared_length(const struct work *work, const struct feature_edge *edge)
{
	const double *a = work->mesh.nodes[edge->ends[0]].at;
	const double *b = work->mesh.nodes[edge->ends[1]].at;
	double along[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };

	return (float)collapse_dot(along, along);
}

/* Section 3.5.2: if both ends may be removed, the one on the flatter side is. */
static void add_candidate(struct work *work, const struct feature_edge *edge, double epsilon,
			  float usual_square)
{
	struct feature_vertex *vertices = work->features.vertices;
	double weights[2] = { weight_of(work, edge, 0), weight_of(work, edge, 1) };
	float square = squared_length(work, edge);
	int gone = 0;

	if (weights[0] < epsilon && weights[1] < epsilon)
		return;
	if (weights[0] < epsilon)
		gone = 1;
	else if (weights[1] >= epsilon)
		gone = weights[0] != weights[1] ? weights[1] > weights[0]
						: flatness(&vertices[edge->ends[1]]) >
							  flatness(&vertices[edge->ends[0]]);
	work->candidates[work->candidate_count++] = (struct candidate){
		.gone = edge->ends[gone],
		.keep = edge->ends[1 - gone],
		.cost = fmaxf(1.0f - (float)weights[gone], 0.0f) +
			LENGTH_SHARE * square / (square + usual_square),
	};
}

static uint32_t bucket_of(float cost)
{
	uint32_t bits;

	memcpy(&bits, &cost, sizeof(bits));
	return bits >> 16;
}

/* By counting: the order of equals stays. */
static void sort_candidates(struct work *work)
{
	static const uint32_t zero[BUCKETS + 1];
	uint32_t starts[BUCKETS + 1];

	memcpy(starts, zero, sizeof(starts));
	for (uint32_t c = 0; c < work->candidate_count; c++)
		starts[bucket_of(work->candidates[c].cost) + 1]++;
	for (uint32_t b = 0; b < BUCKETS; b++)
		starts[b + 1] += starts[b];
	for (uint32_t c = 0; c < work->candidate_count; c++)
		work->sorted[starts[bucket_of(work->candidates[c].cost)]++] = work->candidates[c];
}

static int find_candidates(struct work *work, double epsilon)
{
	const struct features *features = &work->features;
	double sum = 0.0;
	int rc = features_find(&work->features, epsilon);

	if (rc == 0)
		rc = ARRAY_RESERVE(work->candidates, work->room, features->edge_count + 1,
				   UINT32_MAX);
	if (rc == 0)
		rc = ARRAY_RESERVE(work->sorted, work->sorted_room, features->edge_count + 1,
				   UINT32_MAX);
	work->candidate_count = 0;
	for (uint32_t e = 0; rc == 0 && e < features->edge_count; e++)
		sum += squared_length(work, &features->edges[e]);
	for (uint32_t e = 0; rc == 0 && e < features->edge_count; e++)
		add_candidate(work, &features->edges[e], epsilon,
			      (float)(sum / features->edge_count));
	if (rc == 0)
		sort_candidates(work);
	return rc;
}

/* ---- collapses */

/* The triangles around both ends change: what was found about their corners is no longer true. */
static void touch_around(struct work *work, uint32_t vertex)
{
	COLLAPSE_EACH_CORNER(&work->mesh, vertex, corner)
	{
		for (int i = 0; i < 3; i++)
			work->features.vertices[collapse_corners_of(&work->mesh, corner)[i]]
				.touched = work->pass;
	}
}

/* Returns true if the collapse would leave no triangle. collapse_is_last is quick and careful: of
 * three or four triangles it keeps all, also where two make the same surface. */
static bool is_last(struct work *work, uint32_t gone, uint32_t keep)
{
	struct collapse_mesh *mesh = &work->mesh;
	uint32_t forth, count;

	if (!collapse_is_last(mesh, gone, keep))
		return false;
	count = collapse_triangles_at(mesh, gone, keep, &forth);
	COLLAPSE_EACH_CORNER(mesh, gone, corner)
	{
		count += collapse_is_cancelled(mesh, corner, keep) ? 2 : 0;
	}
	return mesh->alive_count <= count;
}

/* As in simplify.c: where colours differ, moving the border between them costs. */
static double colour_loss(const struct work *work, uint32_t gone, uint32_t keep)
{
	const struct collapse_node *from = &work->mesh.nodes[gone], *to = &work->mesh.nodes[keep];
	const struct lattice_vertex *vertices = work->mesh.surface->vertices;
	double along[3], sum = 0.0;

	for (int i = 0; i < 3; i++) {
		double step = (vertices[gone].colour[i] - vertices[keep].colour[i]) / 255.0;

		along[i] = from->at[i] - to->at[i];
		sum += step * step / 3.0;
	}
	return COLOUR_WEIGHT * sum * collapse_dot(along, along) * from->area * from->importance;
}

static void collapse(struct work *work, uint32_t gone, uint32_t keep, double fold_cosine)
{
	struct collapse_mesh *mesh = &work->mesh;
	const double *at = mesh->nodes[keep].at;
	struct quadric sum = mesh->nodes[gone].quadric;
	double value;

	quadric_add(&sum, &mesh->nodes[keep].quadric);
	value = quadric_at(&sum, at);
	if (value + colour_loss(work, gone, keep) > work->loss_most) {
		work->was_refused = true;
		return;
	}
	if (value > sum.weight * work->most || is_last(work, gone, keep) ||
	    collapse_folds(mesh, gone, keep, at, fold_cosine) ||
	    (!work->loose && !collapse_link_is_sound(mesh, keep, gone)))
		return;
	if (sum.weight > 0.0)
		work->result->error_steps = fmax(work->result->error_steps, value / sum.weight);
	work->result->loss_steps4 = fmax(work->result->loss_steps4, value);
	work->result->collapse_count++;
	touch_around(work, gone);
	collapse_join(mesh, keep, gone);
}

/* Returns -ENOMEM. */
static int run_pass(struct work *work, double epsilon, uint32_t target)
{
	const struct feature_vertex *vertices = work->features.vertices;
	int rc = find_candidates(work, epsilon);

	work->pass++;
	for (uint32_t c = 0;
	     rc == 0 && c < work->candidate_count && work->mesh.alive_count > target; c++) {
		const struct candidate *next = &work->sorted[c];

		if (vertices[next->gone].touched != work->pass &&
		    vertices[next->keep].touched != work->pass)
			collapse(work, next->gone, next->keep, fmax(epsilon, FOLD_COSINE));
	}
	return rc;
}

static int run_passes(struct work *work, double epsilon, uint32_t target)
{
	uint32_t before;
	int rc = 0;

	do {
		before = work->mesh.alive_count;
		if (before > target)
			rc = run_pass(work, epsilon, target);
	} while (rc == 0 && work->mesh.alive_count > target &&
		 work->mesh.alive_count < before - before / DRY_PART);
	return rc;
}

static int work_init(struct work *work, struct simplify_surface *surface, double error_most_steps,
		     struct simplify_result *result)
{
	int rc;

	*result = (struct simplify_result){ 0 };
	*work = (struct work){ .most = error_most_steps * error_most_steps, .result = result };
	rc = collapse_mesh_init(&work->mesh, surface);
	return rc < 0 ? rc : features_init(&work->features, &work->mesh);
}

static double mean_area(const struct collapse_mesh *mesh)
{
	double sum = 0.0;

	for (uint32_t v = 0; v < mesh->surface->vertex_count; v++)
		sum += mesh->nodes[v].area;
	return sum / (mesh->surface->triangle_count + 1.0);
}

/* Rounds of ever greater losses, until there are few enough triangles, or there was no collapse and
 * none was refused because it loses too much. */
static int run_rounds(struct work *work, double epsilon_least, uint32_t target)
{
	double loss = mean_area(&work->mesh);
	int rc = 0;

	for (int round = 0; rc == 0 && round < ROUNDS_MAX; round++, loss *= LOSS_GROWTH) {
		const uint32_t before = work->mesh.alive_count;

		work->was_refused = false;
		for (size_t stage = 0; rc == 0 && stage < ARRAY_COUNT(stages); stage++) {
			if (stages[stage].epsilon < epsilon_least)
				continue;
			work->loss_most = loss * stages[stage].loss_share;
			rc = run_passes(work, stages[stage].epsilon, target);
		}
		if (work->mesh.alive_count <= target ||
		    (work->mesh.alive_count == before && !work->was_refused))
			break;
	}
	return rc;
}

int simplify_features(struct simplify_surface *surface, uint32_t target_triangles,
		      double error_most_steps, double epsilon_least, struct simplify_result *result)
{
	struct work work;
	int rc = work_init(&work, surface, error_most_steps, result);

	if (rc == 0)
		rc = run_rounds(&work, epsilon_least, target_triangles);
	/* If it is stuck, the topology of the surface is the obstacle: let it pinch. */
	work.loose = true;
	work.loss_most = INFINITY;
	if (rc == 0 && epsilon_least <= -1.0)
		rc = run_passes(&work, LOOSE_EPSILON, target_triangles);
	if (rc == 0)
		collapse_mesh_give_back(&work.mesh);
	result->error_steps = sqrt(result->error_steps);
	features_finish(&work.features);
	collapse_mesh_finish(&work.mesh);
	free(work.candidates);
	free(work.sorted);
	return rc;
}
