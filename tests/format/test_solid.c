/* The octree of where an eye may be, on the wire: what comes back is what went in, and nothing else
 * is taken. */
#include "format/solid.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/format/solid_example.h"

enum { DEPTH = 5, SIDE = 1 << DEPTH };

/* A ball on the ground. */
static bool ball(const int32_t place[3])
{
	const int32_t x = place[0] - 14, y = place[1] - 17, z = place[2] - 9;

	return place[2] < 3 || x * x + y * y + z * z < 70;
}

static const float low_m[3] = { -3, 2, -0.5f };

static void init(struct solid *solid)
{
	solid_example_init(solid, DEPTH, 0.25f, low_m, ball);
}

static void comes_back_as_it_was(void **state)
{
	struct solid solid, back;
	struct buffer object;

	(void)state;
	init(&solid);
	buffer_init(&object, 1 << 20);
	CHECK(solid_encode(&object, &solid) == 0);
	CHECK(solid_decode(&back, buffer_bytes(&object)) == 0);
	CHECK(back.depth == solid.depth && back.node_count == solid.node_count);
	CHECK(back.cell_m == solid.cell_m && back.room_m == solid.room_m);
	CHECK(memcmp(back.low_m, solid.low_m, sizeof(back.low_m)) == 0);
	for (uint32_t i = 0; i < back.node_count; i++)
		CHECK(back.nodes[i].first == solid.nodes[i].first &&
		      back.nodes[i].states == solid.nodes[i].states);
	/* Two bits a child would be 2 bytes a node. */
	CHECK(object.size < 1.5 * back.node_count);
	solid_finish(&back);
	solid_finish(&solid);
	buffer_finish(&object);
}

static void every_place_is_in_its_cell(void **state)
{
	uint8_t *known;
	struct solid solid;

	(void)state;
	init(&solid);
	known = calloc(SOLID_CHILDREN, solid.node_count);
	for (int32_t i = 0; i < SIDE * SIDE * SIDE; i++) {
		const int32_t place[3] = { i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE };
		struct solid_cell cell;

		solid_find(&solid, place, &cell);
		CHECK((cell.state == SOLID_FULL) == ball(place));
		for (int axis = 0; axis < 3; axis++)
			CHECK(place[axis] >= cell.low[axis] &&
			      place[axis] < cell.low[axis] + cell.side);
		CHECK(cell.id < SOLID_CHILDREN * solid.node_count);
		/* The id is that of this cell alone. */
		if (memcmp(place, cell.low, sizeof(place)) == 0)
			CHECK(!known[cell.id]++);
	}
	free(known);
	solid_finish(&solid);
}

static void refuses_to_encode_what_breaks_a_rule(void **state)
{
	struct buffer object;
	struct solid solid;

	(void)state;
	init(&solid);
	buffer_init(&object, 1 << 20);
	solid.depth = SOLID_DEPTH_MAX + 1;
	CHECK(solid_encode(&object, &solid) == -EINVAL);
	solid.depth = DEPTH - 1; /* the lowest nodes are too deep */
	CHECK(solid_encode(&object, &solid) == -EINVAL);
	solid.depth = DEPTH;
	solid.cell_m = 0;
	CHECK(solid_encode(&object, &solid) == -EINVAL);
	solid.cell_m = 1;
	solid.nodes[1].first++;
	CHECK(solid_encode(&object, &solid) == -EINVAL);
	solid.nodes[1].first--;
	solid.nodes[solid.node_count - 1].states = 0x5555; /* one full cell would do */
	CHECK(solid_encode(&object, &solid) == -EINVAL);
	solid.nodes[solid.node_count - 1].states = 3;
	CHECK(solid_encode(&object, &solid) == -EINVAL);
	CHECK(object.size == 0);
	solid_finish(&solid);
	buffer_finish(&object);
}

/* Decodes bytes in a block of exactly their size. Returns 0 only for an octree that encodes to
 * the same bytes. */
static int decode_exactly(const uint8_t *bytes, size_t size)
{
	uint8_t *exact = malloc(size ? size : 1);
	struct buffer again;
	struct solid solid;
	int rc;

	memcpy(exact, bytes, size);
	rc = solid_decode(&solid, (struct bytes){ exact, size });
	if (rc == 0) {
		buffer_init(&again, 1 << 20);
		CHECK(solid_encode(&again, &solid) == 0);
		CHECK(again.size == size && memcmp(again.data, exact, size) == 0);
		buffer_finish(&again);
	}
	CHECK(rc == 0 || (rc == -EBADMSG && !solid.nodes));
	solid_finish(&solid);
	free(exact);
	return rc;
}

static void refuses_what_is_truncated_or_damaged(void **state)
{
	struct buffer object;
	struct solid solid;
	uint32_t taken = 0;

	(void)state;
	init(&solid);
	buffer_init(&object, 1 << 20);
	CHECK(solid_encode(&object, &solid) == 0);
	for (size_t n = 0; n < object.size; n++)
		CHECK(decode_exactly(object.data, n) == -EBADMSG);
	for (size_t n = 0; n < object.size; n++) {
		object.data[n] ^= 0x41;
		taken += decode_exactly(object.data, object.size) == 0;
		object.data[n] ^= 0x41;
	}
	/* Corner, cell and room may be other numbers. */
	CHECK(taken <= 20);
	buffer_put_u8(&object, 0);
	CHECK(decode_exactly(object.data, object.size) == -EBADMSG);
	solid_finish(&solid);
	buffer_finish(&object);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(comes_back_as_it_was),
		cmocka_unit_test(every_place_is_in_its_cell),
		cmocka_unit_test(refuses_to_encode_what_breaks_a_rule),
		cmocka_unit_test(refuses_what_is_truncated_or_damaged),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
