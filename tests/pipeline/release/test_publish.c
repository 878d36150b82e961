#include "pipeline/release/publish.h"

#include <dirent.h>
#include <errno.h>
#include <ftw.h>

#include "base/clock.h"
#include "pipeline/release/verify.h"
#include "tests/pipeline/release/tiny_fixture.h"

static struct verify_report verified;

static int syncs_left = -1; /* before the disk is full; -1: it never is */

int __real_fsync(int fd);
int __wrap_fsync(int fd);

int __wrap_fsync(int fd)
{
	if (syncs_left == 0) {
		errno = ENOSPC;
		return -1;
	}
	syncs_left -= syncs_left > 0;
	return __real_fsync(fd);
}

static int renames_left = -1; /* before one of them fails; -1: none does */

int __real_rename(const char *from, const char *to);
int __wrap_rename(const char *from, const char *to);

int __wrap_rename(const char *from, const char *to)
{
	if (renames_left >= 0 && renames_left-- == 0) {
		errno = EIO;
		return -1;
	}
	return __real_rename(from, to);
}

static int verify_at(int64_t now_s)
{
	const struct release_reader_options options = { .place = tiny.release };
	struct verify_options verify = { .now_s = now_s };
	int rc;

	CHECK(release_reader_create(&verify.reader, &options) == 0);
	rc = verify_release(&verified, &verify);
	release_reader_destroy(verify.reader);
	CHECK((rc == 0) == (verified.diagnostics.count == 0));
	return rc;
}

static int verify(void)
{
	return verify_at(clock_wall_s());
}

static int count_files(const char *name)
{
	char path[200];
	struct dirent *entry;
	DIR *folder;
	int count = 0;

	snprintf(path, sizeof(path), "%s/%s", tiny.release, name);
	folder = opendir(path);
	CHECK(folder != NULL);
	while ((entry = readdir(folder)))
		count += entry->d_name[0] != '.';
	closedir(folder);
	return count;
}

static void what_is_published_verifies(void **state)
{
	struct publish_report report = tiny_publish(&tiny, "the first");

	(void)state;
	CHECK(report.changed && report.release.sequence == 1);
	CHECK(report.packs.packs_written > 1 && report.packs.packs_reused == 0);
	CHECK(verify() == 0);
	CHECK(verified.release.sequence == 1);
	CHECK(strcmp(verified.release.comment, "the first") == 0);
	CHECK(strcmp(verified.root.name, "Tiny") == 0);
	CHECK(verified.pages[PAGE_BRICK].count == 2);
	CHECK(verified.pages[PAGE_FACE].count == 10);
	CHECK(verified.points == 5 && verified.faces == 10);
	CHECK(verified.tiles.count == 15 && verified.groups.count == 2);
	CHECK(verified.parts == 1 && verified.files.count == 1);
	CHECK(verified.hierarchy_triangles == 4);
}

static void the_same_again_adds_nothing(void **state)
{
	struct publish_report first = tiny_publish(&tiny, NULL), again;
	int packs = count_files("packs");

	(void)state;
	again = tiny_publish(&tiny, NULL);
	CHECK(!again.changed && again.release.sequence == 1);
	CHECK(hash_equal(again.release.root, first.release.root));
	CHECK(again.packs.packs_written == 0 && count_files("packs") == packs);
	CHECK(verify() == 0);
}

static void the_same_content_gives_the_same_packs(void **state)
{
	struct publish_report first = tiny_publish(&tiny, NULL), second;
	char command[500];

	(void)state;
	snprintf(command, sizeof(command), "mv '%s' '%s.first'", tiny.release, tiny.release);
	CHECK(system(command) == 0);
	second = tiny_publish(&tiny, NULL);
	CHECK(hash_equal(first.release.root, second.release.root));
	snprintf(command, sizeof(command),
		 "diff -r '%s/packs' '%s.first/packs' && diff -r '%s/locator' '%s.first/locator'",
		 tiny.release, tiny.release, tiny.release, tiny.release);
	CHECK(system(command) == 0);
}

static void a_change_adds_only_what_changed(void **state)
{
	struct publish_report first = tiny_publish(&tiny, NULL), second;

	(void)state;
	tiny_parts(&tiny, "High tower");
	second = tiny_publish(&tiny, NULL);
	CHECK(second.changed && second.release.sequence == 2);
	CHECK(!hash_equal(first.release.root, second.release.root));
	CHECK(second.packs.blocks_written == 3); /* the root, its children, the information */
	CHECK(second.packs.blocks_reused == first.packs.blocks_written - 3);
	CHECK(verify() == 0);
	tiny_samples(&tiny, 77, 2); /* one point of five, in the second brick */
	second = tiny_publish(&tiny, NULL);
	CHECK(second.release.sequence == 3);
	CHECK(second.packs.blocks_written == 6); /* root, children, samples, brick, two faces */
	CHECK(verify() == 0);
}

/* The path of the pack of a release that has its last tiles. */
static void last_pack(char path[PATH_MAX], struct hash root)
{
	struct locator locator;
	char hex[HASH_HEX_BYTES];

	CHECK(pack_read_whole(&locator, tiny.release, root) == 0);
	hash_to_hex(locator.packs[locator.pack_count - 1], hex);
	snprintf(path, PATH_MAX, "%s/packs/%s", tiny.release, hex);
	locator_finish(&locator);
}

static void a_pack_that_was_lost_or_cut_is_made_again(void **state)
{
	struct publish_report report = tiny_publish(&tiny, NULL);
	char path[PATH_MAX], title[20];

	(void)state;
	for (uint64_t sequence = 2; sequence <= 5; sequence++) {
		last_pack(path, report.release.root);
		CHECK((sequence % 2 ? unlink(path) : truncate(path, 10)) == 0);
		CHECK(verify() < 0);
		if (sequence > 3) { /* not that alone */
			snprintf(title, sizeof(title), "Tower %d", (int)sequence);
			tiny_parts(&tiny, title);
		}
		report = tiny_publish(&tiny, NULL);
		CHECK(report.changed && report.release.sequence == sequence);
		CHECK(verify() == 0);
	}
}

static void a_release_that_lost_a_pack_is_not_gone_back_to(void **state)
{
	const struct publish_target target = tiny_target(&tiny);
	struct publish_report report = tiny_publish(&tiny, NULL);
	char path[PATH_MAX];

	(void)state;
	last_pack(path, report.release.root);
	tiny_parts(&tiny, "High tower");
	tiny_publish(&tiny, NULL);
	CHECK(unlink(path) == 0);
	CHECK(publish_again(&report, &target, 0) == -ENODATA);
	CHECK(tiny_publish(&tiny, NULL).release.sequence == 3);
	CHECK(verify() == 0);
}

/* A server tells versions of a file apart by size and second. */
static void no_two_timestamps_are_of_one_second(void **state)
{
	const struct publish_target target = tiny_target(&tiny);
	struct publish_report report;
	time_t before = 0;
	char path[PATH_MAX];

	(void)state;
	tiny_publish(&tiny, NULL);
	snprintf(path, sizeof(path), "%s/timestamp.json", tiny.release);
	for (int i = 0; i < 5; i++) {
		struct stat status;

		CHECK(publish_renew(&report, &target) == 0);
		CHECK(stat(path, &status) == 0 && status.st_mtim.tv_sec > before);
		before = status.st_mtim.tv_sec;
	}
}

static void undo_shows_the_old_root_under_a_higher_sequence(void **state)
{
	const struct publish_target target = tiny_target(&tiny);
	struct publish_report first, second, undone;

	(void)state;
	CHECK(publish_again(&undone, &target, 0) == -ENOENT); /* nothing there */
	first = tiny_publish(&tiny, NULL);
	CHECK(publish_again(&undone, &target, 0) == -ENOENT); /* nothing before */
	tiny_parts(&tiny, "High tower");
	second = tiny_publish(&tiny, NULL);
	CHECK(publish_again(&undone, &target, 0) == 0);
	CHECK(undone.release.sequence == 3);
	CHECK(hash_equal(undone.release.root, first.release.root));
	CHECK(verify() == 0);
	CHECK(verified.release.sequence == 3);
	CHECK(hash_equal(verified.release.root, first.release.root));
	CHECK(publish_again(&undone, &target, 2) == 0);
	CHECK(undone.release.sequence == 4);
	CHECK(hash_equal(undone.release.root, second.release.root));
	CHECK(publish_again(&undone, &target, 9) == -ENOENT);
	CHECK(verify() == 0);
}

/* Publishes once more with one of the calls failing, for each of them, until it works. Returns how
 * often it failed. release.json without the timestamp that names it would be refused by every
 * terminal. */
static int fail_each(int *calls_left, int error)
{
	const struct publish_target target = tiny_target(&tiny);
	struct publish_report undone;
	int rc = -1, failures = 0;

	tiny_publish(&tiny, NULL);
	tiny_parts(&tiny, "High tower");
	tiny_publish(&tiny, NULL);
	for (int n = 0; rc < 0; n++) {
		*calls_left = n;
		rc = publish_again(&undone, &target, 0);
		*calls_left = -1;
		CHECK(rc == 0 || rc == error);
		CHECK(verify() == 0 && verified.release.sequence >= 2);
		failures += rc < 0;
	}
	CHECK(verified.release.sequence > 2);
	return failures;
}

static void a_full_disk_leaves_one_release_or_the_other(void **state)
{
	(void)state;
	CHECK(fail_each(&syncs_left, -ENOSPC) > 4);
}

static void a_rename_that_fails_leaves_one_release_or_the_other(void **state)
{
	(void)state;
	CHECK(fail_each(&renames_left, -EIO) >= 3); /* history, release, timestamp */
}

static void expiry_is_judged_by_the_clock_that_is_given(void **state)
{
	int64_t now = clock_wall_s();

	(void)state;
	tiny_publish(&tiny, NULL);
	CHECK(verify_at(now + (TIMESTAMP_LIFE_DAYS + 1) * 86400) == -EKEYEXPIRED);
	CHECK(strstr(verified.diagnostics.first.text, "timestamp.json") != NULL);
	CHECK(verify_at(now + (RELEASE_LIFE_DAYS + 1ll) * 86400) == -EKEYEXPIRED);
	CHECK(strstr(verified.diagnostics.first.text, "release.json") != NULL);
	CHECK(verify_at(0) == 0);
}

static void foreign_keys_never_overwrite_a_release(void **state)
{
	struct publish_target target = tiny_target(&tiny);
	struct publisher_keys others;
	struct publish_report report;
	char path[200];

	(void)state;
	tiny_publish(&tiny, NULL);
	snprintf(path, sizeof(path), "%s/other-keys", tiny.folder);
	CHECK(keys_load(&others, path) == -ENOENT);
	CHECK(keys_make(path) == 0);
	CHECK(keys_make(path) == -EEXIST);
	CHECK(keys_load(&others, path) == 0);
	target.keys = &others;
	CHECK(publish_again(&report, &target, 1) == -EKEYREJECTED);
	CHECK(verify() == 0 && verified.release.sequence == 1);
	snprintf(path + strlen(path), 40, "/release.key");
	CHECK(chmod(path, 0644) == 0);
	path[strlen(path) - strlen("/release.key")] = '\0';
	CHECK(keys_load(&others, path) == -EPERM);
	keys_finish(&others);
}

/* ---- damage anywhere is found ---- */

static char (*files)[200];
static size_t file_count;

static int note_file(const char *path, const struct stat *info, int type, struct FTW *at)
{
	(void)info;
	(void)at;
	if (type == FTW_F && !strstr(path, "/history/")) {
		files = realloc(files, (file_count + 1) * sizeof(*files));
		snprintf(files[file_count++], sizeof(*files), "%s", path);
	}
	return 0;
}

/* Verifies with one byte of the file changed, and puts it right again. */
static void check_flip(const char *path, struct buffer *file, size_t at)
{
	char name[HASH_HEX_BYTES] = "";

	file->data[at] ^= 0x20;
	CHECK(bytes_write_file(buffer_bytes(file), path) == 0);
	if (verify() == 0)
		fail_msg("%s: byte %zu of %zu changed, and nobody saw it", path, at, file->size);
	file->data[at] ^= 0x20;
	if (strstr(path, "/packs/")) { /* the message names the file */
		snprintf(name, sizeof(name), "%s", strrchr(path, '/') + 1);
		CHECK(strstr(verified.diagnostics.first.text, name) != NULL);
	}
}

static void a_changed_byte_anywhere_is_found(void **state)
{
	struct buffer file;

	(void)state;
	tiny_publish(&tiny, NULL);
	file_count = 0;
	CHECK(nftw(tiny.release, note_file, 8, FTW_PHYS) == 0);
	CHECK(file_count > 6);
	buffer_init(&file, 1 << 20);
	for (size_t i = 0; i < file_count; i++) {
		CHECK(buffer_read_file(&file, files[i]) == 0);
		/* The newline that ends a signed file may be any space. */
		for (size_t at = 0; at + 1 < file.size; at += 1 + file.size / 23)
			check_flip(files[i], &file, at);
		CHECK(bytes_write_file(buffer_bytes(&file), files[i]) == 0);
	}
	CHECK(verify() == 0);
	buffer_finish(&file);
	free(files);
	files = NULL;
}

static void a_missing_or_cut_file_is_found(void **state)
{
	struct buffer file;

	(void)state;
	tiny_publish(&tiny, NULL);
	file_count = 0;
	CHECK(nftw(tiny.release, note_file, 8, FTW_PHYS) == 0);
	buffer_init(&file, 1 << 20);
	for (size_t i = 0; i < file_count; i++) {
		CHECK(buffer_read_file(&file, files[i]) == 0);
		CHECK(unlink(files[i]) == 0);
		CHECK(verify() == -ENOENT);
		CHECK(bytes_write_file((struct bytes){ file.data, file.size / 2 }, files[i]) == 0);
		CHECK(verify() < 0);
		CHECK(bytes_write_file((struct bytes){ NULL, 0 }, files[i]) == 0);
		CHECK(verify() < 0);
		CHECK(bytes_write_file(buffer_bytes(&file), files[i]) == 0);
	}
	CHECK(verify() == 0);
	buffer_finish(&file);
	free(files);
	files = NULL;
}

/* Honest hashes and signatures around content that is not so. */
static void a_root_page_that_lies_is_found(void **state)
{
	(void)state;
	tiny.root.published_triangles = 5;
	tiny_publish(&tiny, NULL);
	CHECK(verify() == -EBADMSG);
	CHECK(strstr(verified.diagnostics.first.text, "published triangles") != NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(what_is_published_verifies, set_up, tear_down),
		cmocka_unit_test_setup_teardown(the_same_again_adds_nothing, set_up, tear_down),
		cmocka_unit_test_setup_teardown(the_same_content_gives_the_same_packs, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_change_adds_only_what_changed, set_up, tear_down),
		cmocka_unit_test_setup_teardown(a_pack_that_was_lost_or_cut_is_made_again, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_release_that_lost_a_pack_is_not_gone_back_to,
						set_up, tear_down),
		cmocka_unit_test_setup_teardown(no_two_timestamps_are_of_one_second, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(undo_shows_the_old_root_under_a_higher_sequence,
						set_up, tear_down),
		cmocka_unit_test_setup_teardown(a_full_disk_leaves_one_release_or_the_other, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_rename_that_fails_leaves_one_release_or_the_other,
						set_up, tear_down),
		cmocka_unit_test_setup_teardown(expiry_is_judged_by_the_clock_that_is_given, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(foreign_keys_never_overwrite_a_release, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_changed_byte_anywhere_is_found, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_missing_or_cut_file_is_found, set_up, tear_down),
		cmocka_unit_test_setup_teardown(a_root_page_that_lies_is_found, set_up, tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
