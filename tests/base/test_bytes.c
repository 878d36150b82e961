#include "base/bytes.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "tests/check.h"

static void gives_back_what_was_put(void **state)
{
	struct buffer buffer;
	struct reader reader;
	char text[8];

	(void)state;
	buffer_init(&buffer, 1024);
	buffer_put_u8(&buffer, 7);
	buffer_put_u16(&buffer, 0x1234);
	buffer_put_u32(&buffer, 0xdeadbeef);
	buffer_put_u64(&buffer, UINT64_MAX - 1);
	buffer_put_f32(&buffer, -1.5f);
	buffer_put_f64(&buffer, 3.25);
	buffer_put_string(&buffer, "stone");
	CHECK(buffer.error == 0);
	CHECK(buffer.data[1] == 0x34); /* little endian */
	reader_init(&reader, buffer_bytes(&buffer));
	CHECK(reader_u8(&reader) == 7);
	CHECK(reader_u16(&reader) == 0x1234);
	CHECK(reader_u32(&reader) == 0xdeadbeef);
	CHECK(reader_u64(&reader) == UINT64_MAX - 1);
	CHECK(reader_f32(&reader) == -1.5f);
	CHECK(reader_f64(&reader) == 3.25);
	reader_string(&reader, text, sizeof(text));
	CHECK(strcmp(text, "stone") == 0);
	CHECK(!reader.failed && reader_left(&reader) == 0);
	buffer_finish(&buffer);
}

static void appends_text_without_its_zero(void **state)
{
	struct buffer buffer;

	(void)state;
	buffer_init(&buffer, 300);
	buffer_put_text(&buffer, "stone");
	buffer_print(&buffer, " %d%s", 12, "");
	buffer_print(&buffer, "%290s", ""); /* beyond the first memory */
	CHECK(buffer.error == 0 && buffer.size == 298);
	CHECK(memcmp(buffer.data, "stone 12  ", 10) == 0 && buffer.data[297] == ' ');
	buffer_print(&buffer, "%d", 7); /* with its zero, exactly to the ceiling */
	CHECK(buffer.error == 0 && buffer.size == 299);
	buffer_print(&buffer, "%d", 7);
	CHECK(buffer.error == -EFBIG && buffer.size == 299);
	buffer_finish(&buffer);
}

static void stays_failed_past_the_end(void **state)
{
	const uint8_t three[3] = { 1, 2, 3 };
	struct reader reader;

	(void)state;
	reader_init(&reader, (struct bytes){ three, sizeof(three) });
	CHECK(reader_u32(&reader) == 0);
	CHECK(reader.failed);
	CHECK(reader_u8(&reader) == 0); /* though one byte would fit */
}

static void refuses_to_pass_its_ceiling(void **state)
{
	struct buffer buffer;

	(void)state;
	buffer_init(&buffer, 10);
	buffer_put(&buffer, "12345678", 8);
	buffer_put_u32(&buffer, 1);
	CHECK(buffer.error == -EFBIG);
	buffer_put_u8(&buffer, 1); /* would fit; the failure stays */
	CHECK(buffer.size == 8);
	buffer_finish(&buffer);
	buffer_finish(NULL);
}

static void writes_a_file_whole_or_not_at_all(void **state)
{
	char path[] = "/tmp/gopura-bytes-XXXXXX";
	struct buffer back;
	int fd = mkstemp(path);

	(void)state;
	CHECK(fd >= 0);
	close(fd);
	buffer_init(&back, 100);
	CHECK(bytes_write_file((struct bytes){ (const uint8_t *)"temple", 6 }, path) == 0);
	CHECK(buffer_read_file(&back, path) == 0);
	CHECK(back.size == 6 && memcmp(back.data, "temple", 6) == 0);
	CHECK(bytes_write_file((struct bytes){ NULL, 0 }, "/nonexistent/x") == -ENOENT);
	unlink(path);
	CHECK(buffer_read_file(&back, path) == -ENOENT);
	buffer_finish(&back);
}

static void touch_beside(const char *path, const char *end)
{
	char name[128];
	FILE *file;

	snprintf(name, sizeof(name), "%s%s", path, end);
	file = fopen(name, "w");
	CHECK(file && fclose(file) == 0);
}

static bool is_beside(const char *path, const char *end)
{
	char name[128];

	snprintf(name, sizeof(name), "%s%s", path, end);
	return access(name, F_OK) == 0;
}

static void drops_what_a_cut_left_of_a_file_and_nothing_else(void **state)
{
	static const char *const others[] = { "",        ".a1B2c",   ".a1B2c3d",
					      ".a1B2c.", "2.a1B2c3", ".second.a1B2c3" };
	char folder[] = "/tmp/gopura-bytes-XXXXXX", path[64], command[64];

	(void)state;
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/state", folder);
	for (size_t i = 0; i < ARRAY_COUNT(others); i++)
		touch_beside(path, others[i]);
	touch_beside(path, ".a1B2c3");
	touch_beside(path, ".ZZZZZZ");
	bytes_drop_leftovers(path);
	CHECK(!is_beside(path, ".a1B2c3") && !is_beside(path, ".ZZZZZZ"));
	for (size_t i = 0; i < ARRAY_COUNT(others); i++)
		CHECK(is_beside(path, others[i]));
	bytes_drop_leftovers("/nonexistent/state");
	snprintf(command, sizeof(command), "rm -r %s", folder);
	CHECK(system(command) == 0);
}

/* The process that made a young one may still live. */
static void sweeps_a_folder_of_old_leftovers_alone(void **state)
{
	static const char *const others[] = { "", ".a1B2c", ".a1B2c3.json", ".a1B-c3" };
	char folder[] = "/tmp/gopura-bytes-XXXXXX", path[64], inner[96], command[64];

	(void)state;
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/pack", folder);
	for (size_t i = 0; i < ARRAY_COUNT(others); i++)
		touch_beside(path, others[i]);
	snprintf(inner, sizeof(inner), "%s.FOLDER", path);
	CHECK(mkdir(inner, 0700) == 0);
	touch_beside(path, ".a1B2c3");
	touch_beside(path, "2.ZZZZZZ");
	bytes_sweep_folder(folder, time(NULL) - 100);
	CHECK(is_beside(path, ".a1B2c3") && is_beside(path, "2.ZZZZZZ"));
	bytes_sweep_folder(folder, INT64_MAX);
	CHECK(!is_beside(path, ".a1B2c3") && !is_beside(path, "2.ZZZZZZ"));
	CHECK(is_beside(path, ".FOLDER"));
	for (size_t i = 0; i < ARRAY_COUNT(others); i++)
		CHECK(is_beside(path, others[i]));
	bytes_sweep_folder("/nonexistent", INT64_MAX);
	snprintf(command, sizeof(command), "rm -r %s", folder);
	CHECK(system(command) == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_back_what_was_put),
		cmocka_unit_test(appends_text_without_its_zero),
		cmocka_unit_test(stays_failed_past_the_end),
		cmocka_unit_test(refuses_to_pass_its_ceiling),
		cmocka_unit_test(writes_a_file_whole_or_not_at_all),
		cmocka_unit_test(drops_what_a_cut_left_of_a_file_and_nothing_else),
		cmocka_unit_test(sweeps_a_folder_of_old_leftovers_alone),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
