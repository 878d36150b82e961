#include "app/release/updater.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <sodium.h>

#include "base/clock.h"
#include "format/metadata.h"
#include "format/metadata_sign.h"
#include "tests/check.h"

enum { DAY_S = 86400, TODAY_S = 1800000000 };

#define LATE_S  ((int64_t)5000000000) /* the year 2128 */
#define Y2099_S ((int64_t)4090000000)

/* In place of the machine's: a clock that is set, by whomever. */
static int64_t wall_s = TODAY_S;
static bool is_set = true;

int64_t clock_wall_s(void)
{
	return wall_s;
}

bool clock_wall_is_set(void)
{
	return is_set;
}

static char folder[64], state_path[96], trust_path[96];
static int64_t expires_in_s = DAY_S;
static int64_t issued_s; /* of the timestamps that are published; 0: they do not say */
static struct signing_key root_key, release_key, timestamp_key;

/* What the kiosk was told. */
static struct {
	int begun, remembered, failed;
	struct hash begun_root, remembered_root;
} told;

static void on_begin(void *data, struct hash root, uint32_t root_bytes)
{
	(void)data;
	CHECK(root_bytes == 100);
	told.begun++;
	told.begun_root = root;
}

static void on_remembered(void *data, struct hash root, int rc)
{
	(void)data;
	told.remembered += rc == 0;
	told.failed += rc < 0;
	told.remembered_root = root;
}

/* With the keys of now. */
static struct trust_root root_of_version(uint32_t version)
{
	const struct signing_key *const keys[] = {
		[META_ROOT] = &root_key,
		[META_RELEASE] = &release_key,
		[META_TIMESTAMP] = &timestamp_key,
	};
	struct trust_root root = { .version = version, .expires_s = LATE_S };

	for (int role = 0; role < 3; role++) {
		memcpy(root.roles[role].keys[0], keys[role]->public_key, KEY_BYTES);
		root.roles[role].key_count = root.roles[role].threshold = 1;
	}
	return root;
}

static void encode_root(struct buffer *file, uint32_t version)
{
	const struct trust_root root = root_of_version(version);

	buffer_init(file, METADATA_FILE_BYTES_MAX);
	CHECK(trust_root_encode(file, &root, &root_key, 1) == 0);
}

static void write_trust(void)
{
	struct buffer file;

	encode_root(&file, 1);
	CHECK(bytes_write_file(buffer_bytes(&file), trust_path) == 0);
	buffer_finish(&file);
}

static void change_key(struct signing_key *key)
{
	CHECK(crypto_sign_keypair(key->public_key, key->secret) == 0);
}

static int enter_museum(void **unused)
{
	struct signing_key *const keys[] = { &root_key, &release_key, &timestamp_key };

	(void)unused;
	CHECK(sodium_init() >= 0);
	wall_s = TODAY_S;
	for (int i = 0; i < 3; i++)
		change_key(keys[i]);
	snprintf(folder, sizeof(folder), "/tmp/gopura-follow-XXXXXX");
	CHECK(mkdtemp(folder));
	snprintf(state_path, sizeof(state_path), "%s/state.db", folder);
	snprintf(trust_path, sizeof(trust_path), "%s/1.json", folder);
	write_trust();
	memset(&told, 0, sizeof(told));
	return 0;
}

static int leave_museum(void **unused)
{
	char command[128];

	(void)unused;
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	return system(command);
}

static struct updater *open_follow(void)
{
	const struct updater_options options = {
		.state_path = state_path,
		.trust_path = trust_path,
		.begin = on_begin,
		.remembered = on_remembered,
	};
	struct updater *updater;

	CHECK(updater_create(&updater, &options) == 0);
	updater_start(updater);
	return updater;
}

static struct hash root_of(uint8_t n)
{
	struct hash root;

	memset(root.bytes, n, HASH_BYTES);
	return root;
}

/* The fetcher brings the metadata of a release. */
static void offer(struct updater *updater, uint64_t sequence, uint8_t root, enum meta_source source)
{
	const int64_t expires_s = clock_wall_s() + expires_in_s;
	const struct release release = { .sequence = sequence,
					 .root = root_of(root),
					 .root_bytes = 100,
					 .expires_s = expires_s };
	struct timestamp timestamp = { .sequence = sequence,
				       .expires_s = expires_s,
				       .issued_s = issued_s };
	struct buffer file, stamp;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	buffer_init(&stamp, METADATA_FILE_BYTES_MAX);
	CHECK(release_encode(&file, &release, &release_key, 1) == 0);
	timestamp.release = hash_of(buffer_bytes(&file));
	CHECK(timestamp_encode(&stamp, &timestamp, &timestamp_key, 1) == 0);
	updater_meta(updater, META_TIMESTAMP, 0, buffer_bytes(&stamp), source);
	updater_meta(updater, META_RELEASE, 0, buffer_bytes(&file), source);
	buffer_finish(&file);
	buffer_finish(&stamp);
}

static void publish(struct updater *updater, uint64_t sequence, uint8_t root)
{
	offer(updater, sequence, root, META_FROM_SERVER);
}

static void dispatch(struct updater *updater)
{
	struct pollfd ready = { .fd = updater_fd(updater), .events = POLLIN };

	CHECK(poll(&ready, 1, 60000) == 1);
	CHECK(updater_dispatch(updater) == 0);
}

static void show(struct updater *updater, uint8_t root)
{
	updater_remember(updater, root_of(root));
	dispatch(updater);
	CHECK(hash_equal(told.remembered_root, root_of(root)));
}

static void begins_a_release_and_remembers_it_once_shown(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	CHECK(told.begun == 0);
	publish(updater, 1, 0x11);
	CHECK(told.begun == 1 && hash_equal(told.begun_root, root_of(0x11)));
	publish(updater, 1, 0x11); /* it is on its way */
	CHECK(told.begun == 1 && told.remembered == 0);
	show(updater, 0x11);
	CHECK(told.remembered == 1 && told.failed == 0);
	updater_destroy(updater);
	updater = open_follow();
	CHECK(told.begun == 2 && hash_equal(told.begun_root, root_of(0x11)));
	publish(updater, 1, 0x11); /* it is there already */
	CHECK(told.begun == 2);
	updater_destroy(updater);
}

static void forgets_a_release_that_was_never_shown(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	publish(updater, 1, 0x11);
	show(updater, 0x11);
	publish(updater, 2, 0x22);
	updater_destroy(updater);
	updater = open_follow();
	CHECK(hash_equal(told.begun_root, root_of(0x11)));
	updater_destroy(updater);
}

static void takes_the_newest_of_two_that_come_in_a_row(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	publish(updater, 1, 0x11);
	publish(updater, 2, 0x22);
	CHECK(told.begun == 2 && hash_equal(told.begun_root, root_of(0x22)));
	/* The first is shown after all: that must not be written down as the second. */
	updater_remember(updater, root_of(0x11));
	CHECK(told.remembered == 1);
	updater_destroy(updater);
	told.begun = 0;
	updater = open_follow();
	CHECK(told.begun == 0);
	updater_destroy(updater);
}

static void goes_back_to_the_pictures_on_the_panel(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	publish(updater, 1, 0x11);
	show(updater, 0x11);
	publish(updater, 2, 0x22);
	publish(updater, 3, 0x11); /* the museum took 2 back while it was coming */
	CHECK(told.begun == 3 && hash_equal(told.begun_root, root_of(0x11)));
	dispatch(updater); /* the new number is written without being asked for */
	CHECK(told.remembered == 2 && hash_equal(told.remembered_root, root_of(0x11)));
	publish(updater, 2, 0x22);
	CHECK(told.begun == 3);                      /* older than what was seen */
	CHECK(updater_refusal(updater)->count == 1); /* the cause, in words for later */
	CHECK(strcmp(updater_refusal(updater)->what, "timestamp.json") == 0);
	CHECK(strstr(updater_refusal(updater)->why, "older") && updater_refusal(updater)->at_s > 0);
	updater_destroy(updater);
}

/* As a kiosk that works, and is followed by another. */
static void show_and_prove(struct updater *updater, uint64_t sequence, uint8_t root)
{
	publish(updater, sequence, root);
	show(updater, root);
	updater_prove(updater);
}

static void returns_to_the_one_before_after_three_starts_without_a_picture(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	show_and_prove(updater, 1, 0x11);
	publish(updater, 2, 0x22);
	show(updater, 0x22);
	for (int crash = 1; crash <= 3; crash++) {
		CHECK(updater_on_trial(updater) && hash_equal(told.begun_root, root_of(0x22)));
		updater_destroy(updater);
		updater = open_follow();
	}
	CHECK(hash_equal(told.begun_root, root_of(0x11)) && !updater_on_trial(updater));
	CHECK(strcmp(updater_refusal(updater)->what, "release 2") == 0);
	CHECK(strstr(updater_refusal(updater)->why, "three times"));
	told.begun = 0;
	publish(updater, 2, 0x22); /* the server still has it: nothing happens */
	CHECK(told.begun == 0);
	publish(updater, 3, 0x33);
	CHECK(told.begun == 1 && hash_equal(told.begun_root, root_of(0x33)));
	updater_destroy(updater);
}

static void keeps_a_release_that_was_seen_to_work(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	show_and_prove(updater, 1, 0x11);
	show_and_prove(updater, 2, 0x22);
	for (int crash = 0; crash < 5; crash++) {
		updater_destroy(updater);
		updater = open_follow();
		CHECK(hash_equal(told.begun_root, root_of(0x22)) && !updater_on_trial(updater));
	}
	updater_fall_back(updater, "no");
	CHECK(hash_equal(told.begun_root, root_of(0x22)) && updater_refusal(updater)->count == 0);
	updater_destroy(updater);
}

static void falls_back_while_it_runs_and_stays_so(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	show_and_prove(updater, 1, 0x11);
	publish(updater, 2, 0x22);
	show(updater, 0x22);
	updater_fall_back(updater, "nothing to be seen");
	for (int start = 0; start < 2; start++) {
		CHECK(hash_equal(told.begun_root, root_of(0x11)) && !updater_on_trial(updater));
		told.begun = 0;
		publish(updater, 2, 0x22); /* the floor did not fall */
		publish(updater, 1, 0x11);
		CHECK(told.begun == 0);
		updater_destroy(updater);
		updater = open_follow();
	}
	updater_destroy(updater);
}

static void begins_no_release_again_that_cannot_be_decoded(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	show_and_prove(updater, 1, 0x11);
	publish(updater, 2, 0x22);
	updater_refuse(updater, root_of(0x22), "objects of it cannot be decoded");
	CHECK(strcmp(updater_refusal(updater)->what, "release 2") == 0);
	told.begun = 0;
	publish(updater, 2, 0x22);
	CHECK(told.begun == 0);
	updater_destroy(updater);
}

static void takes_a_stick_by_the_same_rules(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	offer(updater, 5, 0x55, META_FROM_STICK);
	CHECK(told.begun == 1 && updater_next_on_stick(updater));
	show(updater, 0x55);
	CHECK(!updater_next_on_stick(updater));
	offer(updater, 4, 0x44, META_FROM_STICK);
	CHECK(told.begun == 1 && updater_refusal(updater)->count == 1);
	CHECK(strcmp(updater_refusal(updater)->what, "timestamp.json of the stick") == 0);
	CHECK(strstr(updater_refusal(updater)->why, "older"));
	publish(updater, 6, 0x66);
	CHECK(told.begun == 2 && !updater_next_on_stick(updater));
	offer(updater, 6, 0x66, META_FROM_STICK); /* the same, nearer */
	CHECK(told.begun == 2 && updater_next_on_stick(updater));
	updater_destroy(updater);
}

/* As the fetcher is told: it looks for the next one. */
static void says_which_root_it_has_verified(void **unused)
{
	static const uint8_t page[] = "<html>Please log in";
	struct updater *updater = open_follow();
	struct trust_root root = root_of_version(2);
	struct buffer file;

	(void)unused;
	CHECK(updater_root_version(updater) == 1);
	updater_meta(updater, META_ROOT, 2, (struct bytes){ page, sizeof(page) }, META_FROM_SERVER);
	CHECK(updater_root_version(updater) == 1);
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	CHECK(trust_root_encode(&file, &root, &root_key, 1) == 0);
	updater_meta(updater, META_ROOT, 3, buffer_bytes(&file), META_FROM_SERVER);
	CHECK(updater_root_version(updater) == 1);
	updater_meta(updater, META_ROOT, 2, buffer_bytes(&file), META_FROM_SERVER);
	CHECK(updater_root_version(updater) == 2);
	buffer_finish(&file);
	updater_destroy(updater);
	updater = open_follow();
	CHECK(updater_root_version(updater) == 2); /* remembered */
	updater_destroy(updater);
}

/* Expired while nobody looked: what is shown stays, only updates are refused. */
static void keeps_showing_what_has_expired(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	show_and_prove(updater, 1, 0x11);
	expires_in_s = -DAY_S;
	publish(updater, 2, 0x22);
	expires_in_s = DAY_S;
	CHECK(told.begun == 1 && updater_refusal(updater)->count == 1);
	CHECK(strstr(updater_refusal(updater)->why, "expired"));
	updater_destroy(updater);
	told.begun = 0;
	updater = open_follow();
	CHECK(told.begun == 1 && hash_equal(told.begun_root, root_of(0x11)));
	updater_destroy(updater);
}

/* ---- the clock */

static void reopen(struct updater **updater)
{
	updater_destroy(*updater);
	*updater = open_follow();
}

/* Metadata that is good by any clock, taken while somebody on the network says it is 2099. */
static void a_clock_that_is_wrong_for_a_day_spoils_nothing(void **unused)
{
	struct updater *updater = open_follow();
	struct buffer root;

	(void)unused;
	wall_s = Y2099_S;
	show_and_prove(updater, 1, 0x11);
	encode_root(&root, 2);
	updater_meta(updater, META_ROOT, 2, buffer_bytes(&root), META_FROM_SERVER);
	buffer_finish(&root);
	CHECK(updater_refusal(updater)->count == 0);
	wall_s = TODAY_S;
	for (int start = 0; start < 2; start++) {
		told.begun = 0;
		publish(updater, 2 + (uint64_t)start, 0x22 + (uint8_t)start);
		CHECK(told.begun == 1 && updater_refusal(updater)->count == 0);
		/* And what has expired has. */
		expires_in_s = -DAY_S;
		publish(updater, 9, 0x99);
		expires_in_s = DAY_S;
		CHECK(told.begun == 1 && updater_refusal(updater)->count == 1);
		CHECK(strstr(updater_refusal(updater)->why, "expired"));
		reopen(&updater);
	}
	updater_destroy(updater);
}

/* A clock that was set back a year, and a file that has expired since. */
static void a_signed_time_stands_against_a_clock_that_was_set_back(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	issued_s = TODAY_S;
	show_and_prove(updater, 1, 0x11);
	issued_s = 0;
	wall_s = TODAY_S - 365 * DAY_S;
	expires_in_s = 30 * DAY_S;
	for (int start = 0; start < 2; start++) {
		told.begun = 0;
		publish(updater, 2, 0x22);
		CHECK(told.begun == 0 && strstr(updater_refusal(updater)->why, "expired"));
		reopen(&updater);
	}
	expires_in_s = DAY_S;
	updater_destroy(updater);
}

static void a_publisher_whose_clock_was_ahead_once_blocks_nothing(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	for (uint8_t n = 1; n < 5; n += 2) {
		is_set = n > 1; /* at a start, the network may not have set it yet */
		issued_s = TODAY_S + 300 * DAY_S;
		expires_in_s = 330 * DAY_S;
		show_and_prove(updater, n, 0x10 + n);
		is_set = true;
		issued_s = TODAY_S;
		expires_in_s = 30 * DAY_S;
		show_and_prove(updater, n + 1, 0x10 + n + 1);
		CHECK(updater_refusal(updater)->count == 0);
		reopen(&updater);
	}
	issued_s = 0;
	expires_in_s = DAY_S;
	updater_destroy(updater);
}

/* The same timestamp comes in each round. */
static void a_signed_time_counts_once_the_clock_is_set(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	is_set = false;
	issued_s = TODAY_S;
	show_and_prove(updater, 1, 0x11);
	is_set = true;
	publish(updater, 1, 0x11);
	issued_s = 0;
	wall_s = TODAY_S - 365 * DAY_S;
	publish(updater, 2, 0x22);
	CHECK(told.begun == 1 && strstr(updater_refusal(updater)->why, "expired"));
	wall_s = TODAY_S;
	updater_destroy(updater);
}

/* ---- keys that were stolen */

#define THIEFS_SEQUENCE ((uint64_t)1 << 53)

static void give_root(struct updater *updater, uint32_t version)
{
	struct buffer root;

	encode_root(&root, version);
	updater_meta(updater, META_ROOT, version, buffer_bytes(&root), META_FROM_SERVER);
	buffer_finish(&root);
}

/* The museum's own, then a thief's who has both keys: the last sequence there is, and a time floor
 * in the next century, in which the terminal's clock is by his time server. */
static struct updater *be_robbed(void)
{
	struct updater *updater = open_follow();

	show_and_prove(updater, 7, 0x77);
	wall_s = issued_s = Y2099_S;
	expires_in_s = LATE_S - TODAY_S;
	show_and_prove(updater, THIEFS_SEQUENCE, 0xee);
	wall_s = TODAY_S;
	issued_s = 0;
	expires_in_s = DAY_S;
	publish(updater, 8, 0x88);
	CHECK(hash_equal(told.begun_root, root_of(0xee)) && updater_refusal(updater)->count == 1);
	return updater;
}

static void publishes_again_after_a_theft_when_both_keys_are_changed(void **unused)
{
	const struct signing_key stolen[2] = { release_key, timestamp_key };
	struct updater *updater = be_robbed();
	struct signing_key own[2];

	(void)unused;
	change_key(&release_key);
	change_key(&timestamp_key);
	told.begun = 0;
	give_root(updater, 2);
	CHECK(told.begun == 0); /* what is shown stays, until the museum publishes */
	reopen(&updater);
	CHECK(told.begun == 1 && hash_equal(told.begun_root, root_of(0xee)));
	/* Nothing of before comes back: neither the thief's nor an older one of the museum's. */
	own[0] = release_key;
	own[1] = timestamp_key;
	release_key = stolen[0];
	timestamp_key = stolen[1];
	publish(updater, THIEFS_SEQUENCE, 0xef);
	publish(updater, 7, 0x77);
	CHECK(told.begun == 1);
	release_key = own[0];
	timestamp_key = own[1];
	show_and_prove(updater, 8, 0x88);
	CHECK(updater_sequence(updater) == 8);
	reopen(&updater);
	CHECK(hash_equal(told.begun_root, root_of(0x88)) && updater_sequence(updater) == 8);
	told.begun = 0;
	publish(updater, 7, 0x77); /* and the floor is there again */
	CHECK(told.begun == 0);
	updater_destroy(updater);
}

static void a_root_that_leaves_the_keys_leaves_the_floors(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	issued_s = TODAY_S;
	show_and_prove(updater, 7, 0x77);
	issued_s = 0;
	give_root(updater, 2);
	for (int start = 0; start < 2; start++) {
		told.begun = 0;
		publish(updater, 6, 0x66);
		CHECK(told.begun == 0 && strstr(updater_refusal(updater)->why, "older"));
		wall_s = TODAY_S - 365 * DAY_S;
		publish(updater, 8, 0x88);
		CHECK(told.begun == 0 && strstr(updater_refusal(updater)->why, "expired"));
		wall_s = TODAY_S;
		reopen(&updater);
	}
	updater_destroy(updater);
}

static void stops_bringing_what_a_key_signed_that_is_trusted_no_more(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	show_and_prove(updater, 7, 0x77);
	publish(updater, THIEFS_SEQUENCE, 0xee);
	CHECK(hash_equal(told.begun_root, root_of(0xee)));
	change_key(&release_key);
	give_root(updater, 2);
	CHECK(hash_equal(told.begun_root, root_of(0x77)));
	/* It had come whole just now: it is not remembered. */
	updater_remember(updater, root_of(0xee));
	reopen(&updater);
	CHECK(hash_equal(told.begun_root, root_of(0x77)));
	show_and_prove(updater, 8, 0x88);
	updater_destroy(updater);
}

/* The thief's release is being written when the root comes: the root is taken at the next round,
 * else the release would raise the floor that the root had cleared. */
static void takes_a_root_after_what_is_being_written(void **unused)
{
	struct updater *updater = open_follow();

	(void)unused;
	show_and_prove(updater, 7, 0x77);
	publish(updater, THIEFS_SEQUENCE, 0xee);
	updater_remember(updater, root_of(0xee));
	change_key(&release_key);
	change_key(&timestamp_key);
	give_root(updater, 2);
	dispatch(updater);
	give_root(updater, 2);
	show_and_prove(updater, 8, 0x88);
	reopen(&updater);
	CHECK(hash_equal(told.begun_root, root_of(0x88)) && updater_sequence(updater) == 8);
	updater_destroy(updater);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(begins_a_release_and_remembers_it_once_shown,
						enter_museum, leave_museum),
		cmocka_unit_test_setup_teardown(forgets_a_release_that_was_never_shown,
						enter_museum, leave_museum),
		cmocka_unit_test_setup_teardown(takes_the_newest_of_two_that_come_in_a_row,
						enter_museum, leave_museum),
		cmocka_unit_test_setup_teardown(goes_back_to_the_pictures_on_the_panel,
						enter_museum, leave_museum),
		cmocka_unit_test_setup_teardown(
			returns_to_the_one_before_after_three_starts_without_a_picture,
			enter_museum, leave_museum),
		cmocka_unit_test_setup_teardown(keeps_a_release_that_was_seen_to_work, enter_museum,
						leave_museum),
		cmocka_unit_test_setup_teardown(falls_back_while_it_runs_and_stays_so, enter_museum,
						leave_museum),
		cmocka_unit_test_setup_teardown(begins_no_release_again_that_cannot_be_decoded,
						enter_museum, leave_museum),
		cmocka_unit_test_setup_teardown(takes_a_stick_by_the_same_rules, enter_museum,
						leave_museum),
		cmocka_unit_test_setup_teardown(says_which_root_it_has_verified, enter_museum,
						leave_museum),
		cmocka_unit_test_setup_teardown(keeps_showing_what_has_expired, enter_museum,
						leave_museum),
		cmocka_unit_test_setup_teardown(a_clock_that_is_wrong_for_a_day_spoils_nothing,
						enter_museum, leave_museum),
		cmocka_unit_test_setup_teardown(
			a_publisher_whose_clock_was_ahead_once_blocks_nothing, enter_museum,
			leave_museum),
		cmocka_unit_test_setup_teardown(a_signed_time_counts_once_the_clock_is_set,
						enter_museum, leave_museum),
		cmocka_unit_test_setup_teardown(
			a_signed_time_stands_against_a_clock_that_was_set_back, enter_museum,
			leave_museum),
		cmocka_unit_test_setup_teardown(
			publishes_again_after_a_theft_when_both_keys_are_changed, enter_museum,
			leave_museum),
		cmocka_unit_test_setup_teardown(a_root_that_leaves_the_keys_leaves_the_floors,
						enter_museum, leave_museum),
		cmocka_unit_test_setup_teardown(
			stops_bringing_what_a_key_signed_that_is_trusted_no_more, enter_museum,
			leave_museum),
		cmocka_unit_test_setup_teardown(takes_a_root_after_what_is_being_written,
						enter_museum, leave_museum),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
