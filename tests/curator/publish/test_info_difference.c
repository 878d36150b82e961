#include "curator/publish/info_difference.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "curator/publish/alt_texts.h"
#include "tests/pipeline/content/info_folder.h"

static cJSON *difference_of(struct bytes now, struct bytes before)
{
	cJSON *json = cJSON_CreateObject();

	CHECK(info_difference(json, now, before) == 0);
	return json;
}

static int count(const cJSON *json, const char *kind)
{
	return cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(json, kind));
}

/* Returns "added", "changed", "removed", or "" if the key is not in the list. */
static const char *change_of(const cJSON *json, const char *kind, const char *key)
{
	const cJSON *row;

	cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(json, kind))
	{
		if (strcmp(cJSON_GetObjectItem(row, "key")->valuestring, key) == 0)
			return cJSON_GetObjectItem(row, "change")->valuestring;
	}
	return "";
}

static int language_number(const cJSON *json, int language, const char *name)
{
	const cJSON *row = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "languages"), language);

	return cJSON_GetObjectItem(row, name)->valueint;
}

static void nothing_differs_from_itself(void **state)
{
	static const char *const kinds[] = { "parts", "cards", "pages", "pictures", "tours" };
	struct info_built built;
	cJSON *json;

	(void)state;
	CHECK(build(&built) == 0);
	json = difference_of(buffer_bytes(&built.database), buffer_bytes(&built.database));
	for (unsigned n = 0; n < ARRAY_COUNT(kinds); n++)
		CHECK(cJSON_GetObjectItem(json, kinds[n]) && count(json, kinds[n]) == 0);
	CHECK(cJSON_GetObjectItem(json, "picture_bytes")->valueint == 0);
	cJSON_Delete(json);
	info_built_finish(&built);
}

static void without_a_release_everything_is_added(void **state)
{
	struct info_built built;
	cJSON *json;

	(void)state;
	CHECK(build(&built) == 0);
	json = difference_of(buffer_bytes(&built.database), (struct bytes){ 0 });
	CHECK(count(json, "parts") == 3 && strcmp(change_of(json, "parts", "gate"), "added") == 0);
	CHECK(count(json, "pages") == 3 && count(json, "pictures") == 2);
	CHECK(cJSON_GetObjectItem(json, "picture_bytes")->valueint > 0);
	/* The third part has no title in Khmer, and one of two pages is not translated. */
	CHECK(language_number(json, 0, "titles") == 0 && language_number(json, 0, "pages") == 0);
	CHECK(language_number(json, 1, "pages") == 1);
	cJSON_Delete(json);
	info_built_finish(&built);
}

static void a_changed_page_a_new_part_and_one_that_is_gone_are_told(void **state)
{
	struct info_built before, now;
	cJSON *json;

	(void)state;
	CHECK(build(&before) == 0);
	write_text("pages/gate.en.html", "<p>Another text.</p>");
	write_text("parts.json",
		   "{\"parts\": [{\"id\": \"gate\", \"title\": {\"en\": \"Gate\"}, \"region\":"
		   " {\"kind\": \"sphere\", \"centre\": [0, 0, 1], \"radius\": 2}},"
		   " {\"id\": \"new\", \"page\": false, \"title\": {\"en\": \"New\"}, \"region\":"
		   " {\"kind\": \"sphere\", \"centre\": [0, 0, 1], \"radius\": 2}}]}");
	CHECK(build(&now) == 0);
	json = difference_of(buffer_bytes(&now.database), buffer_bytes(&before.database));
	CHECK(strcmp(change_of(json, "parts", "new"), "added") == 0);
	CHECK(strcmp(change_of(json, "parts", "gate"), "changed") == 0);
	CHECK(count(json, "parts") == 4); /* and two are gone */
	CHECK(strcmp(change_of(json, "pages", "gate.en"), "changed") == 0);
	CHECK(strcmp(change_of(json, "cards", "new.en"), "added") == 0);
	cJSON_Delete(json);
	info_built_finish(&before);
	info_built_finish(&now);
}

static void read_recording(struct buffer *file)
{
	buffer_init(file, 1 << 20);
	CHECK(buffer_read_file(file, "demo/content/pages/central-tower.en.opus") == 0);
}

static void a_spoken_text_is_told_with_its_words_and_bytes(void **state)
{
	static const char *const words[] = { "Tower", "A tower" };
	struct info_built silent, spoken[2];
	struct buffer file;
	cJSON *json;

	(void)state;
	CHECK(build(&silent) == 0);
	read_recording(&file);
	write_file("pages/tower.en.opus", file.data, file.size);
	for (unsigned n = 0; n < 2; n++) {
		char text[64];

		snprintf(text, sizeof(text), "WEBVTT\n\n00:00.000 --> 00:02.000\n%s\n", words[n]);
		write_text("pages/tower.en.vtt", text);
		CHECK(build(&spoken[n]) == 0);
	}
	json = difference_of(buffer_bytes(&spoken[0].database), buffer_bytes(&silent.database));
	CHECK(strcmp(change_of(json, "sounds", "tower.en"), "added") == 0);
	CHECK(count(json, "sounds") == 1 && count(json, "pages") == 0);
	CHECK(cJSON_GetObjectItem(json, "sound_bytes")->valueint == (int)file.size);
	cJSON_Delete(json);
	/* Other words, the same recording. */
	json = difference_of(buffer_bytes(&spoken[1].database), buffer_bytes(&spoken[0].database));
	CHECK(strcmp(change_of(json, "sounds", "tower.en"), "changed") == 0);
	CHECK(cJSON_GetObjectItem(json, "sound_bytes")->valueint == 0);
	cJSON_Delete(json);
	json = difference_of(buffer_bytes(&silent.database), buffer_bytes(&spoken[0].database));
	CHECK(strcmp(change_of(json, "sounds", "tower.en"), "removed") == 0);
	CHECK(!cJSON_GetObjectItem(json, "sound_bytes"));
	cJSON_Delete(json);
	json = difference_of(buffer_bytes(&spoken[0].database), (struct bytes){ 0 });
	CHECK(strcmp(change_of(json, "sounds", "tower.en"), "added") == 0);
	cJSON_Delete(json);
	buffer_finish(&file);
	info_built_finish(&silent);
	info_built_finish(&spoken[0]);
	info_built_finish(&spoken[1]);
}

static void what_is_no_database_is_refused(void **state)
{
	static const uint8_t nonsense[512] = "SQLite format 4";
	cJSON *json = cJSON_CreateObject();

	(void)state;
	CHECK(info_difference(json, (struct bytes){ nonsense, sizeof(nonsense) },
			      (struct bytes){ 0 }) == -EBADMSG);
	cJSON_Delete(json);
}

static void pictures_without_a_description_are_named(void **state)
{
	static const char html[] =
		"<h1>Gate</h1>\n<img src=\"pictures/a.png\" alt=\"A lion\">\n"
		"<p><img src='pictures/b.png'>\n<img src=pictures/c.png alt=' '>";
	cJSON *list = cJSON_CreateArray();
	const cJSON *row;

	(void)state;
	alt_texts_of(list, "pages/gate.en.html",
		     (struct bytes){ (const uint8_t *)html, strlen(html) });
	CHECK(cJSON_GetArraySize(list) == 2);
	row = cJSON_GetArrayItem(list, 0);
	CHECK(strcmp(cJSON_GetObjectItem(row, "picture")->valuestring, "pictures/b.png") == 0);
	CHECK(cJSON_GetObjectItem(row, "line")->valueint == 3);
	cJSON_Delete(list);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(nothing_differs_from_itself, set_up, tear_down),
		cmocka_unit_test_setup_teardown(without_a_release_everything_is_added, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(
			a_changed_page_a_new_part_and_one_that_is_gone_are_told, set_up, tear_down),
		cmocka_unit_test_setup_teardown(a_spoken_text_is_told_with_its_words_and_bytes,
						set_up, tear_down),
		cmocka_unit_test(what_is_no_database_is_refused),
		cmocka_unit_test(pictures_without_a_description_are_named),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
