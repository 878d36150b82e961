/* IIIF manifests as alignments: where models land, which files they are, and what is left out. */
#include "pipeline/import/manifest.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <sys/stat.h>

#include "pipeline/content/content.h"
#include "pipeline/import/alignment.h"
#include "pipeline/import/import.h"
#include "tests/check.h"
#include "tests/pipeline/import/scan_text.h"

#define SCENE(members, annotations)                                                                \
	"{\"type\": \"Manifest\", \"items\": [{\"id\": \"s\", \"type\": \"Scene\"" members         \
	", \"items\": [{\"type\": \"AnnotationPage\", \"items\": [\n" annotations "\n]}]}]}"
#define PAINTING(body, target)                                                                      \
	"{\"id\": \"a\", \"type\": \"Annotation\", \"motivation\": [\"painting\"], \"body\": " body \
	", \"target\": " target "}"
#define MODEL "{\"id\": \"https://example.org/x/in/d.glb\", \"type\": \"Model\"}"
#define MOVED(list)                                                                                \
	"{\"type\": \"SpecificResource\", \"source\": [" MODEL "], \"transform\": [" list "]}"
#define AT(xyz)                                                                                    \
	"{\"type\": \"SpecificResource\", \"source\": {\"id\": \"s\"}, \"selector\": "             \
	"[{\"type\": \"PointSelector\", " xyz "}]}"
#define TURN(xyz)    "{\"type\": \"RotateTransform\", " xyz "}"
#define SHIFT(xyz)   "{\"type\": \"TranslateTransform\", " xyz "}"
#define SCALE(xyz)   "{\"type\": \"ScaleTransform\", " xyz "}"
#define PLACED(list) SCENE("", PAINTING(MOVED(list), AT("\"x\": 10, \"y\": 20, \"z\": 30")))

static struct diagnostics told;

/* Reads text as scene.json, beside in/d.glb and a.glb. */
static int read_text(struct alignment *out, const char *text)
{
	char path[256], folder[300];
	int rc;

	told = (struct diagnostics){ 0 };
	scan_write(path, "scene.json", text, strlen(text));
	snprintf(folder, sizeof(folder), "%.*s/in", (int)(strrchr(path, '/') - path), path);
	CHECK(mkdir(folder, 0700) == 0);
	scan_write_beside(path, "in/d.glb", "glTF", 4);
	scan_write_beside(path, "a b.glb", "glTF", 4);
	rc = alignment_read(out, path, &told);
	scan_remove(path);
	return rc;
}

static void check_at(const struct transform *transform, double x, double y, double z, double to_x,
		     double to_y, double to_z)
{
	const double from[3] = { x, y, z };
	double to[3];

	transform_point(transform, from, to);
	if (fabs(to[0] - to_x) > 1e-12 || fabs(to[1] - to_y) > 1e-12 || fabs(to[2] - to_z) > 1e-12)
		fail_msg("at %g %g %g, not %g %g %g", to[0], to[1], to[2], to_x, to_y, to_z);
}

/* Each case: where (1 2 3) of the model comes to. */
static void places_models_by_transforms_in_their_order(void **state)
{
	static const struct {
		const char *text;
		double to[3];
	} cases[] = {
		{ SCENE("", PAINTING(MODEL, "\"s\"")), { 1, 2, 3 } },
		{ SCENE("", PAINTING(MODEL, AT("\"y\": 20"))), { 1, 22, 3 } },
		{ PLACED(TURN("\"y\": 90")), { 13, 22, 29 } },
		{ PLACED(TURN("\"x\": 90")), { 11, 17, 32 } },
		{ PLACED(TURN("\"z\": -90")), { 12, 19, 33 } },
		{ PLACED(TURN("\"x\": 90, \"y\": 90")), { 13, 21, 32 } }, /* Rx * Ry */
		{ PLACED(SHIFT("\"x\": 1") "," TURN("\"y\": 180")), { 8, 22, 27 } },
		{ PLACED(TURN("\"y\": 180") "," SHIFT("\"x\": 1")), { 10, 22, 27 } },
		{ PLACED(SCALE("\"x\": 2, \"z\": 3") "," SHIFT("\"x\": 5")), { 17, 22, 39 } },
		{ PLACED(SHIFT("\"x\": 5") "," SCALE("\"x\": 2")), { 22, 22, 33 } },
		{ PLACED(SCALE("\"x\": -1")), { 9, 22, 33 } },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct alignment alignment;

		if (read_text(&alignment, cases[i].text) < 0)
			fail_msg("%s", told.first.text);
		CHECK(alignment.count == 1 && alignment.y_is_up && alignment.left_out.count == 0);
		CHECK(strstr(alignment.scans[0].path, "/in/d.glb"));
		check_at(&alignment.scans[0].transform, 1, 2, 3, cases[i].to[0], cases[i].to[1],
			 cases[i].to[2]);
		CHECK(transform_mirrors(&alignment.scans[0].transform) ==
		      (strstr(cases[i].text, "\"x\": -1}") != NULL));
		alignment_finish(&alignment);
	}
}

static void takes_a_model_as_often_as_it_is_painted(void **state)
{
	struct alignment alignment;
	(void)state;

	CHECK(read_text(&alignment,
			SCENE("", PAINTING(MODEL, "\"s\"") "," PAINTING(
					  "\"a%20b.glb\"",
					  AT("\"x\": 1")) "," PAINTING(MODEL, AT("\"x\": 2")))) ==
	      0);
	CHECK(alignment.count == 3 && strstr(alignment.scans[1].path, "/a b.glb"));
	CHECK(strcmp(alignment.scans[0].path, alignment.scans[2].path) == 0);
	check_at(&alignment.scans[2].transform, 0, 0, 0, 2, 0, 0);
	alignment_finish(&alignment);
}

static void multiplies_scenes_in_scenes(void **state)
{
	static const char text[] =
		"{\"type\": \"Manifest\", \"items\": [\n"
		"{\"id\": \"s\", \"type\": \"Scene\", \"items\": [{\"items\": [" PAINTING(
			MODEL,
			AT("\"x\": 1")) "]}]},\n"
					"{\"id\": \"t\", \"type\": \"Scene\", \"items\": [{\"items\": [" PAINTING(
						"{\"type\": \"SpecificResource\", \"source\": {\"id\": \"s\", \"type\": "
						"\"Scene\"}, \"transform\": [" TURN(
							"\"y\": 90") "]}",
						AT("\"y\": 5")) "]}]}]}";
	struct alignment alignment;
	(void)state;

	if (read_text(&alignment, text) < 0)
		fail_msg("%s", told.first.text);
	CHECK(alignment.count == 1 && alignment.left_out.count == 0);
	check_at(&alignment.scans[0].transform, 0, 0, 0, 0, 5, -1);
	alignment_finish(&alignment);
}

static void refuses_what_cannot_be_read(void **state)
{
	static const struct {
		const char *text, *words;
		unsigned line;
		int error;
	} cases[] = {
		{ "", "is empty", 1, -EBADMSG },
		{ "{\n", "is not valid JSON", 2, -EBADMSG },
		{ "[]", "no IIIF manifest", 1, -EBADMSG },
		{ "{\"type\": \"Collection\"}", "no IIIF manifest", 1, -EBADMSG },
		{ "{\"type\": \"Manifest\", \"items\": []}", "no scene", 1, -EBADMSG },
		{ SCENE("", ""), "no model", 1, -EBADMSG },
		{ SCENE("", PAINTING("{\"type\": \"Model\"}", "\"s\"")), "without an address", 2,
		  -EBADMSG },
		{ SCENE("", PAINTING("\"https://example.org/y/e.glb\"", "\"s\"")),
		  "https://example.org/y/e.glb is not beside the manifest; fetch it and put it "
		  "there as e.glb",
		  2, -ENOENT },
		{ SCENE("", PAINTING("\"https://example.org/../../etc/a.glb\"", "\"s\"")),
		  "is not beside", 2, -ENOENT },
		{ PLACED(SCALE("\"x\": 0")), "flattens", 2, -EBADMSG },
		{ PLACED(TURN("\"x\": 1e999")), "finite", 2, -EBADMSG },
		{ "{\"type\": \"Manifest\", \"items\": [{\"id\": \"s\", \"type\": \"Scene\", "
		  "\"items\": [{\"items\": [\n" PAINTING("{\"id\": \"s\"}", "\"s\"") "]}]}]}",
		  "more than 4 deep", 2, -EFBIG },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct alignment alignment;
		const int rc = read_text(&alignment, cases[i].text);

		if (rc != cases[i].error || !strstr(told.first.text, cases[i].words) ||
		    told.first.line != cases[i].line)
			fail_msg("case %zu: %d, line %u: '%s'", i, rc, told.first.line,
				 told.first.text);
		CHECK(alignment.count == 0 && !alignment.scans);
	}
}

static void names_what_has_no_place(void **state)
{
#define THING(type) PAINTING("{\"id\": \"thing\", \"type\": \"" type "\"}", "\"s\"")
	static const struct {
		const char *text, *words;
		unsigned line;
	} cases[] = {
		{ SCENE("", THING("SpotLight")), "SpotLight thing is left out", 2 },
		{ SCENE("", THING("Canvas")), "Canvas thing is left out", 2 },
		{ SCENE("", THING("Video")), "Video thing is left out", 2 },
		{ SCENE("", PAINTING("{\"type\": \"PerspectiveCamera\", \"lookAt\": {\"type\": "
				     "\"PointSelector\", \"x\": 7}}",
				     AT("\"y\": 1, \"z\": 4"))),
		  "start = eye 0 -4 1 target 7 0 0", 2 },
		{ SCENE(", \"backgroundColor\": \"#102030\"", ""), "backgroundColor #102030", 1 },
		{ SCENE(", \"duration\": 3", ""), "\"duration\" of s", 1 },
		{ SCENE("", "{\"id\": \"b\", \"motivation\": \"linking\"}"), "annotation b", 2 },
		{ PLACED("{\"type\": \"ShearTransform\"}"), "type ShearTransform", 2 },
		{ SCENE("", PAINTING(MODEL, "{\"type\": \"SpecificResource\", \"selector\": "
					    "{\"type\": \"PolygonZSelector\"}}")),
		  "type PolygonZSelector", 2 },
		{ SCENE("", "{\"type\": \"Choice\", \"items\": [" THING("AmbientLight") "]}"),
		  "the Choice", 2 },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		char text[2000];
		const char *end = strstr(cases[i].text, "\n]}]}]}");
		const bool is_empty = end[-1] == '\n' || strstr(end - 2, "[\n\n");
		struct alignment alignment;
		const struct diagnostic *first;

		/* and a model, last of the scene */
		snprintf(text, sizeof(text), "%.*s%s\n%s%s", (int)(end - cases[i].text),
			 cases[i].text, is_empty ? "" : ",", PAINTING(MODEL, "\"s\""), end);
		if (read_text(&alignment, text) < 0)
			fail_msg("case %zu: %s", i, told.first.text);
		first = diagnostics_get(&alignment.left_out, 0);
		if (alignment.left_out.count == 0 || !strstr(first->text, cases[i].words) ||
		    first->line != cases[i].line || first->error != 0)
			fail_msg("case %zu: line %u: '%s'", i, first->line, first->text);
		alignment_finish(&alignment);
	}
}

/* In a content folder: the model's up is y, and lands in metres with z up. */
static void lands_in_a_content_folder(void **state)
{
	static const char text[] =
		SCENE("", PAINTING(MOVED(TURN("\"y\": 90")), AT("\"x\": 1, \"y\": 2, \"z\": 3")));
	static const float corner[3] = { 1, 0, 0 };
	struct diagnostics found = { 0 };
	struct import_options options;
	struct content content;
	char path[256], folder[256];
	float at_m[3];
	(void)state;

	scan_write(path, "temple.ini", "[model]\nscans = scene.json\n", 27);
	snprintf(folder, sizeof(folder), "%.*s", (int)(strrchr(path, '/') - path), path);
	scan_write_beside(path, "scene.json", text, strlen(text));
	scan_write_beside(path, "d.glb", "glTF", 4);
	CHECK(content_read(&content, folder, &found) == -EINVAL);
	CHECK(strstr(found.first.text, "write 'up = y'"));
	scan_write_beside(path, "temple.ini", "[model]\nscans = scene.json\nup = y\nunit = cm\n",
			  44);
	found = (struct diagnostics){ 0 };
	if (content_read(&content, folder, &found) < 0)
		fail_msg("%s", found.first.text);
	CHECK(content.scan_count == 1 && content.transforms[0]);
	options = content.import;
	options.transform = content.transforms[0];
	import_place(at_m, corner, &options);
	CHECK(fabsf(at_m[0] - 0.01f) < 1e-6f && fabsf(at_m[1] + 0.02f) < 1e-6f &&
	      fabsf(at_m[2] - 0.02f) < 1e-6f);
	content_release(&content);
	scan_remove(path);
}

/* A real model, read from its file: its box, turned, mirrored and placed, in metres with z up. */
static void imports_a_model_in_its_place(void **state)
{
	static const char gltf[] =
		"{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
		"\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":"
		"{\"POSITION\":0}}]}],\"buffers\":[{\"uri\":\"t.bin\",\"byteLength\":36}],"
		"\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,"
		"\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],"
		"\"max\":[1,2,4]}]}";
	static const float corners[3][3] = { { 0, 0, 0 }, { 1, 0, 4 }, { 1, 2, 4 } };
	static const char text[] = SCENE(
		"", PAINTING("{\"type\": \"SpecificResource\", \"source\": {\"id\": "
			     "\"https://example.org/t.gltf\", \"type\": \"Model\"}, \"transform\": "
			     "[" SCALE("\"x\": -1") "," TURN("\"y\": 90") "]}",
			     AT("\"x\": 10, \"y\": 20, \"z\": 30")));
	/* x becomes -x; then z points to x and x to -z; then z up: x, -z, y */
	static const float low[3] = { 10, -31, 20 }, high[3] = { 14, -30, 22 };
	struct import_options options = { .up = IMPORT_Y_UP };
	struct import_report report;
	struct alignment alignment;
	struct mesh mesh;
	float low_m[3], high_m[3];
	char path[256];
	(void)state;

	told = (struct diagnostics){ 0 };
	scan_write(path, "scene.json", text, strlen(text));
	scan_write_beside(path, "t.gltf", gltf, strlen(gltf));
	scan_write_beside(path, "t.bin", corners, sizeof(corners));
	if (alignment_read(&alignment, path, &told) < 0)
		fail_msg("%s", told.first.text);
	options.transform = &alignment.scans[0].transform;
	if (import_scan(&mesh, alignment.scans[0].path, &options, &report, &told) < 0)
		fail_msg("%s", told.first.text);
	mesh_box(&mesh, low_m, high_m);
	for (int k = 0; k < 3; k++)
		CHECK(fabsf(low_m[k] - low[k]) < 1e-5f && fabsf(high_m[k] - high[k]) < 1e-5f);
	mesh_finish(&mesh);
	alignment_finish(&alignment);
	scan_remove(path);
}

/* ---- the manifests that the IIIF 3D group published, where they are */

struct tally {
	uint32_t whole, in_part, without_scene, empty, other;
};

static void read_published(struct tally *tally, const char *manifest)
{
	static const char *const models[] = { "astronaut.glb", "tipped_astronaut.glb",
					      "whale_cranium.glb", "whale_mandible.glb",
					      "lamp_post.glb" };
	struct diagnostics found = { 0 };
	struct alignment alignment;
	struct buffer text;
	char path[256];
	int rc;

	buffer_init(&text, 1 << 20);
	CHECK(buffer_read_file(&text, manifest) == 0);
	scan_write(path, "scene.json", text.data, text.size);
	for (size_t i = 0; i < ARRAY_COUNT(models); i++)
		scan_write_beside(path, models[i], "glTF", 4);
	rc = alignment_read(&alignment, path, &found);
	tally->whole += rc == 0 && alignment.left_out.count == 0;
	tally->in_part += rc == 0 && alignment.left_out.count > 0;
	tally->empty += rc < 0 && strstr(found.first.text, "is empty") != NULL;
	tally->without_scene += rc < 0 && strstr(found.first.text, "no scene") != NULL;
	if (rc < 0 && !strstr(found.first.text, "is empty") &&
	    !strstr(found.first.text, "no scene")) {
		print_message("%s: %s\n", manifest, found.first.text);
		tally->other++;
	}
	alignment_finish(&alignment);
	buffer_finish(&text);
	scan_remove(path);
}

/* The counts are those of docs/iiif.md. */
static void opens_the_published_manifests(void **state)
{
	static const char root[] = "../shared/conformance/iiif3d/manifests";
	struct dirent **folders, **files;
	const int folder_count = scandir(root, &folders, NULL, alphasort);
	struct tally tally = { 0 };
	(void)state;

	if (folder_count < 0) {
		print_message("%s is not here\n", root);
		skip();
	}
	for (int i = 0; i < folder_count; i++) {
		char folder[600], file[900];
		int count;

		snprintf(folder, sizeof(folder), "%s/%s", root, folders[i]->d_name);
		count = folders[i]->d_name[0] == '.' ? 0 : scandir(folder, &files, NULL, alphasort);
		for (int k = 0; k < count; k++) {
			const size_t length = strlen(files[k]->d_name);

			snprintf(file, sizeof(file), "%s/%s", folder, files[k]->d_name);
			if (length > 5 && strcmp(files[k]->d_name + length - 5, ".json") == 0)
				read_published(&tally, file);
			free(files[k]);
		}
		if (count > 0)
			free(files);
		free(folders[i]);
	}
	free(folders);
	if (tally.whole != 13 || tally.in_part != 16 || tally.without_scene != 14 ||
	    tally.empty != 3 || tally.other != 0)
		fail_msg("%u whole, %u in part, %u without scene, %u empty, %u other", tally.whole,
			 tally.in_part, tally.without_scene, tally.empty, tally.other);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(places_models_by_transforms_in_their_order),
		cmocka_unit_test(takes_a_model_as_often_as_it_is_painted),
		cmocka_unit_test(multiplies_scenes_in_scenes),
		cmocka_unit_test(refuses_what_cannot_be_read),
		cmocka_unit_test(names_what_has_no_place),
		cmocka_unit_test(lands_in_a_content_folder),
		cmocka_unit_test(imports_a_model_in_its_place),
		cmocka_unit_test(opens_the_published_manifests),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
