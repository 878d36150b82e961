/* Builds graphs, connects their parts along a Morton curve and divides them with METIS. */
#include "pipeline/hierarchy/graph.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include <metis.h>

#include "base/array.h"

enum { PARTS_BY_BISECTION_MAX = 8, NODES_A_PART = 64 };

/* CLUSTERS_A_PART: METIS gets no more nodes than this for a part. A larger graph is shrunk first to
 * clusters of at most CLUSTER_NODES nodes; afterwards the cut is smoothed node by node. */
enum { CLUSTERS_A_PART = 96, CLUSTER_NODES = 16, SMOOTHING_PASSES = 6 };

/* IMBALANCE: how much too heavy a part may be, in thousandths. It leaves a cut freedom to follow
 * creases and borders. */
enum { IMBALANCE = 40, TRIES = 8 /* bisections that METIS tries; the best is taken */ };

static pthread_mutex_t metis_lock = PTHREAD_MUTEX_INITIALIZER;

int graph_init(struct graph *graph, uint32_t node_count)
{
	*graph = (struct graph){ .node_count = node_count };
	graph->node_weights = malloc((node_count + 1) * sizeof(*graph->node_weights));
	if (!graph->node_weights)
		return -ENOMEM;
	for (uint32_t i = 0; i < node_count; i++)
		graph->node_weights[i] = 1;
	return 0;
}

void graph_finish(struct graph *graph)
{
	if (!graph)
		return;
	free(graph->node_weights);
	free(graph->edges);
	*graph = (struct graph){ 0 };
}

int graph_add(struct graph *graph, uint32_t a, uint32_t b, int32_t weight)
{
	int rc;

	if (a == b)
		return 0;
	rc = ARRAY_RESERVE(graph->edges, graph->edge_room, graph->edge_count + 1, UINT32_MAX);
	if (rc == 0)
		graph->edges[graph->edge_count++] = (struct graph_edge){ a, b, weight };
	return rc;
}

/* ---- connecting parts that are near each other */

static uint32_t find_root(uint32_t *parents, uint32_t node)
{
	while (parents[node] != node) {
		parents[node] = parents[parents[node]];
		node = parents[node];
	}
	return node;
}

static bool unite(uint32_t *parents, uint32_t a, uint32_t b)
{
	a = find_root(parents, a);
	b = find_root(parents, b);
	if (a == b)
		return false;
	parents[a > b ? a : b] = a > b ? b : a;
	return true;
}

/* Spreads the bits of a coordinate in coarse steps, with two zeros after each. */
static uint64_t spread(uint64_t bits)
{
	bits &= 0xffff;
	bits = (bits | bits << 16) & 0x0000ff0000ffu;
	bits = (bits | bits << 8) & 0x00f00f00f00fu;
	bits = (bits | bits << 4) & 0x0c30c30c30c3u;
	return (bits | bits << 2) & 0x249249249249u;
}

/* The position on the Morton curve (1966): a cell of any size is one run of it. */
static uint64_t place_on_curve(const float at[3])
{
	uint64_t place = 0;

	for (int i = 0; i < 3; i++)
		place |= spread((uint64_t)fminf(fmaxf(at[i], 0.0f), 65535.0f)) << i;
	return place;
}

struct placed {
	uint64_t place;
	uint32_t node;
};

/* Sorts by place, and keeps the order of nodes that have the same: by 12 bits at a time, the lowest
 * first. other has room for as many. The result is in placed. */
static void sort_placed(struct placed *placed, struct placed *other, uint32_t count)
{
	enum { BITS = 12, ENDS = 1 << BITS };

	for (int shift = 0; shift < 48; shift += BITS) {
		uint32_t starts[ENDS + 1] = { 0 };
		struct placed *sorted = other;

		for (uint32_t i = 0; i < count; i++)
			starts[(placed[i].place >> shift) % ENDS + 1]++;
		for (uint32_t d = 0; d < ENDS; d++)
			starts[d + 1] += starts[d];
		for (uint32_t i = 0; i < count; i++)
			sorted[starts[(placed[i].place >> shift) % ENDS]++] = placed[i];
		other = placed;
		placed = sorted;
	}
}

/* Nodes of one cell are near each other. Connects the parts within each cell, for ever larger
 * cells; the last cell contains all nodes. */
static int connect_runs(struct graph *graph, uint32_t *parents, const struct placed *placed,
			int32_t weight, uint32_t part_count)
{
	for (int bits = 15; part_count > 1 && bits <= 48; bits += 3)
		for (uint32_t i = 1; part_count > 1 && i < graph->node_count; i++) {
			uint32_t a = placed[i - 1].node, b = placed[i].node;

			if (placed[i - 1].place >> bits != placed[i].place >> bits ||
			    !unite(parents, a, b))
				continue;
			part_count--;
			if (graph_add(graph, a, b, weight) < 0)
				return -ENOMEM;
		}
	return 0;
}

int graph_connect(struct graph *graph, float (*at)[3], int32_t weight)
{
	uint32_t *parents = malloc((graph->node_count + 1) * sizeof(*parents));
	struct placed *placed = NULL;
	uint32_t part_count = graph->node_count;
	int rc = parents ? 0 : -ENOMEM;

	for (uint32_t i = 0; rc == 0 && i < graph->node_count; i++)
		parents[i] = i;
	for (size_t e = 0; rc == 0 && e < graph->edge_count; e++)
		part_count -= unite(parents, graph->edges[e].a, graph->edges[e].b);
	if (rc == 0 && part_count > 1) {
		placed = malloc(2 * (size_t)graph->node_count * sizeof(*placed));
		rc = placed ? 0 : -ENOMEM;
		for (uint32_t i = 0; rc == 0 && i < graph->node_count; i++)
			placed[i] = (struct placed){ place_on_curve(at[i]), i };
		if (rc == 0) {
			sort_placed(placed, placed + graph->node_count, graph->node_count);
			rc = connect_runs(graph, parents, placed, weight, part_count);
		}
	}
	free(placed);
	free(parents);
	return rc;
}

/* ---- division */

struct rows {
	idx_t *first, *to, *weights, *node_weights;
};

static void rows_finish(struct rows *rows)
{
	free(rows->first);
	free(rows->to);
	free(rows->weights);
	free(rows->node_weights);
}

/* Sorts the entries of a row by node and adds up the weights of equal ones: METIS wants no edge
 * twice. Rows are short, so insertion sort will do. Returns the number of entries left. */
static idx_t tidy_row(idx_t *to, idx_t *weights, idx_t count)
{
	idx_t kept = 0;

	for (idx_t i = 0; i < count; i++) {
		idx_t node = to[i], weight = weights[i], at = kept;

		while (at > 0 && to[at - 1] > node)
			at--;
		if (at > 0 && to[at - 1] == node) {
			weights[at - 1] += weight;
			continue;
		}
		memmove(to + at + 1, to + at, (size_t)(kept - at) * sizeof(*to));
		memmove(weights + at + 1, weights + at, (size_t)(kept - at) * sizeof(*weights));
		to[at] = node;
		weights[at] = weight;
		kept++;
	}
	return kept;
}

static int rows_init(struct rows *rows, const struct graph *graph)
{
	uint32_t nodes = graph->node_count;
	idx_t kept = 0;

	*rows = (struct rows){
		.first = calloc((size_t)nodes + 2, sizeof(*rows->first)),
		.to = malloc((2 * graph->edge_count + 1) * sizeof(*rows->to)),
		.weights = malloc((2 * graph->edge_count + 1) * sizeof(*rows->weights)),
		.node_weights = malloc((nodes + 1) * sizeof(*rows->node_weights)),
	};
	if (!rows->first || !rows->to || !rows->weights || !rows->node_weights)
		return -ENOMEM;
	for (uint32_t i = 0; i < nodes; i++)
		rows->node_weights[i] = graph->node_weights[i];
	for (size_t e = 0; e < graph->edge_count; e++) {
		rows->first[graph->edges[e].a + 2]++;
		rows->first[graph->edges[e].b + 2]++;
	}
	for (uint32_t i = 2; i < nodes + 2; i++)
		rows->first[i] += rows->first[i - 1];
	for (size_t e = 0; e < graph->edge_count; e++) {
		const struct graph_edge *edge = &graph->edges[e];
		idx_t at_a = rows->first[edge->a + 1]++, at_b = rows->first[edge->b + 1]++;

		rows->to[at_a] = (idx_t)edge->b;
		rows->to[at_b] = (idx_t)edge->a;
		rows->weights[at_a] = rows->weights[at_b] = edge->weight;
	}
	for (uint32_t i = 0; i < nodes; i++) {
		idx_t first = rows->first[i], count = rows->first[i + 1] - first;

		count = tidy_row(rows->to + first, rows->weights + first, count);
		memmove(rows->to + kept, rows->to + first, (size_t)count * sizeof(*rows->to));
		memmove(rows->weights + kept, rows->weights + first,
			(size_t)count * sizeof(*rows->weights));
		rows->first[i] = kept;
		kept += count;
	}
	rows->first[nodes] = kept;
	return 0;
}

static int run_metis(idx_t *parts, struct rows *rows, const struct graph *graph,
		     uint32_t part_count, const float *shares)
{
	idx_t nodes = (idx_t)graph->node_count, constraints = 1, count = (idx_t)part_count, cut;
	idx_t options[METIS_NOPTIONS];
	real_t wanted[2];
	int code;

	METIS_SetDefaultOptions(options);
	options[METIS_OPTION_SEED] = 1;
	options[METIS_OPTION_NUMBERING] = 0;
	options[METIS_OPTION_UFACTOR] = IMBALANCE;
	if (part_count == 2)
		options[METIS_OPTION_NCUTS] = TRIES;
	if (shares && part_count == 2) {
		wanted[0] = shares[0];
		wanted[1] = shares[1];
	}
	pthread_mutex_lock(&metis_lock);
	if (part_count <= PARTS_BY_BISECTION_MAX)
		code = METIS_PartGraphRecursive(&nodes, &constraints, rows->first, rows->to,
						rows->node_weights, NULL, rows->weights, &count,
						shares && part_count == 2 ? wanted : NULL, NULL,
						options, &cut, parts);
	else
		code = METIS_PartGraphKway(&nodes, &constraints, rows->first, rows->to,
					   rows->node_weights, NULL, rows->weights, &count, NULL,
					   NULL, options, &cut, parts);
	pthread_mutex_unlock(&metis_lock);
	return code == METIS_OK ? 0 : code == METIS_ERROR_MEMORY ? -ENOMEM : -EINVAL;
}

/* METIS may leave a part empty on very small or unusual graphs. Then simple runs of nodes will
 * do. */
static void divide_in_runs(uint32_t *labels, const struct graph *graph, uint32_t part_count)
{
	for (uint32_t i = 0; i < graph->node_count; i++)
		labels[i] = (uint32_t)((uint64_t)i * part_count / graph->node_count);
}

/* Returns 1 if no part is empty, 0 if one is, or -ENOMEM. */
static int all_parts_used(const idx_t *parts, uint32_t node_count, uint32_t part_count)
{
	uint32_t used = 0;
	bool *seen = calloc(part_count, sizeof(*seen));

	if (!seen)
		return -ENOMEM;
	for (uint32_t i = 0; i < node_count; i++) {
		used += !seen[parts[i]];
		seen[parts[i]] = true;
	}
	free(seen);
	return used == part_count;
}

static int divide_at_once(uint32_t *labels, const struct graph *graph, uint32_t part_count,
			  const float *shares)
{
	struct rows rows;
	idx_t *parts = calloc(graph->node_count, sizeof(*parts));
	int rc = rows_init(&rows, graph);

	if (!parts)
		rc = -ENOMEM;
	if (rc == 0)
		rc = run_metis(parts, &rows, graph, part_count, shares);
	if (rc == 0)
		rc = all_parts_used(parts, graph->node_count, part_count);
	if (rc > 0)
		for (uint32_t i = 0; i < graph->node_count; i++)
			labels[i] = (uint32_t)parts[i];
	else if (rc == 0)
		divide_in_runs(labels, graph, part_count);
	rows_finish(&rows);
	free(parts);
	return rc < 0 ? rc : 0;
}

/* Makes a graph of the nodes with one of two labels. names[node] is set to a node's index in it. */
static int half_of_graph(struct graph *half, uint32_t *names, const struct graph *graph,
			 const uint32_t *labels, uint32_t label)
{
	uint32_t count = 0;
	int rc;

	for (uint32_t i = 0; i < graph->node_count; i++)
		if (labels[i] == label)
			names[i] = count++;
	rc = graph_init(half, count);
	for (uint32_t i = 0; rc == 0 && i < graph->node_count; i++)
		if (labels[i] == label)
			half->node_weights[names[i]] = graph->node_weights[i];
	for (size_t e = 0; rc == 0 && e < graph->edge_count; e++) {
		const struct graph_edge *edge = &graph->edges[e];

		if (labels[edge->a] == label && labels[edge->b] == label)
			rc = graph_add(half, names[edge->a], names[edge->b], edge->weight);
	}
	return rc;
}

/* With few heavy nodes per part, or one that outweighs a part, METIS cannot divide into many parts
 * at once. So divide into halves, step by step, and check each. */
static int divide_by_halves(uint32_t *labels, const struct graph *graph, uint32_t part_count)
{
	uint32_t parts[2] = { part_count / 2, part_count - part_count / 2 }, counts[2] = { 0, 0 };
	const float shares[2] = { (float)parts[0] / (float)part_count,
				  (float)parts[1] / (float)part_count };
	uint32_t *names = malloc((graph->node_count + 1) * sizeof(*names));
	uint32_t *halves = malloc((graph->node_count + 1) * sizeof(*halves));
	uint32_t *inner = malloc((graph->node_count + 1) * sizeof(*inner));
	int rc = names && halves && inner ? divide_at_once(halves, graph, 2, shares) : -ENOMEM;

	for (uint32_t i = 0; rc == 0 && i < graph->node_count; i++)
		counts[halves[i]]++;
	if (rc == 0 && (counts[0] < parts[0] || counts[1] < parts[1])) {
		divide_in_runs(labels, graph, part_count);
		parts[0] = parts[1] = 0;
	}
	for (uint32_t side = 0; rc == 0 && side < 2 && parts[side] > 0; side++) {
		struct graph half;

		rc = half_of_graph(&half, names, graph, halves, side);
		if (rc == 0)
			rc = graph_divide(inner, &half, parts[side], NULL);
		for (uint32_t i = 0; rc == 0 && i < graph->node_count; i++)
			if (halves[i] == side)
				labels[i] = inner[names[i]] + (side ? parts[0] : 0);
		graph_finish(&half);
	}
	free(names);
	free(halves);
	free(inner);
	return rc;
}

/* Whether a node is heavier than a part may be. METIS then puts no node beside it, and complains
 * that nothing is left to divide. */
static bool has_giant(const struct graph *graph, uint32_t part_count)
{
	int64_t total = 0, heaviest = 0;

	for (uint32_t i = 0; i < graph->node_count; i++) {
		total += graph->node_weights[i];
		if (graph->node_weights[i] > heaviest)
			heaviest = graph->node_weights[i];
	}
	return heaviest * part_count * 1000 > total * (1000 + IMBALANCE);
}

static int divide_unclustered(uint32_t *labels, const struct graph *graph, uint32_t part_count,
			      const float *shares)
{
	if (part_count > 2 &&
	    (graph->node_count < NODES_A_PART * part_count || has_giant(graph, part_count)))
		return divide_by_halves(labels, graph, part_count);
	return divide_at_once(labels, graph, part_count, shares);
}

/* ---- large graphs: clusters, then smoothing */

#define NO_CLUSTER UINT32_MAX

/* The nodes next to a growing cluster, with the weight of their edges into it. */
struct frontier {
	struct {
		uint32_t node;
		idx_t weight;
	} items[256];
	uint32_t count;
};

static void frontier_add(struct frontier *frontier, uint32_t node, idx_t weight)
{
	uint32_t i = 0;

	while (i < frontier->count && frontier->items[i].node != node)
		i++;
	if (i == ARRAY_COUNT(frontier->items))
		return;
	if (i == frontier->count) {
		frontier->items[frontier->count].node = node;
		frontier->items[frontier->count++].weight = 0;
	}
	frontier->items[i].weight += weight;
}

/* Removes and returns the node with the strongest edges into the cluster, of equals the first. */
static uint32_t frontier_take(struct frontier *frontier)
{
	uint32_t best = 0, node;

	for (uint32_t i = 1; i < frontier->count; i++)
		if (frontier->items[i].weight > frontier->items[best].weight)
			best = i;
	node = frontier->items[best].node;
	for (uint32_t i = best; i + 1 < frontier->count; i++)
		frontier->items[i] = frontier->items[i + 1];
	frontier->count--;
	return node;
}

/* Grows clusters of at most that weight, node after node. Returns the number of clusters. */
static uint32_t grow_clusters(uint32_t *cluster_of, const struct rows *rows, uint32_t node_count,
			      int64_t weight_most)
{
	uint32_t cluster_count = 0;

	memset(cluster_of, 0xff, node_count * sizeof(*cluster_of));
	for (uint32_t seed = 0; seed < node_count; seed++) {
		struct frontier frontier = { .count = 0 };
		uint32_t node = seed;
		int64_t weight = 0;

		if (cluster_of[seed] != NO_CLUSTER)
			continue;
		for (;;) {
			cluster_of[node] = cluster_count;
			weight += rows->node_weights[node];
			for (idx_t e = rows->first[node]; e < rows->first[node + 1]; e++)
				if (cluster_of[rows->to[e]] == NO_CLUSTER)
					frontier_add(&frontier, (uint32_t)rows->to[e],
						     rows->weights[e]);
			if (frontier.count == 0)
				break;
			node = frontier_take(&frontier);
			if (weight + rows->node_weights[node] > weight_most)
				break;
		}
		cluster_count++;
	}
	return cluster_count;
}

static int graph_of_clusters(struct graph *out, const struct rows *rows, uint32_t node_count,
			     const uint32_t *cluster_of, uint32_t cluster_count)
{
	int rc = graph_init(out, cluster_count);

	if (rc == 0)
		memset(out->node_weights, 0, cluster_count * sizeof(*out->node_weights));
	for (uint32_t i = 0; rc == 0 && i < node_count; i++) {
		out->node_weights[cluster_of[i]] += rows->node_weights[i];
		for (idx_t e = rows->first[i]; rc == 0 && e < rows->first[i + 1]; e++)
			if ((uint32_t)rows->to[e] > i)
				rc = graph_add(out, cluster_of[i], cluster_of[rows->to[e]],
					       rows->weights[e]);
	}
	return rc;
}

/* What smoothing keeps track of. */
struct smoothing {
	const struct rows *rows;
	uint32_t *labels;
	int64_t *weights, *least, *most; /* for each part */
};

/* Moves a node to the neighbouring part that its edges hold to most. Returns true if it moved. */
static bool move_node(struct smoothing *smoothing, uint32_t node)
{
	const struct rows *rows = smoothing->rows;
	uint32_t from = smoothing->labels[node], parts[8], count = 0, best = from;
	idx_t pulls[8], weight = rows->node_weights[node], stay = 0, strongest;

	for (idx_t e = rows->first[node]; e < rows->first[node + 1]; e++) {
		uint32_t part = smoothing->labels[rows->to[e]], i = 0;

		if (part == from) {
			stay += rows->weights[e];
			continue;
		}
		while (i < count && parts[i] != part)
			i++;
		if (i == ARRAY_COUNT(parts))
			continue;
		if (i == count) {
			parts[count] = part;
			pulls[count++] = 0;
		}
		pulls[i] += rows->weights[e];
	}
	strongest = stay;
	for (uint32_t i = 0; i < count; i++)
		if (pulls[i] > strongest &&
		    smoothing->weights[parts[i]] + weight <= smoothing->most[parts[i]]) {
			strongest = pulls[i];
			best = parts[i];
		}
	if (best == from || smoothing->weights[from] - weight < smoothing->least[from])
		return false;
	smoothing->weights[from] -= weight;
	smoothing->weights[best] += weight;
	smoothing->labels[node] = best;
	return true;
}

static int smooth(uint32_t *labels, const struct rows *rows, uint32_t node_count,
		  uint32_t part_count, const float *shares)
{
	struct smoothing smoothing = {
		.rows = rows,
		.labels = labels,
		.weights = calloc(part_count, sizeof(*smoothing.weights)),
		.least = calloc(part_count, sizeof(*smoothing.least)),
		.most = calloc(part_count, sizeof(*smoothing.most)),
	};
	int rc = smoothing.weights && smoothing.least && smoothing.most ? 0 : -ENOMEM;
	bool moved = rc == 0;
	double total = 0.0;

	for (uint32_t i = 0; rc == 0 && i < node_count; i++) {
		smoothing.weights[labels[i]] += rows->node_weights[i];
		total += rows->node_weights[i];
	}
	for (uint32_t p = 0; rc == 0 && p < part_count; p++) {
		double wanted =
			total * (shares && part_count == 2 ? (double)shares[p] : 1.0 / part_count);

		smoothing.most[p] = (int64_t)(wanted * (1.0 + IMBALANCE / 1000.0));
		smoothing.least[p] = (int64_t)(wanted * (1.0 - IMBALANCE / 1000.0));
	}
	for (int pass = 0; moved && pass < SMOOTHING_PASSES; pass++) {
		moved = false;
		for (uint32_t i = 0; i < node_count; i++)
			moved = move_node(&smoothing, i) || moved;
	}
	free(smoothing.weights);
	free(smoothing.least);
	free(smoothing.most);
	return rc;
}

static int divide_clusters(uint32_t *labels, const struct graph *graph, uint32_t part_count,
			   const float *shares, int64_t cluster_weight)
{
	uint32_t *cluster_of = malloc(graph->node_count * sizeof(*cluster_of)), *parts = NULL;
	struct graph clusters = { 0 };
	struct rows rows;
	int rc = rows_init(&rows, graph);

	if (!cluster_of)
		rc = -ENOMEM;
	if (rc == 0)
		rc = graph_of_clusters(
			&clusters, &rows, graph->node_count, cluster_of,
			grow_clusters(cluster_of, &rows, graph->node_count, cluster_weight));
	if (rc == 0) {
		parts = malloc(clusters.node_count * sizeof(*parts));
		/* Where nodes are too heavy or too lonely to form clusters, METIS gets them as they
		 * are. */
		rc = !parts ? -ENOMEM
		     : clusters.node_count < graph->node_count - graph->node_count / 4
			     ? graph_divide(parts, &clusters, part_count, shares)
			     : divide_unclustered(parts, &clusters, part_count, shares);
	}
	for (uint32_t i = 0; rc == 0 && i < graph->node_count; i++)
		labels[i] = parts[cluster_of[i]];
	if (rc == 0)
		rc = smooth(labels, &rows, graph->node_count, part_count, shares);
	graph_finish(&clusters);
	rows_finish(&rows);
	free(cluster_of);
	free(parts);
	return rc;
}

/* Returns the weight of the clusters that a graph is to be shrunk to, or 0: it is small enough. */
static int64_t cluster_weight_for(const struct graph *graph, uint32_t part_count)
{
	double nodes = graph->node_count / ((double)CLUSTERS_A_PART * part_count);
	double total = 0.0;

	if (nodes < 2.0)
		return 0;
	for (uint32_t i = 0; i < graph->node_count; i++)
		total += graph->node_weights[i];
	return (int64_t)(total / graph->node_count * fmin(nodes, CLUSTER_NODES));
}

int graph_divide(uint32_t *labels, const struct graph *graph, uint32_t part_count,
		 const float *shares)
{
	int64_t cluster_weight;

	if (part_count <= 1 || graph->node_count <= part_count) {
		for (uint32_t i = 0; i < graph->node_count; i++)
			labels[i] = part_count <= 1 ? 0 : i;
		return 0;
	}
	cluster_weight = cluster_weight_for(graph, part_count);
	return cluster_weight > 0
		       ? divide_clusters(labels, graph, part_count, shares, cluster_weight)
		       : divide_unclustered(labels, graph, part_count, shares);
}
