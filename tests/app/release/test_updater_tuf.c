/* The updater of a terminal that goes over to The Update Framework and follows it. */
#include "app/release/updater.h"

#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/clock.h"
#include "tests/app/release/tuf_museum.h"

/* In place of the machine's: a clock that is set. */
static int64_t wall_s;

int64_t clock_wall_s(void)
{
	return wall_s;
}

bool clock_wall_is_set(void)
{
	return true;
}

static char folder[64], state_path[96], trust_path[96];
static struct updater *updater;

/* What the updater asked for last, and the release that it began last. */
static struct message_file wish;
static bool wishes;
static int begun;
static struct hash begun_root;

static void on_begin(void *data, struct hash root, uint32_t root_bytes)
{
	(void)data;
	CHECK(root_bytes == 100);
	begun++;
	begun_root = root;
}

static void on_remembered(void *data, struct hash root, int rc)
{
	(void)data;
	(void)root;
	CHECK(rc == 0);
}

static void on_ask(void *data, const struct message_file *file)
{
	(void)data;
	CHECK(message_name_is_fine(file->name));
	wish = *file;
	wishes = true;
}

static void start(void)
{
	const struct updater_options options = {
		.state_path = state_path,
		.trust_path = trust_path,
		.begin = on_begin,
		.remembered = on_remembered,
		.ask = on_ask,
	};

	wishes = false;
	begun = 0;
	CHECK(updater_create(&updater, &options) == 0);
	updater_start(updater);
}

static void start_again(void)
{
	updater_destroy(updater);
	start();
}

static struct trust_root earlier_root(void)
{
	const struct signing_key *const of[] = { &root_key, &release_key, &timestamp_key };
	struct trust_root root = { .version = 1, .expires_s = LATER_S };

	for (int role = 0; role < 3; role++) {
		memcpy(root.roles[role].keys[0], of[role]->public_key, KEY_BYTES);
		root.roles[role].key_count = root.roles[role].threshold = 1;
	}
	return root;
}

static int set_up(void **unused)
{
	struct trust_root root;
	struct buffer file;

	(void)unused;
	wall_s = NOW_S;
	museum_open();
	snprintf(folder, sizeof(folder), "/tmp/gopura-tuf-XXXXXX");
	CHECK(mkdtemp(folder));
	snprintf(state_path, sizeof(state_path), "%s/state.db", folder);
	snprintf(trust_path, sizeof(trust_path), "%s/root.json", folder);
	root = earlier_root();
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	CHECK(trust_root_encode(&file, &root, &root_key, 1) == 0);
	CHECK(bytes_write_file(buffer_bytes(&file), trust_path) == 0);
	buffer_finish(&file);
	publish_root(1);
	start();
	return 0;
}

static int tear_down(void **unused)
{
	char command[128];

	(void)unused;
	updater_destroy(updater);
	museum_close();
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	return system(command);
}

/* Answers from the museum's files until nothing is asked for. */
static void answer_all(void)
{
	for (int i = 0; i < 40 && wishes; i++) {
		struct message_file answer = wish;

		wishes = false;
		answer.bytes = file_of(wish.name);
		answer.answer = answer.bytes.size ? FILE_IS_HERE : FILE_NOT_THERE;
		updater_file(updater, &answer);
	}
	CHECK(!wishes);
}

/* The fetcher brings the museum's timestamp. */
static void look(void)
{
	updater_meta(updater, META_TIMESTAMP, 0, file_of("timestamp.json"), META_FROM_SERVER);
	answer_all();
}

/* Offers a release in the earlier form; tuf_root: what it says of roots of the other. */
static void offer_earlier(uint32_t n, uint32_t tuf_root)
{
	const struct release release = { .sequence = n,
					 .expires_s = LATER_S,
					 .root = { { (uint8_t)n } },
					 .root_bytes = 100,
					 .tuf_root = tuf_root };
	struct timestamp timestamp = { .sequence = n, .expires_s = LATER_S };
	struct buffer file, stamp;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	buffer_init(&stamp, METADATA_FILE_BYTES_MAX);
	CHECK(release_encode(&file, &release, &release_key, 1) == 0);
	timestamp.release = hash_of(buffer_bytes(&file));
	CHECK(timestamp_encode(&stamp, &timestamp, &timestamp_key, 1) == 0);
	updater_meta(updater, META_TIMESTAMP, 0, buffer_bytes(&stamp), META_FROM_SERVER);
	updater_meta(updater, META_RELEASE, 0, buffer_bytes(&file), META_FROM_SERVER);
	answer_all();
	buffer_finish(&file);
	buffer_finish(&stamp);
}

static void show(uint8_t n)
{
	struct pollfd ready = { .fd = updater_fd(updater), .events = POLLIN };

	updater_remember(updater, (struct hash){ { n } });
	CHECK(poll(&ready, 1, 60000) == 1);
	CHECK(updater_dispatch(updater) == 0 && updater_sequence(updater) == n);
}

static struct updater_trust trusted(void)
{
	struct updater_trust trust;

	updater_trust(updater, &trust);
	return trust;
}

static void go_over(void)
{
	offer_earlier(1, 1);
	show(1);
	CHECK(updater_root_version(updater) == MESSAGE_TRUST_TUF && trusted().tuf);
}

static void goes_over_and_reads_the_earlier_form_no_more(void **unused)
{
	(void)unused;
	offer_earlier(1, 0);
	CHECK(begun == 1 && updater_root_version(updater) == 1 && !trusted().tuf);
	offer_earlier(2, 1);
	show(2);
	CHECK(updater_root_version(updater) == MESSAGE_TRUST_TUF && trusted().root_version == 1);
	begun = 0;
	offer_earlier(3, 1);
	CHECK(begun == 0);
	publish(4);
	look();
	CHECK(begun == 1 && begun_root.bytes[0] == 4);
	CHECK(trusted().timestamp_version == 4 && trusted().timestamp_expires_s == LATER_S);
	show(4);
	start_again(); /* it remembers */
	CHECK(begun == 1 && begun_root.bytes[0] == 4);
	CHECK(updater_root_version(updater) == MESSAGE_TRUST_TUF);
	CHECK(trusted().timestamp_version == 4);
	publish(3);
	look();
	CHECK(begun == 1 && strstr(updater_refusal(updater)->why, "older"));
}

static void stays_with_the_earlier_form_where_strangers_offer_a_root(void **unused)
{
	const struct signing_key right = root_key;

	(void)unused;
	root_key = other_key;
	publish_root(1);
	root_key = right;
	offer_earlier(1, 1);
	CHECK(begun == 1 && updater_root_version(updater) == 1);
	CHECK(strstr(updater_refusal(updater)->why, "not signed by the root keys"));
	publish_root(1);
	offer_earlier(2, 1); /* it asks anew */
	CHECK(begun == 2 && updater_root_version(updater) == MESSAGE_TRUST_TUF);
}

static void goes_over_in_a_later_round_where_the_root_was_not_there_yet(void **unused)
{
	(void)unused;
	museum_close(); /* it has no files */
	offer_earlier(1, 1);
	CHECK(begun == 1 && updater_root_version(updater) == 1);
	CHECK(strstr(updater_refusal(updater)->why, "not there"));
	publish_root(1);
	offer_earlier(1, 1); /* the same, in the next round */
	CHECK(begun == 1 && updater_root_version(updater) == MESSAGE_TRUST_TUF);
}

static void a_release_below_the_one_that_is_shown_is_refused(void **unused)
{
	(void)unused;
	go_over();
	publish(7);
	look();
	show(7);
	publish(6);
	publish_timestamp(8, 6); /* the snapshot is older too: TUF refuses it first */
	look();
	CHECK(strstr(updater_refusal(updater)->why, "older"));
	CHECK(begun == 2 && begun_root.bytes[0] == 7);
}

static void a_root_that_withdraws_keys_drops_what_they_signed_and_its_floor(void **unused)
{
	(void)unused;
	go_over();
	publish(200); /* by a thief */
	look();
	show(200);
	publish(201);
	look();
	CHECK(begun_root.bytes[0] == 201); /* it is being loaded */
	make_key(&release_key);
	make_key(&timestamp_key);
	publish_root(2);
	publish(2);
	look();
	CHECK(trusted().root_version == 2 && begun_root.bytes[0] == 2);
	CHECK(strstr(updater_refusal(updater)->why, "no longer trusted"));
	show(2);
	start_again();
	CHECK(begun_root.bytes[0] == 2 && trusted().root_version == 2);
}

static void the_signed_time_stands_against_a_clock_that_was_set_back(void **unused)
{
	(void)unused;
	go_over();
	issued_s = NOW_S;
	publish(2);
	look();
	CHECK(begun_root.bytes[0] == 2);
	issued_s = 0;
	expires_s = NOW_S - 10;
	publish(3);
	wall_s = NOW_S - 1000;
	look();
	CHECK(begun_root.bytes[0] == 2 && strstr(updater_refusal(updater)->why, "expired"));
}

static void a_publisher_whose_clock_was_ahead_once_blocks_nothing(void **unused)
{
	(void)unused;
	go_over();
	issued_s = NOW_S + 300 * 86400;
	publish(2);
	look();
	show(2);
	issued_s = NOW_S;
	expires_s = NOW_S + 30 * 86400;
	publish(3);
	look();
	CHECK(begun_root.bytes[0] == 3 && updater_refusal(updater)->count == 0);
}

static void begins_with_a_root_of_tuf_that_was_given(void **unused)
{
	char second_path[128];

	(void)unused;
	updater_destroy(updater);
	snprintf(second_path, sizeof(second_path), "%s.second", state_path);
	CHECK(unlink(state_path) == 0 && unlink(second_path) == 0);
	CHECK(bytes_write_file(file_of("1.root.json"), trust_path) == 0);
	start();
	CHECK(updater_root_version(updater) == MESSAGE_TRUST_TUF);
	publish(1);
	look();
	CHECK(begun == 1);
	show(1);
	CHECK(unlink(trust_path) == 0);
	start_again();
	CHECK(updater_root_version(updater) == MESSAGE_TRUST_TUF && begun == 1);
}

#define IN_A_MUSEUM(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		IN_A_MUSEUM(goes_over_and_reads_the_earlier_form_no_more),
		IN_A_MUSEUM(stays_with_the_earlier_form_where_strangers_offer_a_root),
		IN_A_MUSEUM(goes_over_in_a_later_round_where_the_root_was_not_there_yet),
		IN_A_MUSEUM(a_release_below_the_one_that_is_shown_is_refused),
		IN_A_MUSEUM(a_root_that_withdraws_keys_drops_what_they_signed_and_its_floor),
		IN_A_MUSEUM(a_publisher_whose_clock_was_ahead_once_blocks_nothing),
		IN_A_MUSEUM(the_signed_time_stands_against_a_clock_that_was_set_back),
		IN_A_MUSEUM(begins_with_a_root_of_tuf_that_was_given),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
