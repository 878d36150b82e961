/* Parts as W3C Web Annotations and back: nothing is lost on the way, and what other tools write is
 * taken where it can be and refused by name where it cannot. */
#include "pipeline/content/annotations.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <unistd.h>

#include "pipeline/content/annotations_export.h"
#include "pipeline/content/annotations_import.h"
#include "pipeline/import/alignment.h"
#include "pipeline/import/import.h"
#include "tests/pipeline/content/info_folder.h"

static char copy[100], file[100]; /* where imports go, and what they read */

static int set_up_exchange(void **state)
{
	int rc = set_up(state);

	write_text(
		"parts.json",
		"{\"credits\": {\"rights\": {\"en\": \"© The museum\", \"km\": \"© សារមន្ទីរ\"}},\n"
		"\"parts\": [\n"
		"{\"id\": \"tower\", \"region\": {\"kind\": \"box\", \"centre\": [0, 1.1, 20],\n"
		" \"half\": [3, 4, 5], \"turn\": 45}, \"anchor\": [0.1, 1e-7, 25],\n"
		" \"title\": {\"en\": \"Tower\", \"km\": \"ប្រាង្គ\"}, \"reading\": {\"km\": \"prang\"},\n"
		" \"caption\": {\"en\": \"\\\"High\\\"\"}, \"thumbnail\": \"pictures/a.png\",\n"
		" \"credits\": {\"creator\": [\"A\", \"B\"], \"date\": \"1150\"}},\n"
		"{\"id\": \"gate\", \"region\": {\"kind\": \"prism\", \"floor\": 0, \"roof\": 4,\n"
		" \"corners\": [[0, 0], [0, 2], [2, 2], [2, 0]]}, \"title\": {\"en\": \"Gate\"}},\n"
		"{\"id\": \"bud\", \"region\": {\"kind\": \"sphere\", \"centre\": [1, 2, 3],\n"
		" \"radius\": 0.5}, \"page\": false, \"title\": {\"en\": \"Bud\"}},\n"
		"{\"id\": \"spot\", \"region\": {\"kind\": \"point\", \"centre\": [1, 2, 3]},\n"
		" \"anchor\": [4, 5, 6], \"page\": false, \"title\": {\"en\": \"Spot\"}},\n"
		"{\"id\": \"naga\", \"anchor\": [5, 6, 7], \"page\": false,\n"
		" \"title\": {\"en\": \"Naga\"}},\n"
		"{\"id\": \"lintel\", \"region\": {\"kind\": \"faces\", \"file\":\n"
		" \"regions/lintel.faces\", \"scan\": \"gate.ply\"}, \"anchor\": [6, 7, 8],\n"
		" \"page\": false, \"title\": {\"en\": \"Lintel\"}}\n"
		"]}\n");
	snprintf(copy, sizeof(copy), "%s/copy", folder);
	snprintf(file, sizeof(file), "%s/exchange.jsonld", folder);
	return rc;
}

static int export_from(struct annotations *out, const char *from)
{
	const struct annotations_export_options options = { .folder = from, .diagnostics = &told };

	diagnostics_finish(&told);
	return annotations_export(out, &options);
}

static int import_with(struct annotations_imported *report, bool y_is_up, bool skip_unknown)
{
	const struct annotations_import_options options = { .file = file,
							    .folder = copy,
							    .y_is_up = y_is_up,
							    .skip_unknown = skip_unknown,
							    .diagnostics = &told };

	diagnostics_finish(&told);
	return annotations_import(report, &options);
}

static void read_copy(struct buffer *out, const char *name)
{
	char path[200];

	snprintf(path, sizeof(path), "%s/%s", copy, name);
	buffer_init(out, 1 << 20);
	if (buffer_read_file(out, path) < 0)
		fail_msg("%s is not there", path);
	buffer_put_u8(out, 0);
}

static bool copy_says(const char *name, const char *words)
{
	struct buffer text;
	bool found;

	read_copy(&text, name);
	found = strstr((char *)text.data, words) != NULL;
	buffer_finish(&text);
	return found;
}

static void comes_back_byte_for_byte(void **state)
{
	struct annotations first, second;
	struct annotations_imported report;
	struct buffer page;

	(void)state;
	CHECK(export_from(&first, folder) == 0);
	CHECK(first.count == 6 && first.picture_count == 2);
	write_file("exchange.jsonld", first.json.data, first.json.size);
	if (import_with(&report, false, false) != 0)
		fail_msg("%s", told.first.text);
	CHECK(report.part_count == 6 && report.page_count == 3 && report.picture_count == 2);
	CHECK(export_from(&second, copy) == 0);
	CHECK(second.json.size == first.json.size);
	CHECK(memcmp(second.json.data, first.json.data, first.json.size) == 0);
	read_copy(&page, "pages/tower.en.html");
	CHECK(strstr((char *)page.data, "<h1>Central tower</h1>\n<p>Above the <a"));
	buffer_finish(&page);
	CHECK(strstr((char *)first.json.data, "FaceListSelector"));
	CHECK(copy_says("parts.json", "\"regions/lintel.faces\""));
	annotations_finish(&first);
	annotations_finish(&second);
	annotations_finish(NULL);
}

/* And the links to them, which are faults where they are not there. */
static void tours_come_back_with_the_parts(void **state)
{
	static const char tours[] =
		"{\"tours\": [{\"id\": \"walk\", \"title\": {\"en\": \"A walk\"},\n"
		"\"thumbnail\": \"pictures/b.png\", \"stops\": [\n"
		"{\"eye\": [1, 2.5, 3], \"target\": [4, 5, 6]}, {\"part\": \"tower\"}]}]}";
	struct annotations first, second;
	struct annotations_imported report;

	(void)state;
	write_text("tours.json", tours);
	write_text("pages/tower.en.html", "<p>Take <a href=\"tour:walk\">a walk</a>.</p>");
	CHECK(export_from(&first, folder) == 0);
	CHECK(first.picture_count == 2); /* one that only the tour shows */
	write_file("exchange.jsonld", first.json.data, first.json.size);
	if (import_with(&report, false, false) != 0)
		fail_msg("%s", told.first.text);
	CHECK(copy_says("tours.json", "2.5"));
	CHECK(export_from(&second, copy) == 0);
	CHECK(second.json.size == first.json.size);
	CHECK(memcmp(second.json.data, first.json.data, first.json.size) == 0);
	annotations_finish(&first);
	annotations_finish(&second);
	write_text("tours.json", "{\"tours\": [{\"id\": \"walk\"}]}");
	CHECK(export_from(&first, folder) == -EINVAL);
	CHECK(was_told("tours.json", 1, "no title in"));
}

/* What the standards ask for, and where our own terms are used. */
static void writes_what_the_standards_name(void **state)
{
	struct annotations annotations;
	const cJSON *item, *context, *selector;
	cJSON *json;

	(void)state;
	CHECK(export_from(&annotations, folder) == 0);
	json = cJSON_ParseWithLength((char *)annotations.json.data, annotations.json.size);
	context = cJSON_GetObjectItem(json, "@context");
	CHECK(strcmp(cJSON_GetArrayItem(context, 0)->valuestring,
		     "http://www.w3.org/ns/anno.jsonld") == 0);
	CHECK(strcmp(cJSON_GetObjectItem(json, "type")->valuestring, "AnnotationCollection") == 0);
	CHECK(cJSON_GetObjectItem(json, "total")->valueint == 6);
	item = cJSON_GetArrayItem(cJSON_GetObjectItem(cJSON_GetObjectItem(json, "first"), "items"),
				  0);
	CHECK(strcmp(cJSON_GetObjectItem(item, "type")->valuestring, "Annotation") == 0);
	CHECK(cJSON_GetArraySize(cJSON_GetObjectItem(item, "dcterms:creator")) == 2);
	selector = cJSON_GetObjectItem(cJSON_GetObjectItem(item, "target"), "selector");
	CHECK(strcmp(cJSON_GetObjectItem(cJSON_GetArrayItem(selector, 0), "type")->valuestring,
		     "BoxSelector") == 0);
	CHECK(cJSON_GetObjectItem(cJSON_GetArrayItem(selector, 1), "x")->valuedouble == 0.1);
	/* Every term of ours that is used is in the context. */
	for (const cJSON *s = selector->child; s; s = s->next)
		for (const cJSON *member = s->child; member; member = member->next)
			CHECK(strcmp(member->string, "type") == 0 ||
			      cJSON_HasObjectItem(cJSON_GetArrayItem(context, 1), member->string));
	cJSON_Delete(json);
	annotations_finish(&annotations);
}

static void refuses_a_folder_that_is_at_fault(void **state)
{
	struct annotations annotations;
	char path[200];

	(void)state;
	write_text("pages/gate.en.html", "<p>x</p>\n<script></script>");
	CHECK(export_from(&annotations, folder) == -EINVAL);
	CHECK(was_told("pages/gate.en.html", 2, "<script>"));
	write_text("parts.json", "{\"parts\": [\n,]}");
	CHECK(export_from(&annotations, folder) == -EINVAL);
	CHECK(was_told("parts.json", 2, "not valid JSON"));
	snprintf(path, sizeof(path), "%s/parts.json", folder);
	unlink(path);
	CHECK(export_from(&annotations, folder) == -ENOENT);
}

/* As an IIIF viewer writes: y up, an agent as creator, HTML as a comment. */
static void takes_what_another_tool_wrote(void **state)
{
	struct annotations_imported report;

	(void)state;
	write_text(
		"exchange.jsonld",
		"{\"@context\": \"http://iiif.io/api/presentation/4/context.json\",\n"
		"\"id\": \"https://example.org/page/1\", \"type\": \"AnnotationPage\",\n"
		"\"items\": [\n"
		"{\"id\": \"https://example.org/Anno/East Gate\", \"type\": \"Annotation\",\n"
		" \"motivation\": [\"commenting\"],\n"
		" \"creator\": {\"type\": \"Person\", \"name\": \"A. Scholar\"},\n"
		" \"rights\": \"https://creativecommons.org/licenses/by/4.0/\",\n"
		" \"body\": [{\"type\": \"TextualBody\", \"purpose\": \"tagging\",\n"
		"  \"value\": \"East gate\"},\n"
		"  {\"type\": \"TextualBody\", \"purpose\": \"commenting\", \"language\": [\"en\"],\n"
		"  \"format\": \"text/html\", \"value\": \"<p>One enters here.</p>\"},\n"
		"  {\"type\": \"Image\", \"id\": \"https://example.org/a.jpg\"}],\n"
		" \"target\": {\"source\": [{\"id\": \"https://example.org/scene\", \"type\":\n"
		"  \"Scene\"}], \"selector\": [{\"type\": \"PointSelector\", \"x\": 1, \"y\": 2,\n"
		"  \"z\": 3}]}}]}\n");
	if (import_with(&report, true, false) != 0)
		fail_msg("%s", diagnostics_get(&told, told.count - 1)->text);
	CHECK(report.part_count == 1 && report.page_count == 1);
	CHECK(told.count >= 1 && told.first.error == 0); /* the image */
	CHECK(copy_says("parts.json", "\"id\":\t\"east-gate\""));
	CHECK(copy_says("parts.json", "[1, -3, 2]"));
	CHECK(copy_says("parts.json", "\"creator\":\t\"A. Scholar\""));
	CHECK(copy_says("parts.json", "licenses/by/4.0"));
	CHECK(copy_says("pages/east-gate.en.html", "<p>One enters here.</p>"));
}

#define ITEM(id, selector)                                                                         \
	"{\"id\": \"" id "\", \"type\": \"Annotation\", \"body\": {\"type\": \"TextualBody\","     \
	" \"purpose\": \"identifying\", \"value\": \"x\"}, \"target\": {\"selector\": " selector   \
	"}}"
#define POINT "{\"type\": \"PointSelector\", \"x\": 1, \"y\": 2, \"z\": 3}"
#define SVG   "{\"type\": \"SvgSelector\", \"value\": \"<svg/>\"}"

static bool nothing_is_left(void)
{
	return access(copy, F_OK) < 0;
}

#define WITH_PAGE(html)                                                                            \
	"{\"id\": \"#gate\", \"body\": [{\"value\": \"x\", \"purpose\": \"tagging\"}, "            \
	"{\"value\": \"" html "\", \"format\": \"text/html\"}], \"target\": {\"selector\": " POINT \
	"}}"

static void names_the_place_of_what_it_refuses(void **state)
{
	static const struct {
		const char *text, *words;
		unsigned line;
	} cases[] = {
		{ "{\"items\": [\n", "not valid JSON", 2 },
		{ "{\"items\": [\n\"caf\xe9\"]}", "not UTF-8", 2 },
		{ "{\"type\": \"Collection\"}", "holds no annotations", 1 },
		{ "{\"type\": \"Manifest\"}", "no scene", 1 },
		{ "{\"first\": \"https://example.org/1\"}", "is elsewhere", 1 },
		{ "{\"first\": {\"items\": [], \"next\": \"x\"}}", "more pages", 1 },
		{ "{\"items\": [\n" ITEM("#a", POINT) ",\n" ITEM("#b", SVG) "]}", "SvgSelector",
		  3 },
		{ "{\"items\": [\n{\"id\": \"#a\", \"target\": \"https://example.org/x\"}]}",
		  "without selector", 2 },
		{ "{\"items\": [\n" ITEM("#a", POINT) ",\n" ITEM("x/A", POINT) "]}",
		  "part \"a\" already", 3 },
		{ "{\"items\": [\n" ITEM("", POINT) "]}", "without an id", 2 },
		{ "{\"items\": [\n" WITH_PAGE("<p>1</p>") ",\n" WITH_PAGE("<p>2</p>") "]}",
		  "two texts for pages/gate.en.html", 3 },
		{ "{\"items\": [\n\n{\"id\": \"#a\", \"target\": {\"selector\": " POINT "}}]}",
		  "has no title", 3 },
		{ "{\"items\": [\n{\"id\": \"#a\", \"body\": [{\"value\": \"x\", \"purpose\": "
		  "\"tagging\", \"language\": \"../x\"}], \"target\": {\"selector\": " POINT "}}]}",
		  "not a language code", 2 },
		{ "{\"items\": [\n{\"id\": \"#a\", \"body\": [{\"value\": \"x\", \"purpose\": "
		  "\"tagging\"}, {\"value\": \"y\", \"purpose\": \"identifying\"}], \"target\": "
		  "{\"selector\": " POINT "}}]}",
		  "two titles", 2 },
	};
	struct annotations_imported report;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		write_text("exchange.jsonld", cases[i].text);
		if (import_with(&report, false, false) != -EINVAL)
			fail_msg("case %zu was taken", i);
		if (!was_told(file, cases[i].line, cases[i].words))
			fail_msg("case %zu: \"%s\" at line %u", i, told.first.text,
				 told.first.line);
		CHECK(nothing_is_left());
	}
}

/* More annotations than a release has parts, and more bodies than a part has texts: refused where
 * there are too many, before comparing each with all others takes hours. */
static void refuses_more_than_a_release_can_have(void **state)
{
	struct annotations_imported report;
	struct buffer text;

	(void)state;
	buffer_init(&text, 1 << 20);
	buffer_put_text(&text, "[");
	for (int i = 0; i <= INFO_PARTS_MAX; i++) {
		char item[300];

		snprintf(item, sizeof(item), "%s\n" ITEM("#a%d", POINT), i ? "," : "", i);
		buffer_put_text(&text, item);
	}
	buffer_put_text(&text, "]");
	buffer_put_u8(&text, 0);
	write_text("exchange.jsonld", (char *)text.data);
	CHECK(import_with(&report, false, false) == -EINVAL);
	CHECK(was_told(file, INFO_PARTS_MAX + 2, "at most as many parts"));
	CHECK(nothing_is_left());

	text.size = 0;
	buffer_put_text(&text,
			"{\"id\": \"#a\", \"target\": {\"selector\": " POINT "}, \"body\": [{}");
	for (int i = 0; i < 20 * INFO_LANGUAGES_MAX; i++)
		buffer_put_text(&text, ", {}");
	buffer_put_text(&text, "]}");
	buffer_put_u8(&text, 0);
	write_text("exchange.jsonld", (char *)text.data);
	CHECK(import_with(&report, false, false) == -EINVAL);
	CHECK(was_told(file, 1, "over 1280 bodies"));
	buffer_finish(&text);
}

/* The folder of the file may be a stranger's. */
static void brings_in_no_picture_that_is_a_link(void **state)
{
	struct annotations_imported report;
	char link[200];

	(void)state;
	write_text("exchange.jsonld", ITEM("#a", POINT));
	snprintf(link, sizeof(link), "%s/pictures/private.png", folder);
	CHECK(symlink("/etc/passwd", link) == 0);
	CHECK(import_with(&report, false, false) == -EINVAL);
	CHECK(was_told(file, 0, "pictures/private.png cannot be read"));
	CHECK(nothing_is_left());
	CHECK(unlink(link) == 0);
}

#define COMMENT(id, body, target)                                                                  \
	"{\"id\": \"https://x.org/" id "\", \"type\": \"Annotation\", \"motivation\": "            \
	"[\"commenting\"], " body ", \"target\": {\"source\": {\"id\": \"s\"}, \"selector\": "     \
	"[{\"type\": " target "}]}}"
#define ON_POINT "\"PointSelector\", \"x\": 1, \"y\": 2, \"z\": 3"
#define SAID(t)  "{\"type\": \"TextualBody\", " t "}"

#define EYE COMMENT("1/eye", "\"bodyValue\": \"Eye\"", ON_POINT)
#define BROW                                                                                                                               \
	COMMENT("2/eye",                                                                                                                   \
		"\"body\": [{\"type\": \"Choice\", \"items\": [" SAID("\"value\": \"Brow\", \"language\": \"en\"") "," SAID(               \
			"\"value\": \"Front\", \"language\": \"fr\"") "]}, " SAID("\"value\": \"It is high.\", \"language\": \"en\"") "]", \
		"\"PolygonZSelector\", \"value\": \"POLYGONZ((0 1 0, 2 1 0, 2 1 2, 0 1 0))\"")
#define WALL                                                                                       \
	COMMENT("wall",                                                                            \
		"\"body\": " SAID(                                                                 \
			"\"format\": \"text/html\", \"value\": \"<p>A text of more than "          \
			"sixty characters&nbsp;&amp; with <i>an end</i> that a title "             \
			"has no room for</p>\""),                                                  \
		"\"PolygonZSelector\", \"value\": \"POLYGON Z((0 0 0, 2 0 0, 2 2 0, 0 2 0))\"")
#define NONE COMMENT("none", "\"bodyValue\": \"None\"", "\"SvgSelector\"")
#define LID                                                                                        \
	COMMENT("list",                                                                            \
		"\"body\": [" SAID("\"value\": \"Lid\", \"language\": \"en\"") ", " SAID(          \
			"\"value\": \"Paupière\", \"language\": \"fr\"") "]",                      \
		ON_POINT)

static void takes_the_comments_of_a_manifest(void **state)
{
	struct annotations_imported report;

	(void)state;
	write_text(
		"exchange.jsonld",
		"{\"type\": \"Manifest\", \"items\": [{\"id\": \"s\", \"type\": \"Scene\",\n"
		"\"items\": [{\"items\": [{\"id\": \"m\", \"motivation\": \"painting\", \"body\":\n"
		"{\"id\": \"c\", \"type\": \"PerspectiveCamera\"}, \"target\": {\"selector\": "
		"{\"type\": \"PointSelector\", \"z\": 9}}}]}],\n"
		"\"annotations\": [{\"items\": [\n" EYE ",\n" BROW ",\n" WALL ",\n" NONE ",\n" LID
		"]}]}]}\n");
	if (import_with(&report, false, false) != 0)
		fail_msg("%s", told.first.text);
	CHECK(report.part_count == 4 && report.page_count == 1 && report.skipped_count == 1);
	CHECK(copy_says("parts.json", "\"id\":\t\"eye\",\n\t\t\t\"anchor\":\t[1, -3, 2]"));
	CHECK(copy_says("parts.json", "\"id\":\t\"eye-2\""));
	CHECK(copy_says("parts.json", "\"fr\":\t\"Front\""));
	CHECK(copy_says("parts.json", "\"en\":\t\"Lid\",\n\t\t\t\t\"fr\":\t\"Paupière\""));
	CHECK(copy_says("parts.json", "\"en\":\t\"It is high.\""));
	CHECK(copy_says("parts.json", "\"corners\":\t[[0, 0], [2, 0], [2, -2]]"));
	CHECK(copy_says("parts.json", "\"floor\":\t0.9,\n"));
	CHECK(copy_says("parts.json", "\"centre\":\t[1, 0, 1]"));
	CHECK(copy_says("parts.json",
			"\"A text of more than sixty characters & with an end that a…\""));
	CHECK(copy_says("pages/wall.en.html", "<i>an end</i>"));
	/* four are read from one camera, one has no place; what has no French title is told after
	 */
	CHECK(told.count > 4 && told.error_count == 0);
	CHECK(strstr(diagnostics_get(&told, 0)->text, "start = eye 0 -9 0 target 1 -3 2"));
	CHECK(strstr(diagnostics_get(&told, 3)->text, "\"https://x.org/none\" is left out"));
	CHECK(diagnostics_get(&told, 3)->line == 8);
}

static int export_manifest_with(struct annotations *out, const char *model)
{
	const struct annotations_export_options options = { .folder = folder,
							    .manifest_base = "https://x.org/t",
							    .manifest_model = model,
							    .diagnostics = &told };

	diagnostics_finish(&told);
	return annotations_export(out, &options);
}

static int export_manifest(struct annotations *out)
{
	return export_manifest_with(out, NULL);
}

/* The parts come back byte for byte, and the scan lies where it lay. */
static void writes_a_manifest_that_comes_back(void **state)
{
	struct annotations first, second, manifest;
	struct annotations_imported report;
	struct alignment alignment;
	const double from[3] = { 1, 2, 3 };
	double to[3];
	char path[200];

	(void)state;
	write_text("temple.ini", "[model]\nscans = a.ply\n");
	write_text("a.ply", "ply\n");
	write_text("parts.json",
		   "{\"parts\": [{\"id\": \"tower\", \"anchor\": [0.1, -1e-7, 25],\n"
		   "\"title\": {\"en\": \"A title of more than sixty characters, which is not cut "
		   "as a caption follows\", \"km\": \"ប្រាង្គ\"}, \"caption\": {\"en\": \"High\"}},\n"
		   "{\"id\": \"bud\", \"anchor\": [4, 0, 0], \"page\": false,\n"
		   "\"title\": {\"en\": \"Bud\"}}]}\n");
	write_text("pages/tower.en.html", "<p>It is <b>high</b> &amp; old.</p>\n");
	if (export_from(&first, folder) != 0)
		fail_msg("%s", told.first.text);
	if (export_manifest(&manifest) != 0)
		fail_msg("%s", told.first.text);
	CHECK(told.error_count == 0);
	write_file("exchange.jsonld", manifest.json.data, manifest.json.size);
	write_file("exchange.json", manifest.json.data, manifest.json.size);
	if (import_with(&report, false, false) != 0)
		fail_msg("%s", told.first.text);
	CHECK(export_from(&second, copy) == 0);
	CHECK(second.json.size == first.json.size);
	CHECK(memcmp(second.json.data, first.json.data, first.json.size) == 0);
	CHECK(strstr((char *)manifest.json.data, "\"https://x.org/t/a.ply\""));
	snprintf(path, sizeof(path), "%s/exchange.json", folder);
	CHECK(alignment_read(&alignment, path, &told) == 0);
	CHECK(alignment.count == 1 && alignment.left_out.count == 0);
	transform_point(&alignment.scans[0].transform, from, to); /* y up */
	CHECK(to[0] == 1 && to[1] == 3 && to[2] == -2);
	alignment_finish(&alignment);
	annotations_finish(&first);
	annotations_finish(&second);
	annotations_finish(&manifest);
}

/* It stands in metres with y up, whatever the scans' unit and axes. */
static void shows_one_model_in_place_of_the_scans(void **state)
{
	const double from[3] = { 1, 2, 3 };
	struct annotations manifest;
	struct alignment alignment;
	double to[3];
	char path[200];

	(void)state;
	write_text("temple.ini", "[model]\nscans = a.ply, b.ply\nunit = 0.01\n");
	write_text("a.ply", "ply\n");
	write_text("b.ply", "ply\n");
	write_text("temple.glb", "glTF");
	write_text("parts.json",
		   "{\"parts\": [{\"id\": \"bud\", \"anchor\": [4, 0, 0], \"page\": false,\n"
		   "\"title\": {\"en\": \"Bud\"}}]}\n");
	CHECK(export_manifest_with(&manifest, "temple.glb") == 0);
	write_file("exchange.json", manifest.json.data, manifest.json.size);
	CHECK(strstr((char *)manifest.json.data, "\"https://x.org/t/temple.glb\""));
	CHECK(strstr((char *)manifest.json.data, "model/gltf-binary"));
	CHECK(!memmem(manifest.json.data, manifest.json.size, ".ply", 4));
	snprintf(path, sizeof(path), "%s/exchange.json", folder);
	CHECK(alignment_read(&alignment, path, &told) == 0);
	CHECK(alignment.count == 1);
	transform_point(&alignment.scans[0].transform, from, to);
	CHECK(memcmp(from, to, sizeof(to)) == 0);
	alignment_finish(&alignment);
	annotations_finish(&manifest);
}

/* Every place that a manifest can say is written so that it is read as the same. */
static void writes_the_places_of_scans(void **state)
{
	static const char *const ups[] = { "x", "y", "z" };
	static const char aln[] =
		"2\na.ply\n#\n0 -2 0 5\n2 0 0 6\n0 0 2 7\n0 0 0 1\n"
		"a.ply\n#\n0.36 -0.48 -0.8 1\n0.8 0.6 0 2\n0.48 -0.64 0.6 3\n0 0 0 1\n0\n";
	struct alignment site, again;
	char path[200], ini[100];

	(void)state;
	write_text("a.ply", "ply\n");
	write_text("site.aln", aln);
	snprintf(path, sizeof(path), "%s/site.aln", folder);
	CHECK(alignment_read(&site, path, &told) == 0);
	snprintf(path, sizeof(path), "%s/exchange.json", folder);
	for (size_t i = 0; i < ARRAY_COUNT(ups); i++) {
		struct annotations manifest;

		snprintf(ini, sizeof(ini), "[model]\nscans = site.aln\nup = %s\nunit = cm\n",
			 ups[i]);
		write_text("temple.ini", ini);
		if (export_manifest(&manifest) != 0)
			fail_msg("%s", told.first.text);
		write_file("exchange.json", manifest.json.data, manifest.json.size);
		CHECK(alignment_read(&again, path, &told) == 0 && again.count == 2);
		for (uint32_t k = 0; k < 2; k++) {
			const float from[3] = { 10, 20, 30 };
			struct import_options options = { .metres_per_unit = 0.01,
							  .transform = &site.scans[k].transform };
			float placed[3], back[3];

			CHECK(import_axis_named(ups[i], &options.up));
			import_place(placed, from, &options);
			options = (struct import_options){ .up = IMPORT_Y_UP,
							   .transform = &again.scans[k].transform };
			import_place(back, from, &options);
			for (int c = 0; c < 3; c++)
				CHECK(fabsf(placed[c] - back[c]) < 1e-6f);
		}
		alignment_finish(&again);
		annotations_finish(&manifest);
	}
	alignment_finish(&site);
}

static void names_what_a_manifest_cannot_say(void **state)
{
	static const char *const words[] = { "\"tower\": its region", "\"reading\"",
					     "\"thumbnail\"",         "\"credits\"",
					     "credits of all parts",  "a.ply is left out" };
	struct annotations manifest;

	(void)state;
	write_text("temple.ini", "[model]\nscans = site.aln\n");
	write_text("a.ply", "ply\n");
	write_text("site.aln", "1\na.ply\n#\n1 0.5 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n0\n");
	CHECK(export_manifest(&manifest) == 0);
	for (size_t i = 0; i < ARRAY_COUNT(words); i++) {
		bool found = false;

		for (uint32_t k = 0; k < told.count; k++)
			found = found || strstr(diagnostics_get(&told, k)->text, words[i]);
		if (!found)
			fail_msg("not told: %s", words[i]);
	}
	CHECK(told.error_count == 0);
	annotations_finish(&manifest);
	write_text("temple.ini", "[model]\nscans = none.ply\n");
	CHECK(export_manifest(&manifest) == -EINVAL && told.error_count > 0);
}

static void refuses_a_manifest_without_comments(void **state)
{
	struct annotations_imported report;

	(void)state;
	write_text("exchange.jsonld",
		   "{\"type\": \"Manifest\", \"items\": [{\"type\": \"Scene\"}]}");
	CHECK(import_with(&report, false, false) == -EINVAL);
	CHECK(was_told(file, 1, "has no comments"));
	write_text("exchange.jsonld", "{\"type\": \"Manifest\", \"items\": []}");
	CHECK(import_with(&report, false, false) == -EINVAL);
	CHECK(was_told(file, 1, "no scene"));
}

static void leaves_unknown_selectors_out_where_told_to(void **state)
{
	struct annotations_imported report;

	(void)state;
	write_text("exchange.jsonld",
		   "{\"items\": [\n" ITEM("#a", POINT) ",\n" ITEM("#b", SVG) "]}");
	CHECK(import_with(&report, false, true) == 0);
	CHECK(report.part_count == 1 && report.skipped_count == 1);
	CHECK(told.first.line == 3 && strstr(told.first.text, "left out"));
	CHECK(copy_says("parts.json", "\"a\"") && !copy_says("parts.json", "\"b\""));
}

/* Of several selectors the one that is known counts. */
static void takes_the_selector_that_it_knows(void **state)
{
	struct annotations_imported report;

	(void)state;
	write_text("exchange.jsonld",
		   "[" ITEM("#a", "[" SVG ", {\"type\": \"SphereSelector\", \"centre\": [1, 2, 3], "
				  "\"radius\": 2}]") "]");
	CHECK(import_with(&report, false, false) == 0);
	CHECK(copy_says("parts.json", "\"sphere\""));
}

/* A page that no terminal may show, a region that is none, a picture that is nowhere: refused by
 * the folder's own readers, and taken away again. */
static void takes_away_what_the_folder_cannot_be(void **state)
{
	static const struct {
		const char *text, *file, *words;
	} cases[] = {
		{ ITEM("#a",
		       "{\"type\": \"SphereSelector\", \"centre\": [1, 2, 3], \"radius\": -2}"),
		  "parts.json", "radius" },
		{ "{\"id\": \"#a\", \"body\": [{\"value\": \"x\", \"purpose\": \"tagging\"}, "
		  "{\"format\": \"text/html\", \"value\": \"<p>y</p><script></script>\"}], "
		  "\"target\": {\"selector\": " POINT "}}",
		  "pages/a.en.html", "<script>" },
		{ "{\"id\": \"#a\", \"schema:thumbnailUrl\": {\"id\": \"pictures/z.png\"}, \"body\": "
		  "[{\"value\": \"x\", \"purpose\": \"tagging\"}], \"target\": {\"selector\": " POINT
		  "}}",
		  "parts.json", "z.png" },
	};
	struct annotations_imported report;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		bool is_told = false;

		write_text("exchange.jsonld", cases[i].text);
		CHECK(import_with(&report, false, false) == -EINVAL);
		for (uint32_t k = 0; k < told.count; k++) {
			const struct diagnostic *found = diagnostics_get(&told, k);

			is_told |=
				strncmp(found->text, cases[i].file, strlen(cases[i].file)) == 0 &&
				strstr(found->text + found->place_bytes, cases[i].words);
		}
		if (!is_told)
			fail_msg("case %zu: %s", i, told.first.text);
		CHECK(nothing_is_left());
	}
}

static void writes_over_nothing(void **state)
{
	struct annotations_imported report;

	(void)state;
	write_text("exchange.jsonld", ITEM("#a", POINT));
	CHECK(import_with(&report, false, false) == 0);
	CHECK(import_with(&report, false, false) == -EINVAL);
	CHECK(was_told(file, 0, "exists already"));
	CHECK(copy_says("parts.json", "\"a\""));
}

static void refuses_every_truncation(void **state)
{
	struct annotations_imported report;
	struct annotations annotations;

	(void)state;
	CHECK(export_from(&annotations, folder) == 0);
	for (size_t size = 0; size + 2 < annotations.json.size; size += 61) {
		write_file("exchange.jsonld", annotations.json.data, size);
		CHECK(import_with(&report, false, false) == -EINVAL);
		CHECK(nothing_is_left());
	}
	annotations_finish(&annotations);
}

int main(void)
{
#define IN_A_FOLDER(claim) cmocka_unit_test_setup_teardown(claim, set_up_exchange, tear_down)
	const struct CMUnitTest tests[] = {
		IN_A_FOLDER(comes_back_byte_for_byte),
		IN_A_FOLDER(tours_come_back_with_the_parts),
		IN_A_FOLDER(writes_what_the_standards_name),
		IN_A_FOLDER(refuses_a_folder_that_is_at_fault),
		IN_A_FOLDER(takes_what_another_tool_wrote),
		IN_A_FOLDER(names_the_place_of_what_it_refuses),
		IN_A_FOLDER(refuses_more_than_a_release_can_have),
		IN_A_FOLDER(brings_in_no_picture_that_is_a_link),
		IN_A_FOLDER(takes_the_comments_of_a_manifest),
		IN_A_FOLDER(refuses_a_manifest_without_comments),
		IN_A_FOLDER(writes_a_manifest_that_comes_back),
		IN_A_FOLDER(shows_one_model_in_place_of_the_scans),
		IN_A_FOLDER(writes_the_places_of_scans),
		IN_A_FOLDER(names_what_a_manifest_cannot_say),
		IN_A_FOLDER(leaves_unknown_selectors_out_where_told_to),
		IN_A_FOLDER(takes_the_selector_that_it_knows),
		IN_A_FOLDER(takes_away_what_the_folder_cannot_be),
		IN_A_FOLDER(writes_over_nothing),
		IN_A_FOLDER(refuses_every_truncation),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
