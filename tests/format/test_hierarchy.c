#include "format/hierarchy.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <zstd.h>

#include "tests/check.h"

/* Group 0 holds patches 0 to 2; group 1 replaces 0 and 1; group 2 replaces 2; group 3 replaces
 * one patch of group 1 and one of group 2: a graph that is no tree. */
struct example {
	struct hierarchy_group groups[4];
	struct hierarchy_patch patches[9];
	struct hierarchy hierarchy;
};

static void example_init(struct example *example)
{
	static const uint32_t counts[4] = { 3, 2, 2, 2 };
	static const uint32_t finer[9] = {
		1, 1, 2, HIERARCHY_NONE, 3, HIERARCHY_NONE, 3, HIERARCHY_NONE, HIERARCHY_NONE
	};
	uint32_t patch = 0;

	for (uint32_t g = 0; g < 4; g++) {
		example->groups[g] = (struct hierarchy_group){
			.first_patch = patch,
			.patch_count = counts[g],
			.error_m = g == 0 ? INFINITY : 1.0f / (float)g,
			.centre_m = { 1.0f + 0.01f * (float)g, 2.0f, 3.0f },
			.radius_m = 10.0f - (float)g,
		};
		for (uint32_t i = 0; i < counts[g]; i++, patch++)
			example->patches[patch] = (struct hierarchy_patch){
				.group = g,
				.finer = finer[patch],
				.triangle_count = (uint16_t)(1000 + patch),
				.vertex_count = 600,
				.centre_m = { 1.0f, 2.0f, (float)patch },
				.radius_m = 2.0f,
				.cone_axis = { 0.0f, 0.0f, 1.0f },
				.cone_cos = 0.25f,
			};
	}
	example->hierarchy = (struct hierarchy){ 4, 9, example->groups, example->patches };
}

static void gives_back_every_number(void **state)
{
	struct example example;
	struct hierarchy back;
	struct buffer payload;

	(void)state;
	example_init(&example);
	buffer_init(&payload, 1 << 16);
	CHECK(hierarchy_encode(&payload, &example.hierarchy) == 0);
	CHECK(hierarchy_decode(&back, buffer_bytes(&payload)) == 0);
	CHECK(back.group_count == 4 && back.patch_count == 9);
	CHECK(memcmp(back.groups, example.groups, sizeof(example.groups)) == 0);
	CHECK(memcmp(back.patches, example.patches, sizeof(example.patches)) == 0);
	hierarchy_finish(&back);
	buffer_finish(&payload);
}

static int decode_exact(const uint8_t *data, size_t size)
{
	uint8_t *exact = malloc(size ? size : 1);
	struct hierarchy back;
	int rc;

	memcpy(exact, data, size);
	rc = hierarchy_decode(&back, (struct bytes){ exact, size });
	if (rc < 0)
		CHECK(!back.groups && !back.patches && back.group_count == 0);
	hierarchy_finish(&back);
	free(exact);
	return rc;
}

static void refuses_every_truncation_and_anything_behind(void **state)
{
	struct example example;
	struct buffer payload;
	uint8_t empty[64];
	size_t size;

	(void)state;
	example_init(&example);
	buffer_init(&payload, 1 << 16);
	CHECK(hierarchy_encode(&payload, &example.hierarchy) == 0);
	size = payload.size;
	for (size_t n = 0; n < size; n++)
		CHECK(decode_exact(payload.data, n) == -EBADMSG);
	CHECK(decode_exact(payload.data, size) == 0);
	buffer_put_u8(&payload, 1);
	CHECK(decode_exact(payload.data, payload.size) == -EBADMSG);
	/* another frame, with nothing in it */
	payload.size = size;
	buffer_put(&payload, empty, ZSTD_compress(empty, sizeof(empty), "", 0, 1));
	CHECK(payload.size > size && decode_exact(payload.data, payload.size) == -EBADMSG);
	buffer_finish(&payload);
}

#define REFUSED(change)                                                                            \
	do {                                                                                       \
		struct example example;                                                            \
		struct hierarchy_group *groups = example.groups;                                   \
		struct hierarchy_patch *patches = example.patches;                                 \
		struct hierarchy *hierarchy = &example.hierarchy;                                  \
		example_init(&example);                                                            \
		CHECK(hierarchy_check(hierarchy) == 0);                                            \
		change;                                                                            \
		CHECK(hierarchy_check(hierarchy) == -EINVAL);                                      \
		(void)groups, (void)patches;                                                       \
	} while (0)

static void knows_each_broken_rule(void **state)
{
	(void)state;
	REFUSED(hierarchy->group_count = 0);
	REFUSED(hierarchy->patch_count = 8);
	REFUSED(groups[1].patch_count = 0);
	REFUSED(groups[1].patch_count = 65);
	REFUSED(groups[2].first_patch = 4);
	REFUSED(groups[0].error_m = 5.0f);     /* only infinity will do */
	REFUSED(groups[2].error_m = INFINITY); /* only at the top */
	REFUSED(groups[2].error_m = -0.5f);    /* no error is negative */
	REFUSED(groups[3].error_m = 0.9f);     /* above group 2, whose patch it replaces */
	REFUSED(groups[3].radius_m = 9.5f);    /* outside groups 1 and 2 */
	REFUSED(groups[3].centre_m[1] = 4.0f); /* outside group 2 */
	REFUSED(groups[1].radius_m = NAN);
	REFUSED(patches[2].finer = 0);              /* not after its group */
	REFUSED(patches[5].finer = 2);              /* its own group */
	REFUSED(patches[8].finer = 4);              /* there is none */
	REFUSED(patches[2].finer = HIERARCHY_NONE); /* then group 2 replaces nothing */
	REFUSED(patches[4].group = 2);
	REFUSED(patches[4].triangle_count = 0);
	REFUSED(patches[4].triangle_count = 4001);
	REFUSED(patches[4].vertex_count = 12001);
	REFUSED(patches[4].radius_m = -1.0f);
	REFUSED(patches[4].cone_cos = 1.5f);
	REFUSED(patches[4].cone_cos = NAN);
	REFUSED(patches[4].cone_axis[1] = INFINITY);
}

static void does_not_encode_what_breaks_a_rule(void **state)
{
	struct example example;
	struct buffer payload;

	(void)state;
	example_init(&example);
	buffer_init(&payload, 1 << 16);
	example.groups[3].error_m = 0.9f;
	CHECK(hierarchy_encode(&payload, &example.hierarchy) == -EINVAL);
	CHECK(payload.size == 0);
	example_init(&example);
	CHECK(hierarchy_encode(&payload, &example.hierarchy) == 0);
	for (size_t bit = 0; bit < 8 * 9; bit++) {
		payload.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
		CHECK(decode_exact(payload.data, payload.size) == -EBADMSG);
		payload.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
	}
	buffer_finish(&payload);
}

/* Sound compression around unsound numbers: the decoder judges by the same rules. */
static void refuses_well_packed_nonsense(void **state)
{
	enum { HEADER = 9, RAW_MAX = 4096 };
	uint8_t raw[RAW_MAX], packed[2 * RAW_MAX];
	struct example example;
	struct buffer payload;
	size_t size, refused = 0;

	(void)state;
	example_init(&example);
	buffer_init(&payload, 1 << 16);
	CHECK(hierarchy_encode(&payload, &example.hierarchy) == 0);
	size = ZSTD_decompress(raw, sizeof(raw), payload.data + HEADER, payload.size - HEADER);
	CHECK(!ZSTD_isError(size));
	memcpy(packed, payload.data, HEADER);
	for (size_t i = 0; i < size; i++) {
		uint8_t before = raw[i];
		size_t packed_size;
		int rc;

		raw[i] = 0xff;
		packed_size = ZSTD_compress(packed + HEADER, sizeof(packed) - HEADER, raw, size, 1);
		rc = decode_exact(packed, HEADER + packed_size);
		CHECK(rc == 0 || rc == -EBADMSG);
		refused += rc < 0;
		raw[i] = before;
	}
	CHECK(refused > size / 4);
	buffer_finish(&payload);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_back_every_number),
		cmocka_unit_test(refuses_every_truncation_and_anything_behind),
		cmocka_unit_test(knows_each_broken_rule),
		cmocka_unit_test(does_not_encode_what_breaks_a_rule),
		cmocka_unit_test(refuses_well_packed_nonsense),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
