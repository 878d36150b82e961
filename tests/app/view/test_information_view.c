/* A release's information as the kiosk meets it: piece by piece, in any language, damaged or not.
 */
#include "app/view/information_view.h"
#include "pipeline/content/info_build.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "tests/check.h"
#include "ui/overlay_state.h"

enum {
	PICTURES = 50, /* of the page */
	PICTURES_MOST = 600,
	PICTURES_KEPT = 48,
	PICTURES_WANTED = 128,
};

static char folder[64];

/* An info page, what it names, and the root page that names it. */
struct release {
	struct info_built built;
	struct bytes objects[1 + PICTURES_MOST]; /* the database, then the pictures */
	struct buffer pictures[PICTURES_MOST], page;
	uint32_t picture_count;
	struct page_child children[1 + PICTURES_MOST], root_children[ROOT_CHILD_COUNT];
	struct page root;
};

static void write_file(const char *name, struct bytes bytes)
{
	char path[200];

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	CHECK(bytes_write_file(bytes, path) == 0);
}

static void write_text(const char *name, const char *text)
{
	write_file(name, (struct bytes){ (const uint8_t *)text, strlen(text) });
}

static void write_picture(uint32_t n, uint32_t width, uint32_t height)
{
	struct picture picture = { width, height, calloc((size_t)width * height, 4) };
	struct buffer png;
	char name[64];

	CHECK(picture.rgba);
	picture.rgba[0] = (uint8_t)n;
	picture.rgba[1] = (uint8_t)(n >> 8);
	picture.rgba[3] = 255;
	buffer_init(&png, 64 << 20);
	CHECK(picture_encode_png(&png, &picture) == 0);
	snprintf(name, sizeof(name), "pictures/%02u.png", n);
	write_file(name, buffer_bytes(&png));
	buffer_finish(&png);
	picture_finish(&picture);
}

static void write_page_of_pictures(uint32_t count, uint32_t width, uint32_t height)
{
	char html[PICTURES * 64] = "<h1>Tower</h1>";

	for (uint32_t n = 0; n < count; n++) {
		const size_t used = strlen(html);

		write_picture(n, width, height);
		snprintf(html + used, sizeof(html) - used, "<p><img src=\"pictures/%02u.png\"></p>",
			 n);
	}
	write_text("pages/tower.en.html", html);
}

static void write_folder(void)
{
	write_text("parts.json",
		   "{\"parts\": [\n"
		   "{\"id\": \"tower\", \"title\": {\"en\": \"Tower\", \"km\": \"ប្រាង្គ\"},\n"
		   " \"region\": {\"kind\": \"box\", \"centre\": [0,0,0], \"half\": [9,9,9]}},\n"
		   "{\"id\": \"door\", \"title\": {\"en\": \"Door\"}, \"page\": false,\n"
		   " \"region\": {\"kind\": \"sphere\", \"centre\": [5,0,0], \"radius\": 2}},\n"
		   "{\"id\": \"spot\", \"title\": {\"en\": \"Spot\"}, \"page\": false,\n"
		   " \"anchor\": [5, 0, 0]}\n"
		   "]}\n");
	write_page_of_pictures(PICTURES, 1, 1);
}

static int set_up(void **state)
{
	char path[100];

	(void)state;
	snprintf(folder, sizeof(folder), "/tmp/gopura-story-XXXXXX");
	if (!mkdtemp(folder))
		return -1;
	snprintf(path, sizeof(path), "%s/pages", folder);
	mkdir(path, 0755);
	snprintf(path, sizeof(path), "%s/pictures", folder);
	mkdir(path, 0755);
	write_folder();
	return 0;
}

static int tear_down(void **state)
{
	char command[100];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	return system(command);
}

static void name_object(struct release *release, uint32_t child, struct bytes object)
{
	release->objects[child] = object;
	release->children[child] =
		(struct page_child){ .hash = hash_of(object), .size = (uint32_t)object.size };
}

static void make_release(struct release *release)
{
	static const char *const languages[] = { "en", "km" };
	struct diagnostics diagnostics = { 0 };
	const struct info_build_options options = { .folder = folder,
						    .languages = languages,
						    .language_count = 2,
						    .diagnostics = &diagnostics };
	struct page page = { .kind = PAGE_INFO, .children = release->children };
	char path[200];

	memset(release, 0, sizeof(*release));
	CHECK(info_build(&release->built, &options) == 0);
	CHECK(release->built.file_count <= PICTURES_MOST);
	release->picture_count = release->built.file_count;
	page.child_count = 1 + release->picture_count;
	name_object(release, 0, buffer_bytes(&release->built.database));
	for (uint32_t n = 0; n < release->picture_count; n++) {
		buffer_init(&release->pictures[n], 64 << 20);
		snprintf(path, sizeof(path), "%s/%s", folder, release->built.files[n].name);
		CHECK(buffer_read_file(&release->pictures[n], path) == 0);
		name_object(release, 1 + n, buffer_bytes(&release->pictures[n]));
	}
	buffer_init(&release->page, PAGE_BYTES_MAX);
	page_encode(&release->page, &page);
	for (int i = 0; i < ROOT_CHILD_COUNT; i++)
		release->root_children[i] = (struct page_child){ { { 1 } }, 100, true };
	release->root_children[ROOT_CHILD_INFO].hash = hash_of(buffer_bytes(&release->page));
	release->root_children[ROOT_CHILD_INFO].size = (uint32_t)release->page.size;
	release->root = (struct page){ .kind = PAGE_ROOT,
				       .child_count = ROOT_CHILD_COUNT,
				       .children = release->root_children };
}

static void finish_release(struct release *release)
{
	info_built_finish(&release->built);
	for (uint32_t n = 0; n < release->picture_count; n++)
		buffer_finish(&release->pictures[n]);
	buffer_finish(&release->page);
}

static struct information_view *begin(const struct release *release, const char *language)
{
	const struct information_view_options options = { 1920, 1080, 4, language, false };
	struct information_view *view;

	CHECK(information_view_create(&view, &options) == 0);
	information_view_open(view, (struct hash){ { 7 } }, &release->root);
	return view;
}

static struct message_want wants[1 + PICTURES_MOST];

/* Fills `wants` with what the view needs, and returns how many there are. */
static uint32_t count_wants(struct information_view *view)
{
	return information_view_wants(view, wants, ARRAY_COUNT(wants));
}

static bool give_page(struct information_view *view, const struct release *release)
{
	return information_view_give(view, release->root_children[ROOT_CHILD_INFO].hash,
				     buffer_bytes(&release->page));
}

static bool give(struct information_view *view, const struct release *release, uint32_t child)
{
	return information_view_give(view, release->children[child].hash, release->objects[child]);
}

static void asks_for_page_then_database_then_nothing(void **state)
{
	struct release release;
	struct information_view *view;

	(void)state;
	make_release(&release);
	view = begin(&release, NULL);
	CHECK(!information_view_overlay(view) && !information_view_info(view) &&
	      !information_view_language(view));
	CHECK(!give(view, &release, 0)); /* nobody asked for it yet */
	CHECK(count_wants(view) == 1 && wants[0].offset == 200);
	CHECK(hash_equal(wants[0].hash, release.root_children[ROOT_CHILD_INFO].hash));
	CHECK(give_page(view, &release));
	CHECK(count_wants(view) == 1 && wants[0].offset == 0);
	CHECK(hash_equal(wants[0].hash, release.children[0].hash));
	CHECK(give(view, &release, 0));
	CHECK(information_view_overlay(view) && info_part_count(information_view_info(view)) == 3);
	CHECK(count_wants(view) == 0);
	CHECK(!information_view_give(view, (struct hash){ { 99 } },
				     release.objects[0])); /* the scene's */
	information_view_destroy(view);
	finish_release(&release);
}

static void falls_back_to_the_first_language(void **state)
{
	static const struct {
		const char *asked, *got;
	} cases[] = { { NULL, "en" }, { "km", "km" }, { "xx", "en" } };
	struct release release;

	(void)state;
	make_release(&release);
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct information_view *view = begin(&release, cases[i].asked);

		CHECK(give_page(view, &release) && give(view, &release, 0));
		CHECK(strcmp(information_view_language(view), cases[i].got) == 0);
		information_view_set_language(view, "km");
		CHECK(strcmp(information_view_language(view), "km") == 0);
		CHECK(information_view_open_page(view, 0)); /* it has one in English alone */
		CHECK(!information_view_open_page(view, 1));
		information_view_destroy(view);
	}
	finish_release(&release);
}

static void another_language_keeps_what_is_open(void **state)
{
	struct release release;
	struct information_view *view;
	struct overlay *overlay;
	float read;

	(void)state;
	make_release(&release);
	view = begin(&release, NULL);
	CHECK(give_page(view, &release) && give(view, &release, 0));
	overlay = information_view_overlay(view);
	CHECK(information_view_open_page(view, 0));
	overlay_read_from(overlay, 0.5f);
	read = overlay_read(overlay);
	overlay_show_card(overlay, 1); /* by a link of the page */
	information_view_set_language(view, "km");
	CHECK(overlay_page(overlay) == 0 && overlay_card(overlay) == 1);
	CHECK(read > 0.4f && overlay_read(overlay) == read);
	overlay_show_card(overlay, -1);
	overlay_show_picture(overlay, 3);
	information_view_set_language(view, "en");
	CHECK(overlay_page(overlay) == 0 && overlay_picture(overlay) == 3);
	CHECK(overlay_card(overlay) == -1);
	information_view_destroy(view);
	finish_release(&release);
}

/* The letters as the overlay's own keyboard has them. */
static void press(struct overlay *overlay, const char *letter)
{
	const struct keyboard *keyboard = &overlay->search.keyboard;

	for (uint32_t i = 0; i < keyboard->key_count; i++)
		if (strcmp(keyboard->keys[i].text, letter) == 0)
			CHECK(overlay_press(overlay, (int)i));
}

static void a_query_lists_what_it_finds(void **state)
{
	struct release release;
	struct information_view *view;
	struct overlay *overlay;

	(void)state;
	make_release(&release);
	view = begin(&release, NULL);
	CHECK(give_page(view, &release) && give(view, &release, 0));
	overlay = information_view_overlay(view);
	overlay_show_search(overlay, true);
	information_view_search(view); /* nothing typed: all stay */
	CHECK(overlay->search.found_count == 3);
	press(overlay, "d");
	information_view_search(view);
	CHECK(overlay->search.found_count == 1 && overlay->search.found[0] == 1);
	information_view_set_language(view, "km"); /* what is typed is looked for again */
	CHECK(overlay_searching(overlay) && overlay->search.found_count == 1);
	information_view_destroy(view);
	finish_release(&release);
}

static void a_point_belongs_to_the_smallest_region(void **state)
{
	const float in_both[3] = { 5, 0, 0 }, in_tower[3] = { -5, 0, 0 }, outside[3] = { 50, 0, 0 };
	struct release release;
	struct region region;
	struct information_view *view;

	(void)state;
	make_release(&release);
	view = begin(&release, NULL);
	CHECK(information_view_part_at(view, in_both) == -1); /* nothing is known yet */
	CHECK(give_page(view, &release) && give(view, &release, 0));
	CHECK(information_view_part_at(view, in_both) == 1);
	CHECK(information_view_part_at(view, in_tower) == 0);
	CHECK(information_view_part_at(view, outside) == -1);
	CHECK(information_view_region(view, 1, &region) && region.kind == REGION_SPHERE);
	CHECK(!information_view_region(view, 2, &region)); /* only a spot */
	information_view_destroy(view);
	finish_release(&release);
}

static void does_not_ask_again_for_what_came_damaged(void **state)
{
	struct release release;
	struct information_view *view;

	(void)state;
	make_release(&release);
	view = begin(&release, NULL);
	release.page.data[0] ^= 1;
	CHECK(give_page(view, &release)); /* ours, if of no use */
	CHECK(count_wants(view) == 0 && !information_view_info(view));
	information_view_destroy(view);
	release.page.data[0] ^= 1;

	view = begin(&release, NULL);
	release.page.data[4] = PAGE_BRICK; /* whole, but no info page */
	CHECK(give_page(view, &release));
	CHECK(count_wants(view) == 0 && !give(view, &release, 0));
	information_view_destroy(view);
	release.page.data[4] = PAGE_INFO;

	view = begin(&release, NULL);
	CHECK(give_page(view, &release));
	release.built.database.data[0] ^= 1;
	CHECK(give(view, &release, 0));
	CHECK(count_wants(view) == 0 && !information_view_info(view) &&
	      !information_view_overlay(view));
	release.built.database.data[0] ^= 1;
	information_view_open(view, (struct hash){ { 8 } },
			      &release.root); /* the next release is good */
	CHECK(give_page(view, &release) && give(view, &release, 0));
	CHECK(information_view_info(view));
	information_view_destroy(view);
	finish_release(&release);
}

static void a_damaged_picture_is_not_asked_for_again(void **state)
{
	struct release release;
	struct information_view *view;

	(void)state;
	make_release(&release);
	view = begin(&release, NULL);
	CHECK(give_page(view, &release) && give(view, &release, 0));
	CHECK(information_view_open_page(view, 0));
	CHECK(count_wants(view) == PICTURES);
	CHECK(information_view_wants(view, wants, 3) == 3);
	release.pictures[3].data[0] ^= 1;
	CHECK(give(view, &release, 1 + 3));
	CHECK(information_view_open_page(view, 0));
	CHECK(count_wants(view) == PICTURES - 1);
	information_view_destroy(view);
	finish_release(&release);
}

static void lets_pictures_go_and_asks_for_them_again(void **state)
{
	struct release release;
	struct information_view *view;

	(void)state;
	make_release(&release);
	view = begin(&release, NULL);
	CHECK(give_page(view, &release) && give(view, &release, 0));
	CHECK(information_view_open_page(view, 0));
	for (uint32_t n = 0; n < PICTURES; n++)
		CHECK(give(view, &release, 1 + n));
	overlay_close_page(information_view_overlay(view));
	CHECK(information_view_open_page(view, 0));
	CHECK(count_wants(view) == PICTURES - PICTURES_KEPT);
	information_view_destroy(view);
	finish_release(&release);
}

/* Gives what is wanted first. Returns false if nothing is. */
static bool give_wanted(struct information_view *view, const struct release *release)
{
	uint32_t child = 0;

	if (count_wants(view) == 0)
		return false;
	while (!hash_equal(release->children[child].hash, wants[0].hash))
		child++;
	return give(view, release, child);
}

static void a_page_of_many_pictures_comes_to_rest(void **state)
{
	struct release release;
	struct information_view *view;
	uint32_t given = 0;

	(void)state;
	make_release(&release);
	view = begin(&release, NULL);
	CHECK(give_page(view, &release) && give(view, &release, 0));
	CHECK(information_view_open_page(view, 0));
	while (given <= PICTURES && give_wanted(view, &release))
		given++;
	CHECK(given == PICTURES);
	information_view_destroy(view);
	finish_release(&release);
}

static void large_pictures_go_sooner(void **state)
{
	enum { LARGE = 5, LARGE_KEPT = 4 }; /* of 32 MiB each */
	struct release release;
	struct information_view *view;

	(void)state;
	write_page_of_pictures(LARGE, 4096, 2048);
	make_release(&release);
	view = begin(&release, NULL);
	CHECK(give_page(view, &release) && give(view, &release, 0));
	CHECK(information_view_open_page(view, 0));
	for (uint32_t n = 0; n < LARGE; n++)
		CHECK(give_wanted(view, &release));
	CHECK(count_wants(view) == 0);
	CHECK(information_view_open_page(view, 0));
	CHECK(count_wants(view) == LARGE - LARGE_KEPT);
	information_view_destroy(view);
	finish_release(&release);
}

/* Many parts, each with a picture of its own. */
static void write_parts_with_pictures(uint32_t count)
{
	struct buffer json;

	buffer_init(&json, 1 << 20);
	buffer_put_text(&json, "{\"parts\": [\n");
	for (uint32_t n = 0; n < count; n++) {
		write_picture(n, 1, 1);
		buffer_print(
			&json,
			"%s{\"id\": \"part%u\", \"title\": {\"en\": \"Part\"}, \"page\": false,\n"
			" \"anchor\": [5, 0, 0], \"thumbnail\": \"pictures/%02u.png\"}\n",
			n > 0 ? "," : "", n, n);
	}
	buffer_put_text(&json, "]}\n");
	CHECK(json.error == 0);
	write_file("parts.json", buffer_bytes(&json));
	buffer_finish(&json);
}

/* The card asks for the picture. */
static void look_at(struct information_view *view, uint32_t part)
{
	struct overlay *overlay = information_view_overlay(view);
	static int64_t now_ms;

	overlay_show_card(overlay, (int)part);
	overlay_update(overlay, now_ms += 16);
}

static void a_release_may_have_any_number_of_pictures(void **state)
{
	struct release release;
	struct information_view *view;

	(void)state;
	write_parts_with_pictures(PICTURES_MOST);
	make_release(&release);
	CHECK(release.picture_count == PICTURES_MOST);
	view = begin(&release, NULL);
	CHECK(give_page(view, &release) && give(view, &release, 0));
	for (uint32_t n = 0; n < PICTURES_MOST; n++) {
		look_at(view, n);
		CHECK(give_wanted(view, &release) && count_wants(view) == 0);
	}
	information_view_destroy(view);
	finish_release(&release);
}

/* Without a network they would take all room in the list of what the fetcher is asked for. */
static void what_was_looked_at_long_ago_is_not_wanted(void **state)
{
	struct release release;
	struct information_view *view;

	(void)state;
	write_parts_with_pictures(2 * PICTURES_WANTED);
	make_release(&release);
	view = begin(&release, NULL);
	CHECK(give_page(view, &release) && give(view, &release, 0));
	for (uint32_t n = 0; n < 2 * PICTURES_WANTED; n++)
		look_at(view, n);
	CHECK(count_wants(view) == PICTURES_WANTED);
	look_at(view, 0); /* wanted again */
	CHECK(give_wanted(view, &release));
	CHECK(count_wants(view) < PICTURES_WANTED);
	information_view_destroy(view);
	finish_release(&release);
}

#define IN_A_FOLDER(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		IN_A_FOLDER(asks_for_page_then_database_then_nothing),
		IN_A_FOLDER(falls_back_to_the_first_language),
		IN_A_FOLDER(another_language_keeps_what_is_open),
		IN_A_FOLDER(a_query_lists_what_it_finds),
		IN_A_FOLDER(a_point_belongs_to_the_smallest_region),
		IN_A_FOLDER(does_not_ask_again_for_what_came_damaged),
		IN_A_FOLDER(a_damaged_picture_is_not_asked_for_again),
		IN_A_FOLDER(lets_pictures_go_and_asks_for_them_again),
		IN_A_FOLDER(a_page_of_many_pictures_comes_to_rest),
		IN_A_FOLDER(large_pictures_go_sooner),
		IN_A_FOLDER(a_release_may_have_any_number_of_pictures),
		IN_A_FOLDER(what_was_looked_at_long_ago_is_not_wanted),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
