/* Half-edge collapses in passes, the flattest edges first. */
#include "pipeline/hierarchy/simplify_features.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "pipeline/hierarchy/feature_edges.h"

#define FOLD_COSINE   0.2   /* minimum cosine between a triangle's normals before and after */
#define LENGTH_SHARE  1e-4f /* what a long edge costs more than a short one */
#define LOOSE_EPSILON -10.0 /* below all weights: nothing is a feature */

enum {
	BUCKETS = 1 << 15, /* of the order: the upper half of a float that is not negative */
	DRY_PART = 32,     /* a pass that removes less than this part of the triangles was dry */
};

/* The features that passes keep, the weakest first. */
static const double epsilons[] = { 0.995, 0.98, 0.95, 0.9, 0.8, 0.65, 0.5, 0.25, 0.0, -0.5, -1.0 };

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
	const float *sum = vertex->sum;

	return vertex->area > 0.0f
		       ? sqrtf(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / vertex->area
		       : 0.0f;
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

static void collapse(struct work *work, uint32_t gone, uint32_t keep, double fold_cosine)
{
	struct collapse_mesh *mesh = &work->mesh;
	const double *at = mesh->nodes[keep].at;
	struct quadric sum = mesh->nodes[gone].quadric;
	double value;

	quadric_add(&sum, &mesh->nodes[keep].quadric);
	value = quadric_at(&sum, at);
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

static int run_passes(struct work *work, double epsilon, uint32_t target, uint32_t dry_part)
{
	uint32_t before;
	int rc = 0;

	do {
		before = work->mesh.alive_count;
		if (before > target)
			rc = run_pass(work, epsilon, target);
	} while (rc == 0 && work->mesh.alive_count > target &&
		 work->mesh.alive_count < before - before / dry_part);
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

int simplify_features(struct simplify_surface *surface, uint32_t target_triangles,
		      double error_most_steps, double epsilon_least, struct simplify_result *result)
{
	struct work work;
	int rc = work_init(&work, surface, error_most_steps, result);

	for (uint32_t step = 0; rc == 0 && step < ARRAY_COUNT(epsilons); step++)
		if (epsilons[step] >= epsilon_least)
			rc = run_passes(&work, epsilons[step], target_triangles, DRY_PART);
	work.loose = true;
	if (rc == 0 && epsilon_least <= -1.0)
		rc = run_passes(&work, LOOSE_EPSILON, target_triangles, DRY_PART);
	if (rc == 0)
		collapse_mesh_give_back(&work.mesh);
	result->error_steps = sqrt(result->error_steps);
	features_finish(&work.features);
	collapse_mesh_finish(&work.mesh);
	free(work.candidates);
	free(work.sorted);
	return rc;
}
