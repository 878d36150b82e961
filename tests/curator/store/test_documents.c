#include "curator/store/documents.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/log.h"
#include "curator/store/documents_versions.h"
#include "tests/check.h"

static char folder[PATH_MAX];

/* ---- calls that fail, or end the process, after so many; -1: never */

static int calls_left = -1;
static bool kills;

static bool fails_now(void)
{
	if (calls_left < 0 || calls_left-- > 0)
		return false;
	if (kills)
		_exit(9);
	errno = ENOSPC;
	calls_left = -1; /* what is taken back works */
	return true;
}

int __real_fsync(int fd);
int __wrap_fsync(int fd);
int __real_rename(const char *from, const char *to);
int __wrap_rename(const char *from, const char *to);

int __wrap_fsync(int fd)
{
	return fails_now() ? -1 : __real_fsync(fd);
}

int __wrap_rename(const char *from, const char *to)
{
	return fails_now() ? -1 : __real_rename(from, to);
}

/* libgit2 calls this one too. */
static bool disk_is_full;

ssize_t write(int fd, const void *bytes, size_t size)
{
	if (!disk_is_full)
		return syscall(SYS_write, fd, bytes, size);
	errno = ENOSPC;
	return -1;
}

/* ---- a folder */

static const char *at(const char *name)
{
	static char path[PATH_MAX + 300];

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	return path;
}

static int make_folder(void **state)
{
	(void)state;
	snprintf(folder, sizeof(folder), "/tmp/gopura-documents-XXXXXX");
	return mkdtemp(folder) && mkdir(at("pages"), 0755) == 0 ? 0 : -1;
}

static int remove_folder(void **state)
{
	char command[PATH_MAX + 20];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf '%s'", folder);
	return system(command);
}

static struct bytes bytes_of(const char *text)
{
	return (struct bytes){ (const uint8_t *)text, strlen(text) };
}

static void write_outside(const char *name, const char *text)
{
	CHECK(bytes_write_file(bytes_of(text), at(name)) == 0);
}

static struct documents *opened(void)
{
	struct diagnostics diagnostics = { 0 };
	struct documents *documents;
	int rc = documents_open(&documents, folder, &diagnostics);

	if (rc < 0)
		fail_msg("%s", diagnostics_cause(&diagnostics, rc));
	return documents;
}

/* base NULL: whatever is there. */
static int save(struct documents *documents, const char *name, const char *text, const char *base,
		const char *author)
{
	struct document_change change = { .name = name, .text = bytes_of(text), .base = base };

	return documents_save(documents, &change, 1, author, "a test", NULL);
}

static bool has(struct documents *documents, const char *name, const char *text)
{
	char tag[DOCUMENT_TAG_BYTES];
	struct buffer found;
	bool equal;

	buffer_init(&found, DOCUMENT_BYTES_MAX);
	equal = documents_read(documents, name, &found, tag, NULL) == 0 &&
		found.size == strlen(text) && memcmp(found.data, text, found.size) == 0;
	buffer_finish(&found);
	return equal;
}

static void tag_of(struct documents *documents, const char *name, char tag[DOCUMENT_TAG_BYTES])
{
	struct buffer found;

	buffer_init(&found, DOCUMENT_BYTES_MAX);
	CHECK(documents_read(documents, name, &found, tag, NULL) == 0);
	buffer_finish(&found);
}

static uint32_t versions_of(struct documents *documents, const char *name,
			    struct history_version out[20])
{
	uint32_t count;

	CHECK(documents_versions(documents, name, out, 20, &count, NULL) == 0);
	return count;
}

static bool version_has(struct documents *documents, const char *name, const char *version,
			const char *text)
{
	struct buffer found;
	bool equal;

	buffer_init(&found, DOCUMENT_BYTES_MAX);
	equal = documents_read_version(documents, name, version, &found, NULL) == 0 &&
		found.size == strlen(text) && memcmp(found.data, text, found.size) == 0;
	buffer_finish(&found);
	return equal;
}

/* ---- the claims */

static void a_save_is_a_version_with_who_and_what(void **state)
{
	struct documents *documents = opened();
	struct history_version versions[20];

	(void)state;
	CHECK(save(documents, "pages/gate.en.html", "<p>One", "", "ana") == 0);
	CHECK(save(documents, "pages/gate.en.html", "<p>Two", NULL, "ben") == 0);
	CHECK(save(documents, "parts.json", "{}", NULL, "") == 0);
	CHECK(versions_of(documents, "pages/gate.en.html", versions) == 2);
	CHECK(strcmp(versions[0].author, "ben") == 0 && strcmp(versions[0].what, "a test") == 0);
	CHECK(strcmp(versions[1].author, "ana") == 0 && versions[1].time_s > 1700000000);
	CHECK(version_has(documents, "pages/gate.en.html", versions[1].id, "<p>One"));
	CHECK(version_has(documents, "pages/gate.en.html", versions[0].id, "<p>Two"));
	CHECK(has(documents, "pages/gate.en.html", "<p>Two"));
	documents_close(documents);
}

static void what_others_changed_becomes_a_version(void **state)
{
	struct history_version versions[20];
	struct documents *documents;

	(void)state;
	write_outside("pages/gate.en.html", "by hand");
	documents = opened();
	CHECK(versions_of(documents, "pages/gate.en.html", versions) == 1);
	CHECK(strcmp(versions[0].author, DOCUMENTS_OUTSIDE) == 0);
	write_outside("pages/gate.en.html", "by hand again");
	CHECK(save(documents, "pages/gate.en.html", "by ana", NULL, "ana") == 0);
	CHECK(versions_of(documents, "pages/gate.en.html", versions) == 3);
	CHECK(version_has(documents, "pages/gate.en.html", versions[1].id, "by hand again"));
	CHECK(unlink(at("pages/gate.en.html")) == 0);
	CHECK(versions_of(documents, "pages/gate.en.html", versions) == 4);
	CHECK(!versions[0].text_id[0] && strcmp(versions[0].author, DOCUMENTS_OUTSIDE) == 0);
	documents_close(documents);
}

static void a_save_from_an_older_text_is_refused(void **state)
{
	struct documents *documents = opened();
	char first[DOCUMENT_TAG_BYTES], second[DOCUMENT_TAG_BYTES];
	struct document_change change = { .name = "pages/a.en.html", .text = bytes_of("three") };

	(void)state;
	CHECK(save(documents, "pages/a.en.html", "one", "", "ana") == 0);
	tag_of(documents, "pages/a.en.html", first);
	CHECK(save(documents, "pages/a.en.html", "two", first, "ben") == 0);
	tag_of(documents, "pages/a.en.html", second);
	change.base = first;
	CHECK(documents_save(documents, &change, 1, "ana", "late", NULL) == -ESTALE);
	CHECK(strcmp(change.tag, second) == 0);
	CHECK(save(documents, "pages/a.en.html", "new", "", "ana") == -ESTALE);
	CHECK(has(documents, "pages/a.en.html", "two"));
	documents_close(documents);
}

static void two_who_edit_one_text_both_keep_their_words(void **state)
{
	struct documents *documents = opened();
	char base[DOCUMENT_TAG_BYTES], tag[DOCUMENT_TAG_BYTES];
	struct buffer merged;
	bool is_clean;

	(void)state;
	buffer_init(&merged, 1000);
	CHECK(save(documents, "pages/a.en.html", "a\nb\nc\n", "", "ana") == 0);
	tag_of(documents, "pages/a.en.html", base);
	CHECK(save(documents, "pages/a.en.html", "a\nb\nC by ben\n", base, "ben") == 0);
	CHECK(documents_merge(documents, "pages/a.en.html", base, bytes_of("A by ana\nb\nc\n"),
			      &merged, &is_clean, tag, NULL) == 0);
	CHECK(is_clean && merged.size == strlen("A by ana\nb\nC by ben\n"));
	buffer_clear(&merged);
	CHECK(documents_merge(documents, "pages/a.en.html", base, bytes_of("a\nb\nC by ana\n"),
			      &merged, &is_clean, tag, NULL) == 0);
	CHECK(!is_clean && memmem(merged.data, merged.size, "C by ana", 8) &&
	      memmem(merged.data, merged.size, "C by ben", 8));
	buffer_clear(&merged);
	CHECK(documents_merge(documents, "pages/a.en.html",
			      "0123456789012345678901234567890123456789", bytes_of("x"), &merged,
			      &is_clean, tag, NULL) == -ENOENT);
	buffer_finish(&merged);
	documents_close(documents);
}

static void a_removed_text_can_be_brought_back(void **state)
{
	struct documents *documents = opened();
	struct document_change change = { .name = "pages/a.en.html", .removes = true };
	struct history_version versions[20];

	(void)state;
	CHECK(save(documents, "pages/a.en.html", "words", "", "ana") == 0);
	CHECK(documents_save(documents, &change, 1, "ben", "removed", NULL) == 0);
	CHECK(access(at("pages/a.en.html"), F_OK) < 0);
	CHECK(versions_of(documents, "pages/a.en.html", versions) == 2);
	CHECK(version_has(documents, "pages/a.en.html", versions[1].id, "words"));
	CHECK(save(documents, "pages/a.en.html", "words", "", "ana") == 0);
	CHECK(has(documents, "pages/a.en.html", "words"));
	documents_close(documents);
}

static void only_documents_are_written(void **state)
{
	static const char *const names[] = {
		"temple.ini", "../x",      "pages",         "pages/",     "pages/../x",
		"pages/.x",   "pages/a/b", "/etc/passwd",   ".curator/x", "pages/x.a1B2c3",
		"scan.ply",   "pages/x~",  "pages/a\nb.en", "pages//x",   "",
	};
	struct documents *documents = opened();

	(void)state;
	for (size_t n = 0; n < ARRAY_COUNT(names); n++)
		CHECK(save(documents, names[n], "x", NULL, "ana") == -EINVAL);
	CHECK(save(documents, "pictures/gate.jpg", "x", "", "ana") == 0);
	documents_close(documents);
}

static void two_files_change_together_or_not_at_all(void **state)
{
	struct documents *documents = opened();
	struct document_change changes[2] = {
		{ .name = "regions/a.faces", .text = bytes_of("7") },
		{ .name = "parts.json", .text = bytes_of("new") },
	};
	struct history_version versions[20];
	int failures = 0;

	(void)state;
	CHECK(save(documents, "regions/a.faces", "1", "", "ana") == 0);
	CHECK(save(documents, "parts.json", "old", "", "ana") == 0);
	log_set_level((enum log_level) - 1);
	for (int steps = 0;; steps++) {
		int rc;

		calls_left = steps;
		rc = documents_save(documents, changes, 2, "ana", "both", NULL);
		calls_left = -1;
		if (rc == 0)
			break;
		failures++;
		CHECK(has(documents, "regions/a.faces", "1") &&
		      has(documents, "parts.json", "old"));
		CHECK(versions_of(documents, "parts.json", versions) == 1);
	}
	CHECK(failures >= 4);
	CHECK(has(documents, "regions/a.faces", "7") && has(documents, "parts.json", "new"));
	CHECK(versions_of(documents, "parts.json", versions) == 2);
	documents_close(documents);
}

/* Saves in a child that is killed at a step. Returns whether it was. */
static bool save_and_be_killed(int steps)
{
	int status;
	const pid_t child = fork();

	if (child == 0) {
		struct document_change changes[2] = {
			{ .name = "regions/a.faces", .text = bytes_of("7") },
			{ .name = "parts.json", .text = bytes_of("new") },
		};
		struct documents *documents = opened();

		kills = true;
		calls_left = steps;
		_exit(documents_save(documents, changes, 2, "ana", "both", NULL) == 0 ? 0 : 1);
	}
	CHECK(child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status));
	CHECK(WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 9);
	return WEXITSTATUS(status) == 9;
}

static void a_kill_between_any_steps_leaves_all_or_nothing(void **state)
{
	struct history_version versions[20];
	bool killed = true;

	(void)state;
	log_set_level((enum log_level) - 1);
	for (int steps = 0; killed; steps++) {
		struct documents *documents = opened();
		bool is_new;

		CHECK(save(documents, "regions/a.faces", "1", NULL, "ben") == 0);
		CHECK(save(documents, "parts.json", "old", NULL, "ben") == 0);
		documents_close(documents);
		killed = save_and_be_killed(steps);
		documents = opened();
		is_new = has(documents, "parts.json", "new");
		CHECK(has(documents, "regions/a.faces", is_new ? "7" : "1"));
		CHECK(is_new || has(documents, "parts.json", "old"));
		CHECK(is_new || killed);
		CHECK(versions_of(documents, "parts.json", versions) >= 1);
		CHECK(strcmp(versions[0].author, is_new ? "ana" : "ben") == 0);
		documents_close(documents);
	}
}

/* A kill between the making of a lock and the change that it is for. */
static void locks_of_a_killed_program_are_removed(void **state)
{
	struct documents *documents = opened();

	(void)state;
	CHECK(save(documents, "parts.json", "words", "", "ana") == 0);
	documents_close(documents);
	write_outside(".curator/history.git/refs/heads/main.lock", "");
	write_outside(".curator/history.git/refs/gopura/staged.lock", "");
	documents = opened();
	CHECK(save(documents, "parts.json", "more", NULL, "ana") == 0);
	CHECK(has(documents, "parts.json", "more"));
	documents_close(documents);
}

static void a_damaged_history_is_put_aside(void **state)
{
	struct documents *documents = opened();
	struct history_version versions[20];

	(void)state;
	CHECK(save(documents, "parts.json", "words", "", "ana") == 0);
	documents_close(documents);
	write_outside(".curator/history.git/refs/heads/main", "nonsense\n");
	log_set_level((enum log_level) - 1);
	documents = opened();
	CHECK(has(documents, "parts.json", "words"));
	CHECK(versions_of(documents, "parts.json", versions) == 1);
	CHECK(strcmp(versions[0].author, DOCUMENTS_OUTSIDE) == 0);
	CHECK(save(documents, "parts.json", "more", NULL, "ana") == 0);
	documents_close(documents);
}

static void a_history_without_its_objects_is_put_aside(void **state)
{
	struct documents *documents = opened();
	char command[PATH_MAX + 60];

	(void)state;
	CHECK(save(documents, "parts.json", "words", "", "ana") == 0);
	documents_close(documents);
	snprintf(command, sizeof(command), "rm -rf '%s'/.curator/history.git/objects/??", folder);
	CHECK(system(command) == 0);
	log_set_level((enum log_level) - 1);
	documents = opened();
	CHECK(has(documents, "parts.json", "words"));
	CHECK(save(documents, "parts.json", "more", NULL, "ana") == 0);
	documents_close(documents);
}

/* What cannot be read now may be whole, so it is refused and stays where it is. */
static void a_history_that_cannot_be_read_is_not_put_aside(void **state)
{
	struct documents *documents = opened();
	struct history_version versions[20];
	char command[2 * PATH_MAX + 60];

	(void)state;
	CHECK(save(documents, "parts.json", "words", "", "ana") == 0);
	documents_close(documents);
	/* a branch that is a loop of links: the system refuses to open it */
	snprintf(command, sizeof(command),
		 "cd '%s'/.curator/history.git/refs/heads && mv main ../../kept && ln -s main main",
		 folder);
	CHECK(system(command) == 0);
	log_set_level((enum log_level) - 1);
	CHECK(documents_open(&documents, folder, NULL) == -EIO);
	snprintf(command, sizeof(command),
		 "cd '%s'/.curator/history.git/refs/heads && rm main && mv ../../kept main",
		 folder);
	CHECK(system(command) == 0);
	documents = opened();
	CHECK(versions_of(documents, "parts.json", versions) == 1);
	CHECK(strcmp(versions[0].author, "ana") == 0);
	documents_close(documents);
}

/* As a backup that root brought back. */
static void a_history_of_another_user_is_not_put_aside(void **state)
{
	struct documents *documents = opened();
	char command[3 * PATH_MAX];
	int status;
	pid_t child;

	(void)state;
	CHECK(save(documents, "parts.json", "words", "", "ana") == 0);
	documents_close(documents);
	snprintf(command, sizeof(command),
		 "cd '%s' && chmod 0 .curator/history.git && { [ $(id -u) != 0 ] || chown -R 65534 "
		 ". && chown 0 .curator/history.git; }",
		 folder);
	CHECK(system(command) == 0);
	child = fork();
	if (child == 0) {
		struct diagnostics diagnostics = { 0 };

		log_set_level((enum log_level) - 1);
		if (geteuid() == 0 && setuid(65534) < 0)
			_exit(1);
		_exit(documents_open(&documents, folder, &diagnostics) == -EACCES &&
				      strstr(diagnostics.first.text,
					     "history.git: Permission denied")
			      ? 0
			      : 2);
	}
	CHECK(child > 0 && waitpid(child, &status, 0) == child && status == 0);
	CHECK(chmod(at(".curator/history.git"), 0700) == 0);
	documents = opened();
	CHECK(has(documents, "parts.json", "words"));
	CHECK(save(documents, "parts.json", "more", NULL, "ana") == 0);
	documents_close(documents);
}

/* docs/curator.md lets an administrator pack the history while the program runs. */
static void a_history_that_git_packs_meanwhile_goes_on(void **state)
{
	struct documents *documents;
	struct history_version versions[20];
	char command[PATH_MAX + 200], text[32];
	struct buffer old;

	(void)state;
	if (system("command -v git >/dev/null") != 0)
		skip();
	documents = opened();
	for (int n = 0; n < 5; n++) {
		snprintf(text, sizeof(text), "text %d", n);
		CHECK(save(documents, "parts.json", text, NULL, "ana") == 0);
	}
	snprintf(
		command, sizeof(command),
		"cd '%s'/.curator && git --git-dir=history.git gc --quiet --prune=now && "
		"[ -z \"$(find history.git/objects -type f ! -path '*/pack/*' ! -path '*/info/*')\" ]",
		folder);
	CHECK(system(command) == 0);
	CHECK(save(documents, "parts.json", "after it", NULL, "petra") == 0);
	CHECK(versions_of(documents, "parts.json", versions) == 6);
	CHECK(strcmp(versions[0].author, "petra") == 0 && strcmp(versions[5].author, "ana") == 0);
	buffer_init(&old, 100);
	CHECK(documents_read_version(documents, "parts.json", versions[5].id, &old, NULL) == 0);
	CHECK(old.size == 6 && memcmp(old.data, "text 0", 6) == 0);
	buffer_finish(&old);
	documents_close(documents);
	documents = opened();
	CHECK(has(documents, "parts.json", "after it"));
	documents_close(documents);
}

static void a_full_disk_is_called_so(void **state)
{
	struct documents *documents = opened();
	struct document_change change = { .name = "pages/gate.en.html", .text = bytes_of("new") };
	struct diagnostics diagnostics = { 0 };

	(void)state;
	disk_is_full = true;
	CHECK(documents_save(documents, &change, 1, "ana", "page", &diagnostics) == -ENOSPC);
	disk_is_full = false;
	CHECK(strstr(diagnostics.first.text, "No space left"));
	CHECK(documents_save(documents, &change, 1, "ana", "page", NULL) == 0);
	documents_close(documents);
}

static void another_process_cannot_open_the_folder(void **state)
{
	struct documents *documents = opened();
	int status;
	const pid_t child = fork();

	(void)state;
	if (child == 0) {
		struct documents *second;

		_exit(documents_open(&second, folder, NULL) == -EBUSY ? 0 : 1);
	}
	CHECK(child > 0 && waitpid(child, &status, 0) == child && status == 0);
	documents_close(documents);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, make_folder, remove_folder)
	const struct CMUnitTest tests[] = {
		TEST(a_save_is_a_version_with_who_and_what),
		TEST(what_others_changed_becomes_a_version),
		TEST(a_save_from_an_older_text_is_refused),
		TEST(two_who_edit_one_text_both_keep_their_words),
		TEST(a_removed_text_can_be_brought_back),
		TEST(only_documents_are_written),
		TEST(two_files_change_together_or_not_at_all),
		TEST(a_kill_between_any_steps_leaves_all_or_nothing),
		TEST(locks_of_a_killed_program_are_removed),
		TEST(a_damaged_history_is_put_aside),
		TEST(a_history_without_its_objects_is_put_aside),
		TEST(a_history_that_cannot_be_read_is_not_put_aside),
		TEST(a_history_of_another_user_is_not_put_aside),
		TEST(a_history_that_git_packs_meanwhile_goes_on),
		TEST(a_full_disk_is_called_so),
		TEST(another_process_cannot_open_the_folder),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
