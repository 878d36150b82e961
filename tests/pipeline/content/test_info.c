/* The information database from a content folder to what the kiosk reads, and what the builder
 * says about a folder that is at fault. */
#include "pipeline/content/info_build.h"

#include <errno.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/article.h"
#include "tests/pipeline/content/info_folder.h"

static void gives_back_what_the_folder_says(void **state)
{
	struct info_built built;
	struct info *info;
	struct bytes article;
	const char *language;
	struct info_text text;

	(void)state;
	CHECK(build(&built) == 0);
	CHECK(built.part_count == 3 && built.page_count == 3 && built.file_count == 2);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	CHECK(info_part_count(info) == 3 && info_language_count(info) == 2);
	CHECK(strcmp(info_language(info, 1), "km") == 0);
	CHECK(info_find(info, "gate") == 1 && info_find(info, "nothing") == -ENOENT);

	CHECK(info_part(info, 0)->region.kind == REGION_BOX);
	CHECK(info_part(info, 0)->region.half_m[2] == 5);
	CHECK(info_part(info, 0)->region.turn_deg == 45);
	CHECK(info_part(info, 0)->anchor_m[2] == 25);
	CHECK(info_part(info, 2)->region.kind == REGION_POINT);
	CHECK(info_part(info, 2)->region.centre_m[1] == 6);
	CHECK(!info_part(info, 2)->has_page && info_part(info, 1)->has_page);

	text = info_text(info, 0, "km");
	CHECK(strcmp(text.title, "ប្រាង្គកណ្ដាល") == 0 && strcmp(text.caption, "") == 0);
	CHECK(strcmp(text.thumbnail, "pictures/a.png") == 0);
	CHECK(strcmp(info_text(info, 0, "de").title, "Central tower") == 0);

	CHECK(info_page(info, 0, "km", &article, &language) == 0);
	CHECK(strcmp(language, "km") == 0 && memmem(article.data, article.size, "ភ្នំ", 12));
	CHECK(info_page(info, 1, "km", &article, &language) == 0); /* falls back */
	CHECK(strcmp(language, "en") == 0);
	CHECK(info_page(info, 2, "en", &article, NULL) == -ENOENT);

	CHECK(info_picture_count(info) == 2);
	CHECK(info_find_picture(info, "pictures/b.png")->width_px == 20);
	CHECK(!info_find_picture(info, "pictures/c.png"));
	for (uint32_t i = 0; i < built.file_count; i++) {
		const struct info_picture *found = info_find_picture(info, built.files[i].name);

		CHECK(found && hash_equal(found->hash, built.files[i].hash));
	}
	info_close(info);
	info_built_finish(&built);
}

/* A prism given clockwise is turned round: render asks for counter-clockwise. */
static void turns_a_clockwise_prism_round(void **state)
{
	struct info_built built;
	const struct region *region;
	double area = 0;
	struct info *info;

	(void)state;
	CHECK(build(&built) == 0);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	region = &info_part(info, 1)->region;
	CHECK(region->corner_count == 4);
	for (int i = 0; i < 4; i++)
		area += region->corners_m[i][0] * region->corners_m[(i + 1) % 4][1] -
			region->corners_m[(i + 1) % 4][0] * region->corners_m[i][1];
	CHECK(area == 8); /* twice 2 x 2, positive */
	CHECK(region->centre_m[0] == 1 && region->centre_m[2] == 2);
	info_close(info);
	info_built_finish(&built);
}

static void writes_the_same_bytes_for_the_same_folder(void **state)
{
	struct info_built first, second;

	(void)state;
	CHECK(build(&first) == 0);
	free(malloc(100000)); /* other addresses, other old contents of memory */
	CHECK(build(&second) == 0);
	CHECK(first.database.size == second.database.size);
	CHECK(memcmp(first.database.data, second.database.data, first.database.size) == 0);
	info_built_finish(&first);
	write_text("pages/gate.en.html", "<p>One leaves here.</p>");
	CHECK(build(&first) == 0);
	CHECK(first.database.size != second.database.size ||
	      memcmp(first.database.data, second.database.data, first.database.size) != 0);
	info_built_finish(&first);
	info_built_finish(&second);
}

static void a_folder_without_parts_gives_an_empty_database(void **state)
{
	struct info_built built;
	struct info *info;
	char path[100];

	(void)state;
	snprintf(path, sizeof(path), "%s/parts.json", folder);
	unlink(path);
	CHECK(build(&built) == 0);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	CHECK(info_part_count(info) == 0 && info_language_count(info) == 2);
	info_close(info);
	info_built_finish(&built);
}

/* What is wrong with parts.json is told with the line on which the part begins. */
static void names_the_line_of_a_bad_part(void **state)
{
	static const struct {
		const char *text, *words;
		unsigned line;
	} cases[] = {
		{ "{\"parts\": [\n{\"id\": \"a\"\n\"title\"}]}", "not valid JSON", 3 },
		{ "[1, 2]", "at the top level", 1 },
		{ "{\"parts\": [\n{\"id\": \"a\", \"anchor\": [0,0,0], \"page\": false,\n"
		  "\"title\": {\"en\": \"caf\xe9\"}}]}",
		  "not UTF-8", 3 },
		{ "{\"parts\": [\n\n {\"id\": \"A b\", \"anchor\": [0,0,0], \"page\": false,"
		  "\"title\": {\"en\": \"x\"}}]}",
		  "use 1 to", 3 },
		{ "{\"parts\": [\n{\"id\": \"a\", \"anchor\": [0,0,0], \"page\": false}]}",
		  "has no title in \"en\"", 2 },
		{ "{\"parts\": [\n{\"id\": \"a\", \"region\": {\"kind\": \"cone\"}, \"page\": false,"
		  "\"title\": {\"en\": \"x\"}}]}",
		  "\"cone\"", 2 },
		{ "{\"parts\": [\n{\"id\": \"a\", \"region\": {\"kind\": \"sphere\", \"centre\":"
		  "[0,0,0], \"radius\": -1}, \"page\": false, \"title\": {\"en\": \"x\"}}]}",
		  "radius", 2 },
		{ "{\"parts\": [\n{\"id\": \"a\", \"region\": {\"kind\": \"faces\"}, \"page\": false,"
		  "\"title\": {\"en\": \"x\"}}]}",
		  "needs a \"file\"", 2 },
		{ "{\"parts\": [\n{\"id\": \"a\", \"region\": {\"kind\": \"prism\", \"floor\": 0,"
		  "\"roof\": 1, \"corners\": [[0,0],[1,1]]}, \"page\": false,"
		  "\"title\": {\"en\": \"x\"}}]}",
		  "3 to 16", 2 },
		{ "{\"parts\": [\n{\"id\": \"a\", \"anchor\": [0,0,1e99], \"page\": false,"
		  "\"title\": {\"en\": \"x\"}}]}",
		  "three numbers", 2 },
		/* finite, but the middle of the heights, a float, would not be */
		{ "{\"parts\": [\n{\"id\": \"a\", \"region\": {\"kind\": \"prism\", \"floor\": 2e38,"
		  "\"roof\": 3e38, \"corners\": [[0,0],[1,1],[0,1]]}, \"page\": false,"
		  "\"title\": {\"en\": \"x\"}}]}",
		  "heights up to 1e+09", 2 },
		{ "{\"parts\": [\n{\"id\": \"a\", \"region\": {\"kind\": \"sphere\", \"centre\":"
		  "[0,0,0], \"radius\": 1.1e9}, \"page\": false, \"title\": {\"en\": \"x\"}}]}",
		  "radius", 2 },
		{ "{\"parts\": [\n{\"id\": \"a\", \"anchor\": [0,0,0], \"page\": false,"
		  "\"title\": {\"en\": \"x\"}},\n{\"id\": \"a\", \"anchor\": [0,0,0],"
		  "\"page\": false, \"title\": {\"en\": \"{[\"}}]}",
		  "twice", 3 },
		{ "{\"parts\": [\n{\"id\": \"a\", \"anchor\": [0,0,0], \"page\": false,"
		  "\"thumbnail\": \"../secret.png\", \"title\": {\"en\": \"x\"}}]}",
		  "pictures/NAME", 2 },
	};
	struct info_built built;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		write_text("parts.json", cases[i].text);
		CHECK(build(&built) == -EINVAL);
		if (!was_told("parts.json", cases[i].line, cases[i].words))
			fail_msg("case %zu: \"%s\" at line %u, not \"%s\"", i, told.first.text,
				 told.first.line, cases[i].words);
	}
}

static bool was_warned(unsigned line, const char *words)
{
	for (uint32_t i = 0; i < told.count; i++) {
		const struct diagnostic *found = diagnostics_get(&told, i);

		if (found->error == 0 && found->line == line && strstr(found->text, words))
			return true;
	}
	return false;
}

/* A card has three lines, and what is no text is not on it. */
static void a_caption_is_one_paragraph(void **state)
{
	static const char parts[] =
		"{\"parts\": [\n{\"id\": \"a\", \"anchor\": [0,0,0], \"page\": false, \"title\": "
		"{\"en\": \"x\"}, \"caption\": {\"en\": \"One\\ntwo\", \"km\": [\"One\", \"two\"]}},\n"
		"{\"id\": \"b\", \"anchor\": [0,0,0], \"page\": false, \"title\": {\"en\": \"x\"}, "
		"\"caption\": \"One\"}]}";
	struct info_built built;
	struct info *info;

	(void)state;
	write_text("parts.json", parts);
	CHECK(build(&built) == 0);
	CHECK(was_warned(2, "its caption is left out"));
	CHECK(was_warned(3, "write \"caption\": {\"en\""));
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	CHECK(strcmp(info_text(info, 0, "en").caption, "One two") == 0);
	info_close(info);
	info_built_finish(&built);
}

#define TEN "k0 k1=1 k2='2' k3=\"3\" k4 k5 k6 k7=<b k8 = x k9 "

static void names_the_line_of_a_bad_page(void **state)
{
	static const struct {
		const char *html, *words;
		unsigned line;
	} cases[] = {
		{ "<p>x\n<a href=\"https://example.org\">out</a></p>",
		  "shows nothing outside the release", 2 },
		{ "<p>x</p>\n\n<p><a href=\"part:none\">y</a></p>", "no part has that id", 3 },
		{ "<p>x</p>\n<a href=\"page:none\">y</a>", "no part has that id", 2 },
		{ "<p>x</p>\n<a href=\"page:naga\">y</a>", "has no page; write \"part:naga\"", 2 },
		{ "<p>x</p>\n<a href=\"page\">y</a>", "shows nothing outside the release", 2 },
		{ "<p>x</p>\n<img src=\"pictures/none.png\">", "is not there", 2 },
		{ "<p>x</p>\n<img src=\"http://example.org/a.png\">", "pictures/NAME", 2 },
		{ "<p>x</p>\n<script>alert(1)</script>", "<script>", 2 },
		{ "<p>x</p>\n<p onclick=\"go()\">y</p>", "onclick", 2 },
		{ "<p>x</p>\n\n\n<iframe></iframe>", "<iframe>", 4 },
		{ "<p>x</p>\n<b\nclass=y " TEN TEN TEN TEN TEN TEN "a b c d>z</b>",
		  "a tag with 65 attributes", 2 },
		{ "<table>\n<tr><td>1<td>2<td>3<td>4<td>5<td>6<td>7<td>8</tr>\n"
		  "<tr><th>1<td>2<td>3<td>4<td>5<td>6<td>7<td>8<td>9</tr></table>",
		  "a row of 9 cells", 3 },
		{ "  \n <p> </p>", "no text", 1 },
		{ "<title>x</title>", "no text", 1 },
		{ "<p>\xff\xfe</p>", "UTF-8", 0 },
	};
	struct info_built built;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		write_text("pages/gate.en.html", cases[i].html);
		CHECK(build(&built) == -EINVAL);
		if (!was_told("pages/gate.en.html", cases[i].line, cases[i].words))
			fail_msg("case %zu: \"%s\" at line %u, not \"%s\"", i, told.first.text,
				 told.first.line, cases[i].words);
	}
}

/* More blocks than an article may have; the kiosk would refuse it. */
static void refuses_a_page_of_too_many_blocks(void **state)
{
	struct info_built built;
	char *page = malloc(ARTICLE_BLOCKS_MAX * 4 + 8);
	size_t size = 0;

	(void)state;
	while (size < ARTICLE_BLOCKS_MAX * 4)
		size += (size_t)snprintf(page + size, 5, "<hr>");
	snprintf(page + size - 4, 8, "end");
	write_text("pages/gate.en.html", page);
	CHECK(build(&built) == 0);
	info_built_finish(&built);
	snprintf(page + size - 4, 8, "<hr>end");
	write_text("pages/gate.en.html", page);
	CHECK(build(&built) == -EINVAL);
	CHECK(was_told("pages/gate.en.html", 0, "split the page"));
	free(page);
}

/* A page is published: the file of a link, a key perhaps, would be shown to everybody. */
static void refuses_a_page_that_is_a_link_or_a_fifo(void **state)
{
	struct info_built built;
	char path[100], target[100];

	(void)state;
	snprintf(path, sizeof(path), "%s/pages/gate.en.html", folder);
	snprintf(target, sizeof(target), "%s/elsewhere.html", folder);
	write_text("elsewhere.html", "<p>One enters here.</p>");
	for (int i = 0; i < 2; i++) {
		unlink(path);
		CHECK((i ? mkfifo(path, 0600) : symlink(target, path)) == 0);
		CHECK(build(&built) == -EINVAL);
		CHECK(was_told("pages/gate.en.html", 0, "put the page itself there"));
	}
	unlink(path);
}

static void wants_the_page_in_the_first_language(void **state)
{
	struct info_built built;
	char path[100];

	(void)state;
	snprintf(path, sizeof(path), "%s/pages/gate.en.html", folder);
	unlink(path);
	CHECK(build(&built) == -EINVAL);
	CHECK(was_told("pages/gate.en.html", 0, "is missing"));
	CHECK(!was_told("pages/gate.km.html", 0, "")); /* that one only a warning */
}

static void refuses_a_picture_too_large_for_a_terminal(void **state)
{
	struct info_built built;

	(void)state;
	write_picture("pictures/b.png", PICTURE_PAGE_SIDE_MOST_PX, 1, 200);
	CHECK(build(&built) == 0);
	info_built_finish(&built);
	write_picture("pictures/b.png", 1, PICTURE_PAGE_SIDE_MOST_PX + 1, 200);
	CHECK(build(&built) == -EINVAL);
	CHECK(was_told("pictures/b.png", 0, "4096 pixels a side"));
}

static void refuses_a_damaged_picture(void **state)
{
	struct info_built built;

	(void)state;
	write_text("pictures/b.png", "\x89PNG\r\n\x1a\nrubbish");
	CHECK(build(&built) == -EINVAL);
	CHECK(was_told("pictures/b.png", 0, "not a complete JPEG or PNG"));
}

/* Every foreign key holds, and the schema refuses what breaks one. */
static void keeps_foreign_keys(void **state)
{
	struct info_built built;
	sqlite3_stmt *statement;
	unsigned char *copy;
	sqlite3 *db;

	(void)state;
	CHECK(build(&built) == 0);
	CHECK(sqlite3_open(":memory:", &db) == SQLITE_OK);
	copy = sqlite3_malloc64(built.database.size);
	memcpy(copy, built.database.data, built.database.size);
	CHECK(sqlite3_deserialize(db, "main", copy, (sqlite3_int64)built.database.size,
				  (sqlite3_int64)built.database.size,
				  SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_RESIZEABLE) ==
	      SQLITE_OK);
	CHECK(sqlite3_prepare_v2(db, "PRAGMA foreign_key_check", -1, &statement, NULL) ==
	      SQLITE_OK);
	CHECK(sqlite3_step(statement) == SQLITE_DONE);
	sqlite3_finalize(statement);
	CHECK(sqlite3_exec(db, "PRAGMA foreign_keys = ON", NULL, NULL, NULL) == SQLITE_OK);
	CHECK(sqlite3_exec(db, "INSERT INTO assigned_information VALUES(0, 99, 1)", NULL, NULL,
			   NULL) == SQLITE_CONSTRAINT);
	sqlite3_close(db);
	info_built_finish(&built);
}

static void refuses_what_is_no_information_database(void **state)
{
	struct info_built built;
	struct info *info;
	uint8_t *image;
	size_t size;

	(void)state;
	CHECK(info_open(&info, (struct bytes){ (const uint8_t *)"temple", 6 }) == -EBADMSG);
	CHECK(!info);
	CHECK(info_open(&info, (struct bytes){ (const uint8_t *)"", 0 }) == -EBADMSG);
	CHECK(build(&built) == 0);
	size = built.database.size;
	for (size_t n = 1; n < size; n += 509) {
		image = malloc(n); /* exact, for the sanitizer */
		memcpy(image, built.database.data, n);
		CHECK(info_open(&info, (struct bytes){ image, n }) == -EBADMSG);
		free(image);
	}
	built.database.data[63] = 9; /* user_version, big endian at 60 */
	CHECK(info_open(&info, buffer_bytes(&built.database)) == -EBADMSG);
	info_built_finish(&built);
	info_built_finish(NULL);
	info_close(NULL);
}

/* Flipped bytes may hit a text and go unnoticed here (the hash would tell), but nothing breaks. */
static void survives_flipped_bytes(void **state)
{
	struct info_built built;
	uint32_t random = 1;

	(void)state;
	CHECK(build(&built) == 0);
	for (int i = 0; i < 300; i++) {
		struct buffer *image = &built.database;
		struct info *info;
		size_t at = (random = random * 1664525u + 1013904223u) % image->size;
		uint8_t before = image->data[at];
		int rc;

		image->data[at] ^= (uint8_t)(1 + (random >> 24) % 255);
		rc = info_open(&info, buffer_bytes(image));
		CHECK((rc == 0) == (info != NULL));
		for (uint32_t p = 0; info && p < info_part_count(info); p++) {
			struct bytes article;
			int page = info_page(info, p, "en", &article, NULL);

			CHECK(page <= 0 && info_text(info, p, "km").title);
		}
		info_close(info);
		image->data[at] = before;
	}
	info_built_finish(&built);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(gives_back_what_the_folder_says, set_up, tear_down),
		cmocka_unit_test_setup_teardown(turns_a_clockwise_prism_round, set_up, tear_down),
		cmocka_unit_test_setup_teardown(writes_the_same_bytes_for_the_same_folder, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_folder_without_parts_gives_an_empty_database,
						set_up, tear_down),
		cmocka_unit_test_setup_teardown(names_the_line_of_a_bad_part, set_up, tear_down),
		cmocka_unit_test_setup_teardown(a_caption_is_one_paragraph, set_up, tear_down),
		cmocka_unit_test_setup_teardown(names_the_line_of_a_bad_page, set_up, tear_down),
		cmocka_unit_test_setup_teardown(refuses_a_page_of_too_many_blocks, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(refuses_a_page_that_is_a_link_or_a_fifo, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(wants_the_page_in_the_first_language, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(refuses_a_picture_too_large_for_a_terminal, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(refuses_a_damaged_picture, set_up, tear_down),
		cmocka_unit_test_setup_teardown(keeps_foreign_keys, set_up, tear_down),
		cmocka_unit_test_setup_teardown(refuses_what_is_no_information_database, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(survives_flipped_bytes, set_up, tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
