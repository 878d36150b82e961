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

struct walk {
	struct solid *solid;
	struct symbol_coder coder;
	struct symbol_model (*models)[SIDES][SIDES]; /* owned; [0]: cells that may be divided */
	uint16_t (*places)[3];                       /* owned; of each node, on its own level */
	uint32_t known; /* nodes that have a place: those before, and their children */
};

/* Finds a cell on a level that both sides know; the root is level 0. Writes the node of one that is
 * divided. What is outside of the root is free. */
static enum solid_state look(const struct walk *walk, uint32_t level, const int32_t place[3],
			     uint32_t *node)
{
	*node = 0;
	for (int axis = 0; axis < 3; axis++)
		if (place[axis] < 0 || place[axis] >> level != 0)
			return SOLID_FREE;
	for (uint32_t bit = level; bit-- > 0;) {
		const struct solid_node *n = &walk->solid->nodes[*node];
		const uint32_t child = (uint32_t)(place[0] >> bit & 1) |
				       (uint32_t)(place[1] >> bit & 1) << 1 |
				       (uint32_t)(place[2] >> bit & 1) << 2;
		const enum solid_state state = solid_child_state(n, child);

		if (state != SOLID_DIVIDED)
			return state;
		*node = solid_child_node(n, child);
	}
	return SOLID_DIVIDED;
}

/* The six cells around a node, of its own size. */
struct around {
	enum solid_state low[3], high[3];
	uint32_t low_node[3];
};

static void look_around(const struct walk *walk, uint32_t at, uint32_t level, struct around *out)
{
	for (int axis = 0; axis < 3; axis++) {
		int32_t place[3] = { walk->places[at][0], walk->places[at][1],
				     walk->places[at][2] };
		uint32_t node;

		place[axis]--;
		out->low[axis] = look(walk, level, place, &out->low_node[axis]);
		place[axis] += 2;
		out->high[axis] = look(walk, level, place, &node);
	}
}

static void tally(uint32_t *sides, enum solid_state state)
{
	*sides += state == SOLID_FREE ? 1 : state == SOLID_FULL ? 4 : 0;
}

static struct symbol_model *model_of(const struct walk *walk, const struct around *around,
				     uint32_t states, uint32_t child, bool last)
{
	uint32_t low = 0, high = 0;

	for (uint32_t axis = 0; axis < 3; axis++) {
		const uint32_t beside = child ^ 1u << axis;

		if (child >> axis & 1) {
			tally(&low, (enum solid_state)(states >> 2 * beside & 3));
			tally(&high, around->high[axis]);
		} else if (around->low[axis] == SOLID_DIVIDED) {
			tally(&low, solid_child_state(&walk->solid->nodes[around->low_node[axis]],
						      beside));
		} else {
			tally(&low, around->low[axis]);
		}
	}
	return &walk->models[last][low][high];
}

/* Codes a node's states and gives its divided children their places. Returns -EBADMSG if they are
 * not those of a node. */
static int code_node(struct walk *walk, uint32_t at, uint32_t level)
{
	struct solid_node *node = &walk->solid->nodes[at];
	const bool last = level + 1 == walk->solid->depth;
	uint32_t states = 0, symbols = last ? 2 : 3;
	struct around around;

	look_around(walk, at, level, &around);
	node->first = walk->known;
	for (uint32_t child = 0; child < SOLID_CHILDREN; child++) {
		struct symbol_model *model = model_of(walk, &around, states, child, last);
		const uint32_t state =
			symbol_code(&walk->coder, model, symbols, node->states >> 2 * child & 3);

		states |= state << 2 * child;
		if (state != SOLID_DIVIDED)
			continue;
		if (walk->known >= walk->solid->node_count)
			return -EBADMSG;
		for (int axis = 0; axis < 3; axis++)
			walk->places[walk->known][axis] =
				(uint16_t)(2u * walk->places[at][axis] + (child >> axis & 1));
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
	walk->places = calloc(count, sizeof(*walk->places));
	if (!walk->models || !walk->places)
		rc = -ENOMEM;
	walk->known = 1;
	for (uint32_t level = 0; rc == 0 && level < walk->solid->depth; level++)
		for (const uint32_t end = walk->known; rc == 0 && at < end; at++)
			rc = code_node(walk, at, level);
	free(walk->models);
	free(walk->places);
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
