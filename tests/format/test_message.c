#include "format/message.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/page.h"
#include "tests/check.h"

static const struct hash some = { { 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16 } };
static const struct hash other = { { 255, 2, 3 } };
static const uint8_t text[] = "a corner of a lintel";

/* One of each kind. */
static const struct message samples[] = {
	{ .kind = MESSAGE_RELEASE, .release = { some, 4096, false } },
	{ .kind = MESSAGE_RELEASE, .release = { other, 7, true } },
	{ .kind = MESSAGE_WANT, .want = { some, other, 70000, OBJECT_BYTES_MAX, 1234567 } },
	{ .kind = MESSAGE_DROP, .drop = some },
	{ .kind = MESSAGE_KEEP, .keep = other },
	{ .kind = MESSAGE_ASK_META, .period_s = 3600 },
	{ .kind = MESSAGE_SYNC },
	{ .kind = MESSAGE_SYNCED, .synced = true },
	{ .kind = MESSAGE_OBJECT, .object = { some, { text, sizeof(text) }, sizeof(text) } },
	{ .kind = MESSAGE_OBJECT, .object = { some, { NULL, 0 }, 5 << 20 } },
	{ .kind = MESSAGE_MISSING, .missing = { some, MISSING_DAMAGED } },
	{ .kind = MESSAGE_META, .meta = { META_ROOT, 7, { text, sizeof(text) }, META_FROM_STICK } },
	{ .kind = MESSAGE_STATUS, .status = { 1, 12, 1ull << 40, 5, 6, 1700000000 } },
	{ .kind = MESSAGE_TRUST, .root_version = 70 },
	{ .kind = MESSAGE_TRUST, .root_version = MESSAGE_TRUST_TUF },
	{ .kind = MESSAGE_ASK_FILE,
	  .file = { .name = "2.root.json", .source = META_FROM_STICK, .bytes_max = 16384 } },
	{ .kind = MESSAGE_FILE,
	  .file = { .name = "targets/5a.release.json", .bytes = { text, sizeof(text) } } },
	{ .kind = MESSAGE_FILE,
	  .file = { .name = "a%2Fb.json", .source = META_FROM_STICK, .answer = FILE_TOO_LARGE } },
};

static struct buffer encoded(const struct message *message)
{
	struct buffer out;

	buffer_init(&out, MESSAGE_BYTES_MAX);
	message_encode(&out, message);
	CHECK(out.error == 0);
	return out;
}

static void gives_back_every_kind(void **state)
{
	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(samples); i++) {
		struct buffer first = encoded(&samples[i]), second;
		struct message back;

		CHECK(message_decode(&back, buffer_bytes(&first)) == 0);
		CHECK(back.kind == samples[i].kind);
		second = encoded(&back);
		CHECK(first.size == second.size);
		CHECK(memcmp(first.data, second.data, first.size) == 0);
		buffer_finish(&first);
		buffer_finish(&second);
	}
}

static void keeps_every_field(void **state)
{
	struct buffer wire = encoded(&samples[2]);
	struct message back;

	(void)state;
	CHECK(message_decode(&back, buffer_bytes(&wire)) == 0);
	CHECK(hash_equal(back.want.hash, some) && hash_equal(back.want.page, other));
	CHECK(back.want.offset == 70000 && back.want.size == OBJECT_BYTES_MAX);
	CHECK(back.want.priority == 1234567);
	buffer_finish(&wire);
	wire = encoded(&samples[12]);
	CHECK(message_decode(&back, buffer_bytes(&wire)) == 0);
	CHECK(back.status.online == 1 && back.status.wanted == 12);
	CHECK(back.status.received_bytes == 1ull << 40 && back.status.cache_bytes == 5);
	CHECK(back.status.cache_budget_bytes == 6 && back.status.offline_since_s == 1700000000);
	buffer_finish(&wire);
}

/* Returns where the last field begins that takes the rest of the packet; 0: there is none. */
static size_t rest_at(const struct message *message)
{
	if (message->kind == MESSAGE_META)
		return 7;
	if (message->kind == MESSAGE_FILE && message->file.answer == FILE_IS_HERE)
		return 4 + strlen(message->file.name);
	return 0;
}

static void refuses_every_truncated_packet(void **state)
{
	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(samples); i++) {
		struct buffer wire = encoded(&samples[i]);

		for (size_t n = 0; n <= wire.size; n++) {
			uint8_t *exact = malloc(n ? n : 1);
			struct message back;
			int rc;

			memcpy(exact, wire.data, n);
			rc = message_decode(&back, (struct bytes){ exact, n });
			if (n == wire.size)
				CHECK(rc == 0);
			else if (rest_at(&samples[i]) > 0 && n > rest_at(&samples[i]))
				CHECK(rc == 0 &&
				      (back.kind == MESSAGE_META
					       ? back.meta.bytes.size
					       : back.file.bytes.size) == n - rest_at(&samples[i]));
			else if (samples[i].kind == MESSAGE_OBJECT && n == 21)
				CHECK(rc == 0 && back.object.bytes.size == 0); /* in a descriptor */
			else
				CHECK(rc == -EBADMSG);
			free(exact);
		}
		buffer_finish(&wire);
	}
}

static void refuses_bytes_after_the_last_field(void **state)
{
	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(samples); i++) {
		struct buffer wire = encoded(&samples[i]);
		struct message back;

		buffer_put_u8(&wire, 0);
		if (rest_at(&samples[i]) == 0)
			CHECK(message_decode(&back, buffer_bytes(&wire)) == -EBADMSG);
		buffer_finish(&wire);
	}
}

static void refuses_sizes_out_of_range(void **state)
{
	static const struct message bad[] = {
		{ .kind = MESSAGE_RELEASE, .release = { some, 0, false } },
		{ .kind = MESSAGE_RELEASE, .release = { some, OBJECT_BYTES_MAX + 1, false } },
		{ .kind = MESSAGE_RELEASE, .release = { { { 0 } }, 10, false } },
		{ .kind = MESSAGE_WANT, .want = { some, other, 0, 0, 0 } },
		{ .kind = MESSAGE_WANT, .want = { some, other, 0, OBJECT_BYTES_MAX + 1, 0 } },
		{ .kind = MESSAGE_WANT, .want = { { { 0 } }, other, 0, 1, 0 } },
		{ .kind = MESSAGE_OBJECT, .object = { some, { text, 5 }, 6 } },
		{ .kind = MESSAGE_OBJECT, .object = { some, { NULL, 0 }, OBJECT_BYTES_MAX + 1 } },
		{ .kind = MESSAGE_MISSING, .missing = { some, MISSING_DAMAGED + 1 } },
		{ .kind = MESSAGE_META, .meta = { META_TIMESTAMP + 1, 0, { text, 4 } } },
		{ .kind = MESSAGE_META, .meta = { META_ROOT, 0, { NULL, 0 } } },
		{ .kind = MESSAGE_META,
		  .meta = { META_ROOT, 0, { text, 4 }, META_FROM_STICK + 1 } },
		{ .kind = MESSAGE_ASK_META, .period_s = MESSAGE_PERIOD_S_MAX + 1 },
		{ .kind = MESSAGE_STATUS, .status = { .online = 2 } },
		{ .kind = 200 },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
		struct buffer wire = encoded(&bad[i]);
		struct message back;

		CHECK(message_decode(&back, buffer_bytes(&wire)) == -EBADMSG);
		buffer_finish(&wire);
	}
}

static void encodes_no_object_past_the_inline_ceiling(void **state)
{
	uint8_t *large = calloc(1, MESSAGE_INLINE_MAX + 1);
	struct message message = { .kind = MESSAGE_OBJECT };
	struct buffer wire;

	(void)state;
	message.object.hash = some;
	message.object.bytes = (struct bytes){ large, MESSAGE_INLINE_MAX };
	message.object.size = MESSAGE_INLINE_MAX;
	wire = encoded(&message);
	CHECK(wire.size <= MESSAGE_BYTES_MAX);
	buffer_clear(&wire);
	message.object.bytes.size = message.object.size = MESSAGE_INLINE_MAX + 1;
	message_encode(&wire, &message);
	CHECK(wire.error == -EFBIG);
	buffer_finish(&wire);
	free(large);
}

static void takes_no_name_that_leads_elsewhere(void **state)
{
	static const char *const bad[] = { "",     ".",     "..",     "/root.json", "../root.json",
					   "a/",   "a//b",  "a/../b", "a/.b",       "a b",
					   "a\\b", "a?b=c", "a#b",    "http://a",   "\xc3\xa9" };
	char name[MESSAGE_NAME_MAX + 2];

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
		struct message message = { .kind = MESSAGE_ASK_FILE, .file = { .bytes_max = 1 } };
		struct buffer wire;

		CHECK(!message_name_is_fine(bad[i]));
		snprintf(message.file.name, sizeof(message.file.name), "%s", bad[i]);
		wire = encoded(&message);
		CHECK(message_decode(&message, buffer_bytes(&wire)) == -EBADMSG);
		buffer_finish(&wire);
	}
	memset(name, 'a', sizeof(name));
	name[MESSAGE_NAME_MAX + 1] = '\0';
	CHECK(!message_name_is_fine(name));
	name[MESSAGE_NAME_MAX] = '\0';
	CHECK(message_name_is_fine(name) && message_name_is_fine("targets/0-9_~.%20/a..b"));
}

static void refuses_files_out_of_range(void **state)
{
	static uint8_t large[MESSAGE_META_BYTES_MAX + 1];
	const struct message bad[] = {
		{ .kind = MESSAGE_ASK_FILE, .file = { .name = "a", .bytes_max = 0 } },
		{ .kind = MESSAGE_ASK_FILE,
		  .file = { .name = "a", .bytes_max = MESSAGE_META_BYTES_MAX + 1 } },
		{ .kind = MESSAGE_ASK_FILE,
		  .file = { .name = "a", .bytes_max = 1, .source = (enum meta_source)2 } },
		{ .kind = MESSAGE_FILE, .file = { .name = "a" } }, /* here, and empty */
		{ .kind = MESSAGE_FILE,
		  .file = { .name = "a", .answer = FILE_NOT_THERE, .bytes = { text, 1 } } },
		{ .kind = MESSAGE_FILE, .file = { .name = "a", .answer = (enum file_answer)3 } },
	};
	struct message message = { .kind = MESSAGE_FILE,
				   .file = { .name = "a", .bytes = { large, sizeof(large) } } };
	struct buffer wire;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
		wire = encoded(&bad[i]);
		CHECK(message_decode(&message, buffer_bytes(&wire)) == -EBADMSG);
		buffer_finish(&wire);
	}
	message = (struct message){ .kind = MESSAGE_FILE,
				    .file = { .name = "a", .bytes = { large, sizeof(large) } } };
	buffer_init(&wire, MESSAGE_BYTES_MAX);
	message_encode(&wire, &message);
	CHECK(wire.error == -EFBIG);
	buffer_finish(&wire);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_back_every_kind),
		cmocka_unit_test(keeps_every_field),
		cmocka_unit_test(refuses_every_truncated_packet),
		cmocka_unit_test(refuses_bytes_after_the_last_field),
		cmocka_unit_test(refuses_sizes_out_of_range),
		cmocka_unit_test(encodes_no_object_past_the_inline_ceiling),
		cmocka_unit_test(takes_no_name_that_leads_elsewhere),
		cmocka_unit_test(refuses_files_out_of_range),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
