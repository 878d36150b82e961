/* verify looks into pages: that each is an article, and shows only pictures that there are. */
#include "pipeline/content/info_build.h"
#include "pipeline/release/publish_samples.h"
#include "pipeline/release/verify.h"

#include <errno.h>
#include <sqlite3.h>

#include "format/article_builder.h"
#include "tests/pipeline/release/tiny_fixture.h"

static struct verify_report verified;

/* Adds the database of an information page with all its pages replaced. */
static void add_database(struct object_store *objects, struct bytes database, struct bytes body,
			 struct page_child *out)
{
	unsigned char *image = sqlite3_malloc64(database.size);
	sqlite3_stmt *update;
	sqlite3_int64 size;
	sqlite3 *db;

	memcpy(image, database.data, database.size);
	CHECK(sqlite3_open(":memory:", &db) == SQLITE_OK);
	CHECK(sqlite3_deserialize(
		      db, "main", image, (sqlite3_int64)database.size, (sqlite3_int64)database.size,
		      SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_RESIZEABLE) == SQLITE_OK);
	CHECK(sqlite3_prepare_v2(db,
				 "UPDATE information_contents SET body = ? WHERE body IS NOT NULL",
				 -1, &update, NULL) == SQLITE_OK);
	sqlite3_bind_blob(update, 1, body.data, (int)body.size, SQLITE_STATIC);
	CHECK(sqlite3_step(update) == SQLITE_DONE && sqlite3_changes(db) > 0);
	sqlite3_finalize(update);
	image = sqlite3_serialize(db, "main", &size, 0);
	CHECK(object_store_add(objects, (struct bytes){ image, (size_t)size }, out) == 0);
	sqlite3_free(image);
	sqlite3_close(db);
}

static void add_info_page(struct object_store *objects, struct bytes body, struct page_child *out)
{
	static const char *const languages[] = { "en" };
	struct diagnostics diagnostics = { 0 };
	const struct info_build_options options = { .folder = tiny.content,
						    .languages = languages,
						    .language_count = 1,
						    .diagnostics = &diagnostics };
	struct page_child children[8];
	struct page page = { .kind = PAGE_INFO, .children = children };
	struct info_built built;

	CHECK(info_build(&built, &options) == 0 && built.file_count < 8);
	add_database(objects, buffer_bytes(&built.database), body, &children[0]);
	for (uint32_t i = 0; i < built.file_count; i++) {
		struct buffer file;
		char path[300];

		snprintf(path, sizeof(path), "%s/%s", tiny.content, built.files[i].name);
		buffer_init(&file, OBJECT_BYTES_MAX);
		CHECK(buffer_read_file(&file, path) == 0);
		CHECK(object_store_add(objects, buffer_bytes(&file), &children[i + 1]) == 0);
		buffer_finish(&file);
	}
	page.child_count = built.file_count + 1;
	CHECK(object_store_add_page(objects, &page, out) == 0);
	info_built_finish(&built);
}

/* Verifies a release whose pages all are these bytes. */
static int publish_and_verify(struct bytes body)
{
	const struct publish_target target = tiny_target(&tiny);
	const struct release_reader_options options = { .place = tiny.release };
	struct verify_options verify = { 0 };
	struct page_child children[ROOT_CHILD_COUNT];
	struct publish_report report;
	struct object_store *objects;
	int rc;

	CHECK(object_store_create(&objects) == 0);
	tiny_hierarchy(objects, &children[ROOT_CHILD_HIERARCHY]);
	CHECK(tiny_publish_samples(&tiny, objects, &children[ROOT_CHILD_SAMPLES]) == 0);
	add_info_page(objects, body, &children[ROOT_CHILD_INFO]);
	CHECK(publish_parts(&report, &target, objects, &tiny.root, children, ROOT_CHILD_COUNT) ==
	      0);
	object_store_destroy(objects);
	CHECK(release_reader_create(&verify.reader, &options) == 0);
	rc = verify_release(&verified, &verify);
	release_reader_destroy(verify.reader);
	return rc;
}

static struct buffer article_with(const char *picture)
{
	const struct article_look look = { .link = -1 };
	struct article_builder builder;
	struct buffer out;

	buffer_init(&out, ARTICLE_BYTES_MAX);
	article_builder_init(&builder);
	article_builder_text(&builder, "Stone.", 6, &look);
	article_builder_image(&builder, picture, &look);
	CHECK(article_builder_encode(&builder, &out) == 0);
	article_builder_finish(&builder);
	return out;
}

static void a_page_that_is_an_article_is_taken(void **state)
{
	struct buffer article = article_with("");
	(void)state;

	if (publish_and_verify(buffer_bytes(&article)) != 0)
		fail_msg("%s", verified.diagnostics.first.text);
	buffer_finish(&article);
}

static void a_page_that_is_no_article_is_found(void **state)
{
	struct buffer article = article_with("");
	(void)state;

	article.data[article.size - 2] = 0xff;
	CHECK(publish_and_verify(buffer_bytes(&article)) == -EBADMSG);
	if (!strstr(verified.diagnostics.first.text, "page of tower in en is damaged"))
		fail_msg("%s", verified.diagnostics.first.text);
	buffer_finish(&article);
}

static void a_picture_that_there_is_not_is_found(void **state)
{
	struct buffer article = article_with("pictures/none.png");
	(void)state;

	CHECK(publish_and_verify(buffer_bytes(&article)) == -EBADMSG);
	if (!strstr(verified.diagnostics.first.text, "pictures/none.png"))
		fail_msg("%s", verified.diagnostics.first.text);
	buffer_finish(&article);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_page_that_is_an_article_is_taken, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_page_that_is_no_article_is_found, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_picture_that_there_is_not_is_found, set_up,
						tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
