#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "health/gather.h"
#include "tests/check.h"

static char folder[] = "/tmp/gopura-gather-XXXXXX";
static char paths[PROGRAM_COUNT][64];
static struct snapshot snapshot;

static int listen_at(const char *path)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);

	memcpy(address.sun_path, path, strlen(path) + 1);
	CHECK(bind(fd, (struct sockaddr *)&address, sizeof(address)) == 0 && listen(fd, 1) == 0);
	return fd;
}

struct program_thread {
	int fd;
	const char *const *pieces; /* NULL at the end */
	pthread_t thread;
};

static void *answer(void *data)
{
	struct program_thread *program = data;
	const int fd = accept(program->fd, NULL, NULL);

	for (const char *const *piece = program->pieces; *piece; piece++)
		if (send(fd, *piece, strlen(*piece), MSG_NOSIGNAL) <
		    0) /* it may have heard enough */
			break;
	close(fd);
	return NULL;
}

static void gather(int64_t patience_ms)
{
	const struct gather_options options = {
		.sockets = { paths[PROGRAM_KIOSK], paths[PROGRAM_FETCH] },
		.patience_ms = patience_ms,
		.machine = { "", "/nowhere", "/" },
	};

	snapshot_take(&snapshot, &options);
}

/* A kiosk that says these pieces. */
static void gather_from(const char *const *pieces)
{
	struct program_thread program = { listen_at(paths[PROGRAM_KIOSK]), pieces, 0 };

	pthread_create(&program.thread, NULL, answer, &program);
	gather(60000);
	pthread_join(program.thread, NULL);
	close(program.fd);
	unlink(paths[PROGRAM_KIOSK]);
}

static int begin(void **state)
{
	(void)state;
	if (!mkdtemp(folder))
		return -1;
	for (int i = 0; i < PROGRAM_COUNT; i++)
		snprintf(paths[i], sizeof(paths[i]), "%s/%d", folder, i);
	snapshot_init(&snapshot);
	return 0;
}

static int end(void **state)
{
	(void)state;
	snapshot_finish(&snapshot);
	return rmdir(folder);
}

static void what_a_program_says_is_taken_whole(void **state)
{
	static const char *const pieces[] = { "gopura_ki", "osk_x 1\n", NULL };
	const struct answer *kiosk = &snapshot.answers[PROGRAM_KIOSK];

	(void)state;
	gather_from(pieces);
	CHECK(kiosk->rc == 0 && kiosk->text.size == 17);
	CHECK(memcmp(kiosk->text.data, "gopura_kiosk_x 1\n", 17) == 0);
	CHECK(snapshot.answers[PROGRAM_FETCH].rc == -ENOENT);
	CHECK(snapshot.taken_ms > 0 && snapshot.taken_wall_s > 0);
}

static void nonsense_is_not_passed_on(void **state)
{
	static const char *const cut[] = { "gopura_kiosk_x 1", NULL };
	static const char *const empty[] = { NULL };
	static const char *const others[] = { "gopura_fetch_x 1\n", NULL };
	const struct answer *kiosk = &snapshot.answers[PROGRAM_KIOSK];

	(void)state;
	gather_from(cut);
	CHECK(kiosk->rc == -EBADMSG && kiosk->text.size == 0);
	gather_from(empty);
	CHECK(kiosk->rc == -EBADMSG && kiosk->text.size == 0);
	gather_from(others);
	CHECK(kiosk->rc == -EBADMSG && kiosk->text.size == 0);
}

static void more_than_a_program_may_say_is_nonsense(void **state)
{
	static const char *pieces[METRICS_BYTES_MAX / 17 + 3];
	const struct answer *kiosk = &snapshot.answers[PROGRAM_KIOSK];

	(void)state;
	for (size_t i = 0; i + 1 < ARRAY_COUNT(pieces); i++)
		pieces[i] = "gopura_kiosk_x 1\n";
	gather_from(pieces);
	CHECK(kiosk->rc == -EBADMSG && kiosk->text.size == 0);
}

static void a_program_that_hangs_is_told_from_one_that_ended(void **state)
{
	int hangs = listen_at(paths[PROGRAM_KIOSK]), ended = listen_at(paths[PROGRAM_FETCH]);

	(void)state;
	close(ended);
	gather(50);
	CHECK(snapshot.answers[PROGRAM_KIOSK].rc == -ETIMEDOUT);
	CHECK(snapshot.answers[PROGRAM_FETCH].rc == -ECONNREFUSED);
	for (int i = 0; i < 4; i++) /* its queue is full by then */
		gather(50);
	CHECK(snapshot.answers[PROGRAM_KIOSK].rc == -ETIMEDOUT);
	close(hangs);
	unlink(paths[PROGRAM_KIOSK]);
	unlink(paths[PROGRAM_FETCH]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_a_program_says_is_taken_whole),
		cmocka_unit_test(nonsense_is_not_passed_on),
		cmocka_unit_test(more_than_a_program_may_say_is_nonsense),
		cmocka_unit_test(a_program_that_hangs_is_told_from_one_that_ended),
	};

	return cmocka_run_group_tests(tests, begin, end);
}
