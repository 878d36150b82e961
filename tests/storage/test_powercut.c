/* The power goes at every write of a workload that calls cache and state as the programs do: first
 * release, update, an update that is returned from, a restart. Each disk that may be left is opened
 * with the product's own code, and what was promised is looked for. docs/powercut.md.
 *
 *   test_powercut               a sample of the cuts, as a unit test
 *   test_powercut --all [SEED]  every write, 1 000 disks where not all can be tried; prints counts
 */
#include <errno.h>
#include <sys/resource.h>

#include "base/clock.h"
#include "base/log.h"
#include "storage/cache.h"
#include "storage/state.h"
#include "tests/storage/power_disk.h"

enum {
	RELEASES = 5, /* 1 .. 4 are shown in turn, 3 is returned from */
	OBJECTS = 10, /* of a release; the last two are the next one's too */
	OBJECT_BYTES_MIN = 300,
	MARKS_MAX = 256,
};

static char folder[] = "/dev/shm/gopura-powercut-XXXXXX";
static char record_folder[64], replay_folder[64];

/* What was promised at a mark. */
struct promise {
	uint64_t in_use, before, floor; /* sequences */
	uint32_t tries;
	bool trusted;
	uint32_t tuf;      /* number of the metadata of The Update Framework; 0: none */
	uint32_t objects;  /* of the first so many all must be there */
	uint32_t locators; /* the same, in use or before */
};

static struct promise promises[MARKS_MAX];
static size_t promise_count;

/* What a test leaves out, to see that it is missed. */
static bool careless;

struct counts {
	uint64_t ops, cuts, disks, whole_cuts, losses;
	char loss[256]; /* the first one */
};

/* ---- the releases: everything follows from their numbers */

static uint32_t object_number(uint32_t release, uint32_t n)
{
	return (release - 1) * (OBJECTS - 2) + n;
}

/* Borrowed until the next call. */
static struct bytes object(uint32_t number)
{
	static uint8_t bytes[8192];
	uint32_t size = OBJECT_BYTES_MIN + number * 977 % 5000;

	for (uint32_t i = 0; i < size; i++)
		bytes[i] = (uint8_t)((i * 2654435761u + number * 40503u) >> 13);
	return (struct bytes){ bytes, size };
}

/* Of each object, once: a million disks ask. */
static struct hash hash_of_object(uint32_t number)
{
	static struct hash hashes[OBJECTS * RELEASES];
	static bool known;

	for (uint32_t n = 0; !known && n < OBJECTS * RELEASES; n++)
		hashes[n] = hash_of(object(n));
	known = true;
	return hashes[number];
}

static struct hash root_of(uint64_t sequence)
{
	return (struct hash){ { (uint8_t)sequence, 0xaa } };
}

static struct state_release release_of(uint64_t sequence)
{
	static uint8_t file[700];

	memset(file, (int)sequence, sizeof(file));
	return (struct state_release){
		root_of(sequence), 100 + (uint32_t)sequence, sequence, { file, sizeof(file) }
	};
}

/* Metadata of The Update Framework of that number: four files of its byte. */
static struct state_tuf tuf_of(uint8_t number)
{
	static uint8_t file[900];

	memset(file, number, sizeof(file));
	return (struct state_tuf){ { file, 900 }, { file, 300 }, { file, 310 }, { file, 500 } };
}

/* Returns the number of the metadata that is kept; 0: none; UINT32_MAX: files of two numbers. */
static uint32_t kept_tuf(const struct state *state)
{
	struct state_tuf tuf, expected;

	if (state_tuf(state, &tuf) == -ENOENT)
		return 0;
	expected = tuf_of(tuf.root.data[0]);
	return bytes_equal(tuf.root, expected.root) &&
			       bytes_equal(tuf.timestamp, expected.timestamp) &&
			       bytes_equal(tuf.snapshot, expected.snapshot) &&
			       bytes_equal(tuf.targets, expected.targets)
		       ? tuf.root.data[0]
		       : UINT32_MAX;
}

/* ---- the workload */

static struct cache *open_cache(const char *in)
{
	char path[96];
	const struct cache_options options = { .path = path, .budget_bytes = CACHE_BUDGET_MIN };
	struct cache *cache;

	snprintf(path, sizeof(path), "%s/cache.db", in);
	CHECK(cache_create(&cache, &options) == 0);
	return cache;
}

static struct state *open_state(const char *in)
{
	struct state *state;
	char path[96];

	snprintf(path, sizeof(path), "%s/state.db", in);
	CHECK(state_create(&state, path) == 0);
	return state;
}

static uint64_t sequence_of(int rc, const struct state_release *release)
{
	return rc == 0 ? release->sequence : 0;
}

/* What the state says now is promised from here on. */
static void promise(const struct state *state, uint32_t objects, uint32_t locators)
{
	struct state_release release = { 0 };
	struct promise *next = &promises[promise_count];
	struct bytes trust;

	CHECK(promise_count < MARKS_MAX);
	next->in_use = sequence_of(state_release(state, &release), &release);
	next->before = sequence_of(state_previous(state, &release), &release);
	next->floor = state_sequence_floor(state);
	next->tries = state_tries(state);
	next->trusted = state_trust(state, &trust) == 0;
	next->tuf = kept_tuf(state);
	next->objects = objects;
	next->locators = locators;
	power_mark(promise_count++);
}

/* Brings a release as the fetcher does: locator, objects in transactions, what is kept. */
static void bring(struct cache *cache, uint32_t release)
{
	CHECK(cache_put_file(cache, root_of(release), object(1000 + release)) == 0);
	for (uint32_t n = 0; n < OBJECTS; n++) {
		const uint32_t number = object_number(release, n);
		const struct hash hash = hash_of(object(number));

		CHECK(cache_put(cache, hash, object(number), n * 1000) == 0);
		if (n % 2 == 0)
			CHECK(cache_keep(cache, hash) == 0);
		if (n % 4 == 3)
			CHECK(cache_flush(cache) == 0);
	}
	CHECK(careless || cache_sync(cache) == 0);
}

/* An update: objects first, then the state that names them, then the cache is told. */
static void switch_to(struct cache *cache, struct state *state, uint32_t release)
{
	const struct state_release next = release_of(release);
	const struct state_tuf tuf = tuf_of((uint8_t)release);
	const uint32_t objects = object_number(release, OBJECTS), before = objects - OBJECTS + 2;

	bring(cache, release);
	promise(state, careless ? before : objects, careless ? release - 1 : release);
	CHECK(state_set_tuf(state, &tuf, STATE_CLEAR_NOTHING) == 0);
	promise(state, careless ? before : objects, careless ? release - 1 : release);
	CHECK(state_activate(state, &next) == 0);
	promise(state, objects, release);
	CHECK(cache_use_release(cache, next.root) == 0);
	for (uint32_t n = 0; n < OBJECTS; n += 2)
		CHECK(cache_keep(cache, hash_of(object(object_number(release, n)))) == 0);
	CHECK(cache_flush(cache) == 0);
}

static void prove(struct state *state, uint32_t release)
{
	CHECK(state_prove(state) == 0);
	promise(state, object_number(release, OBJECTS), release);
}

static void work(void)
{
	struct cache *cache = open_cache(record_folder);
	struct state *state = open_state(record_folder);
	const uint32_t three = object_number(3, OBJECTS);

	promise(state, 0, 0);
	CHECK(state_set_trust(state, (struct bytes){ (const uint8_t *)"root", 4 },
			      STATE_CLEAR_NOTHING) == 0);
	promise(state, 0, 0);
	switch_to(cache, state, 1);
	prove(state, 1);
	CHECK(state_raise_time_floor(state, 1700000000) == 0);
	switch_to(cache, state, 2);
	prove(state, 2);
	state_destroy(state);
	cache_destroy(cache);
	cache = open_cache(record_folder);
	state = open_state(record_folder);
	switch_to(cache, state, 3);
	CHECK(state_try(state) == 0);
	promise(state, three, 3);
	CHECK(state_try(state) == 0);
	promise(state, three, 3);
	CHECK(state_fall_back(state) == 0);
	promise(state, three, 3);
	CHECK(cache_use_release(cache, root_of(2)) == 0);
	switch_to(cache, state, 4);
	prove(state, 4);
	state_destroy(state);
	cache_destroy(cache);
}

static void record(bool swallow_syncs)
{
	char command[256];

	for (size_t i = 0; i < power.op_count; i++)
		free(power.ops[i].bytes);
	power.op_count = 0;
	power.file_count = 0;
	promise_count = 0;
	memset(promises, 0, sizeof(promises));
	snprintf(command, sizeof(command), "rm -rf %s && mkdir -p %s %s", record_folder,
		 record_folder, replay_folder);
	CHECK(system(command) == 0);
	snprintf(power.folder, sizeof(power.folder), "%s", record_folder);
	power.swallows_syncs = swallow_syncs;
	power.records = true;
	work();
	power.records = false;
}

/* ---- one disk */

static const char *wrong_release(int rc, const struct state_release *got)
{
	const struct state_release expected = release_of(got->sequence);

	if (rc == -ENOENT)
		return NULL;
	if (!hash_equal(got->root, expected.root) || got->root_bytes != expected.root_bytes ||
	    got->file.size != expected.file.size ||
	    memcmp(got->file.data, expected.file.data, expected.file.size) != 0)
		return "a release is mixed";
	return NULL;
}

static bool keeps(const struct state *state, const struct promise *promise)
{
	struct state_release release = { 0 };
	struct bytes trust;

	return sequence_of(state_release(state, &release), &release) == promise->in_use &&
	       sequence_of(state_previous(state, &release), &release) == promise->before &&
	       state_sequence_floor(state) == promise->floor &&
	       state_tries(state) == promise->tries && kept_tuf(state) == promise->tuf &&
	       (state_trust(state, &trust) == 0) == promise->trusted;
}

/* NULL: all is well. Old or new: the promise that was given, or the next one. */
static const char *judge_state(const struct state *state, const struct promise *old,
			       const struct promise *new)
{
	struct state_release release = { 0 };
	const char *wrong = wrong_release(state_release(state, &release), &release);

	if (!wrong)
		wrong = wrong_release(state_previous(state, &release), &release);
	if (!wrong && state_sequence_floor(state) < old->floor)
		wrong = "the sequence floor fell";
	if (!wrong && kept_tuf(state) == UINT32_MAX)
		wrong = "the metadata of The Update Framework is mixed";
	if (!wrong && kept_tuf(state) < old->tuf)
		wrong = "the metadata of The Update Framework went back";
	if (!wrong && !keeps(state, old) && !keeps(state, new))
		wrong = "the state is neither the old nor the new one";
	return wrong;
}

static const char *judge_objects(struct cache *cache, uint32_t promised)
{
	struct buffer got;
	const char *wrong = NULL;

	buffer_init(&got, 1 << 20);
	for (uint32_t n = 0; n < object_number(RELEASES, 0) && !wrong; n++) {
		const struct hash hash = hash_of_object(n);
		const int rc = cache_get(cache, hash, 0, &got);

		if (rc == 0 && !hash_equal(hash_of(buffer_bytes(&got)), hash))
			wrong = "the cache gives an object that is not of its hash";
		else if (rc != 0 && rc != -ENOENT)
			wrong = "an object is damaged";
		else if (rc != 0 && n < promised)
			wrong = "an object is lost that was safe";
	}
	buffer_finish(&got);
	return wrong;
}

static const char *judge_locators(struct cache *cache, const struct state *state)
{
	struct state_release releases[2] = { 0 };
	const char *wrong = NULL;
	struct buffer got;

	buffer_init(&got, 1 << 20);
	for (int i = 0; i < 2 && !wrong; i++) {
		const int rc = i == 0 ? state_release(state, &releases[i])
				      : state_previous(state, &releases[i]);

		if (rc == 0 && cache_get_file(cache, releases[i].root, &got) != 0)
			wrong = i == 0 ? "the locator of the release in use is lost"
				       : "the locator of the release before is lost";
	}
	buffer_finish(&got);
	return wrong;
}

/* What it promises now, and what will be promised next. */
static const char *judge_disk(const struct promise *old, const struct promise *new, bool goes_on)
{
	struct cache *cache = open_cache(replay_folder);
	struct state *state = open_state(replay_folder);
	struct state_release release = { 0 };
	struct cache_figures figures;
	const char *wrong = judge_state(state, old, new);
	uint32_t promised = old->objects;

	/* The release that the state names is whole, whatever was promised. */
	if (state_release(state, &release) == 0 &&
	    object_number((uint32_t)release.sequence, OBJECTS) > promised)
		promised = object_number((uint32_t)release.sequence, OBJECTS);
	if (!wrong)
		wrong = judge_objects(cache, promised);
	if (!wrong)
		wrong = judge_locators(cache, state);
	cache_figures(cache, &figures);
	if (!wrong && figures.set_aside > 0)
		wrong = "the cache was set aside as damaged";
	if (!wrong && goes_on) {
		release = release_of(100);
		if (state_activate(state, &release) < 0)
			wrong = "the state takes no other release";
		else if (cache_put(cache, hash_of(object(500)), object(500), 0) < 0 ||
			 cache_flush(cache) < 0)
			wrong = "the cache takes no other object";
	}
	state_destroy(state);
	cache_destroy(cache);
	return wrong;
}

/* ---- all disks of a cut */

static uint64_t seed = 1, random_state;

static uint64_t next_random(void)
{
	random_state ^= random_state << 13;
	random_state ^= random_state >> 7;
	random_state ^= random_state << 17;
	return random_state;
}

struct subset {
	const uint8_t *has;
};

static bool is_in(const void *data, size_t i)
{
	return ((const struct subset *)data)->has[i] != 0;
}

/* A beginning, a half of them, or all but a few: in turn. */
static void choose(uint8_t *has, size_t count, uint32_t n)
{
	const size_t first = count ? next_random() % (count + 1) : 0;

	for (size_t i = 0; i < count; i++) {
		const uint64_t dice = next_random() >> 32;

		has[i] = n % 3 == 0 ? i < first : n % 3 == 1 ? dice % 2 : dice % 16 != 0;
	}
}

/* All subsets of so few, or a sample. */
struct effort {
	uint32_t subsets_of_most; /* pending ops */
	uint32_t samples;         /* of more */
	uint32_t torn;            /* one in so many disks has its last write torn too */
	uint64_t losses_most;     /* enough is known then */
	uint32_t shard, shards;   /* cuts are dealt out; 0 shards: all are ours */
};

static void try_disk(const uint8_t *has, uint64_t torn, const struct promise *old,
		     const struct promise *new, size_t op, struct counts *counts)
{
	const struct subset subset = { has };
	const char *wrong;

	power_disk_make(replay_folder, is_in, &subset, torn);
	wrong = judge_disk(old, new, counts->disks % 16 == 0);
	counts->disks++;
	if (!wrong)
		return;
	if (counts->losses++ == 0)
		snprintf(counts->loss, sizeof(counts->loss),
			 "after op %zu of %zu, %zu unsynced: %s", op, power.op_count,
			 power.pending_count, wrong);
}

static void cut_here(size_t op, const struct promise *old, const struct promise *new,
		     const struct effort *effort, struct counts *counts)
{
	const size_t pending = power.pending_count;
	const bool all = pending <= effort->subsets_of_most;
	const uint64_t disks = all ? 1ull << pending : effort->samples;
	uint8_t *has = calloc(pending + 1, 1);

	CHECK(has);
	counts->cuts++;
	counts->whole_cuts += all;
	for (uint64_t n = 0; n < disks && counts->losses < effort->losses_most; n++) {
		if (all)
			for (size_t i = 0; i < pending; i++)
				has[i] = n >> i & 1;
		else
			choose(has, pending, (uint32_t)n);
		try_disk(has, 0, old, new, op, counts);
		if (pending > 0 && n % effort->torn == 0 &&
		    power.ops[power.pending[pending - 1]].kind == POWER_WRITE &&
		    power.ops[power.pending[pending - 1]].size > POWER_SECTOR_BYTES)
			try_disk(has, next_random() | 1, old, new, op, counts);
	}
	free(has);
}

/* stride: every so many ops the power goes. */
static struct counts replay(const struct effort *effort, size_t stride)
{
	static const struct promise nothing;
	struct counts counts = { .ops = power.op_count };
	const struct promise *old = &nothing;

	power_rewind();
	for (size_t op = 0; op < power.op_count && counts.losses < effort->losses_most; op++) {
		size_t next = 0;

		power_step(op);
		if (power.ops[op].kind == POWER_MARK)
			old = &promises[power.ops[op].at];
		/* A mark changes no disk, but it makes the promise stronger. */
		if (op + 1 < power.op_count && power.ops[op + 1].kind == POWER_MARK)
			continue;
		if (op % stride != 0 && power.ops[op].kind != POWER_MARK)
			continue;
		if (effort->shards > 0 && op % effort->shards != effort->shard)
			continue;
		random_state = seed ^ (op + 1) * 0x9e3779b97f4a7c15ull;
		next = old == &nothing ? 0 : (size_t)(old - promises) + 1;
		cut_here(op, old, next < promise_count ? &promises[next] : old, effort, &counts);
	}
	return counts;
}

/* ---- the tests */

static const struct effort a_little = {
	.subsets_of_most = 3, .samples = 6, .torn = 2, .losses_most = 1
};

static void loses_nothing_that_was_promised(void **unused)
{
	struct counts counts;

	(void)unused;
	record(false);
	counts = replay(&a_little, 3);
	if (counts.losses > 0)
		fail_msg("%s", counts.loss);
	CHECK(counts.cuts > 100 && counts.disks > 500);
}

static void misses_syncs_that_are_swallowed(void **unused)
{
	struct counts counts;

	(void)unused;
	record(true);
	counts = replay(&a_little, 3);
	CHECK(counts.losses > 0);
	print_message("found: %s\n", counts.loss);
}

/* The state names a release whose objects nobody synced. */
static void misses_a_sync_before_the_switch(void **unused)
{
	struct counts counts;

	(void)unused;
	careless = true;
	record(false);
	careless = false;
	counts = replay(&a_little, 1);
	CHECK(counts.losses > 0);
	print_message("found: %s\n", counts.loss);
	CHECK(strstr(counts.loss, "an object is lost that was safe") ||
	      strstr(counts.loss, "locator"));
}

static int set_up(void **unused)
{
	(void)unused;
	if (!mkdtemp(folder))
		return -1;
	snprintf(record_folder, sizeof(record_folder), "%s/work", folder);
	snprintf(replay_folder, sizeof(replay_folder), "%s/disk", folder);
	power_install();
	log_set_level(LOG_LEVEL_ERROR);
	return 0;
}

static int tear_down(void **unused)
{
	char command[96];

	(void)unused;
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	return system(command);
}

/* A child's part; the counts go through the pipe. */
static void run_shard(int pipe, uint32_t shard, uint32_t shards)
{
	const struct effort all = { .subsets_of_most = 8,
				    .samples = 1000,
				    .torn = 4,
				    .losses_most = UINT64_MAX,
				    .shard = shard,
				    .shards = shards };
	struct counts counts;

	snprintf(replay_folder, sizeof(replay_folder), "%s/disk%u", folder, shard);
	CHECK(mkdir(replay_folder, 0755) == 0);
	counts = replay(&all, 1);
	CHECK(write(pipe, &counts, sizeof(counts)) == (ssize_t)sizeof(counts));
	_exit(0);
}

static void add(struct counts *sum, const struct counts *more)
{
	sum->ops = more->ops;
	sum->cuts += more->cuts;
	sum->whole_cuts += more->whole_cuts;
	sum->disks += more->disks;
	if (sum->losses == 0)
		memcpy(sum->loss, more->loss, sizeof(sum->loss));
	sum->losses += more->losses;
}

/* Every write, in as many processes as there are cores; another seed takes other samples. */
static int run_all(const char *text)
{
	const uint32_t shards = (uint32_t)sysconf(_SC_NPROCESSORS_ONLN);
	const int64_t began_ms = clock_now_ms();
	struct counts sum = { 0 }, counts;
	uint32_t answers = 0;
	int pipes[2];

	CHECK(set_up(NULL) == 0 && pipe(pipes) == 0);
	seed = text ? strtoull(text, NULL, 10) + 1 : 1;
	record(false);
	for (uint32_t i = 0; i < shards; i++)
		if (fork() == 0)
			run_shard(pipes[1], i, shards);
	close(pipes[1]);
	while (read(pipes[0], &counts, sizeof(counts)) == (ssize_t)sizeof(counts)) {
		add(&sum, &counts);
		answers++;
	}
	printf("%llu operations on disk, %llu cuts, of these %llu with every subset tried\n"
	       "%llu disks opened in %lld s, %llu losses\n",
	       (unsigned long long)sum.ops, (unsigned long long)sum.cuts,
	       (unsigned long long)sum.whole_cuts, (unsigned long long)sum.disks,
	       (long long)(clock_now_ms() - began_ms) / 1000, (unsigned long long)sum.losses);
	if (sum.losses > 0)
		printf("first loss: %s\n", sum.loss);
	if (answers < shards)
		printf("%u of %u processes did not end well\n", shards - answers, shards);
	CHECK(tear_down(NULL) == 0);
	return sum.losses == 0 && answers == shards ? 0 : 1;
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(loses_nothing_that_was_promised),
		cmocka_unit_test(misses_syncs_that_are_swallowed),
		cmocka_unit_test(misses_a_sync_before_the_switch),
	};

	if (argc > 1 && strcmp(argv[1], "--all") == 0)
		return run_all(argc > 2 ? argv[2] : NULL);
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
