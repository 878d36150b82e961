#include "base/processes.h"

#include <errno.h>
#include <signal.h>
#include <stdbool.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/shared_memory.h"
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
	/* On a busy machine the bad one may end after many of the others. */
	if (piece > scene->bad_piece)
		clock_nanosleep(CLOCK_MONOTONIC, 0, &(struct timespec){ .tv_nsec = 300000000 },
				NULL);
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

static void every_shard_does_all_pieces_its_own_first(void **state)
{
	(void)state;
	for (uint32_t pieces = 1; pieces < 70; pieces++)
		for (uint32_t count = 0; count < 9; count++)
			for (uint32_t number = 0; number == 0 || number < count; number++) {
				const struct shard shard = { number, count };
				uint32_t parts = count > 1 ? count : 1;
				uint32_t first = pieces * number / parts;
				uint32_t own = pieces * (number + 1) / parts - first;
				uint32_t order[70];
				bool seen[70] = { false };

				shard_order(shard, order, pieces);
				for (uint32_t n = 0; n < pieces; n++) {
					uint32_t piece = order[n];

					CHECK(piece < pieces && !seen[piece]);
					CHECK(n >= own || piece == first + n);
					seen[piece] = true;
				}
			}
}

/* If all went on with the same piece, no one would be of help to another. */
static void shards_go_on_with_different_pieces(void **state)
{
	enum { COUNT = 8, MANY = 400, OWN = MANY / COUNT };
	static uint32_t orders[COUNT][MANY];
	uint32_t meetings = 0;

	(void)state;
	for (uint32_t a = 0; a < COUNT; a++)
		shard_order((struct shard){ a, COUNT }, orders[a], MANY);
	for (uint32_t n = OWN; n < MANY; n++)
		for (uint32_t a = 0; a < COUNT; a++)
			for (uint32_t b = 0; b < a; b++)
				meetings += orders[a][n] == orders[b][n];
	/* by chance, one pair in so many pieces: twice as much as that is too often */
	CHECK(meetings < 2 * (MANY - OWN) * (COUNT * (COUNT - 1) / 2) / MANY);
}

static void a_shard_runs_every_piece(void **state)
{
	struct scene scene = scene_make();
	const struct processes processes = {
		.worker_count = 1,
		.piece_count = PIECES,
		.shard = { 2, 4 },
		.work = work,
		.done = done,
		.user = &scene,
	};

	(void)state;
	CHECK(processes_run(&processes) == 0);
	CHECK(scene.done_count == PIECES && scene.board->order[0] == 10);
	for (uint32_t p = 0; p < PIECES; p++)
		CHECK(scene.board->runs[p] == 1);
	shared_memory_destroy(scene.board, sizeof(*scene.board));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_piece_runs_once),
		cmocka_unit_test(one_worker_takes_them_in_order),
		cmocka_unit_test(a_failure_ends_it_and_comes_back),
		cmocka_unit_test(every_shard_does_all_pieces_its_own_first),
		cmocka_unit_test(shards_go_on_with_different_pieces),
		cmocka_unit_test(a_shard_runs_every_piece),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
