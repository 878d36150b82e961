/* A maximum flow by two search trees (Boykov and Kolmogorov 2004, reference 3 of P0): one grows
 * from the source, which is the part, and one from the sink, the rest. Where they meet, flow is
 * pushed along the path; branches that this cuts off look for another place in their tree. Graphs
 * of pictures have short paths, on which this is faster than general algorithms: docs/regions.md
 * compares it with igraph and Boost. */
#include "curator/select/min_cut.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"

/* Numbers of arcs; two arcs of one link are 2n and 2n + 1. */
enum { ARC_NONE = -1, ARC_TERMINAL = -2, ARC_ORPHAN = -3 };
enum { NODE_NONE = -1, NODE_LAST = -2 };
enum { SCALE = 1024, COST_MAX = 100000 };

struct arc {
	int32_t head, next; /* the node where it ends; the next arc of the node where it begins */
	int32_t residual;   /* how much more can flow */
};

struct node {
	int32_t first;       /* of its arcs */
	int32_t parent;      /* the arc to its parent in the tree, or ARC_NONE: in no tree */
	int32_t next_active; /* NODE_NONE: not in the queue; NODE_LAST: the last in it */
	int32_t terminal;    /* what can still flow from the source, or, negative, to the sink */
	uint32_t stamp, distance; /* to the terminal; valid if stamp is that of the last search */
	bool of_sink;             /* which tree it is in */
};

struct flow {
	struct node *nodes; /* arrays owned */
	struct arc *arcs;
	int32_t *orphans; /* a stack */
	uint32_t node_count, orphan_count, now;
	int32_t active_first, active_last;
	int error;
};

/* ---- queues */

static void make_active(struct flow *flow, int32_t n)
{
	struct node *node = &flow->nodes[n];

	if (node->next_active != NODE_NONE)
		return;
	node->next_active = NODE_LAST;
	if (flow->active_first == NODE_NONE)
		flow->active_first = n;
	else
		flow->nodes[flow->active_last].next_active = n;
	flow->active_last = n;
}

/* Takes the next node from the queue that is still in a tree; NODE_NONE: there is none. */
static int32_t next_active(struct flow *flow)
{
	while (flow->active_first != NODE_NONE) {
		const int32_t n = flow->active_first;
		struct node *node = &flow->nodes[n];

		flow->active_first = node->next_active == NODE_LAST ? NODE_NONE : node->next_active;
		node->next_active = NODE_NONE;
		if (node->parent != ARC_NONE)
			return n;
	}
	return NODE_NONE;
}

static void make_orphan(struct flow *flow, int32_t n)
{
	flow->nodes[n].parent = ARC_ORPHAN;
	flow->orphans[flow->orphan_count++] = n;
}

/* ---- growing */

/* What can flow towards the sink between a node of one tree and what its arc leads to. */
static int32_t room_along(const struct flow *flow, int32_t arc, bool of_sink)
{
	return flow->arcs[of_sink ? arc ^ 1 : arc].residual;
}

/* Takes a neighbour into the tree of n; or, if it is there already, makes n its parent where that
 * brings it nearer to the terminal. */
static void take_in(struct flow *flow, int32_t n, int32_t arc)
{
	const struct node *node = &flow->nodes[n];
	const int32_t m = flow->arcs[arc].head;
	struct node *other = &flow->nodes[m];

	if (other->parent == ARC_NONE) {
		other->of_sink = node->of_sink;
		make_active(flow, m);
	} else if (other->stamp > node->stamp || other->distance <= node->distance) {
		return;
	}
	other->parent = arc ^ 1;
	other->stamp = node->stamp;
	other->distance = node->distance + 1;
}

/* Grows the tree at a node. Returns an arc from the source's tree to the sink's along which more
 * can flow, or ARC_NONE. */
static int32_t grow(struct flow *flow, int32_t n)
{
	const struct node *node = &flow->nodes[n];

	for (int32_t arc = node->first; arc != ARC_NONE; arc = flow->arcs[arc].next) {
		const struct node *other = &flow->nodes[flow->arcs[arc].head];

		if (room_along(flow, arc, node->of_sink) == 0)
			continue;
		if (other->parent != ARC_NONE && other->of_sink != node->of_sink)
			return node->of_sink ? arc ^ 1 : arc;
		take_in(flow, n, arc);
	}
	return ARC_NONE;
}

/* ---- pushing */

/* Lowers *most to what can flow between a node and its terminal. */
static void find_room(const struct flow *flow, int32_t n, bool of_sink, int32_t *most)
{
	int32_t room;

	while (flow->nodes[n].parent != ARC_TERMINAL) {
		const int32_t arc = flow->nodes[n].parent;

		room = flow->arcs[of_sink ? arc : arc ^ 1].residual;
		*most = room < *most ? room : *most;
		n = flow->arcs[arc].head;
	}
	room = abs(flow->nodes[n].terminal);
	*most = room < *most ? room : *most;
}

static void push_to_terminal(struct flow *flow, int32_t n, bool of_sink, int32_t amount)
{
	while (flow->nodes[n].parent != ARC_TERMINAL) {
		const int32_t arc = flow->nodes[n].parent, along = of_sink ? arc : arc ^ 1;

		flow->arcs[along].residual -= amount;
		flow->arcs[along ^ 1].residual += amount;
		if (flow->arcs[along].residual == 0)
			make_orphan(flow, n);
		n = flow->arcs[arc].head;
	}
	flow->nodes[n].terminal += of_sink ? amount : -amount;
	if (flow->nodes[n].terminal == 0)
		make_orphan(flow, n);
}

/* Pushes as much as possible along the path through an arc that joins the trees. */
static void push(struct flow *flow, int32_t arc)
{
	const int32_t from = flow->arcs[arc ^ 1].head, to = flow->arcs[arc].head;
	int32_t amount = flow->arcs[arc].residual;

	find_room(flow, from, false, &amount);
	find_room(flow, to, true, &amount);
	flow->arcs[arc].residual -= amount;
	flow->arcs[arc ^ 1].residual += amount;
	push_to_terminal(flow, from, false, amount);
	push_to_terminal(flow, to, true, amount);
}

/* ---- adopting */

/* Returns how far a node of a tree is from its terminal; UINT32_MAX: it hangs on an orphan. */
static uint32_t find_distance(const struct flow *flow, int32_t n)
{
	uint32_t distance = 0;

	for (;;) {
		const struct node *node = &flow->nodes[n];

		if (node->stamp == flow->now)
			return distance + node->distance;
		if (node->parent == ARC_ORPHAN)
			return UINT32_MAX;
		distance++;
		if (node->parent == ARC_TERMINAL)
			return distance;
		n = flow->arcs[node->parent].head;
	}
}

/* Notes along the way from a node what find_distance returned for it. */
static void note_distances(struct flow *flow, int32_t n, uint32_t distance)
{
	while (flow->nodes[n].stamp != flow->now) {
		struct node *node = &flow->nodes[n];

		node->stamp = flow->now;
		node->distance = distance--;
		if (node->parent == ARC_TERMINAL)
			return;
		n = flow->arcs[node->parent].head;
	}
}

/* What hung on an orphan that found no parent: its children become orphans, and neighbours that
 * could take it in are active again. */
static void let_go(struct flow *flow, int32_t n)
{
	struct node *node = &flow->nodes[n];

	for (int32_t arc = node->first; arc != ARC_NONE; arc = flow->arcs[arc].next) {
		const int32_t m = flow->arcs[arc].head;
		const struct node *other = &flow->nodes[m];

		if (other->of_sink != node->of_sink || other->parent == ARC_NONE)
			continue;
		if (room_along(flow, arc ^ 1, node->of_sink) > 0)
			make_active(flow, m);
		if (other->parent >= 0 && flow->arcs[other->parent].head == n)
			make_orphan(flow, m);
	}
	node->parent = ARC_NONE;
}

/* Gives an orphan the parent that is nearest to the terminal. */
static void adopt(struct flow *flow, int32_t n)
{
	struct node *node = &flow->nodes[n];
	int32_t best = ARC_NONE;
	uint32_t nearest = UINT32_MAX;

	for (int32_t arc = node->first; arc != ARC_NONE; arc = flow->arcs[arc].next) {
		const int32_t m = flow->arcs[arc].head;
		const struct node *other = &flow->nodes[m];

		if (room_along(flow, arc ^ 1, node->of_sink) == 0 ||
		    other->of_sink != node->of_sink || other->parent == ARC_NONE)
			continue;
		const uint32_t distance = find_distance(flow, m);
		if (distance == UINT32_MAX)
			continue;
		if (distance < nearest) {
			nearest = distance;
			best = arc;
		}
		note_distances(flow, m, distance);
	}
	if (best == ARC_NONE) {
		let_go(flow, n);
		return;
	}
	node->parent = best;
	node->stamp = flow->now;
	node->distance = nearest + 1;
}

/* ---- the whole */

/* Every node with a way to or from a terminal is the root of a tree. */
static void plant(struct flow *flow)
{
	flow->active_first = flow->active_last = NODE_NONE;
	for (uint32_t n = 0; n < flow->node_count; n++) {
		struct node *node = &flow->nodes[n];

		node->next_active = NODE_NONE;
		node->parent = ARC_NONE;
		if (node->terminal == 0)
			continue;
		node->of_sink = node->terminal < 0;
		node->parent = ARC_TERMINAL;
		node->distance = 1;
		make_active(flow, (int32_t)n);
	}
}

static void run(struct flow *flow)
{
	int32_t n;

	plant(flow);
	while ((n = next_active(flow)) != NODE_NONE) {
		int32_t arc;

		/* The node stays at its turn as long as paths are found at it. */
		while (flow->nodes[n].parent != ARC_NONE && (arc = grow(flow, n)) != ARC_NONE) {
			flow->now++;
			push(flow, arc);
			while (flow->orphan_count > 0)
				adopt(flow, flow->orphans[--flow->orphan_count]);
		}
	}
}

static int32_t whole(float cost)
{
	return (int32_t)lrintf(vec_least(cost, COST_MAX) * SCALE);
}

static void add_arc(struct flow *flow, int32_t arc, uint32_t from, uint32_t to, int32_t residual)
{
	flow->arcs[arc] = (struct arc){ (int32_t)to, flow->nodes[from].first, residual };
	flow->nodes[from].first = arc;
}

int min_cut(bool *in_part, const struct min_cut_node *nodes, uint32_t node_count,
	    const struct min_cut_link *links, uint32_t link_count)
{
	struct flow flow = { .node_count = node_count };

	flow.nodes = calloc((size_t)node_count + 1, sizeof(*flow.nodes));
	flow.arcs = malloc((2 * (size_t)link_count + 1) * sizeof(*flow.arcs));
	/* A node is an orphan once at a time. */
	flow.orphans = malloc(((size_t)node_count + 1) * sizeof(*flow.orphans));
	if (flow.nodes && flow.arcs && flow.orphans) {
		for (uint32_t n = 0; n < node_count; n++) {
			flow.nodes[n].first = ARC_NONE;
			flow.nodes[n].terminal =
				whole(nodes[n].rest_cost) - whole(nodes[n].part_cost);
		}
		for (uint32_t n = 0; n < link_count; n++) {
			const int32_t cost = whole(links[n].cost);

			add_arc(&flow, 2 * (int32_t)n, links[n].a, links[n].b, cost);
			add_arc(&flow, 2 * (int32_t)n + 1, links[n].b, links[n].a, cost);
		}
		run(&flow);
		for (uint32_t n = 0; n < node_count; n++)
			in_part[n] = flow.nodes[n].parent != ARC_NONE && !flow.nodes[n].of_sink;
	} else {
		flow.error = -ENOMEM;
	}
	free(flow.nodes);
	free(flow.arcs);
	free(flow.orphans);
	return flow.error;
}
