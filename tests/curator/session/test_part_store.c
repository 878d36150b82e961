/* Two curators who mark parts of one content folder. */
#include "curator/session/part_store.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/log.h"
#include "tests/check.h"

enum { TRIANGLES = 40 };

static char folder[PATH_MAX], scan_path[PATH_MAX + 20];
static struct mesh mesh;
static struct site site;
static uint32_t triangles[TRIANGLES][3], faces[TRIANGLES];

/* A curator's region, and what it was opened from. */
struct curator {
	struct region_set set;
	struct open_part open;
};

static const char *at(const char *name)
{
	static char path[PATH_MAX + 300];

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	return path;
}

static void put(const char *name, const char *text)
{
	FILE *file = fopen(at(name), "w");

	CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

/* Returns the text of a file until the next call; "" if there is none. */
static const char *text_of(const char *name)
{
	static char text[4000];
	FILE *file = fopen(at(name), "r");

	text[0] = '\0';
	if (file) {
		text[fread(text, 1, sizeof(text) - 1, file)] = '\0';
		fclose(file);
	}
	return text;
}

static int open_site(void **state)
{
	(void)state;
	log_set_level((enum log_level) - 1);
	snprintf(folder, sizeof(folder), "/tmp/gopura-part-store-XXXXXX");
	if (!mkdtemp(folder))
		return -1;
	snprintf(scan_path, sizeof(scan_path), "%s/scan.ply", folder);
	for (uint32_t t = 0; t < TRIANGLES; t++) {
		for (uint32_t k = 0; k < 3; k++)
			triangles[t][k] = t + k;
		faces[t] = t;
	}
	mesh = (struct mesh){ .vertex_count = TRIANGLES + 2,
			      .triangle_count = TRIANGLES,
			      .triangles = triangles,
			      .faces = faces,
			      .scan_count = 1,
			      .scans = { { TRIANGLES, TRIANGLES } } };
	site = (struct site){ .mesh = &mesh };
	snprintf(site.content.folder, sizeof(site.content.folder), "%s", folder);
	site.content.scans[0] = scan_path;
	site.content.scan_count = 1;
	site.content.language_count = 2;
	snprintf(site.content.languages[0], sizeof(site.content.languages[0]), "en");
	snprintf(site.content.languages[1], sizeof(site.content.languages[1]), "de");
	put("parts.json", "{\"parts\": [{\"id\": \"ball\", \"region\": {\"kind\": \"sphere\"}, "
			  "\"title\": {\"en\": \"Ball\", \"de\": \"Kugel\"}}]}");
	return documents_open(&site.documents, folder, NULL);
}

static int close_site(void **state)
{
	char command[PATH_MAX + 20];

	(void)state;
	documents_close(site.documents);
	snprintf(command, sizeof(command), "rm -rf '%s'", folder);
	return system(command);
}

static void come(struct curator *curator)
{
	*curator = (struct curator){ 0 };
	CHECK(region_set_init(&curator->set, TRIANGLES) == 0);
}

static void leave(struct curator *curator)
{
	region_set_finish(&curator->set);
}

/* Marks faces first to last, and no others. */
static void mark(struct curator *curator, uint32_t first, uint32_t last)
{
	region_set_begin(&curator->set);
	region_set_put_all(&curator->set, false);
	for (uint32_t t = first; t <= last; t++)
		region_set_put(&curator->set, t, true);
	CHECK(region_set_commit(&curator->set) == 0);
}

static int save_as(struct curator *curator, const struct part_to_save *wanted)
{
	struct diagnostics diagnostics = { 0 };
	struct part_to_save save = *wanted;
	int rc;

	save.author = "ana";
	save.language = save.language ? save.language : "";
	save.title = save.title ? save.title : "";
	save.from = save.from ? save.from : "";
	rc = part_store_save(&site, &curator->set, &save, &curator->open, &diagnostics);
	CHECK((rc < 0) == (diagnostics.count > 0));
	return rc;
}

static int save_new(struct curator *curator, const char *id, const char *title)
{
	return save_as(curator, &(struct part_to_save){ .id = id, .is_new = true, .title = title });
}

static int save(struct curator *curator, const char *id)
{
	return save_as(curator, &(struct part_to_save){ .id = id });
}

static int open(struct curator *curator, const char *id)
{
	struct diagnostics diagnostics = { 0 };

	return part_store_open(&site, &curator->set, id, &curator->open, &diagnostics);
}

/* Whether parts.json is these parts. */
static bool parts_are(const char *json)
{
	cJSON *expected = cJSON_Parse(json), *root = cJSON_Parse(text_of("parts.json"));
	const bool equal =
		expected && cJSON_Compare(cJSON_GetObjectItem(root, "parts"), expected, true);

	cJSON_Delete(expected);
	cJSON_Delete(root);
	return equal;
}

#define BALL                                                                                       \
	"{\"id\": \"ball\", \"region\": {\"kind\": \"sphere\"}, "                                  \
	"\"title\": {\"en\": \"Ball\", \"de\": \"Kugel\"}}"
#define FACES(id) "\"region\": {\"kind\": \"faces\", \"file\": \"regions/" id ".faces\"}"

static void two_new_parts_of_one_id_are_two_parts(void **state)
{
	struct curator a, b;

	(void)state;
	come(&a);
	come(&b);
	mark(&a, 0, 3);
	mark(&b, 10, 12);
	CHECK(save_new(&a, "part", "ទ្វារ") == 0 && strcmp(a.open.id, "part") == 0);
	CHECK(save_new(&b, "part", "ប៉ម") == 0 && strcmp(b.open.id, "part-2") == 0);
	CHECK(strcmp(text_of("regions/part.faces"), "0-3\n") == 0);
	CHECK(strcmp(text_of("regions/part-2.faces"), "10-12\n") == 0);
	CHECK(parts_are(
		"[" BALL
		", {\"id\": \"part\", \"page\": false, " FACES("part") ", \"title\": {\"en\": \"ទ្វារ\"}}, {\"id\": \"part-2\", \"page\": false, " FACES(
			"part-2") ", \"title\": {\"en\": \"ប៉ម\"}}]"));
	/* Each goes on with its own. */
	mark(&b, 10, 20);
	CHECK(save(&b, "part-2") == 0);
	CHECK(strcmp(text_of("regions/part-2.faces"), "10-20\n") == 0);
	leave(&b);
	leave(&a);
}

static void a_number_fits_behind_the_longest_id(void **state)
{
	char id[REQUEST_ID_BYTES];
	struct curator a;

	(void)state;
	memset(id, 'x', sizeof(id) - 1);
	id[sizeof(id) - 1] = '\0';
	come(&a);
	mark(&a, 0, 3);
	CHECK(save_new(&a, id, "One") == 0 && strcmp(a.open.id, id) == 0);
	CHECK(save_new(&a, id, "Two") == 0 && strlen(a.open.id) == sizeof(id) - 1 &&
	      strcmp(a.open.id + sizeof(id) - 4, "x-2") == 0);
	leave(&a);
}

static void a_file_that_no_part_names_is_not_written_over(void **state)
{
	struct curator a;

	(void)state;
	CHECK(mkdir(at("regions"), 0755) == 0);
	put("regions/gate.faces", "7\n");
	come(&a);
	mark(&a, 0, 3);
	CHECK(save_new(&a, "gate", "Gate") == 0 && strcmp(a.open.id, "gate-2") == 0);
	CHECK(strcmp(text_of("regions/gate.faces"), "7\n") == 0);
	leave(&a);
}

static void a_region_that_somebody_else_saved_is_not_overwritten(void **state)
{
	struct curator a, b;

	(void)state;
	come(&a);
	come(&b);
	mark(&a, 0, 3);
	CHECK(save_new(&a, "gate", "Gate") == 0);
	CHECK(open(&b, "gate") == 0 && b.set.count == 4);
	mark(&a, 0, 5);
	mark(&b, 0, 9);
	CHECK(save(&b, "gate") == 0);
	CHECK(save(&a, "gate") == -ESTALE);
	CHECK(save(&a, "gate") == -ESTALE); /* asking twice decides nothing */
	CHECK(strcmp(text_of("regions/gate.faces"), "0-9\n") == 0);
	/* Both are kept as two parts, or theirs is replaced knowingly. */
	CHECK(save_new(&a, "gate", "Gate") == 0 && strcmp(a.open.id, "gate-2") == 0);
	CHECK(open(&a, "gate") == 0 && a.set.count == 10);
	mark(&a, 0, 5);
	mark(&b, 0, 1);
	CHECK(save(&b, "gate") == 0);
	CHECK(save(&a, "gate") == -ESTALE);
	CHECK(save_as(&a, &(struct part_to_save){ .id = "gate", .replaces = true }) == 0);
	CHECK(strcmp(text_of("regions/gate.faces"), "0-5\n") == 0);
	CHECK(save(&b, "gate") == -ESTALE);
	leave(&b);
	leave(&a);
}

static void a_part_that_was_removed_does_not_come_back(void **state)
{
	struct curator a;

	(void)state;
	come(&a);
	mark(&a, 0, 3);
	CHECK(save_new(&a, "gate", "Gate") == 0);
	put("parts.json", "{\"parts\": []}");
	CHECK(remove(at("regions/gate.faces")) == 0);
	CHECK(save(&a, "gate") == -ENOENT);
	CHECK(save_as(&a, &(struct part_to_save){ .id = "gate", .replaces = true }) == -ENOENT);
	CHECK(parts_are("[]") && strcmp(text_of("regions/gate.faces"), "") == 0);
	CHECK(save_new(&a, "gate", "Gate") == 0 && strcmp(a.open.id, "gate") == 0);
	leave(&a);
}

static void a_region_is_saved_to_the_part_that_is_open_alone(void **state)
{
	struct curator a;

	(void)state;
	come(&a);
	mark(&a, 0, 3);
	CHECK(save_new(&a, "gate", "Gate") == 0);
	CHECK(save_new(&a, "door", "Door") == 0);
	CHECK(save(&a, "gate") == -EINVAL && save(&a, "ball") == -EINVAL);
	/* What cannot be opened leaves the other open. */
	mark(&a, 7, 8);
	CHECK(open(&a, "nothing") == -ENOENT);
	CHECK(a.set.count == 2 && strcmp(a.open.id, "door") == 0);
	put("regions/gate.faces", "5000\n");
	CHECK(open(&a, "gate") == -EINVAL);
	CHECK(a.set.count == 2 && save(&a, "door") == 0);
	leave(&a);
}

static void a_shape_opens_with_nothing_marked_and_is_replaced(void **state)
{
	struct curator a, b;

	(void)state;
	come(&a);
	come(&b);
	mark(&a, 0, 3);
	CHECK(open(&a, "ball") == 0 && open(&b, "ball") == 0 && a.set.count == 0);
	CHECK(save(&a, "ball") == -EINVAL); /* nothing is marked */
	mark(&a, 0, 3);
	mark(&b, 4, 5);
	CHECK(save(&a, "ball") == 0);
	CHECK(save(&b, "ball") == -ESTALE);
	CHECK(parts_are("[{\"id\": \"ball\", " FACES(
		"ball") ", \"title\": {\"en\": \"Ball\", \"de\": \"Kugel\"}}]"));
	leave(&b);
	leave(&a);
}

static void a_title_is_written_only_over_the_one_it_replaces(void **state)
{
	struct part_to_save saved = { .id = "ball", .title = "Die Kugel", .language = "de" };
	struct curator a;

	(void)state;
	come(&a);
	CHECK(open(&a, "ball") == 0);
	mark(&a, 0, 3);
	saved.from = "Ball";
	CHECK(save_as(&a, &saved) == -ESTALE && strcmp(text_of("regions/ball.faces"), "") == 0);
	saved.from = "Kugel";
	CHECK(save_as(&a, &saved) == 0);
	CHECK(save_as(&a, &saved) == 0); /* it is that already */
	CHECK(save(&a, "ball") == 0);
	CHECK(parts_are("[{\"id\": \"ball\", " FACES(
		"ball") ", \"title\": {\"en\": \"Ball\", \"de\": \"Die Kugel\"}}]"));
	saved.title = "Eine Kugel";
	CHECK(save_as(&a, &saved) == -ESTALE);
	saved.replaces = true;
	CHECK(save_as(&a, &saved) == 0);
	CHECK(strstr(text_of("parts.json"), "Eine Kugel"));
	leave(&a);
}

/* A scan of that many bytes, which lies beside the files that say how it is marked. */
static void put_scan(const char *text)
{
	put("temple.ini", "[model]\nname = Ball\nscans = scan.ply\n");
	put("scan.ply", text);
}

static void no_region_is_saved_for_a_scan_that_was_replaced(void **state)
{
	struct content known = site.content;
	struct diagnostics none = { 0 };
	struct curator a;
	struct hash key;

	(void)state;
	put_scan("one");
	CHECK(content_read(&site.content, folder, &none) == 0);
	CHECK(scans_create(&site.scans, &site.content) == 0 &&
	      scans_key(site.scans, &key, NULL) == 0);
	come(&a);
	mark(&a, 3, 5);
	CHECK(save_new(&a, "gate", "Gate") == 0);
	CHECK(open(&a, "gate") == 0);
	put_scan("another one");
	mark(&a, 10, 12);
	CHECK(save(&a, "gate") == -EINVAL);
	CHECK(strcmp(text_of("regions/gate.faces"), "3-5\n") == 0);
	CHECK(open(&a, "gate") == -EINVAL && a.set.count == 3);
	put("temple.ini",
	    "[model]\nscans = another.ply\n"); /* it has faults: nothing is built of it */
	CHECK(save(&a, "gate") == 0);
	leave(&a);
	scans_destroy(site.scans);
	content_release(&site.content);
	site.content = known;
	site.scans = NULL;
}

static void the_list_has_all_titles(void **state)
{
	struct buffer out;
	cJSON *list, *expected;

	(void)state;
	buffer_init(&out, 4000);
	CHECK(part_store_list(&site, &out, NULL) == 0);
	buffer_put_u8(&out, 0);
	list = cJSON_Parse((const char *)out.data);
	expected = cJSON_Parse("[{\"id\": \"ball\", \"title\": \"Ball\", \"titles\": {\"en\": "
			       "\"Ball\", \"de\": \"Kugel\"}, \"faces\": false}]");
	CHECK(cJSON_Compare(list, expected, true));
	cJSON_Delete(expected);
	cJSON_Delete(list);
	buffer_finish(&out);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, open_site, close_site)
	const struct CMUnitTest tests[] = {
		TEST(two_new_parts_of_one_id_are_two_parts),
		TEST(a_number_fits_behind_the_longest_id),
		TEST(a_file_that_no_part_names_is_not_written_over),
		TEST(a_region_that_somebody_else_saved_is_not_overwritten),
		TEST(a_part_that_was_removed_does_not_come_back),
		TEST(a_region_is_saved_to_the_part_that_is_open_alone),
		TEST(a_shape_opens_with_nothing_marked_and_is_replaced),
		TEST(a_title_is_written_only_over_the_one_it_replaces),
		TEST(no_region_is_saved_for_a_scan_that_was_replaced),
		TEST(the_list_has_all_titles),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
