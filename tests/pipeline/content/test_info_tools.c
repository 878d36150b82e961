/* The tools that a content gives visitors, from the folder's options to what the kiosk reads. */
#include <sqlite3.h>

#include "storage/info_schema.h"
#include "storage/info_tools.h"
#include "tests/pipeline/content/info_folder.h"

static void build_with(struct info_built *out, unsigned tools)
{
	static const char *const languages[] = { "en", "km" };
	const struct info_build_options options = { .folder = folder,
						    .languages = languages,
						    .language_count = 2,
						    .tools = tools,
						    .scan_error_m = 0.0025,
						    .diagnostics = &told };

	CHECK(info_build(out, &options) == 0);
}

static unsigned tools_of(struct bytes image)
{
	struct info *info;
	unsigned tools;

	CHECK(info_open(&info, image) == 0);
	tools = info_tools(info);
	info_close(info);
	return tools;
}

static void gives_back_the_tools_of_the_content(void **state)
{
	static const unsigned all =
		INFO_TOOL_LIGHT | INFO_TOOL_SECTION | INFO_TOOL_MEASURE | INFO_TOOL_WALK;
	struct info_built built;

	(void)state;
	for (unsigned tools = 0; tools <= all; tools++) {
		build_with(&built, tools);
		CHECK(tools_of(buffer_bytes(&built.database)) == tools);
		/* A program that knows no tools reads on what it always read. */
		CHECK(built.database.data[63] == INFO_SCHEMA_VERSION);
		info_built_finish(&built);
	}
}

/* The image as another program wrote it: sql is done to it. -1: it is refused. */
static int tools_after(const struct info_built *built, const char *sql)
{
	sqlite3 *db;
	sqlite3_int64 size;
	unsigned char *image;
	struct info *info;
	int tools = -1;

	CHECK(sqlite3_open(":memory:", &db) == SQLITE_OK);
	image = sqlite3_malloc64(built->database.size);
	memcpy(image, built->database.data, built->database.size);
	size = (sqlite3_int64)built->database.size;
	CHECK(sqlite3_deserialize(db, "main", image, size, size,
				  SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_RESIZEABLE) ==
	      SQLITE_OK);
	CHECK(sqlite3_exec(db, sql, NULL, NULL, NULL) == SQLITE_OK);
	image = sqlite3_serialize(db, "main", &size, 0);
	if (info_open(&info, (struct bytes){ image, (size_t)size }) == 0) {
		tools = (int)info_tools(info);
		info_close(info);
	}
	sqlite3_free(image);
	sqlite3_close(db);
	return tools;
}

static void who_measures_is_told_the_scan_s_error(void **state)
{
	struct info_built built;
	struct info *info;

	(void)state;
	build_with(&built, INFO_TOOL_LIGHT | INFO_TOOL_MEASURE);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	CHECK(info_scan_error_m(info) == 0.0025f);
	info_close(info);
	CHECK(tools_after(&built, "UPDATE tool SET error_m = -1 WHERE name = 'measure'") == -1);
	CHECK(tools_after(&built, "UPDATE tool SET error_m = 9e999 WHERE name = 'measure'") == -1);
	CHECK(tools_after(&built, "UPDATE tool SET error_m = NULL WHERE name = 'light'") ==
	      (INFO_TOOL_LIGHT | INFO_TOOL_MEASURE));
	info_built_finish(&built);
	build_with(&built, INFO_TOOL_LIGHT); /* an image of before: it has no such column */
	CHECK(tools_after(&built, "ALTER TABLE tool RENAME TO old; CREATE TABLE tool(name TEXT "
				  "PRIMARY KEY) WITHOUT ROWID; INSERT INTO tool SELECT name FROM "
				  "old") == INFO_TOOL_LIGHT);
	info_built_finish(&built);
}

static void a_content_without_tools_has_no_table_of_them(void **state)
{
	struct info_built built;

	(void)state;
	build_with(&built, 0);
	CHECK(!memmem(built.database.data, built.database.size, "TABLE tool(", 11));
	info_built_finish(&built);
	build_with(&built, INFO_TOOL_LIGHT);
	CHECK(memmem(built.database.data, built.database.size, "TABLE tool(", 11));
	info_built_finish(&built);
}

static void what_is_no_tool_of_ours_is_left_out(void **state)
{
	struct info_built built;

	(void)state;
	build_with(&built, INFO_TOOL_LIGHT);
	CHECK(tools_after(&built, "INSERT INTO tool VALUES('lens', 1)") == INFO_TOOL_LIGHT);
	CHECK(tools_after(&built, "INSERT INTO tool VALUES('lightly', 1)") == INFO_TOOL_LIGHT);
	CHECK(tools_after(&built, "UPDATE tool SET name = x'ff'") == 0);
	CHECK(tools_after(&built, "DELETE FROM tool") == 0);
	CHECK(tools_after(&built, "DROP TABLE tool") == 0);
	CHECK(tools_after(&built, "DROP TABLE tool; CREATE VIEW tool AS SELECT 'light' name") == 0);
	CHECK(tools_after(&built, "DROP TABLE tool; CREATE TABLE tool(x)") == -1);
	info_built_finish(&built);
}

#define IN_A_FOLDER(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		IN_A_FOLDER(gives_back_the_tools_of_the_content),
		IN_A_FOLDER(who_measures_is_told_the_scan_s_error),
		IN_A_FOLDER(a_content_without_tools_has_no_table_of_them),
		IN_A_FOLDER(what_is_no_tool_of_ours_is_left_out),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
