/* Labels on the wire: what comes back is what went in, and nothing else is taken. */
#include "format/label.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

enum { TRIANGLES = 6 };

/* A gallery, and a relief within it whose outline runs through triangle 2. */
struct example {
	struct label_group group;
	struct label_part parts[2];
	struct label_set sets[3];
	uint16_t members[3];
	struct label_patch patches[2];
	uint16_t in[TRIANGLES];
	struct label_border border;
	int8_t values[256];
};

/* Within where i is small: the outline is the line of i = 1/2 of the side. */
static void example_init(struct example *e)
{
	const uint16_t in[TRIANGLES] = { 0, 1, 1, 2, 0, 2 };
	const int level = 3, n = 1 << level;

	*e = (struct example){
		.parts = { { "gallery", 40 }, { "relief-1", 2.5f } },
		.sets = { { 0, 0 }, { 0, 1 }, { 1, 2 } },
		.members = { 0, 0, 1 },
		.border = { .triangle = 2, .part = 1, .level = (uint8_t)level },
	};
	memcpy(e->in, in, sizeof(in));
	e->patches[0] = (struct label_patch){ TRIANGLES, e->in, 1, &e->border };
	e->group = (struct label_group){ .part_count = 2,
					 .set_count = 3,
					 .member_count = 3,
					 .patch_count = 2,
					 .value_count = label_values(level),
					 .parts = e->parts,
					 .sets = e->sets,
					 .members = e->members,
					 .patches = e->patches,
					 .values = e->values };
	for (int i = 0; i <= n; i++)
		for (int j = 0; j <= n - i; j++)
			e->values[label_value_at(level, i, j)] = (int8_t)(2 * i < n ? 1 : -1);
}

static struct buffer encoded(const struct label_group *group)
{
	struct buffer out;

	buffer_init(&out, 1 << 20);
	CHECK(label_group_encode(&out, group) == 0);
	return out;
}

static void every_corner_of_a_divided_triangle_has_its_place(void **state)
{
	(void)state;
	for (int level = LABEL_LEVEL_MIN; level <= LABEL_LEVEL_MAX; level++) {
		int n = 1 << level;
		uint32_t next = 0;

		for (int i = 0; i <= n; i++)
			for (int j = 0; j <= n - i; j++)
				CHECK(label_value_at(level, i, j) == next++);
		CHECK(label_values(level) == next);
	}
}

static void comes_back_as_it_went(void **state)
{
	struct example e;
	struct label_group back;
	struct buffer bytes;

	(void)state;
	example_init(&e);
	bytes = encoded(&e.group);
	CHECK(label_group_decode(&back, buffer_bytes(&bytes)) == 0);
	CHECK(back.part_count == 2 && strcmp(back.parts[1].id, "relief-1") == 0);
	CHECK(back.parts[1].area_m2 == 2.5f && label_find(&back, "relief-1") == 1);
	CHECK(label_find(&back, "relief") == -1);
	CHECK(back.patch_count == 2 && back.patches[1].triangle_count == 0);
	CHECK(memcmp(back.patches[0].sets, e.in, sizeof(e.in)) == 0);
	CHECK(back.patches[0].border_count == 1 && back.patches[0].borders[0].triangle == 2);
	CHECK(back.value_count == e.group.value_count &&
	      memcmp(back.values, e.values, back.value_count) == 0);
	label_group_finish(&back);
	buffer_finish(&bytes);
}

static void the_smallest_part_answers_on_its_side_of_the_outline(void **state)
{
	struct example e;

	(void)state;
	example_init(&e);
	CHECK(label_part_at(&e.group, 0, 0, 0.2f, 0.2f) == -1);
	CHECK(label_part_at(&e.group, 0, 1, 0.2f, 0.2f) == 0);
	CHECK(label_part_at(&e.group, 0, 3, 0.2f, 0.2f) == 1); /* in both */
	/* Between i = 3 and i = 4 of 8 the outline crosses. */
	CHECK(label_part_at(&e.group, 0, 2, 3.4f / 8, 0.1f) == 1);
	CHECK(label_part_at(&e.group, 0, 2, 3.6f / 8, 0.1f) == 0);
	CHECK(label_part_at(&e.group, 0, 2, 0, 1) == 1);
	CHECK(label_part_at(&e.group, 0, 2, 1, 0) == 0);
	CHECK(label_part_at(&e.group, 0, TRIANGLES, 0, 0) == -1);
	CHECK(label_holds(&e.group, 0, 3, 1) && !label_holds(&e.group, 0, 2, 1));
}

static void refuses_every_truncation_and_every_bit(void **state)
{
	struct label_group back;
	struct buffer bytes;
	struct example e;

	(void)state;
	example_init(&e);
	bytes = encoded(&e.group);
	for (size_t n = 0; n < bytes.size; n++) {
		uint8_t *exact = malloc(n ? n : 1);

		memcpy(exact, bytes.data, n);
		CHECK(label_group_decode(&back, (struct bytes){ exact, n }) == -EBADMSG);
		CHECK(back.parts == NULL);
		free(exact);
	}
	for (size_t bit = 0; bit < 8 * bytes.size; bit++) {
		bytes.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
		if (label_group_decode(&back, buffer_bytes(&bytes)) == 0)
			label_group_finish(&back); /* other numbers, as good */
		bytes.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
	}
	buffer_put_u8(&bytes, 0);
	CHECK(label_group_decode(&back, buffer_bytes(&bytes)) == -EBADMSG);
	buffer_finish(&bytes);
}

static int encoding_of(const struct example *e)
{
	struct buffer out;
	int rc;

	buffer_init(&out, 1 << 20);
	rc = label_group_encode(&out, &e->group);
	buffer_finish(&out);
	return rc;
}

static void what_breaks_a_rule_is_not_written(void **state)
{
	struct example e;

	(void)state;
	example_init(&e);
	CHECK(encoding_of(&e) == 0);
	e.in[0] = 3; /* no such set */
	CHECK(encoding_of(&e) == -EINVAL);
	example_init(&e);
	e.members[2] = 0; /* twice in its set */
	CHECK(encoding_of(&e) == -EINVAL);
	example_init(&e);
	e.in[2] = 2; /* wholly in it, and crossed by its outline */
	CHECK(encoding_of(&e) == -EINVAL);
	example_init(&e);
	e.values[0] = 2; /* even: neither side */
	CHECK(encoding_of(&e) == -EINVAL);
	example_init(&e);
	memset(e.values, 1, sizeof(e.values)); /* no outline in it */
	CHECK(encoding_of(&e) == -EINVAL);
	example_init(&e);
	e.border.triangle = TRIANGLES;
	CHECK(encoding_of(&e) == -EINVAL);
	example_init(&e);
	e.border.level = LABEL_LEVEL_MAX + 1;
	CHECK(encoding_of(&e) == -EINVAL);
	example_init(&e);
	memcpy(e.parts[0].id, "a b", 4);
	CHECK(encoding_of(&e) == -EINVAL);
}

static void a_page_says_which_groups_have_labels(void **state)
{
	const uint32_t children[11] = { 0,          LABEL_NONE, 1,          2,
					LABEL_NONE, LABEL_NONE, LABEL_NONE, 3,
					LABEL_NONE, LABEL_NONE, 4 };
	struct buffer bytes;
	uint32_t *back;

	(void)state;
	buffer_init(&bytes, 100);
	label_page_encode(&bytes, children, 11);
	CHECK(label_page_decode(&back, 11, 5, buffer_bytes(&bytes)) == 0);
	CHECK(memcmp(back, children, sizeof(children)) == 0);
	free(back);
	CHECK(label_page_decode(&back, 11, 4, buffer_bytes(&bytes)) == -EBADMSG);
	CHECK(label_page_decode(&back, 12, 5, buffer_bytes(&bytes)) == -EBADMSG);
	CHECK(label_page_decode(&back, 19, 5, buffer_bytes(&bytes)) == -EBADMSG && !back);
	bytes.data[bytes.size - 1] |= 0x80; /* a bit of no group */
	CHECK(label_page_decode(&back, 11, 5, buffer_bytes(&bytes)) == -EBADMSG);
	bytes.size--;
	CHECK(label_page_decode(&back, 11, 5, buffer_bytes(&bytes)) == -EBADMSG);
	buffer_finish(&bytes);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_corner_of_a_divided_triangle_has_its_place),
		cmocka_unit_test(comes_back_as_it_went),
		cmocka_unit_test(the_smallest_part_answers_on_its_side_of_the_outline),
		cmocka_unit_test(refuses_every_truncation_and_every_bit),
		cmocka_unit_test(what_breaks_a_rule_is_not_written),
		cmocka_unit_test(a_page_says_which_groups_have_labels),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
