#include "pipeline/release/pack.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/check.h"

enum { LEAVES = 6, LEAF_BYTES = 100 };

static char folder[64];
static struct object_store *objects;

static int set_up(void **state)
{
	(void)state;
	snprintf(folder, sizeof(folder), "/tmp/gopura-pack-XXXXXX");
	return mkdtemp(folder) && object_store_create(&objects) == 0 ? 0 : -1;
}

static int tear_down(void **state)
{
	char command[100];

	(void)state;
	object_store_destroy(objects);
	snprintf(command, sizeof(command), "rm -rf '%s'", folder);
	return system(command);
}

static struct page_child leaf(uint8_t value)
{
	uint8_t bytes[LEAF_BYTES];
	struct page_child child;

	memset(bytes, value, sizeof(bytes));
	CHECK(object_store_add(objects, (struct bytes){ bytes, sizeof(bytes) }, &child) == 0);
	return child;
}

static struct page_child page_of(enum page_kind kind, struct page_child *children, uint32_t count)
{
	struct page page = { .kind = kind, .child_count = count, .children = children };
	struct page_child child;

	CHECK(object_store_add_page(objects, &page, &child) == 0);
	CHECK(child.is_page);
	return child;
}

/* A root of two pages of three leaves each; the second one's leaves begin with `second`. */
static struct page_child tree(uint8_t second)
{
	struct page_child leaves[LEAVES], pages[2];

	for (uint8_t i = 0; i < LEAVES; i++)
		leaves[i] = leaf(i < 3 ? i : (uint8_t)(second + i));
	pages[0] = page_of(PAGE_FACE, leaves, 3);
	pages[1] = page_of(PAGE_FACE, leaves + 3, 3);
	return page_of(PAGE_BRICK, pages, 2);
}

static int pack(struct page_child root, const struct locator *before, struct pack_result *result)
{
	const struct pack_options options = { .release = folder,
					      .objects = objects,
					      .root = root,
					      .before = before,
					      .pack_bytes = 400 };

	return pack_release(&options, result);
}

/* Everything below the page lies where the locator says. */
static void check_page(const struct locator *locator, struct hash name)
{
	const struct locator_block *block = locator_find(locator, name);
	char path[200], hex[HASH_HEX_BYTES];
	struct buffer object, pack;
	struct page page;

	CHECK(block != NULL);
	buffer_init(&object, 1 << 20);
	buffer_init(&pack, 1 << 20);
	CHECK(object_store_read(objects, name, &object) == 0);
	CHECK(page_decode(&page, buffer_bytes(&object)) == 0);
	hash_to_hex(locator->packs[block->pack], hex);
	snprintf(path, sizeof(path), "%s/packs/%s", folder, hex);
	CHECK(buffer_read_file(&pack, path) == 0);
	CHECK(hash_equal(hash_of(buffer_bytes(&pack)), locator->packs[block->pack]));
	CHECK(block->size == page_child_offset(&page, page.child_count));
	for (uint32_t i = 0; i < page.child_count; i++) {
		struct bytes child = { pack.data + block->offset + page_child_offset(&page, i),
				       page.children[i].size };

		CHECK(hash_equal(hash_of(child), page.children[i].hash));
		if (page.children[i].is_page)
			check_page(locator, page.children[i].hash);
	}
	page_finish(&page);
	buffer_finish(&object);
	buffer_finish(&pack);
}

static void every_object_lies_where_the_locator_says(void **state)
{
	struct page_child root = tree(0);
	struct pack_result result;
	struct locator locator;

	(void)state;
	CHECK(pack(root, NULL, &result) == 0);
	CHECK(result.blocks_written == 4 && result.blocks_reused == 0);
	CHECK(result.packs_written == 3); /* pages; three leaves; three leaves */
	CHECK(pack_read_locator(&locator, folder, root.hash) == 0);
	CHECK(locator.block_count == 4);
	check_page(&locator, root.hash);
	CHECK(locator_find(&locator, (struct hash){ 0 })->size == root.size);
	locator_finish(&locator);
}

static void blocks_of_before_stay_where_they_are(void **state)
{
	struct page_child first = tree(0), second = tree(50);
	struct pack_result result;
	struct locator before, after;

	(void)state;
	CHECK(pack(first, NULL, &result) == 0);
	CHECK(pack_read_locator(&before, folder, first.hash) == 0);
	CHECK(pack(second, &before, &result) == 0);
	CHECK(result.blocks_reused == 1 && result.reused_bytes == 3 * LEAF_BYTES);
	CHECK(result.packs_reused == 1);
	CHECK(pack_read_locator(&after, folder, second.hash) == 0);
	check_page(&after, second.hash);
	check_page(&before, first.hash); /* the old release is whole still */
	locator_finish(&before);
	locator_finish(&after);
}

static void a_pack_that_is_gone_is_not_pointed_into(void **state)
{
	struct page_child first = tree(0), second = tree(50);
	struct pack_result result;
	struct locator before, after;
	char command[100];

	(void)state;
	CHECK(pack(first, NULL, &result) == 0);
	CHECK(pack_read_locator(&before, folder, first.hash) == 0);
	snprintf(command, sizeof(command), "rm '%s'/packs/*", folder);
	CHECK(system(command) == 0);
	CHECK(pack(second, &before, &result) == 0);
	CHECK(result.blocks_reused == 0);
	CHECK(pack_read_locator(&after, folder, second.hash) == 0);
	check_page(&after, second.hash);
	locator_finish(&before);
	locator_finish(&after);
}

/* Has the folder for a moment, with a pack half written. Returns 0 if the pack could be finished.
 */
static int another_publisher(int told_fd)
{
	char packs[100], path[120], temporary[BYTES_PATH_MAX];
	int fd, file;

	snprintf(packs, sizeof(packs), "%s/packs", folder);
	snprintf(path, sizeof(path), "%s/theirs", packs);
	fd = open(packs, O_RDONLY | O_DIRECTORY);
	file = bytes_begin_file(temporary, path);
	if (fd < 0 || file < 0 || flock(fd, LOCK_EX) < 0 || write(told_fd, "x", 1) != 1)
		return 1;
	usleep(300000); /* in which the pack would be removed */
	return bytes_end_file(file, temporary, path, 0) < 0;
}

static void another_publishers_half_written_pack_is_left_alone(void **state)
{
	struct page_child root = tree(0);
	struct pack_result result;
	int told[2], status;
	char command[100], byte;
	pid_t child;

	(void)state;
	snprintf(command, sizeof(command), "mkdir '%s/packs'", folder);
	CHECK(system(command) == 0 && pipe(told) == 0);
	child = fork();
	if (child == 0)
		_exit(another_publisher(told[1]));
	CHECK(read(told[0], &byte, 1) == 1);
	CHECK(pack(root, NULL, &result) == 0);
	CHECK(waitpid(child, &status, 0) == child);
	CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0);
	close(told[0]);
	close(told[1]);
}

static void what_a_killed_publisher_left_is_removed(void **state)
{
	struct page_child root = tree(0);
	struct pack_result result;
	char command[200];

	(void)state;
	snprintf(command, sizeof(command), "mkdir '%s/packs' && touch '%s/packs/x.abc123'", folder,
		 folder);
	CHECK(system(command) == 0);
	CHECK(pack(root, NULL, &result) == 0);
	snprintf(command, sizeof(command), "test ! -e '%s/packs/x.abc123'", folder);
	CHECK(system(command) == 0);
}

static void an_object_that_is_missing_stops_it(void **state)
{
	struct page_child nowhere = { .hash = { { 1, 2, 3 } }, .size = 10 }, root;
	struct pack_result result;
	struct locator locator;

	(void)state;
	root = page_of(PAGE_INFO, &nowhere, 1);
	CHECK(pack(root, NULL, &result) == -ENOENT);
	CHECK(pack_read_locator(&locator, folder, root.hash) == -ENOENT);
}

static void a_stretch_of_a_file_is_checked_when_it_is_read(void **state)
{
	const uint8_t text[] = "before|the tile|after";
	const struct bytes tile = { text + 7, 8 };
	struct page_child child = { .hash = hash_of(tile), .size = 8 };
	struct buffer out;
	char path[100];

	(void)state;
	snprintf(path, sizeof(path), "%s/tiles", folder);
	CHECK(bytes_write_file((struct bytes){ text, sizeof(text) }, path) == 0);
	CHECK(object_store_add_stretch(objects, path, 7, &child) == 0);
	buffer_init(&out, 1000);
	CHECK(object_store_has(objects, child.hash));
	CHECK(object_store_read(objects, child.hash, &out) == 0);
	CHECK(out.size == 8 && memcmp(out.data, "the tile", 8) == 0);
	object_store_destroy(objects);
	CHECK(object_store_create(&objects) == 0);
	CHECK(object_store_read(objects, child.hash, &out) == -ENOENT);
	CHECK(object_store_add_stretch(objects, path, 6, &child) == 0); /* one byte off */
	CHECK(object_store_read(objects, child.hash, &out) == -EBADMSG);
	buffer_finish(&out);
}

static void refuses_objects_out_of_bounds(void **state)
{
	const struct page_child large = { .hash = { { 1 } }, .size = OBJECT_BYTES_MAX + 1 };

	(void)state;
	CHECK(object_store_add(objects, (struct bytes){ NULL, 0 }, NULL) == -EFBIG);
	CHECK(object_store_add_stretch(objects, "x", 0, &large) == -EFBIG);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(every_object_lies_where_the_locator_says, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(blocks_of_before_stay_where_they_are, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_pack_that_is_gone_is_not_pointed_into, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(another_publishers_half_written_pack_is_left_alone,
						set_up, tear_down),
		cmocka_unit_test_setup_teardown(what_a_killed_publisher_left_is_removed, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(an_object_that_is_missing_stops_it, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_stretch_of_a_file_is_checked_when_it_is_read,
						set_up, tear_down),
		cmocka_unit_test_setup_teardown(refuses_objects_out_of_bounds, set_up, tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
