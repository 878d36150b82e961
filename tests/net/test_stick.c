#include "net/stick.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/clock.h"
#include "format/locator.h"
#include "tests/check.h"

static int64_t now_ms;

int64_t clock_now_ms(void)
{
	return now_ms;
}

/* A device that hangs: reads of files wait until it is let go. */
static struct {
	pthread_mutex_t lock;
	pthread_cond_t changed;
	bool hangs;
	int fails_at; /* this read from now fails; 0: none */
} device = { PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, false, 0 };

ssize_t pread(int fd, void *to, size_t size, off_t at)
{
	pthread_mutex_lock(&device.lock);
	while (device.hangs)
		pthread_cond_wait(&device.changed, &device.lock);
	const bool fails = device.fails_at > 0 && --device.fails_at == 0;
	pthread_mutex_unlock(&device.lock);
	if (fails) {
		errno = EIO;
		return -1;
	}
	return syscall(SYS_pread64, fd, to, size, at);
}

static void set_device(bool hangs)
{
	pthread_mutex_lock(&device.lock);
	device.hangs = hangs;
	pthread_cond_broadcast(&device.changed);
	pthread_mutex_unlock(&device.lock);
}

struct stage {
	char folder[64];
	struct stick *stick;
	char said[256];
	/* the last answer */
	int answers, rc;
	char object[64];
	bool nobody_wants;
	int files; /* answers to stick_ask_file */
	struct message_file file;
	char text[64]; /* of the file */
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

static void on_object(void *data, struct hash hash, int rc, struct bytes bytes)
{
	struct stage *stage = data;

	(void)hash;
	stage->answers++;
	stage->rc = rc;
	snprintf(stage->object, sizeof(stage->object), "%.*s", (int)bytes.size,
		 (const char *)bytes.data);
}

static void on_file(void *data, const struct message_file *file)
{
	struct stage *stage = data;

	stage->files++;
	stage->file = *file;
	snprintf(stage->text, sizeof(stage->text), "%.*s", (int)file->bytes.size,
		 (const char *)file->bytes.data);
}

static bool is_wanted(void *data, struct hash hash)
{
	const struct stage *stage = data;

	(void)hash;
	return !stage->nobody_wants;
}

static int set_up(void **state)
{
	struct stage *stage = calloc(1, sizeof(*stage));
	const struct stick_options options = { .folder = stage->folder,
					       .meta = on_meta,
					       .object = on_object,
					       .file = on_file,
					       .is_wanted = is_wanted,
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
	struct locator locator = { 1, 1, &pack, &block, HASH_BYTES };
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

/* Begins what there is to do, and takes what comes of it. true: a stick came. */
static bool work(struct stage *stage)
{
	struct pollfd ready = { .fd = stick_fd(stage->stick), .events = POLLIN };
	bool came = stick_work(stage->stick, true);

	CHECK(poll(&ready, 1, 60000) == 1);
	stick_clear_event(stage->stick);
	return stick_work(stage->stick, true) || came;
}

static bool look(struct stage *stage)
{
	now_ms += 5000;
	stage->said[0] = '\0';
	return work(stage);
}

static struct message_want want_of(uint32_t offset, uint32_t size)
{
	struct message_want want = { .page = page, .offset = offset, .size = size };

	if (offset + size < sizeof(stones))
		want.hash = hash_of((struct bytes){ (const uint8_t *)stones + offset, size });
	return want;
}

/* What the stick has of the object at offset; its size, or the error. */
static int get(struct stage *stage, struct hash of, uint32_t offset, uint32_t size,
	       const char *text)
{
	const struct message_want want = want_of(offset, size);

	if (!stick_request(stage->stick, &of, 1, &want))
		return -ENOENT;
	stage->answers = 0;
	CHECK(!work(stage) && stage->answers == 1);
	if (stage->rc == 0)
		CHECK(strcmp(stage->object, text) == 0);
	return stage->rc;
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
	CHECK(look(stage) && strcmp(stage->said, "timestamp0:T release0:R ") == 0);
	stick_trust(stage->stick, 72);
	CHECK(!look(stage));
}

static void make_folder(const struct stage *stage, const char *name)
{
	char path[192];

	in_folder(stage, path, name);
	CHECK(mkdir(path, 0755) == 0);
}

/* The kiosk tells its root while the stick is looked at for the first time. */
static void tells_nothing_that_was_read_for_another_root(void **state)
{
	struct stage *stage = *state;
	struct pollfd ready = { .fd = stick_fd(stage->stick), .events = POLLIN };

	put_release(stage, "", "T");
	make_folder(stage, "tuf");
	put_text(stage, "tuf/timestamp.json", "of TUF");
	now_ms += 5000;
	CHECK(!stick_work(stage->stick, true));
	CHECK(poll(&ready, 1, 60000) == 1); /* it was looked at, and nobody has asked yet */
	stick_trust(stage->stick, MESSAGE_TRUST_TUF);
	stick_clear_event(stage->stick);
	CHECK(stick_work(stage->stick, true) && stage->said[0] == '\0');
	CHECK(look(stage) && strcmp(stage->said, "timestamp0:of TUF ") == 0);
}

/* Returns the answer; stage->text is what is in the file. */
static enum file_answer ask_file(struct stage *stage, const char *name)
{
	struct message_file file = { .source = META_FROM_STICK, .bytes_max = 8 };

	snprintf(file.name, sizeof(file.name), "%s", name);
	stage->files = 0;
	stick_ask_file(stage->stick, &file);
	CHECK(stick_due_ms(stage->stick, true) == 0);
	CHECK(!work(stage) && stage->files == 1);
	CHECK(strcmp(stage->file.name, name) == 0 && stage->file.source == META_FROM_STICK);
	return stage->file.answer;
}

static void brings_files_of_tuf_by_name(void **state)
{
	struct stage *stage = *state;

	stick_trust(stage->stick, MESSAGE_TRUST_TUF);
	CHECK(!look(stage));
	CHECK(ask_file(stage, "1.root.json") == FILE_NOT_THERE); /* no stick */
	put_release(stage, "release/", "T");
	CHECK(!look(stage)); /* it has the earlier form alone */
	make_folder(stage, "release/tuf");
	make_folder(stage, "release/tuf/targets");
	put_text(stage, "release/tuf/timestamp.json", "U");
	put_text(stage, "release/tuf/1.root.json", "A");
	put_text(stage, "release/tuf/large.json", "123456789");
	put_text(stage, "release/tuf/targets/5a.release.json", "R");
	CHECK(look(stage) && strcmp(stage->said, "timestamp0:U ") == 0);
	CHECK(ask_file(stage, "1.root.json") == FILE_IS_HERE && strcmp(stage->text, "A") == 0);
	CHECK(ask_file(stage, "targets/5a.release.json") == FILE_IS_HERE &&
	      strcmp(stage->text, "R") == 0);
	CHECK(ask_file(stage, "2.root.json") == FILE_NOT_THERE);
	CHECK(ask_file(stage, "large.json") == FILE_TOO_LARGE && stage->text[0] == '\0');
	CHECK(ask_file(stage, "targets") == FILE_NOT_THERE); /* a folder */
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
	put_text(stage, name, "sandstOnelaterite");
	CHECK(get(stage, root, 0, 4, "sand") == 0); /* the pack is open */
	stick_forget(stage->stick);
	CHECK(look(stage) && get(stage, root, 0, 9, "") == -EBADMSG);
}

static void fail_read(int n)
{
	pthread_mutex_lock(&device.lock);
	device.fails_at = n;
	pthread_mutex_unlock(&device.lock);
}

/* A read that failed once says nothing of the stick. */
static void reads_again_what_could_not_be_read(void **state)
{
	struct stage *stage = *state;

	put_release(stage, "", "T");
	fail_read(3); /* timestamp, root, release */
	CHECK(look(stage) && strcmp(stage->said, "root1:A timestamp0:T ") == 0);
	CHECK(look(stage) && strcmp(stage->said, "root1:A timestamp0:T release0:R ") == 0);
	CHECK(!look(stage));
	fail_read(1); /* the locator */
	CHECK(get(stage, root, 0, 9, "") == -EIO);
	fail_read(2); /* the pack */
	CHECK(get(stage, root, 0, 9, "") == -EIO);
	CHECK(get(stage, root, 0, 9, "sandstone") == 0);
	make_folder(stage, "tuf");
	put_text(stage, "tuf/2.root.json", "B");
	fail_read(1);
	CHECK(ask_file(stage, "2.root.json") == FILE_NOT_THERE);
	/* who follows the timestamp asks again when it comes again */
	CHECK(look(stage) && strstr(stage->said, "timestamp0:T"));
	CHECK(ask_file(stage, "2.root.json") == FILE_IS_HERE);
	for (int n = 0; n < 100; n++) { /* a device that never reads it does not go on for ever */
		fail_read(3);
		(void)look(stage);
	}
	fail_read(0);
	CHECK(!look(stage));
}

/* The loop goes on without it, whatever it was asked for; when it comes back it is looked at again.
 */
static void leaves_a_device_that_hangs_alone(void **state)
{
	struct stage *stage = *state;
	const struct message_want want = want_of(0, 9), other = want_of(9, 8);
	struct pollfd ready = { .fd = stick_fd(stage->stick), .events = POLLIN };

	put_release(stage, "", "T");
	CHECK(look(stage));
	CHECK(get(stage, root, 0, 9, "sandstone") == 0);
	set_device(true);
	stage->answers = 0;
	CHECK(stick_request(stage->stick, &root, 1, &want));
	CHECK(!stick_work(stage->stick, true)); /* the thread hangs, we do not */
	CHECK(stick_request(stage->stick, &root, 1, &other));
	now_ms += 9000;
	CHECK(!stick_work(stage->stick, true) && stage->answers == 0);
	CHECK(stick_due_ms(stage->stick, true) == now_ms + 1000);
	now_ms += 1000;
	CHECK(!stick_work(stage->stick, true));
	CHECK(stage->answers == 2 && stage->rc == -ENOENT); /* the server may have them */
	CHECK(!stick_request(stage->stick, &root, 1, &want));
	CHECK(stick_due_ms(stage->stick, true) == INT64_MAX);
	set_device(false);
	CHECK(poll(&ready, 1, 60000) == 1);
	stick_clear_event(stage->stick);
	CHECK(!stick_work(stage->stick, true) && stage->answers == 2);
	CHECK(stick_due_ms(stage->stick, true) == now_ms + 60000);
	now_ms += 60000;
	CHECK(work(stage));
	CHECK(get(stage, root, 0, 9, "sandstone") == 0);
}

static void ends_while_a_device_hangs(void **state)
{
	struct stage *stage = *state;
	const struct message_want want = want_of(0, 9);

	put_release(stage, "", "T");
	CHECK(look(stage));
	CHECK(get(stage, root, 0, 9, "sandstone") == 0);
	CHECK(stick_request(stage->stick, &root, 1, &want));
	set_device(true);
	CHECK(!stick_work(stage->stick, true));
	stick_destroy(stage->stick); /* leaves the thread behind */
	stage->stick = NULL;
	set_device(false);
}

static void reads_the_best_first_and_nothing_that_is_not_wanted(void **state)
{
	struct stage *stage = *state;
	struct message_want want = want_of(0, 9);

	put_release(stage, "", "T");
	CHECK(look(stage));
	stage->answers = 0;
	for (uint32_t i = 0; i < 40; i++) {
		want.priority = i;
		CHECK(stick_request(stage->stick, &root, 1, &want));
	}
	want = want_of(9, 8);
	CHECK(stick_request(stage->stick, &root, 1, &want));
	CHECK(!work(stage) && stage->answers == 32 && strcmp(stage->object, "sandstone") == 0);
	CHECK(!work(stage) && stage->answers == 41 && strcmp(stage->object, "laterite") == 0);
	CHECK(stick_request(stage->stick, &root, 1, &want));
	stage->nobody_wants = true;
	CHECK(!stick_work(stage->stick, true) && stage->answers == 41);
	CHECK(stick_due_ms(stage->stick, true) > now_ms); /* nothing was begun */
}

static void follows_no_link_on_the_way_to_a_file(void **state)
{
	static const char *const folders[] = { "root", "packs", "locator" };
	struct stage *stage = *state;
	char path[192], moved[224];

	put_release(stage, "", "T");
	for (size_t i = 0; i < ARRAY_COUNT(folders); i++) {
		in_folder(stage, path, folders[i]);
		snprintf(moved, sizeof(moved), "%s.moved", path);
		CHECK(rename(path, moved) == 0 && symlink(moved, path) == 0);
		stick_forget(stage->stick);
		CHECK(look(stage));
		CHECK(!strstr(stage->said, "root")); /* the first of them */
		CHECK((get(stage, root, 0, 9, "sandstone") == 0) == (i == 0));
	}
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
	CHECK(truncate(path, MESSAGE_META_BYTES_MAX + 1) == 0);
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
		STAGED(brings_files_of_tuf_by_name),
		STAGED(tells_nothing_that_was_read_for_another_root),
		STAGED(tells_the_roots_after_the_one_that_the_kiosk_has),
		STAGED(finds_a_folder_named_release),
		STAGED(gives_objects_by_the_locator),
		STAGED(is_gone_when_it_is_pulled_out),
		STAGED(lives_with_damage),
		STAGED(reads_again_what_could_not_be_read),
		STAGED(opens_no_links_and_nothing_that_blocks),
		STAGED(refuses_endless_files),
		STAGED(follows_no_link_on_the_way_to_a_file),
		STAGED(reads_the_best_first_and_nothing_that_is_not_wanted),
		STAGED(leaves_a_device_that_hangs_alone),
		STAGED(ends_while_a_device_hangs),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
