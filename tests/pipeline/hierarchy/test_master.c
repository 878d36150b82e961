#include "pipeline/hierarchy/master.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "format/patch.h"
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

static void gives_every_group_back(void **state)
{
	struct home home;
	struct master *master;
	struct buffer object;
	uint64_t finest = 0;

	(void)state;
	home_init(&home);
	CHECK(master_open(&master, home.master, &home.stamp) == 0);
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
	home_finish(&home);
}

static void knows_what_it_was_made_from(void **state)
{
	static const struct hash other_key = { { 8 } };
	struct master_options other_options = options;
	struct home home;
	struct master *master;
	struct hash other = master_stamp(other_key, &options);

	(void)state;
	home_init(&home);
	CHECK(master_open(&master, home.master, &other) == -ESTALE && !master);
	CHECK(master_open(&master, home.master, NULL) == 0);
	master_destroy(master);
	CHECK(master_open(&master, home.folder, NULL) == -ENOENT);
	other_options.multires.jobs = 7; /* makes the same bytes */
	CHECK(hash_equal(home.stamp, master_stamp((struct hash){ { 7 } }, &other_options)));
	other_options.multires.kind = MULTIRES_TREE;
	CHECK(!hash_equal(home.stamp, master_stamp((struct hash){ { 7 } }, &other_options)));
	home_finish(&home);
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
	struct home home;
	struct master *master;
	struct master_cut cut;

	(void)state;
	home_init(&home);
	CHECK(master_open(&master, home.master, NULL) == 0);
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
	home_finish(&home);
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_every_group_back),
		cmocka_unit_test(knows_what_it_was_made_from),
		cmocka_unit_test(refuses_damaged_files),
		cmocka_unit_test(publishes_no_more_than_the_share),
		cmocka_unit_test(a_new_build_leaves_nothing_of_the_old),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
