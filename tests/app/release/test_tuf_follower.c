/* A follower and a repository in memory: what it asks for, what it takes, and what it remembers. */
#include "app/release/tuf_follower.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/app/release/tuf_museum.h"

enum { ROUND_MAX = 32 };

/* ---- the follower */

static struct tuf_follower follower;
static char asked[1024]; /* names, in the order in which they were asked for */
static struct bytes known[2];

static int set_up(void **unused)
{
	const struct state_tuf none = { .root = { NULL, 0 } };

	(void)unused;
	museum_open();
	known[0] = known[1] = (struct bytes){ NULL, 0 };
	publish_root(1);
	publish(1);
	CHECK(tuf_follower_init(&follower, &none, NULL) == 0 && !tuf_follower_is_on(&follower));
	CHECK(tuf_follower_pin(&follower, file_of("1.root.json"), NULL) == 0);
	CHECK(tuf_follower_is_on(&follower) && follower.version[TUF_ROOT] == 1 && follower.changed);
	return 0;
}

static int tear_down(void **unused)
{
	(void)unused;
	tuf_follower_finish(&follower);
	museum_close();
	return 0;
}

static struct message_file answer_to(const char *name)
{
	struct message_file answer = { .answer = FILE_NOT_THERE };
	const struct bytes bytes = file_of(name);

	snprintf(answer.name, sizeof(answer.name), "%s", name);
	if (bytes.size > follower.ask.bytes_max) {
		answer.answer = FILE_TOO_LARGE;
	} else if (bytes.size > 0) {
		answer.answer = FILE_IS_HERE;
		answer.bytes = bytes;
	}
	return answer;
}

/* Runs until there is nothing more to ask for; the answers come from the repository. Returns the
 * last result; after 0, out is the release.json that was published last. */
static int run_on(int64_t now_s)
{
	struct buffer out;
	int rc = -EAGAIN;

	asked[0] = '\0';
	for (int i = 0; i < ROUND_MAX && rc == -EAGAIN; i++) {
		buffer_init(&out, METADATA_FILE_BYTES_MAX);
		rc = tuf_follower_run(&follower, META_FROM_SERVER, now_s, known, &out);
		if (rc == 0)
			CHECK(bytes_equal(buffer_bytes(&out), buffer_bytes(&release_file)));
		buffer_finish(&out);
		if (rc == -EAGAIN) {
			const struct message_file answer = answer_to(follower.ask.name);
			const size_t used = strlen(asked);

			snprintf(asked + used, sizeof(asked) - used, "%.14s ", follower.ask.name);
			tuf_follower_add(&follower, &answer);
		}
	}
	return rc;
}

static int look(int64_t now_s)
{
	tuf_follower_begin(&follower, META_FROM_SERVER, file_of("timestamp.json"));
	return run_on(now_s);
}

/* As after a start of the terminal. */
static void start_again(void)
{
	struct tuf_follower old = follower;
	const struct state_tuf kept = tuf_follower_kept(&old);

	CHECK(tuf_follower_init(&follower, &kept, NULL) == 0);
	tuf_follower_finish(&old);
	CHECK(!follower.changed && tuf_follower_is_on(&follower));
}

static bool has_asked(const char *names)
{
	return strncmp(asked, names, strlen(names)) == 0 &&
	       (asked[strlen(names)] == '\0' || names[strlen(names) - 1] == '/');
}

static void asks_for_one_file_after_another(void **unused)
{
	(void)unused;
	follower.changed = false;
	CHECK(look(NOW_S) == 0 && follower.changed);
	CHECK(has_asked("2.root.json 1.snapshot.jso 1.targets.json targets/"));
	CHECK(tuf_follower_kept(&follower).targets.size == file_of("1.targets.json").size);
	CHECK(follower.expires_s[TUF_TARGETS] == LATER_S);
}

/* One server may have several temples. */
static void follows_its_own_path_alone(void **unused)
{
	char path[TUF_FOLLOWER_TARGET_BYTES + 1];
	struct state_tuf kept = tuf_follower_kept(&follower);
	struct tuf_follower other;

	(void)unused;
	CHECK(tuf_follower_init(&other, &kept, "angkor/release.json") == 0);
	tuf_follower_finish(&follower);
	follower = other;
	CHECK(look(NOW_S) == -ENOENT && strstr(follower.why, "no target angkor/release.json"));
	target_folder = "angkor/";
	publish(2);
	CHECK(look(NOW_S) == 0 && strstr(asked, "targets/angkor"));
	target_folder = "bayon/";
	publish(3);
	CHECK(look(NOW_S) == -ENOENT);
	target_folder = "";
	memset(path, 'a', sizeof(path));
	path[sizeof(path) - 1] = '\0';
	kept = tuf_follower_kept(&follower);
	CHECK(tuf_follower_init(&other, &kept, path) == -ENAMETOOLONG);
	tuf_follower_finish(&other);
}

static void asks_for_what_is_new_alone(void **unused)
{
	(void)unused;
	CHECK(look(NOW_S) == 0);
	follower.changed = false;
	CHECK(look(NOW_S) == 0 && has_asked("2.root.json ") && !follower.changed);
	publish_timestamp(2, 1);
	known[1] = buffer_bytes(&release_file);
	CHECK(look(NOW_S) == 0 && has_asked("2.root.json ") && follower.changed);
	start_again();
	CHECK(look(NOW_S) == 0 && has_asked("2.root.json "));
	known[1] = (struct bytes){ NULL, 0 };
	publish(3);
	CHECK(look(NOW_S) == 0);
	CHECK(has_asked("2.root.json 3.snapshot.jso 3.targets.json targets/"));
}

static void a_round_that_waits_for_a_file_goes_on_with_the_same_timestamp(void **unused)
{
	struct message_file answer;
	struct buffer out;

	(void)unused;
	buffer_init(&out, METADATA_FILE_BYTES_MAX);
	tuf_follower_begin(&follower, META_FROM_SERVER, file_of("timestamp.json"));
	CHECK(tuf_follower_run(&follower, META_FROM_SERVER, NOW_S, known, &out) == -EAGAIN);
	answer = answer_to("2.root.json");
	tuf_follower_add(&follower, &answer);
	for (int i = 0; i < 3; i++) { /* the line is slow */
		CHECK(tuf_follower_run(&follower, META_FROM_SERVER, NOW_S, known, &out) == -EAGAIN);
		CHECK(strcmp(follower.ask.name, "1.snapshot.json") == 0);
		tuf_follower_begin(&follower, META_FROM_SERVER, file_of("timestamp.json"));
	}
	CHECK(run_on(NOW_S) == 0 && has_asked("1.snapshot.jso 1.targets.json targets/"));
	buffer_finish(&out);
}

static void refuses_what_is_older_after_a_start_too(void **unused)
{
	(void)unused;
	publish(5);
	CHECK(look(NOW_S) == 0);
	start_again();
	publish(4);
	CHECK(look(NOW_S) == -ESTALE && strstr(follower.why, "older"));
	CHECK(follower.expires_s[TUF_TIMESTAMP] == LATER_S);
}

static void a_file_that_is_missing_ends_the_round_and_not_the_next(void **unused)
{
	struct buffer aside;

	(void)unused;
	buffer_init(&aside, 1 << 20);
	buffer_put(&aside, file_of("1.snapshot.json").data, file_of("1.snapshot.json").size);
	put("1.snapshot.json", (struct bytes){ NULL, 0 });
	CHECK(look(NOW_S) == -ENOENT && strstr(follower.why, "1.snapshot.json"));
	CHECK(has_asked("2.root.json 1.snapshot.jso "));
	put("1.snapshot.json", buffer_bytes(&aside));
	CHECK(look(NOW_S) == 0);
	buffer_finish(&aside);
}

static void refuses_a_file_that_is_too_large(void **unused)
{
	static uint8_t many[MESSAGE_META_BYTES_MAX + 1];

	(void)unused;
	memset(many, 'x', sizeof(many));
	put("1.snapshot.json", (struct bytes){ many, sizeof(many) });
	CHECK(look(NOW_S) == -EFBIG && strstr(follower.why, "1.snapshot.json"));
	CHECK(follower.ask.bytes_max < 1000); /* as large as the timestamp says */
	put("2.root.json", (struct bytes){ many, sizeof(many) });
	CHECK(look(NOW_S) == -EFBIG && strstr(follower.why, "2.root.json"));
	CHECK(follower.ask.bytes_max == MESSAGE_META_BYTES_MAX);
	put("2.root.json", (struct bytes){ NULL, 0 });
	put("timestamp.json", (struct bytes){ many, 20 << 10 });
	CHECK(look(NOW_S) == -EFBIG && strstr(follower.why, "timestamp.json"));
}

static void refuses_another_file_in_the_targets_place(void **unused)
{
	(void)unused;
	for (int i = 0; i < file_count; i++)
		if (strncmp(files[i].name, "targets/", 8) == 0)
			files[i].bytes.data[9] ^= 1;
	CHECK(look(NOW_S) == -EBADMSG && strstr(follower.why, "not the target"));
}

static void a_round_has_a_most_of_files(void **unused)
{
	(void)unused;
	tuf_follower_begin(&follower, META_FROM_SERVER, file_of("timestamp.json"));
	for (int i = 1; i < TUF_ROUND_FILES_MAX + 9; i++) {
		struct message_file file = { .answer = FILE_NOT_THERE };

		snprintf(file.name, sizeof(file.name), "role%d.json", i);
		tuf_follower_add(&follower, &file);
	}
	CHECK(run_on(NOW_S) == -E2BIG && look(NOW_S) == 0);
}

/* ---- roots */

static struct trust_root earlier_root(const struct signing_key *key, uint32_t threshold)
{
	struct trust_root root = { .version = 1, .expires_s = LATER_S };
	struct role_keys *role = &root.roles[META_ROOT];

	memcpy(role->keys[0], key->public_key, KEY_BYTES);
	memcpy(role->keys[1], other_key.public_key, KEY_BYTES);
	role->key_count = 2;
	role->threshold = threshold;
	return root;
}

static void only_the_earlier_root_keys_name_a_first_root(void **unused)
{
	const struct state_tuf none = { .root = { NULL, 0 } };
	struct trust_root root = earlier_root(&release_key, 1);

	(void)unused;
	tuf_follower_finish(&follower);
	CHECK(tuf_follower_init(&follower, &none, NULL) == 0);
	CHECK(tuf_follower_pin(&follower, file_of("1.root.json"), &root) == -EKEYREJECTED);
	CHECK(strstr(follower.why, "not signed by the root keys"));
	root = earlier_root(&root_key, 2);
	CHECK(tuf_follower_pin(&follower, file_of("1.root.json"), &root) == -EKEYREJECTED);
	CHECK(tuf_follower_pin(&follower, file_of("1.targets.json"), &root) == -EBADMSG);
	CHECK(!tuf_follower_is_on(&follower) && !follower.changed);
	root = earlier_root(&root_key, 1);
	CHECK(tuf_follower_pin(&follower, file_of("1.root.json"), &root) == 0);
	CHECK(look(NOW_S) == 0);
}

static void looks_for_its_first_root_among_all_versions(void **unused)
{
	const struct state_tuf none = { .root = { NULL, 0 } };
	const struct trust_root root = earlier_root(&root_key, 1);
	struct message_file answer;

	(void)unused;
	tuf_follower_finish(&follower);
	CHECK(tuf_follower_init(&follower, &none, NULL) == 0);
	CHECK(!tuf_follower_begin_first(&follower, 0, META_FROM_SERVER));
	answer = answer_to("1.root.json");
	CHECK(tuf_follower_first(&follower, &answer, &root) == -ENOKEY); /* not asked for */
	put("1.root.json", (struct bytes){ (const uint8_t *)"<html>", 6 });
	publish_root(3);
	CHECK(tuf_follower_begin_first(&follower, 2, META_FROM_SERVER));
	for (int i = 0; i < 2; i++) {
		answer = answer_to(follower.ask.name);
		CHECK(tuf_follower_first(&follower, &answer, &root) ==
		      (i == 0 ? -EAGAIN : -ENOENT));
	}
	CHECK(tuf_follower_begin_first(&follower, 1000, META_FROM_SERVER));
	for (int i = 0; i < 3; i++) {
		answer = answer_to(follower.ask.name);
		CHECK(tuf_follower_first(&follower, &answer, &root) == (i < 2 ? -EAGAIN : 0));
	}
	CHECK(follower.version[TUF_ROOT] == 3 && look(NOW_S) == 0);
}

static void a_root_with_the_same_keys_clears_nothing(void **unused)
{
	(void)unused;
	CHECK(look(NOW_S) == 0);
	publish_root(2);
	publish_root(3);
	CHECK(look(NOW_S) == 0 && follower.version[TUF_ROOT] == 3);
	CHECK(has_asked("2.root.json 3.root.json 4.root.json "));
	CHECK(follower.clear == STATE_CLEAR_NOTHING);
}

static void a_root_that_withdraws_the_timestamp_key_clears_both_floors(void **unused)
{
	(void)unused;
	issued_s = NOW_S - 5;
	publish(2000000000); /* by a thief */
	CHECK(look(NOW_S) == 0 && follower.issued_s == NOW_S - 5);
	issued_s = 0;
	make_key(&timestamp_key);
	publish_root(2);
	publish(2000000000);
	publish_timestamp(3, 2000000000);
	CHECK(look(NOW_S) == 0 && follower.clear == STATE_CLEAR_BOTH_FLOORS);
	CHECK(follower.issued_s == 0);
}

static void a_root_that_withdraws_the_release_key_clears_the_sequence_floor(void **unused)
{
	(void)unused;
	publish(2000000000);
	CHECK(look(NOW_S) == 0);
	make_key(&release_key);
	publish_root(2);
	publish(3);
	publish_timestamp(2000000001, 3);
	/* The timestamp's key stays, and what it said of the snapshot: recovery needs a new one
	 * too. */
	CHECK(look(NOW_S) == -ESTALE && follower.clear == STATE_CLEAR_SEQUENCE_FLOOR);
	make_key(&timestamp_key);
	publish_root(3);
	publish(3);
	CHECK(look(NOW_S) == 0 && follower.clear == STATE_CLEAR_BOTH_FLOORS);
}

/* ---- memory */

static long allocations_left;

static void *failing_malloc(size_t size)
{
	return allocations_left-- == 0 ? NULL : malloc(size);
}

/* cJSON's allocations, one after another, through the first root and a round. */
static void lives_through_each_allocation_that_fails(void **unused)
{
	const struct state_tuf none = { .root = { NULL, 0 } };
	const struct trust_root root = earlier_root(&root_key, 1);
	cJSON_Hooks hooks = { failing_malloc, free };
	long failed = 0;

	(void)unused;
	for (long n = 0; failed == n; n++) {
		int rc;

		tuf_follower_finish(&follower);
		CHECK(tuf_follower_init(&follower, &none, NULL) == 0);
		cJSON_InitHooks(&hooks);
		allocations_left = n;
		rc = tuf_follower_pin(&follower, file_of("1.root.json"), &root);
		if (rc == 0)
			rc = look(NOW_S);
		cJSON_InitHooks(NULL);
		failed += allocations_left < 0;
		if (rc < 0)
			CHECK(allocations_left < 0 && follower.why[0]);
		if (!tuf_follower_is_on(&follower))
			CHECK(tuf_follower_pin(&follower, file_of("1.root.json"), &root) == 0);
		CHECK(look(NOW_S) == 0); /* as if nothing had been */
	}
	CHECK(failed > 100);
}

/* ---- time */

static void judges_expiry_only_by_a_clock_that_is_set(void **unused)
{
	(void)unused;
	expires_s = NOW_S - 1;
	publish(2);
	CHECK(look(NOW_S) == -ETIME && strstr(follower.why, "expired"));
	CHECK(tuf_follower_kept(&follower).timestamp.size == 0);
	CHECK(look(0) == 0 && follower.expires_s[TUF_TIMESTAMP] == NOW_S - 1);
	CHECK(look(NOW_S) == -ETIME); /* what it has, it would not take now */
}

static void notes_when_the_timestamp_was_signed(void **unused)
{
	(void)unused;
	issued_s = NOW_S - 100;
	publish(2);
	CHECK(look(NOW_S) == 0 && follower.issued_s == NOW_S - 100);
	issued_s = LATER_S + 1; /* after it expires: nonsense */
	publish(3);
	CHECK(look(NOW_S) == 0 && follower.issued_s == 0);
	issued_s = 0;
	publish(4);
	CHECK(look(NOW_S) == 0 && follower.issued_s == 0);
}

#define IN_A_MUSEUM(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		IN_A_MUSEUM(asks_for_one_file_after_another),
		IN_A_MUSEUM(follows_its_own_path_alone),
		IN_A_MUSEUM(asks_for_what_is_new_alone),
		IN_A_MUSEUM(a_round_that_waits_for_a_file_goes_on_with_the_same_timestamp),
		IN_A_MUSEUM(refuses_what_is_older_after_a_start_too),
		IN_A_MUSEUM(a_file_that_is_missing_ends_the_round_and_not_the_next),
		IN_A_MUSEUM(refuses_a_file_that_is_too_large),
		IN_A_MUSEUM(refuses_another_file_in_the_targets_place),
		IN_A_MUSEUM(a_round_has_a_most_of_files),
		IN_A_MUSEUM(only_the_earlier_root_keys_name_a_first_root),
		IN_A_MUSEUM(looks_for_its_first_root_among_all_versions),
		IN_A_MUSEUM(a_root_with_the_same_keys_clears_nothing),
		IN_A_MUSEUM(a_root_that_withdraws_the_timestamp_key_clears_both_floors),
		IN_A_MUSEUM(a_root_that_withdraws_the_release_key_clears_the_sequence_floor),
		IN_A_MUSEUM(lives_through_each_allocation_that_fails),
		IN_A_MUSEUM(judges_expiry_only_by_a_clock_that_is_set),
		IN_A_MUSEUM(notes_when_the_timestamp_was_signed),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
