#include "net/stick.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "format/locator.h"
#include "tests/check.h"

static int64_t now_ms;

int64_t clock_now_ms(void)
{
	return now_ms;
}

struct stage {
	char folder[64];
	struct stick *stick;
	char said[256];
};

static struct hash pack = { { 5 } };
static const struct hash page = { { 9 } }, root = { { 7 } };
static const char stones[] = "sandstonelaterite";

static void on_meta(void *data, enum meta_role role, uint32_t version, struct bytes bytes)
{
	static const char *const names[] = { "root", "release", "timestamp" };
	struct stage *stage = data;
	size_t used = strlen(stage->said);

	snprintf(stage->said + used, sizeof(stage->said) - used, "%s%u:%.*s ", names[role], version,
		 (int)bytes.size, (const char *)bytes.data);
}

static int set_up(void **state)
{
	struct stage *stage = calloc(1, sizeof(*stage));
	const struct stick_options options = { .folder = stage->folder,
					       .meta = on_meta,
					       .data = stage };

	*state = stage;
	snprintf(stage->folder, sizeof(stage->folder), "/tmp/gopura-stick-XXXXXX");
	CHECK(mkdtemp(stage->folder));
	CHECK(stick_create(&stage->stick, &options) == 0);
	return 0;
}

static int tear_down(void **state)
{
	struct stage *stage = *state;
	char command[128];

	stick_destroy(stage->stick);
	stick_destroy(NULL);
	snprintf(command, sizeof(command), "rm -rf %s", stage->folder);
	free(stage);
	return system(command);
}

static void in_folder(const struct stage *stage, char path[192], const char *name)
{
	snprintf(path, 192, "%s/%s", stage->folder, name);
}

static void put(const struct stage *stage, const char *name, const void *bytes, size_t size)
{
	char path[192];

	in_folder(stage, path, name);
	CHECK(bytes_write_file((struct bytes){ bytes, size }, path) == 0);
}

static void put_text(const struct stage *stage, const char *name, const char *text)
{
	put(stage, name, text, strlen(text));
}

/* Below a prefix: "" or "release/". */
static void put_release(const struct stage *stage, const char *prefix, const char *stamp)
{
	static const char *const folders[] = { "", "root", "locator", "packs" };
	struct locator_block block = { page, 0, 0, sizeof(stones) - 1 };
	struct locator locator = { 1, 1, &pack, &block };
	char path[192], name[96], hex[HASH_HEX_BYTES];
	struct buffer file;

	for (size_t i = 0; i < 4; i++) {
		snprintf(name, sizeof(name), "%s%s", prefix, folders[i]);
		in_folder(stage, path, name);
		CHECK(mkdir(path, 0755) == 0 || errno == EEXIST);
	}
	buffer_init(&file, 1 << 20);
	locator_encode(&file, &locator);
	hash_to_hex(root, hex);
	snprintf(name, sizeof(name), "%slocator/%s", prefix, hex);
	put(stage, name, file.data, file.size);
	buffer_finish(&file);
	hash_to_hex(pack, hex);
	snprintf(name, sizeof(name), "%spacks/%s", prefix, hex);
	put_text(stage, name, stones);
	snprintf(name, sizeof(name), "%sroot/1.json", prefix);
	put_text(stage, name, "A");
	snprintf(name, sizeof(name), "%srelease.json", prefix);
	put_text(stage, name, "R");
	snprintf(name, sizeof(name), "%stimestamp.json", prefix);
	put_text(stage, name, stamp);
}

static bool look(struct stage *stage)
{
	now_ms += 5000;
	stage->said[0] = '\0';
	return stick_work(stage->stick);
}

/* What the stick has of the object at offset; its size, or the error. */
static int get(struct stage *stage, struct hash of, uint32_t offset, uint32_t size,
	       const char *text)
{
	const struct message_want want = { { { 1 } }, page, offset, size, 0 };
	struct buffer out;
	int rc;

	buffer_init(&out, 1 << 20);
	rc = stick_get(stage->stick, of, &want, &out);
	if (rc == 0)
		CHECK(out.size == strlen(text) && memcmp(out.data, text, out.size) == 0);
	buffer_finish(&out);
	return rc;
}

static void tells_of_a_stick_once(void **state)
{
	struct stage *stage = *state;

	CHECK(!look(stage) && stage->said[0] == '\0');
	put_release(stage, "", "T");
	CHECK(look(stage));
	CHECK(strcmp(stage->said, "root1:A timestamp0:T release0:R ") == 0);
	CHECK(!look(stage) && stage->said[0] == '\0');
	put_text(stage, "timestamp.json", "U"); /* another stick, between two looks */
	CHECK(look(stage));
	CHECK(strstr(stage->said, "timestamp0:U"));
	stick_forget(stage->stick);
	CHECK(look(stage) && strstr(stage->said, "timestamp0:U"));
}

static void tells_the_roots_after_the_one_that_the_kiosk_has(void **state)
{
	struct stage *stage = *state;

	put_release(stage, "", "T");
	put_text(stage, "root/71.json", "B");
	put_text(stage, "root/72.json", "C");
	stick_trust(stage->stick, 70);
	CHECK(look(stage));
	CHECK(strcmp(stage->said, "root71:B root72:C timestamp0:T release0:R ") == 0);
	stick_trust(stage->stick, 72);
	stick_forget(stage->stick);
	CHECK(look(stage) && strcmp(stage->said, "timestamp0:T release0:R ") == 0);
}

static void finds_a_folder_named_release(void **state)
{
	struct stage *stage = *state;

	put_release(stage, "release/", "T");
	CHECK(look(stage));
	CHECK(get(stage, root, 0, 9, "sandstone") == 0);
}

static void gives_objects_by_the_locator(void **state)
{
	struct stage *stage = *state;

	CHECK(get(stage, root, 0, 9, "") == -ENOENT); /* no stick */
	put_release(stage, "", "T");
	CHECK(look(stage));
	CHECK(get(stage, root, 0, 9, "sandstone") == 0);
	CHECK(get(stage, root, 9, 8, "laterite") == 0);
	CHECK(get(stage, root, 9, 9, "") == -ENOENT);                   /* past the block */
	CHECK(get(stage, (struct hash){ { 8 } }, 0, 9, "") == -ENOENT); /* another release */
	CHECK(get(stage, root, 0, 9, "sandstone") == 0);
}

static void is_gone_when_it_is_pulled_out(void **state)
{
	struct stage *stage = *state;
	char path[192];

	put_release(stage, "", "T");
	CHECK(look(stage) && get(stage, root, 0, 9, "sandstone") == 0);
	in_folder(stage, path, "timestamp.json");
	CHECK(unlink(path) == 0);
	CHECK(!look(stage) && get(stage, root, 0, 9, "") == -ENOENT);
	put_text(stage, "timestamp.json", "T");
	CHECK(look(stage) && get(stage, root, 0, 9, "sandstone") == 0);
}

static void lives_with_damage(void **state)
{
	struct stage *stage = *state;
	char name[96] = "locator/", hex[HASH_HEX_BYTES];

	put_release(stage, "", "T");
	hash_to_hex(root, name + 8);
	put_text(stage, name, "no locator");
	CHECK(look(stage) && get(stage, root, 0, 9, "") == -ENOENT);
	put_release(stage, "", "U");
	hash_to_hex(pack, hex);
	snprintf(name, sizeof(name), "packs/%s", hex);
	put_text(stage, name, "sand"); /* cut short */
	CHECK(look(stage) && get(stage, root, 0, 9, "") == -ENOENT);
	CHECK(get(stage, root, 0, 4, "sand") == 0);
}

static void opens_no_links_and_nothing_that_blocks(void **state)
{
	struct stage *stage = *state;
	char path[192];

	put_release(stage, "", "T");
	in_folder(stage, path, "release.json");
	CHECK(unlink(path) == 0 && symlink("/etc/hostname", path) == 0);
	CHECK(look(stage));
	CHECK(!strstr(stage->said, "release"));
	in_folder(stage, path, "timestamp.json");
	CHECK(unlink(path) == 0 && mkfifo(path, 0644) == 0);
	CHECK(!look(stage) && stage->said[0] == '\0');
}

static void refuses_endless_files(void **state)
{
	struct stage *stage = *state;
	char path[192];

	put_release(stage, "", "T");
	in_folder(stage, path, "release.json");
	CHECK(truncate(path, MESSAGE_META_BYTES_MOST + 1) == 0);
	CHECK(look(stage) && !strstr(stage->said, "release"));
	in_folder(stage, path, "timestamp.json");
	CHECK(truncate(path, 1ll << 40) == 0);
	CHECK(!look(stage));
}

#define STAGED(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		STAGED(tells_of_a_stick_once),
		STAGED(tells_the_roots_after_the_one_that_the_kiosk_has),
		STAGED(finds_a_folder_named_release),
		STAGED(gives_objects_by_the_locator),
		STAGED(is_gone_when_it_is_pulled_out),
		STAGED(lives_with_damage),
		STAGED(opens_no_links_and_nothing_that_blocks),
		STAGED(refuses_endless_files),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
