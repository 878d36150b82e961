/* scenes.json and its files: scenery with layers, or every fault with its line. */
#include "pipeline/content/scenes.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "tests/check.h"

static char folder[] = "/tmp/gopura-scenes-XXXXXX";

static void write_text(const char *name, const char *text)
{
	char path[100];

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	CHECK(bytes_write_file((struct bytes){ (const uint8_t *)text, strlen(text) }, path) == 0);
}

static int make_folder(void **state)
{
	char path[100];

	(void)state;
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/scenes", folder);
	CHECK(mkdir(path, 0700) == 0);
	write_text("scenes/box.wrl", "#VRML V2.0 utf8\nShape { geometry Box {} }");
	write_text("scenes/bad.wrl", "#VRML V2.0 utf8\n\nScript {}");
	return 0;
}

static int remove_folder(void **state)
{
	char path[100];

	(void)state;
	snprintf(path, sizeof(path), "%s/scenes", folder);
	bytes_remove_folder(path);
	bytes_remove_folder(folder);
	return 0;
}

static int read_json(struct scenery *out, const char *json, struct diagnostics *told)
{
	struct content content = { .language_count = 2, .languages = { "en", "km" } };

	snprintf(content.folder, sizeof(content.folder), "%s", folder);
	write_text("scenes.json", json);
	return scenes_read(out, &content, told);
}

static void layers_have_titles_and_scenes(void **state)
{
	struct diagnostics told = { .max = 20 };
	struct scenery s;

	(void)state;
	CHECK(read_json(
		      &s,
		      "{\"scenes\": [{\"file\": \"scenes/box.wrl\", \"up\": \"z\"},\n"
		      " {\"file\": \"scenes/box.wrl\", \"layer\": \"built\", \"unit\": \"cm\"}],\n"
		      " \"layers\": [{\"id\": \"found\", \"title\": {\"en\": \"As found\"}},\n"
		      "  {\"id\": \"built\", \"title\": {\"en\": \"As built\", \"km\": \"x\"}}]}",
		      &told) == 0);
	CHECK(s.layer_count == 2 && s.layers[0].title_count == 1 && s.layers[1].title_count == 2);
	CHECK(strcmp(s.titles[1].text, "As built") == 0 && strcmp(s.titles[2].language, "km") == 0);
	CHECK(s.node_count == 2 && s.nodes[0].layer == SCENERY_NONE && s.nodes[1].layer == 1);
	CHECK(s.nodes[0].place.turn[3] == 1 && s.nodes[1].place.scale[2] == 0.01f);
	CHECK(s.mesh_count == 2 && told.count == 1); /* no Khmer title: a warning */
	diagnostics_finish(&told);
	scenery_finish(&s);
}

static void without_scenes_there_is_no_scenery(void **state)
{
	struct content content = { .language_count = 1, .languages = { "en" } };
	struct diagnostics told = { 0 };
	struct scenery s;

	(void)state;
	snprintf(content.folder, sizeof(content.folder), "%s/scenes", folder);
	CHECK(scenes_read(&s, &content, &told) == 0 && s.node_count == 0 && told.count == 0);
}

static void every_fault_names_its_line(void **state)
{
	static const struct {
		const char *json, *told;
	} cases[] = {
		{ "[]", "scenes.json:1: must be {\"scenes\": [...]} at the top level" },
		{ "{\"scenes\": [\n{\"file\": \"../box.wrl\"}]}",
		  "scenes.json:2: \"file\" must be in the folder scenes: \"scenes/NAME.wrl\"" },
		{ "{\"scenes\": [\n{\"file\": \"scenes/box.wrl\", \"layr\": \"a\"}]}",
		  "scenes.json:2: \"layr\" is not one of its keys, which are: file layer up unit scene plays materials " },
		{ "{\"scenes\": [\n{\"file\": \"scenes/box.wrl\", \"layer\": \"a\"}]}",
		  "scenes.json:2: layer \"a\" is not one of \"layers\"; correct its name" },
		{ "{\"scenes\": [{\"file\": \"scenes/box.wrl\"}],\n"
		  "\"layers\": [{\"id\": \"a\", \"title\": {\"en\": \"A\", \"km\": \"A\"}},\n"
		  "{\"id\": \"b\", \"title\": {\"km\": \"B\"}}]}",
		  "scenes.json:3: a layer has no title in \"en\", the first language: add \"title\": "
		  "{\"en\": \"...\"}" },
		{ "{\"scenes\": [\n{\"file\": \"scenes/box.wrl\", \"materials\": {\n\"A\": {}}}]}",
		  "scenes.json:2: no material of scenes/box.wrl is called \"A\": correct the name" },
		{ "{\"scenes\": [{\"file\": \"scenes/box.wrl\", \"materials\": {\n"
		  "\"A\": {\"substance\": \"granite\"}}}]}",
		  "scenes.json:2: \"substance\" must be marble, wood, sandstone, laterite or none, "
		  "not \"granite\"" },
		{ "{\"scenes\": [{\"file\": \"scenes/box.wrl\", \"materials\": {\n"
		  "\"A\": {\"relief\": 3}}}]}",
		  "scenes.json:2: \"relief\" must be a number from 0 to 0.1" },
		{ "{\"scenes\": [{\"file\": \"scenes/box.wrl\", \"materials\": {\n"
		  "\"A\": {\"shine\": 3}}}]}",
		  "scenes.json:2: \"shine\" is not one of its keys, which are: substance relief "
		  "mirror " },
		{ "{\"scenes\": [\n{\"file\": \"scenes/box.wrl\", \"materials\": 3}]}",
		  "scenes.json:2: \"materials\" must be {\"NAME\": {...}} with at most 64 names" },
		{ "{\"scenes\": [{\"file\": \"scenes/bad.wrl\"}]}", "bad.wrl:3: Script" },
		{ "{\"scenes\": [\n{\"file\": \"scenes/box.wrl\", \"plays\": \"twice\"}]}",
		  "scenes.json:2: \"plays\" must be \"touch\"" },
		{ "{\"scenes\": [{\"file\": \"scenes/box.wrl\", \"plays\": \"always\"}]}",
		  "box.wrl: a VRML97 file has one scene and says itself what moves when" },
		{ "{\"scenes\": [{\"file\": \"scenes/none.wrl\"}]}",
		  "none.wrl: No such file or directory" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		struct diagnostics told = { 0 };
		struct scenery s;

		CHECK(read_json(&s, cases[i].json, &told) == -EINVAL && s.node_count == 0);
		if (!strstr(diagnostics_cause(&told, 0), cases[i].told))
			fail_msg("case %zu: %s", i, diagnostics_cause(&told, 0));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(layers_have_titles_and_scenes),
		cmocka_unit_test(without_scenes_there_is_no_scenery),
		cmocka_unit_test(every_fault_names_its_line),
	};

	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
