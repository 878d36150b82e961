/* What a hostile stick or settings file can name, opened by who must not wait, follow or read for
 * ever. Each claim is checked twice: with openat2, and where a filter of system calls refuses it.
 */
#include "base/safe_open.h"

#include <errno.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/bytes.h"
#include "base/settings.h"
#include "tests/check.h"

enum { HANG_S = 60 };

static char folder[] = "/tmp/gopura-safe-XXXXXX";

static void path_of(const char *name, char path[128])
{
	snprintf(path, 128, "%s/%s", folder, name);
}

static void write_file(const char *name, const char *text)
{
	char path[128];
	FILE *file;

	path_of(name, path);
	file = fopen(path, "w");
	CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static void make_link(const char *target, const char *name)
{
	char path[128];

	path_of(name, path);
	CHECK(symlink(target, path) == 0);
}

static void make_socket(const char *name)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);

	snprintf(address.sun_path, sizeof(address.sun_path), "%s/%s", folder, name);
	CHECK(fd >= 0 && bind(fd, (struct sockaddr *)&address, sizeof(address)) == 0);
	close(fd);
}

/* A hang ends the test instead of the tester's day. */
static int make_folder(void **state)
{
	char path[128];

	(void)state;
	alarm(HANG_S);
	CHECK(mkdtemp(folder));
	write_file("good", "stone");
	path_of("fifo", path);
	CHECK(mkfifo(path, 0600) == 0);
	path_of("sub", path);
	CHECK(mkdir(path, 0700) == 0);
	write_file("sub/good", "deep");
	make_link("good", "link");
	make_link("/dev/zero", "zero");
	make_link("sub", "linked");
	make_link("..", "sub/up");
	make_socket("socket");
	return 0;
}

static int remove_folder(void **state)
{
	char command[160];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	return system(command);
}

/* What reading the file gives: 0 with its text, or the error. */
static int read_beneath(const char *name, char text[16])
{
	struct buffer file;
	int rc;

	buffer_init(&file, 15);
	rc = buffer_read_beneath(&file, folder, name);
	text[0] = '\0';
	if (rc == 0) {
		memcpy(text, file.data, file.size);
		text[file.size] = '\0';
	}
	buffer_finish(&file);
	return rc;
}

static const struct {
	const char *name;
	int rc;
	const char *text;
} names[] = {
	{ "good", 0, "stone" },
	{ "sub/good", 0, "deep" },
	{ "none", -ENOENT, "" },
	{ "fifo", -ENOTSUP, "" },
	{ "socket", -ENOTSUP, "" },
	{ "sub", -EISDIR, "" },
	{ "link", -ELOOP, "" },
	{ "zero", -ELOOP, "" },
	{ "linked/good", -ELOOP, "" },
	{ "good/good", -ENOTDIR, "" },
	{ "sub/up/good", -ELOOP, "" },
	{ "../good", -EXDEV, "" },
	{ "../../dev/zero", -EXDEV, "" },
	{ "sub/../good", -EXDEV, "" },
	{ "/dev/zero", -EXDEV, "" },
	{ "./good", -EXDEV, "" },
	{ "sub//good", -EXDEV, "" },
	{ "sub/", -EXDEV, "" },
	{ "..", -EXDEV, "" },
	{ "", -EXDEV, "" },
};

/* Of a file on a file system that is mounted below the folder. */
static int cross_a_mount(void)
{
	struct buffer file;
	int rc;

	buffer_init(&file, 4096);
	rc = buffer_read_beneath(&file, "/", "proc/version");
	buffer_finish(&file);
	return rc;
}

/* Index of the first name that is answered wrongly; -1: none. */
static int first_wrong(void)
{
	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		char text[16];

		if (read_beneath(names[i].name, text) != names[i].rc ||
		    strcmp(text, names[i].text) != 0)
			return (int)i;
	}
	return -1;
}

static void reads_regular_files_below_the_folder_and_nothing_else(void **state)
{
	const int wrong = first_wrong();
	char text[16];

	(void)state;
	if (wrong >= 0)
		fail_msg("'%s': %d", names[wrong].name, read_beneath(names[wrong].name, text));
	CHECK(cross_a_mount() == -EXDEV);
}

/* From now on openat2 fails with this errno. */
static int forbid_openat2(int error)
{
	struct sock_filter code[] = {
		BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
		BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_openat2, 0, 1),
		BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | (unsigned)error),
		BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
	};
	const struct sock_fprog program = { ARRAY_COUNT(code), code };

	return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) < 0
		       ? -errno
		       : prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0);
}

static void does_so_where_openat2_is_missing_or_forbidden(void **state)
{
	static const int errors[] = { ENOSYS, EPERM };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(errors); i++) {
		int status = 0;
		pid_t child = fork();

		if (child == 0) {
			alarm(HANG_S);
			if (forbid_openat2(errors[i]) != 0)
				_exit(100);
			_exit(cross_a_mount() == -EXDEV ? first_wrong() + 1 : 101);
		}
		CHECK(child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status));
		if (WEXITSTATUS(status) == 100)
			skip(); /* a machine that lets nobody filter system calls */
		if (WEXITSTATUS(status) == 101)
			fail_msg("another file system was read without openat2");
		if (WEXITSTATUS(status) != 0)
			fail_msg("'%s' without openat2", names[WEXITSTATUS(status) - 1].name);
	}
}

static void a_path_of_ours_may_be_a_link_but_no_pipe_or_device(void **state)
{
	static const struct setting none[1];
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	struct buffer file;
	char path[128];

	(void)state;
	buffer_init(&file, 15);
	path_of("link", path);
	CHECK(buffer_read_file(&file, path) == 0 && file.size == 5);
	path_of("fifo", path);
	CHECK(buffer_read_file(&file, path) == -ENOTSUP);
	CHECK(settings_read_file(path, none, 0, NULL, &diagnostics) == -ENOTSUP);
	CHECK(strstr(diagnostics.first.text, "put a file there"));
	path_of("zero", path);
	CHECK(buffer_read_file(&file, path) == -ENOTSUP);
	CHECK(buffer_read_file(&file, folder) == -EISDIR);
	buffer_finish(&file);
}

static void a_foreign_path_may_lie_below_links_but_be_none(void **state)
{
	struct buffer file;
	char path[128];

	(void)state;
	buffer_init(&file, 15);
	path_of("linked/good", path);
	CHECK(buffer_read_foreign(&file, path) == 0 && file.size == 4);
	path_of("link", path);
	CHECK(buffer_read_foreign(&file, path) == -ELOOP);
	path_of("fifo", path);
	CHECK(buffer_read_foreign(&file, path) == -ENOTSUP);
	CHECK(buffer_read_foreign(&file, "/dev/zero") == -ENOTSUP);
	CHECK(buffer_read_foreign(&file, "Makefile") == -EFBIG);
	CHECK(buffer_read_foreign(&file, "no such file") == -ENOENT);
	buffer_finish(&file);
}

static void stops_at_the_ceiling_also_where_the_size_is_a_hole(void **state)
{
	struct buffer file;
	char path[128], text[16];

	(void)state;
	write_file("long", "sixteen letters!");
	CHECK(read_beneath("long", text) == -EFBIG);
	write_file("long", "fifteen letters");
	CHECK(read_beneath("long", text) == 0);
	path_of("hole", path);
	write_file("hole", "");
	CHECK(truncate(path, (off_t)1 << 40) == 0);
	buffer_init(&file, 1 << 20);
	CHECK(buffer_read_beneath(&file, folder, "hole") == -EFBIG);
	buffer_finish(&file);
	unlink(path);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(reads_regular_files_below_the_folder_and_nothing_else),
		cmocka_unit_test(does_so_where_openat2_is_missing_or_forbidden),
		cmocka_unit_test(a_path_of_ours_may_be_a_link_but_no_pipe_or_device),
		cmocka_unit_test(a_foreign_path_may_lie_below_links_but_be_none),
		cmocka_unit_test(stops_at_the_ceiling_also_where_the_size_is_a_hole),
	};

	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
