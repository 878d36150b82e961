/* What becomes of a release that nobody changes for years. */
#include <errno.h>
#include <limits.h>

#include "base/clock.h"
#include "pipeline/keys/keys_exchange.h"
#include "pipeline/keys/keys_tuf.h"
#include "pipeline/release/publish.h"
#include "pipeline/release/published.h"
#include "pipeline/release/verify.h"
#include "tests/pipeline/release/tiny_fixture.h"

enum { DAY_S = 86400 };

static int64_t ahead_s; /* of the machine's clock */

int64_t __real_clock_wall_s(void);
int64_t __wrap_clock_wall_s(void);

int64_t __wrap_clock_wall_s(void)
{
	return __real_clock_wall_s() + ahead_s;
}

static void go_to_day(int day)
{
	ahead_s = (int64_t)day * DAY_S;
}

static int enter(void **state)
{
	ahead_s = 0;
	return set_up(state);
}

/* As a client without anything would, by the clock of this test. target: NULL: release.json. */
static void check_valid_at(uint64_t sequence, const char *target)
{
	const struct release_reader_options options = { .place = tiny.release };
	struct verify_options verify = { .now_s = clock_wall_s(), .target = target };
	struct verify_report report;

	CHECK(release_reader_create(&verify.reader, &options) == 0);
	if (verify_release(&report, &verify) < 0)
		fail_msg("%s", report.diagnostics.first.text);
	CHECK(report.release.sequence == sequence);
	release_reader_destroy(verify.reader);
}

static void check_valid(uint64_t sequence)
{
	check_valid_at(sequence, NULL);
}

static void publishing_what_has_not_changed_signs_it_again_in_time(void **state)
{
	const struct publish_report first = tiny_publish(&tiny, "the first");
	struct publish_report again;

	(void)state;
	for (int year = 1; year <= 3; year++) {
		go_to_day(year * (RELEASE_LIFE_DAYS / 5) - 1);
		again = tiny_publish(&tiny, NULL);
		CHECK(!again.changed && again.release.sequence == 1);
	}
	go_to_day(RELEASE_LIFE_DAYS * 3 / 5 + 1);
	again = tiny_publish(&tiny, NULL);
	CHECK(again.changed && again.release.sequence == 2 && again.packs.packs_written == 0);
	CHECK(hash_equal(again.release.root, first.release.root));
	CHECK(strcmp(again.release.comment, "the first") == 0);
	CHECK(again.release.expires_s >= clock_wall_s() + (int64_t)RELEASE_LIFE_DAYS * DAY_S - 60);
	again = tiny_publish(&tiny, NULL);
	CHECK(!again.changed && again.release.sequence == 2);
	check_valid(2);
}

static void a_nightly_renewal_keeps_a_release_valid_for_ever(void **state)
{
	const struct publish_target target = tiny_target(&tiny);
	struct publish_report report;

	(void)state;
	tiny_publish(&tiny, NULL);
	for (int day = 0; day < 20 * 365; day += 20) {
		go_to_day(day);
		CHECK(publish_renew(&report, &target) == 0);
		check_valid(report.release.sequence);
	}
	CHECK(report.release.sequence == 7);
}

static void a_release_that_lives_for_weeks_is_not_signed_each_night(void **state)
{
	struct publish_target target = tiny_target(&tiny);
	struct publish_report report;

	(void)state;
	target.release_life_s = 30 * DAY_S;
	tiny_publish(&tiny, NULL);
	CHECK(publish_again(&report, &target, 1) == 0 && report.release.sequence == 2);
	for (int day = 0; day < 60; day++) {
		go_to_day(day);
		CHECK(publish_renew(&report, &target) == 0);
		check_valid(report.release.sequence);
	}
	CHECK(report.release.sequence == 5);
}

/* In both forms first, then in that one alone. */
static void metadata_of_the_update_framework_is_signed_again_with_it(void **state)
{
	struct publish_target target = tiny_target(&tiny);
	struct publish_report report;
	int64_t expires_s;

	(void)state;
	CHECK(keys_make_tuf_root(tiny.keys_at, &tiny.keys) == 0);
	tiny_publish(&tiny, NULL);
	target.trust_clock = true;
	for (int alone = 0; alone < 2; alone++) {
		target.tuf_alone = alone;
		ahead_s += (RELEASE_LIFE_DAYS * 3 / 5 + 1) * (int64_t)DAY_S;
		CHECK(publish_renew(&report, &target) == 0 && report.changed);
		CHECK(published_expires_s(&target, &report.release, &expires_s) == 0);
		CHECK(expires_s >= clock_wall_s() + (int64_t)RELEASE_LIFE_DAYS * DAY_S - 60);
		CHECK(publish_renew(&report, &target) == 0 && !report.changed);
		check_valid(report.release.sequence);
	}
}

/* The snapshot is that of all temples in the folder. */
static void a_release_of_weeks_leaves_the_snapshot_its_years(void **state)
{
	struct publish_target target = tiny_target(&tiny);
	const struct tuf_place place = published_place(&target);
	struct publish_report report;
	struct tuf_folder folder;

	(void)state;
	CHECK(keys_make_tuf_root(tiny.keys_at, &tiny.keys) == 0);
	tiny_publish(&tiny, NULL);
	target.tuf_alone = true;
	target.release_life_s = 30 * DAY_S;
	CHECK(publish_again(&report, &target, 1) == 0);
	CHECK(tuf_folder_open(&folder, &place) == 0);
	CHECK(folder.top.expires_s <= clock_wall_s() + 30 * DAY_S);
	CHECK(folder.snapshot.expires_s >=
	      clock_wall_s() + (int64_t)RELEASE_LIFE_DAYS * DAY_S - 60);
	tuf_folder_finish(&folder);
}

/* ---- a machine whose clock is wrong */

/* What the release folder has, as text. */
static struct hash all_files(void)
{
	char command[200];
	struct buffer list;
	FILE *pipe;
	int byte;

	snprintf(command, sizeof(command), "cd '%s' && find . -type f | sort | xargs cksum",
		 tiny.release);
	buffer_init(&list, 1 << 20);
	pipe = popen(command, "r");
	CHECK(pipe != NULL);
	while ((byte = fgetc(pipe)) != EOF)
		buffer_put_u8(&list, (uint8_t)byte);
	CHECK(pclose(pipe) == 0 && list.size > 0);
	const struct hash hash = hash_of(buffer_bytes(&list));
	buffer_finish(&list);
	return hash;
}

static void check_refused(const struct publish_target *target, int64_t clock_s)
{
	const struct hash before = all_files();
	const int64_t right_s = ahead_s;
	struct publish_report report;

	ahead_s += clock_s;
	CHECK(publish_renew(&report, target) == -ECANCELED);
	CHECK(publish_again(&report, target, 1) == -ECANCELED);
	CHECK(hash_equal(all_files(), before));
	ahead_s = right_s;
}

static void a_clock_that_disagrees_with_the_last_timestamp_signs_nothing(void **state)
{
	struct publish_target target = tiny_target(&tiny);
	struct publish_report report;

	(void)state;
	CHECK(keys_make_tuf_root(tiny.keys_at, &tiny.keys) == 0);
	tiny_publish(&tiny, NULL);
	for (int alone = 0; alone < 2; alone++) {
		target.tuf_alone = alone;
		CHECK(publish_again(&report, &target, 1) == 0);
		check_refused(&target, -6 * 365 * (int64_t)DAY_S); /* an empty battery */
		check_refused(&target, -DAY_S - 60);
		check_refused(&target, 401 * (int64_t)DAY_S);
		ahead_s -= DAY_S - 60; /* of another machine */
		CHECK(publish_renew(&report, &target) == 0);
		ahead_s += DAY_S - 60 + 399 * (int64_t)DAY_S;
		CHECK(publish_renew(&report, &target) == 0);
		/* That was wrong: a person says so. */
		ahead_s -= 399 * (int64_t)DAY_S;
		check_refused(&target, 0);
		target.trust_clock = true;
		CHECK(publish_renew(&report, &target) == 0);
		target.trust_clock = false;
		CHECK(publish_renew(&report, &target) == 0);
	}
}

/* A thief's timestamp says any time; the key that replaces his says that it counts for nothing. */
static void a_timestamp_of_a_key_that_was_exchanged_tells_no_time(void **state)
{
	struct publish_target target = tiny_target(&tiny);
	struct keys_exchanged exchanged;
	struct publish_report report;

	(void)state;
	CHECK(keys_make_tuf_root(tiny.keys_at, &tiny.keys) == 0);
	go_to_day(300);
	tiny_publish(&tiny, NULL);
	go_to_day(0);
	for (int alone = 0; alone < 2; alone++) {
		target.tuf_alone = alone;
		check_refused(&target, 0);
	}
	CHECK(keys_exchange(&exchanged, tiny.keys_at, 1 << EXCHANGE_TIMESTAMP) == 0);
	keys_finish(&tiny.keys);
	CHECK(keys_load(&tiny.keys, tiny.keys_at) == 0);
	for (int alone = 0; alone < 2; alone++) {
		target.tuf_alone = alone;
		CHECK(publish_renew(&report, &target) == 0);
	}
}

/* ---- keys and files of earlier days */

/* The keys as they were are in *out and in old: a second machine, or a backup. */
static void keep_old_keys(struct publisher_keys *out, char old[PATH_MAX])
{
	char command[400];

	snprintf(old, PATH_MAX, "%s/old", tiny.folder);
	snprintf(command, sizeof(command), "cp -a '%s' '%s'", tiny.keys_at, old);
	CHECK(system(command) == 0);
	CHECK(keys_load(out, old) == 0);
}

static void keys_that_were_exchanged_elsewhere_sign_nothing(void **state)
{
	struct publish_target target = tiny_target(&tiny);
	struct publish_target behind = target;
	struct keys_exchanged exchanged;
	struct publish_report report;
	struct publisher_keys keys;
	char old[PATH_MAX];

	(void)state;
	CHECK(keys_make_tuf_root(tiny.keys_at, &tiny.keys) == 0);
	tiny_publish(&tiny, NULL);
	keep_old_keys(&keys, old);
	behind.keys = &keys;
	behind.keys_folder = old;
	CHECK(keys_exchange(&exchanged, tiny.keys_at, 1 << EXCHANGE_TIMESTAMP) == 0);
	keys_finish(&tiny.keys);
	CHECK(keys_load(&tiny.keys, tiny.keys_at) == 0);
	for (int alone = 0; alone < 2; alone++) {
		struct hash before;

		target.tuf_alone = behind.tuf_alone = alone;
		CHECK(publish_renew(&report, &target) == 0);
		check_valid(1);
		before = all_files();
		CHECK(publish_renew(&report, &behind) == -EKEYREJECTED);
		CHECK(hash_equal(all_files(), before));
		CHECK(publish_again(&report, &behind, 1) == -EKEYREJECTED);
		check_valid(1);
		CHECK(publish_renew(&report, &target) == 0);
	}
	keys_finish(&keys);
}

/* The root key alone is another: who has the old roots may still publish. */
static void keys_that_the_newest_root_still_names_sign(void **state)
{
	struct publish_target behind = tiny_target(&tiny);
	struct keys_exchanged exchanged;
	struct publish_report report;
	struct publisher_keys keys;
	char old[PATH_MAX];

	(void)state;
	CHECK(keys_make_tuf_root(tiny.keys_at, &tiny.keys) == 0);
	tiny_publish(&tiny, NULL);
	keep_old_keys(&keys, old);
	CHECK(keys_exchange(&exchanged, tiny.keys_at, 1 << EXCHANGE_ROOT) == 0);
	tiny_publish(&tiny, NULL);
	behind.keys = &keys;
	behind.keys_folder = old;
	for (int alone = 0; alone < 2; alone++) {
		behind.tuf_alone = alone;
		CHECK(publish_again(&report, &behind, 1) == 0);
		check_valid(report.release.sequence);
	}
	keys_finish(&keys);
}

/* Such a file keeps terminals away, but no publisher. */
static void a_root_that_does_not_follow_ends_the_search(void **state)
{
	struct publish_target target = tiny_target(&tiny);
	struct publish_report report;
	char command[400];

	(void)state;
	CHECK(keys_make_tuf_root(tiny.keys_at, &tiny.keys) == 0);
	tiny_publish(&tiny, NULL);
	snprintf(command, sizeof(command),
		 "cd '%s' && cp root/1.json root/2.json && cp tuf/1.root.json tuf/2.root.json",
		 tiny.release);
	CHECK(system(command) == 0);
	for (int alone = 0; alone < 2; alone++) {
		target.tuf_alone = alone;
		CHECK(publish_renew(&report, &target) == 0);
	}
}

/* Terminals of the earlier form would take what is left for the newest release. */
static void going_over_to_one_form_needs_no_other_change(void **state)
{
	struct publish_target target = tiny_target(&tiny);
	struct publish_report report;
	char path[200];

	(void)state;
	CHECK(keys_make_tuf_root(tiny.keys_at, &tiny.keys) == 0);
	tiny_publish(&tiny, NULL);
	target.tuf_alone = true;
	CHECK(publish_renew(&report, &target) == 0 && !report.changed);
	snprintf(path, sizeof(path), "%s/release.json", tiny.release);
	CHECK(access(path, F_OK) < 0);
	snprintf(path, sizeof(path), "%s/timestamp.json", tiny.release);
	CHECK(access(path, F_OK) < 0);
	check_valid(1);
}

/* Terminals have seen higher numbers than the backup has. */
static void a_restored_folder_goes_on_above_what_terminals_have_seen(void **state)
{
	struct publish_target target = tiny_target(&tiny);
	const struct tuf_place place = published_place(&target);
	struct publish_report report;
	struct tuf_folder folder;

	(void)state;
	CHECK(keys_make_tuf_root(tiny.keys_at, &tiny.keys) == 0);
	tiny_publish(&tiny, NULL);
	for (int alone = 0; alone < 2; alone++) {
		const uint32_t above = alone ? 5000 : 1000;

		target.tuf_alone = alone;
		target.above = above;
		CHECK(publish_again(&report, &target, 1 + alone * 1000) == 0);
		CHECK(report.release.sequence == above + 1);
		check_valid(above + 1);
		CHECK(tuf_folder_open(&folder, &place) == 0);
		CHECK(folder.timestamp.version > above && folder.snapshot.version > above);
		tuf_folder_finish(&folder);
		target.above = 7; /* is no way back */
		CHECK(publish_again(&report, &target, above + 1) == 0);
		CHECK(report.release.sequence == above + 2);
		target.above = 0;
		CHECK(publish_renew(&report, &target) == 0 && !report.changed);
		check_valid(above + 2);
	}
}

static void a_target_of_another_path_is_verified_in_both_forms(void **state)
{
	struct publish_target target = tiny_target(&tiny);
	struct publish_report report;

	(void)state;
	tiny_publish(&tiny, NULL);
	CHECK(keys_make_tuf_root(tiny.keys_at, &tiny.keys) == 0);
	target.tuf_target = "angkor/release.json";
	for (int alone = 0; alone < 2; alone++) {
		target.tuf_alone = alone;
		CHECK(publish_again(&report, &target, alone ? 2 : 1) == 0);
		check_valid_at(report.release.sequence, target.tuf_target);
	}
}

/* What is named and not there is not the same as nothing published: numbers would begin again. */
static void a_named_file_that_is_missing_is_not_a_new_folder(void **state)
{
	static const char *const names[] = { "1.snapshot.json", "1.targets.json" };
	struct publish_target target = tiny_target(&tiny);
	struct publish_report report;
	char path[200], aside[200];

	(void)state;
	CHECK(keys_make_tuf_root(tiny.keys_at, &tiny.keys) == 0);
	tiny_publish(&tiny, NULL);
	for (size_t i = 0; i < ARRAY_COUNT(names); i++)
		for (int alone = 0; alone < 2; alone++) {
			struct hash before;

			target.tuf_alone = alone;
			snprintf(path, sizeof(path), "%s/tuf/%s", tiny.release, names[i]);
			snprintf(aside, sizeof(aside), "%s/aside", tiny.folder);
			CHECK(rename(path, aside) == 0);
			before = all_files();
			CHECK(publish_again(&report, &target, 1) == -EBADMSG);
			CHECK(hash_equal(all_files(), before));
			CHECK(rename(aside, path) == 0);
		}
	CHECK(publish_again(&report, &target, 1) == 0 && report.release.sequence == 2);
}

/* docs/release.md: what to do where no copy has such a file. */
static void without_its_timestamp_a_folder_begins_anew_above_all_numbers(void **state)
{
	struct publish_target target = tiny_target(&tiny);
	struct publish_report report;
	char path[200];

	(void)state;
	CHECK(keys_make_tuf_root(tiny.keys_at, &tiny.keys) == 0);
	tiny_publish(&tiny, NULL);
	for (uint32_t alone = 0; alone < 2; alone++) {
		target.tuf_alone = alone > 0;
		snprintf(path, sizeof(path), "%s/tuf/%d.snapshot.json", tiny.release,
			 alone ? 101 : 1);
		CHECK(unlink(path) == 0);
		CHECK(publish_renew(&report, &target) == -EBADMSG);
		snprintf(path, sizeof(path), "%s/tuf/timestamp.json", tiny.release);
		CHECK(unlink(path) == 0);
		target.above = 100 + 100 * alone;
		report = tiny_publish_as(&tiny, target);
		CHECK(report.release.sequence == target.above + 1);
		check_valid(target.above + 1);
		target.above = 0;
		CHECK(publish_renew(&report, &target) == 0 && !report.changed);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(
			publishing_what_has_not_changed_signs_it_again_in_time, enter, tear_down),
		cmocka_unit_test_setup_teardown(a_nightly_renewal_keeps_a_release_valid_for_ever,
						enter, tear_down),
		cmocka_unit_test_setup_teardown(
			a_release_that_lives_for_weeks_is_not_signed_each_night, enter, tear_down),
		cmocka_unit_test_setup_teardown(
			metadata_of_the_update_framework_is_signed_again_with_it, enter, tear_down),
		cmocka_unit_test_setup_teardown(a_release_of_weeks_leaves_the_snapshot_its_years,
						enter, tear_down),
		cmocka_unit_test_setup_teardown(
			a_clock_that_disagrees_with_the_last_timestamp_signs_nothing, enter,
			tear_down),
		cmocka_unit_test_setup_teardown(
			a_timestamp_of_a_key_that_was_exchanged_tells_no_time, enter, tear_down),
		cmocka_unit_test_setup_teardown(keys_that_were_exchanged_elsewhere_sign_nothing,
						enter, tear_down),
		cmocka_unit_test_setup_teardown(keys_that_the_newest_root_still_names_sign, enter,
						tear_down),
		cmocka_unit_test_setup_teardown(a_root_that_does_not_follow_ends_the_search, enter,
						tear_down),
		cmocka_unit_test_setup_teardown(going_over_to_one_form_needs_no_other_change, enter,
						tear_down),
		cmocka_unit_test_setup_teardown(a_named_file_that_is_missing_is_not_a_new_folder,
						enter, tear_down),
		cmocka_unit_test_setup_teardown(
			without_its_timestamp_a_folder_begins_anew_above_all_numbers, enter,
			tear_down),
		cmocka_unit_test_setup_teardown(a_target_of_another_path_is_verified_in_both_forms,
						enter, tear_down),
		cmocka_unit_test_setup_teardown(
			a_restored_folder_goes_on_above_what_terminals_have_seen, enter, tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
