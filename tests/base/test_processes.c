#include "base/processes.h"

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "tests/check.h"

enum { PIECES = 20 };

/* Shared with the processes. */
struct board {
	uint32_t runs[PIECES], order[PIECES], count;
};

struct scene {
	struct board *board;
	uint32_t bad_piece; /* PIECES: none */
	int bad_result;     /* 0: it kills itself */
	bool done[PIECES];
	uint32_t done_count;
};

static int work(void *user, uint32_t piece)
{
	const struct scene *scene = user;

	scene->board->runs[piece]++;
	scene->board->order[__atomic_fetch_add(&scene->board->count, 1, __ATOMIC_RELAXED)] = piece;
	if (piece == scene->bad_piece && scene->bad_result == 0)
		raise(SIGKILL);
	return piece == scene->bad_piece ? scene->bad_result : 0;
}

static void done(void *user, uint32_t piece)
{
	struct scene *scene = user;

	scene->done[piece] = true;
	scene->done_count++;
}

static struct scene scene_make(void)
{
	struct scene scene = { .board = shared_memory_create(sizeof(*scene.board)),
			       .bad_piece = PIECES };

	CHECK(scene.board != NULL);
	return scene;
}

static int run(struct scene *scene, uint32_t workers)
{
	const struct processes processes = {
		.worker_count = workers,
		.piece_count = PIECES,
		.work = work,
		.done = done,
		.user = scene,
	};

	return processes_run(&processes);
}

static void every_piece_runs_once(void **state)
{
	(void)state;
	for (uint32_t workers = 0; workers < 6; workers++) {
		struct scene scene = scene_make();

		CHECK(run(&scene, workers) == 0);
		CHECK(scene.done_count == PIECES && scene.board->count == PIECES);
		for (uint32_t p = 0; p < PIECES; p++)
			CHECK(scene.board->runs[p] == 1 && scene.done[p]);
		shared_memory_destroy(scene.board, sizeof(*scene.board));
	}
}

static void one_worker_takes_them_in_order(void **state)
{
	struct scene scene = scene_make();

	(void)state;
	CHECK(run(&scene, 1) == 0);
	for (uint32_t p = 0; p < PIECES; p++)
		CHECK(scene.board->order[p] == p);
	shared_memory_destroy(scene.board, sizeof(*scene.board));
}

static void a_failure_ends_it_and_comes_back(void **state)
{
	static const int results[] = { -ENOMEM, -EINVAL, -255, 0 };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(results); i++) {
		struct scene scene = scene_make();

		scene.bad_piece = 7;
		scene.bad_result = results[i];
		CHECK(run(&scene, 2) == (results[i] ? results[i] : -EIO));
		CHECK(!scene.done[7] && scene.done_count < PIECES);
		CHECK(scene.board->count < PIECES);
		shared_memory_destroy(scene.board, sizeof(*scene.board));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_piece_runs_once),
		cmocka_unit_test(one_worker_takes_them_in_order),
		cmocka_unit_test(a_failure_ends_it_and_comes_back),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
