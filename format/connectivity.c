/* Codes the triangles of a patch group as they grow from the edges of those before. */
#include "format/connectivity.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define NONE UINT32_MAX

/* Where the third corner of the triangle beyond a gate is. The order is that of their frequency. */
enum operation {
	OP_NEW,      /* a vertex that was not coded before */
	OP_PREVIOUS, /* where the previous gate begins: both gates close */
	OP_OPEN,     /* there is no triangle */
	OP_NEXT,     /* where the next gate ends: both gates close */
	OP_LATER,    /* the triangle belongs to a later patch; how many later follows */
	OP_NEXT_2,   /* where the second next gate ends */
	OP_PREVIOUS_2,
	OP_FAR_NEXT, /* as before; how many gates away follows */
	OP_FAR_PREVIOUS,
	OP_ANY, /* any vertex; its number follows */
	OP_COUNT
};

enum { FAR_MIN = 3, FAR_MAX = 255, DEGREE_MAX = 255 };

enum gate_state { GATE_CLOSED, GATE_ALIVE, GATE_OPEN };

/* A directed edge of the border of what is coded, as the triangle beyond it has it. Gates form
 * loops around the holes in what is coded. */
struct gate {
	uint32_t from, to, apex; /* apex: the third corner of the triangle on this side */
	uint32_t previous, next; /* in the loop; perhaps closed ones, never out of range */
	uint32_t below;          /* in the stack of its patch; NONE: the last one */
	enum gate_state state;
};

enum { DEGREES_TO = 5, DEGREES_FROM = 4 };

/* What the machine knows about a vertex of the group. */
struct corner {
	uint8_t user;    /* the last patch that has it, plus one; 0: none yet */
	uint8_t degree;  /* triangles so far */
	uint16_t number; /* in the patch that has it */
};

struct walk {
	struct connectivity *mesh;
	struct patch_source *source; /* NULL: decoding */
	struct gate *gates;          /* owned; three a triangle are enough */
	uint32_t gate_count;
	uint32_t tops[GROUP_PATCHES_MAX]; /* stack of gates that wait, for each patch */
	struct corner *corners;           /* owned; for each vertex of the group */
	uint32_t *names; /* owned; encoding: the number of each vertex of the source, or NONE */
	/* the patch that is coded: its place in members and indices, and what it has so far */
	uint32_t patch, first_member, first_triangle, member_count, triangle_count;
	uint32_t loose; /* encoding: place in source->loose */
	struct symbol_model operations[4 * DEGREES_TO * DEGREES_FROM];
	struct symbol_model known, later, far;
};

/* Where the third corner is, as the encoder found it. */
struct choice {
	enum operation operation;
	uint32_t third;    /* OP_ANY; OP_NEW: of the source */
	uint32_t distance; /* OP_FAR_...; OP_LATER: patches */
};

static uint32_t add_gate(struct walk *walk, uint32_t from, uint32_t to, uint32_t apex)
{
	struct gate *gate = &walk->gates[walk->gate_count];

	*gate = (struct gate){ .from = from, .to = to, .apex = apex, .state = GATE_ALIVE };
	return walk->gate_count++;
}

static void link_gates(struct walk *walk, uint32_t a, uint32_t b)
{
	walk->gates[a].next = b;
	walk->gates[b].previous = a;
}

static void push(struct walk *walk, uint32_t gate, uint32_t patch)
{
	walk->gates[gate].below = walk->tops[patch];
	walk->tops[patch] = gate;
}

/* Takes the last gate that waits for this patch and is still alive; NONE if there is none. */
static uint32_t pop(struct walk *walk)
{
	uint32_t *top = &walk->tops[walk->patch];

	while (*top != NONE) {
		uint32_t gate = *top;

		*top = walk->gates[gate].below;
		if (walk->gates[gate].state == GATE_ALIVE)
			return gate;
	}
	return NONE;
}

/* Numbers the vertex within the patch. Returns false if the patch has no room for it. */
static force_inline bool use_vertex(struct walk *walk, uint32_t vertex)
{
	struct corner *corner = &walk->corners[vertex];

	if (corner->user == walk->patch + 1)
		return true;
	if (walk->member_count == walk->mesh->patch_vertices[walk->patch])
		return false;
	corner->user = (uint8_t)(walk->patch + 1);
	corner->number = (uint16_t)walk->member_count;
	walk->mesh->members[walk->first_member + walk->member_count++] = vertex;
	return true;
}

/* Adds a vertex that is predicted by step. source is its number in the source. Returns NONE if the
 * patch has no room for it. */
static uint32_t add_vertex(struct walk *walk, struct predict_step step, uint32_t source)
{
	uint32_t vertex = walk->mesh->vertex_count;

	if (walk->member_count == walk->mesh->patch_vertices[walk->patch])
		return NONE;
	walk->mesh->steps[vertex] = step;
	walk->mesh->vertex_count++;
	if (walk->source) {
		walk->names[source] = vertex;
		walk->mesh->sources[vertex] = source;
	}
	return vertex;
}

/* The vertex before is the best guess where nothing else is known. */
static struct predict_step step_after(const struct walk *walk)
{
	uint32_t count = walk->mesh->vertex_count;

	return (struct predict_step){ count > 0, { count > 0 ? count - 1 : 0 } };
}

static force_inline bool add_triangle(struct walk *walk, const uint32_t corners[3])
{
	uint16_t *indices =
		walk->mesh->indices + 3 * (size_t)(walk->first_triangle + walk->triangle_count);

	for (int i = 0; i < 3; i++) {
		struct corner *corner = &walk->corners[corners[i]];

		if (!use_vertex(walk, corners[i]))
			return false;
		indices[i] = corner->number;
		corner->degree += corner->degree < DEGREE_MAX;
	}
	walk->triangle_count++;
	return true;
}

/* ---- the machine */

/* The two outer edges of a new triangle become gates. */
static void grow(struct walk *walk, const struct gate *gate, uint32_t third, uint32_t out[2])
{
	out[0] = add_gate(walk, gate->from, third, gate->to);
	out[1] = add_gate(walk, third, gate->to, gate->from);
	push(walk, out[1], walk->patch);
	push(walk, out[0], walk->patch);
}

static void grow_alone(struct walk *walk, const struct gate *gate, uint32_t third)
{
	uint32_t made[2];

	grow(walk, gate, third, made);
	link_gates(walk, gate->previous, made[0]);
	link_gates(walk, made[0], made[1]);
	link_gates(walk, made[1], gate->next);
}

/* The loop touches itself at the third corner, where the gate far begins, and becomes two. */
static void split(struct walk *walk, const struct gate *gate, uint32_t far)
{
	uint32_t made[2], before = walk->gates[far].previous;

	grow(walk, gate, walk->gates[far].from, made);
	link_gates(walk, gate->previous, made[0]);
	link_gates(walk, made[0], far);
	link_gates(walk, before, made[1]);
	link_gates(walk, made[1], gate->next);
}

static void close_previous(struct walk *walk, const struct gate *gate)
{
	struct gate *previous = &walk->gates[gate->previous], *next = &walk->gates[gate->next];
	uint32_t made;

	previous->state = GATE_CLOSED;
	if (previous->previous == gate->next && next->state == GATE_ALIVE &&
	    next->to == previous->from) {
		next->state = GATE_CLOSED;
		return;
	}
	made = add_gate(walk, previous->from, gate->to, gate->from);
	link_gates(walk, previous->previous, made);
	link_gates(walk, made, gate->next);
	push(walk, made, walk->patch);
}

static void close_next(struct walk *walk, const struct gate *gate)
{
	struct gate *next = &walk->gates[gate->next];
	uint32_t made = add_gate(walk, gate->from, next->to, gate->to);
	uint32_t behind = next->next;

	next->state = GATE_CLOSED;
	link_gates(walk, gate->previous, made);
	link_gates(walk, made, behind);
	push(walk, made, walk->patch);
}

/* Returns the gate that begins at the end of the distance-th next gate, or that is the distance-th
 * previous one. */
static uint32_t far_gate(const struct walk *walk, const struct gate *gate, bool next,
			 uint32_t distance)
{
	uint32_t at = next ? gate->next : gate->previous;

	for (uint32_t i = 1; i < distance + next; i++)
		at = next ? walk->gates[at].next : walk->gates[at].previous;
	return at;
}

/* ---- what the encoder looks up */

/* Finds a vertex on the loop of a gate: returns its distance, 0 if it is too far or not on it. */
static uint32_t distance_to(const struct walk *walk, const struct gate *gate, uint32_t third,
			    bool *next)
{
	uint32_t ahead = gate->next, behind = gate->previous;

	for (uint32_t distance = 1; distance <= FAR_MAX; distance++) {
		*next = walk->gates[ahead].to == third &&
			walk->gates[walk->gates[ahead].next].from == third;
		if (*next || walk->gates[behind].from == third)
			return distance;
		ahead = walk->gates[ahead].next;
		behind = walk->gates[behind].previous;
	}
	return 0;
}

static struct choice choose_known(const struct walk *walk, const struct gate *gate, uint32_t third)
{
	struct choice choice = { .operation = OP_ANY, .third = third };
	bool next;

	if (third == walk->gates[gate->previous].from)
		return (struct choice){ .operation = OP_PREVIOUS };
	if (third == walk->gates[gate->next].to)
		return (struct choice){ .operation = OP_NEXT };
	choice.distance = distance_to(walk, gate, third, &next);
	if (choice.distance >= FAR_MIN)
		choice.operation = next ? OP_FAR_NEXT : OP_FAR_PREVIOUS;
	else if (choice.distance == 2)
		choice.operation = next ? OP_NEXT_2 : OP_PREVIOUS_2;
	return choice;
}

/* Finds the triangle beyond a gate, and marks it as coded if it is of this patch. */
static struct choice choose(struct walk *walk, const struct gate *gate)
{
	const uint32_t *sources = walk->mesh->sources;
	uint32_t edge = patch_source_find(walk->source, sources[gate->from], sources[gate->to]);
	uint32_t third, patch;

	if (edge == SOURCE_NONE)
		return (struct choice){ .operation = OP_OPEN };
	patch = walk->source->patches[edge / 3];
	if (patch != walk->patch)
		return (struct choice){ .operation = OP_LATER, .distance = patch - walk->patch };
	walk->source->coded[edge / 3] = true;
	third = walk->source->triangles[edge / 3][(edge % 3 + 2) % 3];
	if (walk->names[third] == NONE)
		return (struct choice){ .operation = OP_NEW, .third = third };
	return choose_known(walk, gate, walk->names[third]);
}

/* ---- both directions */

static uint32_t bit_length(uint32_t number)
{
	return number == 0 ? 0 : 32 - (uint32_t)__builtin_clz(number);
}

/* Codes the number of a vertex. Returns NONE if there is no such vertex. */
static force_inline uint32_t code_vertex(struct walk *walk, struct symbol_coder *coder,
					 uint32_t vertex)
{
	uint32_t count = walk->mesh->vertex_count;

	vertex = symbol_code_bits(coder, vertex, bit_length(count));
	return vertex < count ? vertex : NONE;
}

/* A corner is closed soon if it has many triangles; nothing can close over an open edge. */
static struct symbol_model *operation_model(struct walk *walk, const struct gate *gate)
{
	uint32_t to = walk->corners[gate->to].degree, from = walk->corners[gate->from].degree;
	uint32_t neighbours = (walk->gates[gate->previous].state == GATE_ALIVE) * 2 +
			      (walk->gates[gate->next].state == GATE_ALIVE);

	to = to < 3 ? 0 : to < 6 ? to - 2 : DEGREES_TO - 1;
	from = from < 3 ? 0 : from < 5 ? from - 2 : DEGREES_FROM - 1;
	return &walk->operations[(neighbours * DEGREES_TO + to) * DEGREES_FROM + from];
}

/* Codes how far away the third corner is. Returns 0 if it is too far. */
static force_inline uint32_t code_far(struct walk *walk, struct symbol_coder *coder,
				      uint32_t distance)
{
	distance = FAR_MIN + symbol_code_number(coder, &walk->far, distance - FAR_MIN, 8);
	return distance <= FAR_MAX ? distance : 0;
}

/* Codes how many patches later the triangle comes, and lets the gate wait for that. */
static force_inline int code_later(struct walk *walk, struct symbol_coder *coder, uint32_t at,
				   uint32_t distance)
{
	distance = 1 + symbol_code_number(coder, &walk->later, distance - 1, 6);
	if (distance >= walk->mesh->patch_count - walk->patch)
		return -EBADMSG;
	push(walk, at, walk->patch + distance);
	return 0;
}

/* Codes the triangle beyond a gate, and moves the border over it. */
static force_inline int code_gate(struct walk *walk, struct symbol_coder *coder, uint32_t at)
{
	struct gate *gate = &walk->gates[at];
	struct choice choice = { 0 };
	uint32_t corners[3] = { gate->from, gate->to, NONE }, far;

	if (coder->encoder)
		choice = choose(walk, gate);
	choice.operation =
		symbol_code(coder, operation_model(walk, gate), OP_COUNT, choice.operation);
	if (choice.operation == OP_LATER)
		return code_later(walk, coder, at, choice.distance);
	gate->state = choice.operation == OP_OPEN ? GATE_OPEN : GATE_CLOSED;
	switch (choice.operation) {
	case OP_OPEN:
		return 0;
	case OP_NEW:
		corners[2] = add_vertex(
			walk, (struct predict_step){ 3, { gate->from, gate->to, gate->apex } },
			choice.third);
		if (corners[2] == NONE)
			return -EBADMSG;
		grow_alone(walk, gate, corners[2]);
		break;
	case OP_PREVIOUS:
		corners[2] = walk->gates[gate->previous].from;
		close_previous(walk, gate);
		break;
	case OP_NEXT:
		corners[2] = walk->gates[gate->next].to;
		close_next(walk, gate);
		break;
	case OP_ANY:
		corners[2] = code_vertex(walk, coder, choice.third);
		if (corners[2] == NONE)
			return -EBADMSG;
		grow_alone(walk, gate, corners[2]);
		break;
	default:
		choice.distance = choice.operation == OP_NEXT_2 || choice.operation == OP_PREVIOUS_2
					  ? 2
					  : code_far(walk, coder, choice.distance);
		if (choice.distance == 0)
			return -EBADMSG;
		far = far_gate(walk, gate,
			       choice.operation == OP_NEXT_2 || choice.operation == OP_FAR_NEXT,
			       choice.distance);
		corners[2] = walk->gates[far].from;
		split(walk, gate, far);
	}
	return add_triangle(walk, corners) ? 0 : -EBADMSG;
}

/* Codes a triangle that touches no gate. corners, of the source, only if encoding. */
static force_inline int code_seed(struct walk *walk, struct symbol_coder *coder,
				  const uint32_t *corners)
{
	uint32_t named[3];
	uint32_t gates[3];

	for (uint32_t i = 0; i < 3; i++) {
		uint32_t source = corners ? corners[i] : NONE;
		uint32_t name = corners ? walk->names[source] : NONE;
		struct predict_step step = { i, { named[0], i > 1 ? named[1] : 0 } };

		if (symbol_code(coder, &walk->known, 2, name != NONE) == 1)
			named[i] = code_vertex(walk, coder, name);
		else
			named[i] = add_vertex(walk, i == 0 ? step_after(walk) : step, source);
		if (named[i] == NONE || !use_vertex(walk, named[i]))
			return -EBADMSG;
	}
	if (!add_triangle(walk, named))
		return -EBADMSG;
	for (uint32_t i = 0; i < 3; i++) {
		uint32_t from = (4 - i) % 3, to = (3 - i) % 3;

		gates[i] = add_gate(walk, named[from], named[to], named[3 - from - to]);
		push(walk, gates[i], walk->patch);
	}
	for (uint32_t i = 0; i < 3; i++)
		link_gates(walk, gates[i], gates[(i + 1) % 3]);
	return 0;
}

/* Returns the next triangle of the patch that is not coded, and marks it. */
static const uint32_t *take_seed(struct walk *walk, uint32_t *at)
{
	while (walk->source->coded[*at])
		++*at;
	walk->source->coded[*at] = true;
	return walk->source->triangles[*at];
}

static force_inline int code_patch(struct walk *walk, struct symbol_coder *coder)
{
	uint32_t seed = walk->first_triangle;
	int rc = 0;

	while (rc == 0 && walk->triangle_count < walk->mesh->patch_triangles[walk->patch]) {
		uint32_t gate = pop(walk);

		if (gate != NONE)
			rc = code_gate(walk, coder, gate);
		else
			rc = code_seed(walk, coder, coder->encoder ? take_seed(walk, &seed) : NULL);
	}
	while (rc == 0 && walk->member_count < walk->mesh->patch_vertices[walk->patch]) {
		uint32_t source = walk->source ? walk->source->loose[walk->loose++] : NONE;

		if (!use_vertex(walk, add_vertex(walk, step_after(walk), source)))
			rc = -EBADMSG;
	}
	return rc;
}

static int allocate(struct walk *walk, uint32_t vertices, uint32_t triangles)
{
	struct connectivity *mesh = walk->mesh;

	mesh->steps = malloc(vertices * sizeof(*mesh->steps));
	mesh->members = malloc(vertices * sizeof(*mesh->members));
	mesh->indices = malloc(3 * (size_t)triangles * sizeof(*mesh->indices));
	walk->gates = malloc(3 * (size_t)triangles * sizeof(*walk->gates));
	walk->corners = calloc(vertices, sizeof(*walk->corners));
	if (!mesh->steps || !mesh->members || !mesh->indices || !walk->gates || !walk->corners)
		return -ENOMEM;
	if (!walk->source)
		return 0;
	mesh->sources = malloc(vertices * sizeof(*mesh->sources));
	walk->names = malloc(vertices * sizeof(*walk->names));
	if (!mesh->sources || !walk->names)
		return -ENOMEM;
	memset(walk->names, 0xff, vertices * sizeof(*walk->names));
	return 0;
}

static force_inline int code_patches_of(struct walk *walk, struct symbol_encoder *encoder,
					struct symbol_decoder *decoder)
{
	struct symbol_coder coder = { encoder, *decoder };
	const struct connectivity *mesh = walk->mesh;
	int rc = 0;

	for (uint32_t p = 0; p < mesh->patch_count; p++)
		walk->tops[p] = NONE;
	for (uint32_t p = 0; rc == 0 && p < mesh->patch_count; p++) {
		walk->patch = p;
		walk->member_count = walk->triangle_count = 0;
		rc = code_patch(walk, &coder);
		walk->first_member += mesh->patch_vertices[p];
		walk->first_triangle += mesh->patch_triangles[p];
	}
	*decoder = coder.decoder;
	return rc;
}

/* Compiled once for each direction. */
static int code_patches(struct walk *walk, struct symbol_coder *coder)
{
	return coder->encoder ? code_patches_of(walk, coder->encoder, &coder->decoder)
			      : code_patches_of(walk, NULL, &coder->decoder);
}

int connectivity_code(struct connectivity *mesh, struct symbol_coder *coder,
		      struct patch_source *source)
{
	struct walk *walk = calloc(1, sizeof(*walk));
	uint32_t vertices = 0, triangles = 0;
	int rc;

	if (!walk)
		return -ENOMEM;
	walk->mesh = mesh;
	walk->source = source;
	for (uint32_t p = 0; p < mesh->patch_count; p++) {
		vertices += mesh->patch_vertices[p];
		triangles += mesh->patch_triangles[p];
	}
	rc = allocate(walk, vertices, triangles);
	if (rc == 0)
		rc = code_patches(walk, coder);
	free(walk->gates);
	free(walk->corners);
	free(walk->names);
	free(walk);
	return rc;
}

void connectivity_finish(struct connectivity *mesh)
{
	free(mesh->steps);
	free(mesh->members);
	free(mesh->indices);
	free(mesh->sources);
	*mesh = (struct connectivity){ 0 };
}
