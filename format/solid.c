/* Encodes, decodes and checks the octree of where an eye may be, and finds its cells.
 *
 * The states of all children are coded in breadth-first order, each by a model that is chosen by
 * what both sides already know of the cells around it: on the low side of each axis the cell of the
 * same size, on the high side the one of its parent's size. A surface goes on as it came, so most
 * states take a fraction of a bit. */
#include "format/solid.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/symbol_coder.h"

enum {
	VERSION = 1,
	ALL_FREE = 0,
	ALL_FULL = 0x5555,
	SIDES = 16, /* of a model's number: how many of three cells are free, how many full */
	METRES_MAX = 1000000
};

static const char magic[4] = "GPso";

uint32_t solid_child_node(const struct solid_node *node, uint32_t child)
{
	/* SOLID_DIVIDED is the only state with the upper bit. */
	const uint32_t below = node->states & 0xaaaau & ((1u << 2 * child) - 1);

	return node->first + (uint32_t)__builtin_popcount(below);
}

void solid_find(const struct solid *solid, const int32_t place[3], struct solid_cell *out)
{
	uint32_t at = 0;

	for (uint32_t bit = solid->depth; bit-- > 0;) {
		const struct solid_node *node = &solid->nodes[at];
		const uint32_t child = (uint32_t)(place[0] >> bit & 1) |
				       (uint32_t)(place[1] >> bit & 1) << 1 |
				       (uint32_t)(place[2] >> bit & 1) << 2;
		const enum solid_state state = solid_child_state(node, child);

		if (state != SOLID_DIVIDED) {
			out->side = 1 << bit;
			for (int axis = 0; axis < 3; axis++)
				out->low[axis] = place[axis] & -out->side;
			out->state = state;
			out->id = SOLID_CHILDREN * at + child;
			return;
		}
		at = solid_child_node(node, child);
	}
}

/* ---- the coder, both directions */

/* A cell of a level beside a node: SIDE_FREE, SIDE_FULL, or the index of the node it is. */
#define SIDE_FREE UINT32_MAX
#define SIDE_FULL (UINT32_MAX - 1)

struct spot {
	uint32_t id;              /* 8 times the parent's node, and the child's number there */
	uint32_t low[3], high[3]; /* the cells of a node's own size beside it, along each axis */
};

struct walk {
	struct solid *solid;
	struct symbol_coder coder;
	struct symbol_model (*models)[SIDES][SIDES]; /* owned; [0]: cells that may be divided */
	struct spot *spots;                          /* owned; of each node */
	uint32_t known; /* nodes that have a spot: those before, and their children */
};

/* Returns what a child is that both sides know. */
static uint32_t side_of(const struct walk *walk, uint32_t node, uint32_t child)
{
	const struct solid_node *n = &walk->solid->nodes[node];
	const enum solid_state state = solid_child_state(n, child);

	return state == SOLID_FREE   ? SIDE_FREE
	       : state == SOLID_FULL ? SIDE_FULL
				     : solid_child_node(n, child);
}

/* Looks around a node: at its siblings, and at the children of the cells around its parent. What is
 * outside of the root is free. */
static void look_around(const struct walk *walk, uint32_t at)
{
	struct spot *spot = &walk->spots[at];
	const struct spot *parent = &walk->spots[spot->id / SOLID_CHILDREN];
	const uint32_t child = spot->id % SOLID_CHILDREN;

	for (uint32_t axis = 0; axis < 3; axis++) {
		const bool is_high = child >> axis & 1;
		const uint32_t beside = child ^ 1u << axis;
		uint32_t outer, inner;

		if (at == 0) {
			spot->low[axis] = spot->high[axis] = SIDE_FREE;
			continue;
		}
		outer = is_high ? parent->high[axis] : parent->low[axis];
		if (outer < SIDE_FULL)
			outer = side_of(walk, outer, beside);
		inner = side_of(walk, spot->id / SOLID_CHILDREN, beside);
		spot->low[axis] = is_high ? inner : outer;
		spot->high[axis] = is_high ? outer : inner;
	}
}

static void tally(uint32_t *sides, uint32_t side)
{
	*sides += side == SIDE_FREE ? 1 : side == SIDE_FULL ? 4 : 0;
}

static void tally_state(uint32_t *sides, uint32_t state)
{
	*sides += state == SOLID_FREE ? 1 : state == SOLID_FULL ? 4 : 0;
}

static struct symbol_model *model_of(const struct walk *walk, const struct spot *spot,
				     uint32_t states, uint32_t child, bool last)
{
	uint32_t low = 0, high = 0;

	for (uint32_t axis = 0; axis < 3; axis++) {
		const uint32_t beside = child ^ 1u << axis, before = spot->low[axis];

		if (child >> axis & 1) {
			tally_state(&low, states >> 2 * beside & 3);
			tally(&high, spot->high[axis]);
		} else if (before < SIDE_FULL) {
			tally_state(&low, solid_child_state(&walk->solid->nodes[before], beside));
		} else {
			tally(&low, before);
		}
	}
	return &walk->models[last][low][high];
}

/* Codes a node's states and gives its divided children their spots. Returns -EBADMSG if they are
 * not those of a node. */
static int code_node(struct walk *walk, uint32_t at, uint32_t level)
{
	struct solid_node *node = &walk->solid->nodes[at];
	const bool last = level + 1 == walk->solid->depth;
	uint32_t states = 0, symbols = last ? 2 : 3;

	look_around(walk, at);
	node->first = walk->known;
	for (uint32_t child = 0; child < SOLID_CHILDREN; child++) {
		struct symbol_model *model = model_of(walk, &walk->spots[at], states, child, last);
		const uint32_t state =
			symbol_code(&walk->coder, model, symbols, node->states >> 2 * child & 3);

		states |= state << 2 * child;
		if (state != SOLID_DIVIDED)
			continue;
		if (walk->known >= walk->solid->node_count)
			return -EBADMSG;
		walk->spots[walk->known].id = SOLID_CHILDREN * at + child;
		walk->known++;
	}
	node->states = (uint16_t)states;
	return states == ALL_FREE || states == ALL_FULL ? -EBADMSG : 0;
}

/* Codes all nodes, level by level. */
static int code_nodes(struct walk *walk)
{
	const uint32_t count = walk->solid->node_count;
	uint32_t at = 0;
	int rc = 0;

	walk->models = calloc(2, sizeof(*walk->models));
	walk->spots = calloc(count, sizeof(*walk->spots));
	if (!walk->models || !walk->spots)
		rc = -ENOMEM;
	walk->known = 1;
	for (uint32_t level = 0; rc == 0 && level < walk->solid->depth; level++)
		for (const uint32_t end = walk->known; rc == 0 && at < end; at++)
			rc = code_node(walk, at, level);
	free(walk->models);
	free(walk->spots);
	return rc == 0 && walk->known != count ? -EBADMSG : rc;
}

static bool is_sane(const struct solid *solid)
{
	bool good = solid->depth >= 1 && solid->depth <= SOLID_DEPTH_MAX &&
		    solid->node_count >= 1 && solid->node_count <= SOLID_NODES_MAX &&
		    isfinite(solid->cell_m) && solid->cell_m > 0 && solid->cell_m < METRES_MAX &&
		    isfinite(solid->room_m) && solid->room_m >= 0;

	for (int axis = 0; axis < 3; axis++)
		good = good && isfinite(solid->low_m[axis]) &&
		       fabsf(solid->low_m[axis]) < METRES_MAX;
	return good;
}

/* ---- encoding */

/* Returns whether the nodes are in order, each below its parent and none but the root without one.
 */
static bool nodes_are_sane(const struct solid *solid)
{
	uint32_t level_end = 1, known = 1, level = 0;

	for (uint32_t i = 0; i < solid->node_count; i++) {
		const uint32_t states = solid->nodes[i].states;

		if (i == level_end) {
			level_end = known;
			level++;
		}
		if (i >= known || solid->nodes[i].first != known || level >= solid->depth ||
		    states == ALL_FREE || states == ALL_FULL)
			return false;
		for (uint32_t child = 0; child < SOLID_CHILDREN; child++)
			if ((states >> 2 * child & 3) > SOLID_DIVIDED)
				return false;
		known += (uint32_t)__builtin_popcount(states & 0xaaaau);
		if (known > solid->node_count ||
		    (level + 1 == solid->depth && (states & 0xaaaau) != 0))
			return false;
	}
	return known == solid->node_count;
}

int solid_encode(struct buffer *out, const struct solid *solid)
{
	struct symbol_encoder encoder;
	/* The nodes are read, and written with what they hold. */
	struct solid copy = *solid;
	struct walk walk = { .solid = &copy, .coder = { .encoder = &encoder } };
	int rc;

	if (!is_sane(solid) || !nodes_are_sane(solid))
		return -EINVAL;
	symbol_encoder_init(&encoder);
	rc = code_nodes(&walk);
	buffer_put(out, magic, sizeof(magic));
	buffer_put_u8(out, VERSION);
	buffer_put_u8(out, (uint8_t)solid->depth);
	for (int axis = 0; axis < 3; axis++)
		buffer_put_f32(out, solid->low_m[axis]);
	buffer_put_f32(out, solid->cell_m);
	buffer_put_f32(out, solid->room_m);
	buffer_put_u32(out, solid->node_count);
	if (rc == 0)
		rc = symbol_encoder_put(&encoder, out);
	symbol_encoder_finish(&encoder);
	return rc < 0 ? rc : out->error;
}

/* ---- decoding */

static int read_header(struct solid *solid, struct reader *reader)
{
	const struct bytes mark = reader_bytes(reader, sizeof(magic));
	const uint8_t version = reader_u8(reader);

	solid->depth = reader_u8(reader);
	for (int axis = 0; axis < 3; axis++)
		solid->low_m[axis] = reader_f32(reader);
	solid->cell_m = reader_f32(reader);
	solid->room_m = reader_f32(reader);
	solid->node_count = reader_u32(reader);
	return reader->failed || memcmp(mark.data, magic, sizeof(magic)) != 0 ||
			       version != VERSION || !is_sane(solid)
		       ? -EBADMSG
		       : 0;
}

int solid_decode(struct solid *out, struct bytes object)
{
	struct solid solid = { 0 };
	struct walk walk = { .solid = &solid };
	struct reader reader;
	int rc;

	*out = solid;
	reader_init(&reader, object);
	rc = read_header(&solid, &reader);
	if (rc == 0)
		rc = symbol_decoder_init(&walk.coder.decoder, &reader);
	if (rc == 0) {
		solid.nodes = calloc(solid.node_count, sizeof(*solid.nodes));
		rc = solid.nodes ? code_nodes(&walk) : -ENOMEM;
	}
	if (rc == 0 && (reader_left(&reader) > 0 || !symbol_decoder_complete(&walk.coder.decoder)))
		rc = -EBADMSG;
	if (rc < 0)
		solid_finish(&solid);
	*out = solid;
	return rc;
}

void solid_finish(struct solid *solid)
{
	if (!solid)
		return;
	free(solid->nodes);
	*solid = (struct solid){ 0 };
}
