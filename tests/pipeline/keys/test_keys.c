/* Signing keys: made whole or completed, never replaced, and found where they belong. */
#include "pipeline/keys/keys_place.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/log.h"
#include "tests/check.h"
#include "tests/pipeline/keys/failing_disk.h"

static char top[] = "/tmp/gopura-keys-XXXXXX";

static void at(char path[PATH_MAX], const char *name)
{
	snprintf(path, PATH_MAX, "%s/%s", top, name);
}

static bool is_there(const char *name)
{
	char path[PATH_MAX];
	struct stat status;

	at(path, name);
	return lstat(path, &status) == 0;
}

static void put(const char *name, const char *text)
{
	char path[PATH_MAX];

	at(path, name);
	CHECK(bytes_write_file((struct bytes){ (const uint8_t *)text, strlen(text) }, path) == 0);
}

static void get(const char *name, char text[256])
{
	struct buffer file;
	char path[PATH_MAX];

	at(path, name);
	buffer_init(&file, 255);
	CHECK(buffer_read_file(&file, path) == 0);
	snprintf(text, 256, "%.*s", (int)file.size, (const char *)file.data);
	buffer_finish(&file);
}

static void make_folder(const char *name)
{
	char path[PATH_MAX];

	at(path, name);
	CHECK(mkdir(path, 0755) == 0);
}

static void run(const char *command)
{
	char line[2 * PATH_MAX];

	snprintf(line, sizeof(line), "cd '%s' && %s", top, command);
	CHECK(system(line) == 0);
}

static int begin(void **state)
{
	(void)state;
	snprintf(top, sizeof(top), "/tmp/gopura-keys-XXXXXX");
	CHECK(mkdtemp(top) != NULL);
	CHECK(setenv("XDG_CONFIG_HOME", top, 1) == 0);
	log_set_level(LOG_LEVEL_ERROR);
	return 0;
}

static int end(void **state)
{
	char command[PATH_MAX];
	(void)state;

	snprintf(command, sizeof(command), "rm -rf '%s'", top);
	return system(command);
}

/* ---- a disk that is full, or otherwise fails, from the n-th call on */

static bool crosses; /* as if the keys' new place were on another file system */

int __wrap_rename(const char *from, const char *to)
{
	const size_t length = strlen(from);

	if (crosses && length > 5 && strcmp(from + length - 5, "/keys") == 0) {
		errno = EXDEV;
		return -1;
	}
	return fails_now() ? -1 : __real_rename(from, to);
}

static void makes_keys_after_a_failure_at_every_step(void **state)
{
	struct publisher_keys keys;
	char path[PATH_MAX];
	int steps = 0;
	(void)state;

	log_set_level((enum log_level) - 1); /* each failure would be told */
	at(path, "made");
	for (bool failed = true; failed; steps++) {
		calls_left = steps + 1;
		failed = keys_make(path) < 0;
		calls_left = -1;
		if (failed) {
			/* A folder of that name is whole, or is none. */
			int rc = keys_load(&keys, path);

			if (rc != (is_there("made") ? 0 : -ENOENT))
				fail_msg("step %d: %d", steps, rc);
			if (rc == -ENOENT && keys_make(path) < 0)
				fail_msg("step %d: not made afterwards", steps);
		}
		if (keys_load(&keys, path) < 0)
			fail_msg("step %d: not whole afterwards", steps);
		keys_finish(&keys);
		CHECK(!is_there("made.part"));
		run("rm -rf made");
		CHECK(steps < 200);
	}
	CHECK(steps > 10);
	log_set_level(LOG_LEVEL_ERROR);
}

/* The disk is full again and again, a little later each time: what was made is used, not made anew.
 */
static void goes_on_where_it_stopped(void **state)
{
	char path[PATH_MAX], first[256] = "", now[256];
	struct publisher_keys keys;
	int tries = 0;
	(void)state;

	log_set_level((enum log_level) - 1);
	at(path, "slow");
	do {
		calls_left = ++tries + 3;
		if (keys_make(path) == 0)
			break;
		calls_left = -1;
		if (!first[0] && is_there("slow.part/root.key"))
			get("slow.part/root.key", first);
	} while (tries < 100);
	calls_left = -1;
	log_set_level(LOG_LEVEL_ERROR);
	CHECK(tries > 2 && first[0]);
	get("slow/root.key", now);
	CHECK(strcmp(first, now) == 0);
	CHECK(keys_load(&keys, path) == 0);
	keys_finish(&keys);
}

/* ---- what earlier programs left */

static void completes_a_folder_that_was_left_half_made(void **state)
{
	static const char *const names[] = { "root.key", "release.key", "timestamp.key" };
	char path[PATH_MAX], line[300], whole[256], half[256];
	struct publisher_keys keys;
	(void)state;

	at(path, "whole");
	CHECK(keys_make(path) == 0);
	at(path, "half");
	for (size_t kept = 0; kept <= 3; kept++)
		for (int cut = 0; cut < 2; cut++) {
			run("cp -a whole half && rm half/root/1.json");
			for (size_t i = kept; i < 3; i++) {
				/* A power cut leaves a file without its bytes. */
				snprintf(line, sizeof(line),
					 cut && i == kept ? ": > half/%s" : "rm half/%s", names[i]);
				run(line);
			}
			CHECK(keys_load(&keys, path) == -ENOENT);
			if (keys_make(path) < 0 || keys_load(&keys, path) < 0)
				fail_msg("%zu kept, cut %d", kept, cut);
			keys_finish(&keys);
			for (size_t i = 0; i < kept; i++) {
				snprintf(line, sizeof(line), "whole/%s", names[i]);
				get(line, whole);
				snprintf(line, sizeof(line), "half/%s", names[i]);
				get(line, half);
				CHECK(strcmp(whole, half) == 0);
			}
			run("rm -rf half");
		}
}

static void never_replaces_keys(void **state)
{
	char path[PATH_MAX];
	(void)state;

	log_set_level((enum log_level) - 1);
	at(path, "whole");
	CHECK(keys_make(path) == 0);
	run("cp -a whole before");
	CHECK(keys_make(path) == -EEXIST);
	/* root.key in the safe, and somebody has lost root/1.json: nothing is made up. */
	run("rm whole/root.key whole/root/1.json before/root.key before/root/1.json");
	CHECK(keys_make(path) == -EEXIST);
	run("diff -r whole before");
	run("cp before/release.key whole/root.key && cp -a whole before2");
	CHECK(keys_make(path) == -EBADMSG); /* a key of another role */
	run("diff -r whole before2");
	log_set_level(LOG_LEVEL_ERROR);
}

/* ---- where they are */

/* Opens the keys of a content folder; place is relative to top. */
static int open_keys(const char *content, const char *given, const char *place, bool expect_new)
{
	char path[PATH_MAX], folder[PATH_MAX], expected[PATH_MAX], keys_at[PATH_MAX];
	struct publisher_keys keys;
	bool made;
	int rc;

	at(path, content);
	at(keys_at, given ? given : "");
	at(expected, place);
	rc = keys_open(&keys, folder, path, given ? keys_at : NULL, &made);
	if (rc < 0)
		return rc;
	if (strcmp(folder, expected) != 0 || made != expect_new)
		fail_msg("%s: keys in %s, made %d, expected %s", content, folder, made, expected);
	keys_finish(&keys);
	return 0;
}

static void by_default_keys_are_not_among_the_content(void **state)
{
	char text[256], expected[PATH_MAX];
	(void)state;

	make_folder("temple");
	CHECK(open_keys("temple", NULL, "gopura/keys/temple", true) == 0);
	CHECK(!is_there("temple/keys"));
	CHECK(open_keys("temple/", NULL, "gopura/keys/temple", false) == 0);
	get("gopura/keys/temple/content", text);
	snprintf(expected, sizeof(expected), "%s/temple\n", top);
	CHECK(strcmp(text, expected) == 0);
	run("[ \"$(stat -c %a gopura gopura/keys gopura/keys/temple gopura/keys/temple/*.key | "
	    "tr '\\n' ' ')\" = '700 700 700 600 600 600 ' ]");
	/* Where --keys says, and no note of it. */
	CHECK(open_keys("temple", "safe/of/it/", "safe/of/it", true) == 0);
	CHECK(!is_there("safe/of/it/content"));
	CHECK(open_keys("temple", "safe/of/it", "safe/of/it", false) == 0);
}

static void without_a_configuration_folder_they_are_in_the_home(void **state)
{
	char home[PATH_MAX];
	(void)state;

	make_folder("temple");
	at(home, "home");
	CHECK(setenv("HOME", home, 1) == 0 && setenv("XDG_CONFIG_HOME", "relative", 1) == 0);
	CHECK(open_keys("temple", NULL, "home/.config/gopura/keys/temple", true) == 0);
	CHECK(unsetenv("HOME") == 0);
	log_set_level((enum log_level) - 1);
	CHECK(open_keys("temple", NULL, "", true) == -ENOENT);
	log_set_level(LOG_LEVEL_ERROR);
	CHECK(open_keys("temple", "safe", "safe", true) == 0);
	CHECK(setenv("HOME", "/nonexistent", 1) == 0);
}

static void two_folders_of_one_name_have_keys_of_their_own(void **state)
{
	(void)state;

	run("mkdir -p a/content b/content c/content");
	CHECK(open_keys("a/content", NULL, "gopura/keys/content", true) == 0);
	CHECK(open_keys("b/content", NULL, "gopura/keys/content-2", true) == 0);
	CHECK(open_keys("a/content", NULL, "gopura/keys/content", false) == 0);
	CHECK(open_keys("b/content", NULL, "gopura/keys/content-2", false) == 0);
	/* Not even where the first is gone: its disk may be away for a day. */
	run("mv a away");
	CHECK(open_keys("c/content", NULL, "gopura/keys/content-3", true) == 0);
	run("mv away a");
	CHECK(open_keys("a/content", NULL, "gopura/keys/content", false) == 0);
	/* Keys that were brought from another machine belong to who asks first. */
	run("mkdir -p other/temple && mv gopura/keys/content-3 gopura/keys/temple && "
	    "rm gopura/keys/temple/content");
	CHECK(open_keys("other/temple", NULL, "gopura/keys/temple", false) == 0);
	run("mkdir temple");
	CHECK(open_keys("temple", NULL, "gopura/keys/temple-2", true) == 0);
}

/* Whoever removes the keys of a temple that is gone must not part another from its own. */
static void keys_are_found_beyond_those_that_were_removed(void **state)
{
	(void)state;

	run("mkdir -p a/content b/content c/content");
	CHECK(open_keys("a/content", NULL, "gopura/keys/content", true) == 0);
	CHECK(open_keys("b/content", NULL, "gopura/keys/content-2", true) == 0);
	run("rm -r a gopura/keys/content");
	CHECK(open_keys("b/content", NULL, "gopura/keys/content-2", false) == 0);
	CHECK(open_keys("c/content", NULL, "gopura/keys/content", true) == 0);
	CHECK(open_keys("b/content", NULL, "gopura/keys/content-2", false) == 0);
}

/* As after a build of another temple of that name by root. */
static void keys_are_found_beyond_those_whose_owner_cannot_be_read(void **state)
{
	(void)state;

	run("mkdir -p a/content b/content c/content");
	CHECK(open_keys("a/content", NULL, "gopura/keys/content", true) == 0);
	CHECK(open_keys("b/content", NULL, "gopura/keys/content-2", true) == 0);
	run("rm gopura/keys/content/content && mkdir gopura/keys/content/content");
	CHECK(open_keys("b/content", NULL, "gopura/keys/content-2", false) == 0);
	log_set_level((enum log_level) - 1);
	CHECK(open_keys("c/content", NULL, "", true) == -EISDIR);
	log_set_level(LOG_LEVEL_ERROR);
	CHECK(!is_there("gopura/keys/content-3"));
}

/* A content folder as earlier programs left it. */
static void make_old(void)
{
	char path[PATH_MAX];

	make_folder("temple");
	at(path, "temple/keys");
	CHECK(keys_make(path) == 0);
	run("cp -a temple/keys was");
}

static void old_keys_are_moved(void **state)
{
	(void)state;

	for (int i = 0; i < 4; i++) {
		const bool given = i % 2;
		const char *place = given ? "safe/temple" : "gopura/keys/temple";

		make_old();
		crosses = i >= 2;
		CHECK(open_keys("temple", given ? place : NULL, place, false) == 0);
		crosses = false;
		CHECK(!is_there("temple/keys"));
		run(given ? "diff -r was safe/temple"
			  : "rm gopura/keys/temple/content && diff -r was gopura/keys/temple");
		run("[ \"$(stat -c %a $(ls -d safe/temple gopura/keys/temple 2>/dev/null))\" = 700 ]");
		run("rm -rf temple was safe gopura");
	}
}

static void a_move_to_another_file_system_that_failed_is_done_again(void **state)
{
	char content[PATH_MAX], folder[PATH_MAX];
	struct publisher_keys keys;
	int steps = 0;
	(void)state;

	log_set_level((enum log_level) - 1);
	at(content, "temple");
	for (bool failed = true; failed; steps++) {
		make_old();
		crosses = true;
		calls_left = steps + 1;
		/* Whatever fails, there are keys, or none are used. */
		if (keys_open(&keys, folder, content, NULL, NULL) == 0)
			keys_finish(&keys);
		failed = calls_left <= 1; /* with one left, a write was cut short */
		calls_left = -1;
		if (failed)
			CHECK(open_keys("temple", NULL, "gopura/keys/temple", false) == 0);
		crosses = false;
		if (is_there("temple/keys") || is_there("gopura/keys/temple.move"))
			fail_msg("step %d: something is left", steps);
		run("rm gopura/keys/temple/content && diff -r was gopura/keys/temple");
		run("rm -rf temple was gopura");
		CHECK(steps < 200);
	}
	log_set_level(LOG_LEVEL_ERROR);
	CHECK(steps > 4);
}

static void old_keys_that_cannot_be_moved_are_used_where_they_are(void **state)
{
	(void)state;

	make_old();
	put("taken", "a file");
	CHECK(open_keys("temple", "taken", "temple/keys", false) == 0);
	CHECK(open_keys("temple", "temple/keys", "temple/keys", false) == 0);
	run("diff -r was temple/keys");
}

static void of_two_sets_the_one_outside_is_used(void **state)
{
	(void)state;

	make_folder("temple");
	CHECK(open_keys("temple", NULL, "gopura/keys/temple", true) == 0);
	run("cp -a gopura/keys/temple temple/keys"); /* as a move that was cut off leaves it */
	CHECK(open_keys("temple", NULL, "gopura/keys/temple", false) == 0);
	CHECK(!is_there("temple/keys/root.key"));
	run("rm -rf temple && cp -a gopura/keys/temple was");
	run("mv gopura/keys/temple aside");
	make_folder("temple");
	CHECK(open_keys("temple", NULL, "gopura/keys/temple", true) == 0);
	run("cp -a was temple/keys"); /* others */
	CHECK(open_keys("temple", NULL, "gopura/keys/temple", false) == 0);
	run("diff -r was temple/keys");
}

#define EACH_IN_ITS_FOLDER(test) cmocka_unit_test_setup_teardown(test, begin, end)

int main(void)
{
	const struct CMUnitTest tests[] = {
		EACH_IN_ITS_FOLDER(makes_keys_after_a_failure_at_every_step),
		EACH_IN_ITS_FOLDER(goes_on_where_it_stopped),
		EACH_IN_ITS_FOLDER(completes_a_folder_that_was_left_half_made),
		EACH_IN_ITS_FOLDER(never_replaces_keys),
		EACH_IN_ITS_FOLDER(by_default_keys_are_not_among_the_content),
		EACH_IN_ITS_FOLDER(without_a_configuration_folder_they_are_in_the_home),
		EACH_IN_ITS_FOLDER(two_folders_of_one_name_have_keys_of_their_own),
		EACH_IN_ITS_FOLDER(keys_are_found_beyond_those_that_were_removed),
		EACH_IN_ITS_FOLDER(keys_are_found_beyond_those_whose_owner_cannot_be_read),
		EACH_IN_ITS_FOLDER(old_keys_are_moved),
		EACH_IN_ITS_FOLDER(a_move_to_another_file_system_that_failed_is_done_again),
		EACH_IN_ITS_FOLDER(old_keys_that_cannot_be_moved_are_used_where_they_are),
		EACH_IN_ITS_FOLDER(of_two_sets_the_one_outside_is_used),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
