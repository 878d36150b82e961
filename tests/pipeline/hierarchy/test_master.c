#include "pipeline/hierarchy/master.h"

#include <errno.h>
#include <glob.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "format/patch.h"
#include "pipeline/hierarchy/master_cut.h"
#include "tests/check.h"
#include "tests/pipeline/shapes.h"

static const struct master_options options = {
	.multires = { .patch_triangles = 64, .top_triangles = 400, .jobs = 2 },
};

struct home {
	char folder[64], master[128], index[160], groups[256];
	struct hash stamp;
};

static void home_init(struct home *home)
{
	static const struct hash key = { { 7 } };
	char hex[HASH_HEX_BYTES];
	struct mesh mesh = shape_temple(50);
	struct master_report report;

	memcpy(home->folder, "/tmp/gopura-master-XXXXXX", 26);
	CHECK(mkdtemp(home->folder) != NULL);
	home->stamp = master_stamp(key, &options);
	hash_to_hex(home->stamp, hex);
	snprintf(home->master, sizeof(home->master), "%s/master", home->folder);
	snprintf(home->index, sizeof(home->index), "%s/index", home->master);
	snprintf(home->groups, sizeof(home->groups), "%s/groups-%s", home->master, hex);
	CHECK(master_build(home->master, &mesh, home->stamp, &options, &report) == 0);
	CHECK(report.stats.level_count > 3);
	mesh_finish(&mesh);
}

static void home_finish(struct home *home)
{
	unlink(home->index);
	unlink(home->groups);
	rmdir(home->master);
	CHECK(rmdir(home->folder) == 0); /* nothing else was left */
}

static struct home kept; /* which tests only read */

static int make_kept(void **state)
{
	(void)state;
	home_init(&kept);
	return 0;
}

static int finish_kept(void **state)
{
	(void)state;
	home_finish(&kept);
	return 0;
}

static void gives_every_group_back(void **state)
{
	struct master *master;
	struct buffer object;
	uint64_t finest = 0;

	(void)state;
	CHECK(master_open(&master, kept.master, &kept.stamp) == 0);
	buffer_init(&object, OBJECT_BYTES_MAX);
	for (uint32_t g = 0; g < master->hierarchy.group_count; g++) {
		const struct hierarchy_group *group = &master->hierarchy.groups[g];
		struct patch_mesh patches[GROUP_PATCHES_MAX];
		uint32_t count;

		buffer_clear(&object);
		CHECK(master_read_group(master, g, &object) == 0);
		CHECK(patch_group_decode(patches, &count, buffer_bytes(&object)) == 0);
		CHECK(count == group->patch_count);
		for (uint32_t p = 0; p < count; p++) {
			const struct hierarchy_patch *row =
				&master->hierarchy.patches[group->first_patch + p];

			CHECK(row->triangle_count == patches[p].triangle_count);
			CHECK(row->vertex_count == patches[p].vertex_count);
			finest += row->finer == HIERARCHY_NONE ? row->triangle_count : 0;
			patch_mesh_finish(&patches[p]);
		}
	}
	CHECK(finest == master->source_triangles);
	CHECK(master_read_group(master, master->hierarchy.group_count, &object) == -EINVAL);
	buffer_finish(&object);
	master_destroy(master);
}

static void knows_what_it_was_made_from(void **state)
{
	static const struct hash other_key = { { 8 } };
	struct master_options other_options = options;
	struct master *master;
	struct hash other = master_stamp(other_key, &options);

	(void)state;
	CHECK(master_open(&master, kept.master, &other) == -ESTALE && !master);
	CHECK(master_open(&master, kept.master, NULL) == 0);
	master_destroy(master);
	CHECK(master_open(&master, kept.folder, NULL) == -ENOENT);
	other_options.multires.jobs = 7; /* makes the same bytes */
	CHECK(hash_equal(kept.stamp, master_stamp((struct hash){ { 7 } }, &other_options)));
	other_options.multires.simplifier = MULTIRES_FEATURES;
	CHECK(!hash_equal(kept.stamp, master_stamp((struct hash){ { 7 } }, &other_options)));
	other_options = options;
	other_options.multires.kind = MULTIRES_TREE;
	CHECK(!hash_equal(kept.stamp, master_stamp((struct hash){ { 7 } }, &other_options)));
}

static void refuses_damaged_files(void **state)
{
	struct home home;
	struct master *master;
	struct buffer index;

	(void)state;
	home_init(&home);
	buffer_init(&index, 16 << 20);
	CHECK(buffer_read_file(&index, home.index) == 0);
	for (size_t at = 0; at < index.size; at += 37) {
		index.data[at] ^= 0x10;
		CHECK(bytes_write_file(buffer_bytes(&index), home.index) == 0);
		CHECK(master_open(&master, home.master, NULL) == -EBADMSG);
		index.data[at] ^= 0x10;
	}
	for (size_t size = 0; size < index.size; size += 61) {
		CHECK(bytes_write_file((struct bytes){ index.data, size }, home.index) == 0);
		CHECK(master_open(&master, home.master, NULL) == -EBADMSG);
	}
	CHECK(bytes_write_file(buffer_bytes(&index), home.index) == 0);
	CHECK(truncate(home.groups, 1000) == 0);
	CHECK(master_open(&master, home.master, NULL) == -EBADMSG);
	CHECK(unlink(home.groups) == 0);
	CHECK(master_open(&master, home.master, NULL) == -ENOENT);
	buffer_finish(&index);
	home_finish(&home);
}

static uint64_t triangles_in(const struct hierarchy *hierarchy)
{
	uint64_t sum = 0;

	for (uint32_t p = 0; p < hierarchy->patch_count; p++)
		sum += hierarchy->patches[p].triangle_count;
	return sum;
}

static void publishes_no_more_than_the_share(void **state)
{
	static const double shares[] = { 0.1, 0.2, 0.5, 0.99 };
	struct master *master;
	struct master_cut cut;

	(void)state;
	CHECK(master_open(&master, kept.master, NULL) == 0);
	for (size_t i = 0; i < ARRAY_COUNT(shares); i++) {
		double most = shares[i] * (double)master->source_triangles;

		CHECK(master_cut_create(&cut, master, shares[i]) == 0);
		/* Honestly counted, sound by all rules, and hardly less than it may be. */
		CHECK(cut.triangle_count == triangles_in(&cut.hierarchy));
		CHECK((double)cut.triangle_count <= most);
		CHECK(hierarchy_check(&cut.hierarchy) == 0);
		CHECK((double)cut.triangle_count >
		      0.6 * fmin(most, (double)triangles_in(&master->hierarchy)));
		for (uint32_t g = 0; g < cut.hierarchy.group_count; g++)
			CHECK(cut.hierarchy.groups[g].error_m ==
			      master->hierarchy.groups[cut.groups[g]].error_m);
		master_cut_finish(&cut);
	}
	CHECK(master_cut_create(&cut, master, 1) == 0); /* everything */
	CHECK(cut.hierarchy.group_count == master->hierarchy.group_count);
	master_cut_finish(&cut);
	CHECK(master_cut_create(&cut, master, 0.001) == -ERANGE);
	CHECK(!cut.groups && !cut.hierarchy.groups);
	master_destroy(master);
}

static void a_new_build_leaves_nothing_of_the_old(void **state)
{
	struct master_options tree = options;
	struct master_report report;
	struct home home;
	struct master *master;
	struct mesh mesh = shape_temple(40);
	struct hash stamp;
	char hex[HASH_HEX_BYTES];

	(void)state;
	home_init(&home);
	tree.multires.kind = MULTIRES_TREE;
	stamp = master_stamp((struct hash){ { 9 } }, &tree);
	CHECK(master_build(home.master, &mesh, stamp, &tree, &report) == 0);
	CHECK(access(home.groups, F_OK) < 0);
	CHECK(master_open(&master, home.master, &home.stamp) == -ESTALE);
	CHECK(master_open(&master, home.master, &stamp) == 0);
	master_destroy(master);
	hash_to_hex(stamp, hex);
	snprintf(home.groups, sizeof(home.groups), "%s/groups-%s", home.master, hex);
	mesh_finish(&mesh);
	home_finish(&home);
}

static const struct master_options shared = {
	.multires = { .patch_triangles = 64,
		      .top_triangles = 400,
		      .block_triangles = 400,
		      .jobs = 2 },
};

static void home_of_shards(struct home *home)
{
	char hex[HASH_HEX_BYTES];

	memcpy(home->folder, "/tmp/gopura-master-XXXXXX", 26);
	CHECK(mkdtemp(home->folder) != NULL);
	home->stamp = master_stamp((struct hash){ { 7 } }, &shared);
	hash_to_hex(home->stamp, hex);
	snprintf(home->master, sizeof(home->master), "%s/master", home->folder);
	snprintf(home->index, sizeof(home->index), "%s/index", home->master);
	snprintf(home->groups, sizeof(home->groups), "%s/groups-%s", home->master, hex);
}

/* Places and spheres are floats there, which are rounded by more than what spheres may differ. */
static void a_model_far_from_the_origin_is_built(void **state)
{
	struct mesh mesh = shape_temple(50);
	struct master_report report;
	struct home home;

	(void)state;
	home_of_shards(&home);
	for (uint32_t v = 0; v < mesh.vertex_count; v++)
		for (int i = 0; i < 2; i++)
			mesh.positions[v][i] += 3000.0f;
	CHECK(master_build(home.master, &mesh, home.stamp, &options, &report) == 0);
	CHECK(report.stats.level_count > 3);
	mesh_finish(&mesh);
	home_finish(&home);
}

/* All levels have at most 2^20 patches (format/hierarchy.c), up to twice those of the finest. */
static void the_largest_scans_have_no_more_patches_than_fit(void **state)
{
	static const uint64_t sizes[] = { 524288000, 700000000, 1500000000, 2097152000 };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(sizes); i++)
		for (uint32_t asked = 0; asked <= 256; asked += 256) {
			struct multires_options some = { .patch_triangles = asked };

			multires_set_defaults(&some, sizes[i]);
			CHECK(some.patch_triangles <= PATCH_TRIANGLES_MAX);
			CHECK(2 * sizes[i] / some.patch_triangles <= 1050000);
		}
}

static void patches_of_other_scans_are_as_large_as_asked(void **state)
{
	struct multires_options none = { 0 }, few = { .patch_triangles = 256 };

	(void)state;
	multires_set_defaults(&none, 100000000);
	multires_set_defaults(&few, 100000000);
	CHECK(none.patch_triangles == 1000 && few.patch_triangles == 256);
}

/* ---- several at once (docs/cluster.md) */

/* Builds a master as one of several shards, in a process of its own. */
static pid_t begin_shard(const char *folder, uint32_t number, uint32_t count)
{
	struct master_options shard_options = shared;
	struct master_report report;
	struct mesh mesh;
	pid_t pid = fork();
	int rc;

	CHECK(pid >= 0);
	if (pid > 0)
		return pid;
	mesh = shape_temple(24);
	shard_options.multires.shard = (struct shard){ number, count };
	rc = master_build(folder, &mesh, master_stamp((struct hash){ { 7 } }, &shared),
			  &shard_options, &report);
	mesh_finish(&mesh);
	_exit(-rc);
}

static int end_shard(pid_t pid)
{
	int status;

	CHECK(waitpid(pid, &status, 0) == pid && WIFEXITED(status));
	return WEXITSTATUS(status);
}

static void check_same_file(const char *a, const char *b)
{
	struct buffer left, right;

	buffer_init(&left, 64 << 20);
	buffer_init(&right, 64 << 20);
	CHECK(buffer_read_file(&left, a) == 0 && buffer_read_file(&right, b) == 0);
	CHECK(left.size > 0 && left.size == right.size &&
	      memcmp(left.data, right.data, left.size) == 0);
	buffer_finish(&left);
	buffer_finish(&right);
}

/* Compares with the master of one machine, and finishes the home. */
static void check_against_one_machine(struct home *home)
{
	struct home alone;

	home_of_shards(&alone);
	CHECK(end_shard(begin_shard(alone.master, 0, 0)) == 0);
	check_same_file(home->groups, alone.groups);
	check_same_file(home->index, alone.index);
	home_finish(&alone);
	master_drop_leftovers(home->master, home->stamp);
	home_finish(home);
}

static void shards_at_once_make_the_same_bytes(void **state)
{
	static const uint32_t numbers[] = { 0, 1, 2, 1 }; /* one is doubled */
	pid_t pids[ARRAY_COUNT(numbers)];
	struct home home;

	(void)state;
	home_of_shards(&home);
	for (size_t i = 0; i < ARRAY_COUNT(numbers); i++)
		pids[i] = begin_shard(home.master, numbers[i], 3);
	for (size_t i = 0; i < ARRAY_COUNT(numbers); i++)
		CHECK(end_shard(pids[i]) == 0);
	check_against_one_machine(&home);
}

static void wait_for_the_first_node(const struct home *home)
{
	char hex[HASH_HEX_BYTES], pattern[256];
	glob_t found;

	hash_to_hex(home->stamp, hex);
	snprintf(pattern, sizeof(pattern), "%s/blocks-%s/node-*", home->master, hex);
	while (glob(pattern, GLOB_NOSORT, NULL, &found) != 0)
		usleep(200);
	globfree(&found);
}

static void a_shard_that_comes_last_ends_well(void **state)
{
	struct home home;
	pid_t slow;

	(void)state;
	home_of_shards(&home);
	slow = begin_shard(home.master, 1, 2);
	wait_for_the_first_node(&home);
	CHECK(kill(slow, SIGSTOP) == 0);
	CHECK(end_shard(begin_shard(home.master, 0, 2)) == 0);
	CHECK(access(home.index, F_OK) == 0);
	CHECK(kill(slow, SIGCONT) == 0);
	CHECK(end_shard(slow) == 0);
	check_against_one_machine(&home);
}

/* Kills a shard once it has made a block. */
static void leave_half_a_build(const struct home *home)
{
	pid_t killed = begin_shard(home->master, 0, 2);
	int status;

	wait_for_the_first_node(home);
	CHECK(kill(killed, SIGKILL) == 0 && waitpid(killed, &status, 0) == killed);
	CHECK(WIFSIGNALED(status) && access(home->index, F_OK) < 0);
}

static void a_damaged_file_of_half_a_build_is_made_again(void **state)
{
	char hex[HASH_HEX_BYTES], pattern[256];
	struct home home;
	glob_t found;

	(void)state;
	home_of_shards(&home);
	leave_half_a_build(&home);
	hash_to_hex(home.stamp, hex);
	snprintf(pattern, sizeof(pattern), "%s/blocks-%s/digest-*", home.master, hex);
	CHECK(glob(pattern, 0, NULL, &found) == 0);
	CHECK(truncate(found.gl_pathv[0], 5) == 0);
	globfree(&found);
	CHECK(end_shard(begin_shard(home.master, 0, 0)) == 0);
	check_against_one_machine(&home);
}

static void half_a_build_of_other_options_leaves_its_room(void **state)
{
	struct mesh mesh = shape_temple(50);
	struct master_report report;
	char hex[HASH_HEX_BYTES], blocks[256];
	struct home home;

	(void)state;
	home_of_shards(&home);
	leave_half_a_build(&home);
	hash_to_hex(home.stamp, hex);
	snprintf(blocks, sizeof(blocks), "%s/blocks-%s", home.master, hex);
	CHECK(access(blocks, F_OK) == 0);
	mesh.triangles[5][1] = mesh.vertex_count; /* this one does not come to its end */
	CHECK(master_build(home.master, &mesh, master_stamp((struct hash){ { 9 } }, &shared),
			   &shared, &report) == -EINVAL);
	CHECK(access(blocks, F_OK) < 0);
	mesh_finish(&mesh);
	master_drop_leftovers(home.master, home.stamp);
	home_finish(&home);
}

static void a_killed_shard_costs_nothing(void **state)
{
	struct home home;

	(void)state;
	home_of_shards(&home);
	leave_half_a_build(&home);
	CHECK(end_shard(begin_shard(home.master, 1, 2)) == 0);
	check_against_one_machine(&home);
}

/* `build` begins by removing what looks left over (docs/cluster.md). */
static void a_build_that_sweeps_costs_a_slow_shard_nothing(void **state)
{
	struct home home;
	pid_t slow;

	(void)state;
	home_of_shards(&home);
	slow = begin_shard(home.master, 0, 2);
	wait_for_the_first_node(&home);
	CHECK(kill(slow, SIGSTOP) == 0);
	bytes_sweep_folder(home.master, INT64_MAX);
	CHECK(kill(slow, SIGCONT) == 0);
	CHECK(end_shard(slow) == 0);
	check_against_one_machine(&home);
}

/* That it was there before is no excuse for a build that failed. */
static void a_failure_is_told_where_a_master_is_there(void **state)
{
	struct home home;
	struct mesh mesh = shape_temple(50);
	struct master_report report;

	(void)state;
	home_init(&home);
	mesh.triangles[5][1] = mesh.vertex_count;
	CHECK(master_build(home.master, &mesh, home.stamp, &options, &report) == -EINVAL);
	master_drop_leftovers(home.master, home.stamp);
	mesh_finish(&mesh);
	home_finish(&home);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_every_group_back),
		cmocka_unit_test(knows_what_it_was_made_from),
		cmocka_unit_test(refuses_damaged_files),
		cmocka_unit_test(publishes_no_more_than_the_share),
		cmocka_unit_test(a_new_build_leaves_nothing_of_the_old),
		cmocka_unit_test(a_model_far_from_the_origin_is_built),
		cmocka_unit_test(the_largest_scans_have_no_more_patches_than_fit),
		cmocka_unit_test(patches_of_other_scans_are_as_large_as_asked),
		cmocka_unit_test(shards_at_once_make_the_same_bytes),
		cmocka_unit_test(a_shard_that_comes_last_ends_well),
		cmocka_unit_test(a_killed_shard_costs_nothing),
		cmocka_unit_test(a_damaged_file_of_half_a_build_is_made_again),
		cmocka_unit_test(half_a_build_of_other_options_leaves_its_room),
		cmocka_unit_test(a_build_that_sweeps_costs_a_slow_shard_nothing),
		cmocka_unit_test(a_failure_is_told_where_a_master_is_there),
	};

	return cmocka_run_group_tests(tests, make_kept, finish_kept);
}
