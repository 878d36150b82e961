/* Tours from tours.json to what the kiosk reads; what is said of one that is at fault; and images
 * of before there were tours. */
#include <errno.h>
#include <math.h>
#include <unistd.h>

#include "app/visit/tour.h"
#include "geometry/viewpoint.h"
#include "storage/info_schema.h"
#include "storage/info_tour.h"
#include "tests/pipeline/content/info_folder.h"

static const char good_tours[] =
	"{\"tours\": [\n"
	"  {\"id\": \"short\", \"title\": {\"en\": \"Short\", \"km\": \"ខ្លី\"},\n"
	"   \"stops\": [\n"
	"    {\"eye\": [1, 2, 3], \"target\": [4, 5, 6], \"stay\": 3},\n"
	"    {\"part\": \"naga\", \"stay\": 4, \"travel\": 7.5}]},\n"
	"  {\"id\": \"round\", \"attract\": true, \"title\": {\"en\": \"All\"},\n"
	"   \"caption\": {\"en\": \"Four minutes\", \"km\": \"បួននាទី\"}, \"thumbnail\": "
	"\"pictures/b.png\",\n"
	"   \"stops\": [\n"
	"    {\"eye\": [0, -50, 20], \"part\": \"tower\", \"caption\": {\"en\": \"See\", "
	"\"km\": \"មើល\"}},\n"
	"    {\"eye\": [9, -40, 20], \"target\": [0, 1, 5], \"stay\": 0},\n"
	"    {\"eye\": [20, -30, 20], \"target\": [0, 1, 25],\n"
	"     \"caption\": {\"en\": \"There\"}}\n"
	"   ]}\n"
	"]}\n";

static uint32_t version_of(const struct info_built *built)
{
	return built->database.data[63]; /* user_version, big endian at 60 */
}

static void gives_back_the_tours_of_the_folder(void **state)
{
	const struct info_tour *tour;
	struct info_built built;
	struct info_text text;
	struct info *info;

	(void)state;
	write_text("tours.json", good_tours);
	CHECK(build(&built) == 0);
	CHECK(built.tour_count == 2 && version_of(&built) == INFO_SCHEMA_VERSION);
	CHECK(built.tour_lines[0].tour == 2 && built.tour_lines[0].stops[1] == 5);
	CHECK(built.tour_lines[1].tour == 6 && built.tour_lines[1].stops[2] == 11);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	CHECK(info_tour_count(info) == 2 && info_find_tour(info, "round") == 1);
	CHECK(info_find_tour(info, "long") == -ENOENT);

	tour = info_tour(info, 0);
	CHECK(!tour->attract && tour->stop_count == 2);
	CHECK(tour->stops[0].eye_m[1] == 2 && tour->stops[0].target_m[2] == 6);
	CHECK(tour->stops[0].stay_s == 3 && tour->stops[0].travel_s == 0);
	CHECK(tour->stops[0].part == -1 && tour->stops[1].part == info_find(info, "naga"));
	CHECK(tour->stops[1].stay_s == 4 && tour->stops[1].travel_s == 7.5f);

	tour = info_tour(info, 1);
	CHECK(tour->attract && tour->stop_count == 3 && tour->stops[1].stay_s == 0);
	CHECK(tour->stops[0].stay_s == 6 && tour->stops[0].target_m[2] == 25); /* the anchor */

	text = info_tour_text(info, 1, "km");
	CHECK(strcmp(text.title, "All") == 0 && strcmp(text.caption, "បួននាទី") == 0);
	CHECK(strcmp(text.thumbnail, "pictures/b.png") == 0);
	CHECK(strcmp(info_tour_text(info, 0, "km").title, "ខ្លី") == 0);
	CHECK(strcmp(info_stop_caption(info, 1, 0, "km"), "មើល") == 0);
	CHECK(strcmp(info_stop_caption(info, 1, 2, "km"), "There") == 0);
	CHECK(strcmp(info_stop_caption(info, 1, 1, "en"), "") == 0);
	info_close(info);
	info_built_finish(&built);
}

/* As the kiosk flies to a part: from where the eye stands, but nearer. */
static void a_stop_that_names_a_part_alone_is_the_view_of_it(void **state)
{
	const struct info_stop *stops;
	float eye[3], target[3];
	struct info_built built;
	struct info *info;

	(void)state;
	write_text("tours.json", good_tours);
	CHECK(build(&built) == 0);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	stops = info_tour(info, 0)->stops;
	viewpoint_of_region(&info_part(info, 2)->region, info_part(info, 2)->anchor_m, 0.5f,
			    stops[0].eye_m, eye, target);
	for (int i = 0; i < 3; i++)
		CHECK(stops[1].eye_m[i] == eye[i] && stops[1].target_m[i] == target[i]);
	CHECK(target[0] == 5 && target[2] == 7);
	CHECK(fabsf(hypotf(hypotf(eye[0] - 5, eye[1] - 6), eye[2] - 7) - 2.5f) < 1e-4f);
	info_close(info);
	info_built_finish(&built);
}

static void a_folder_without_tours_gives_none(void **state)
{
	struct info_built built, empty;
	struct info *info;

	(void)state;
	CHECK(build(&built) == 0);
	CHECK(built.tour_count == 0 && version_of(&built) == INFO_SCHEMA_VERSION);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	CHECK(info_tour_count(info) == 0 && info_find_tour(info, "round") == -ENOENT);
	info_close(info);
	write_text("tours.json", "{\"tours\": []}");
	CHECK(build(&empty) == 0);
	CHECK(empty.database.size == built.database.size &&
	      memcmp(empty.database.data, built.database.data, built.database.size) == 0);
	info_built_finish(&built);
	info_built_finish(&empty);
}

static void links_lead_to_tours_that_are_there(void **state)
{
	struct info_built built;

	(void)state;
	write_text("tours.json", good_tours);
	write_text("pages/gate.en.html", "<p>See <a href=\"tour:round\">all of it</a>.</p>");
	CHECK(build(&built) == 0);
	info_built_finish(&built);
	write_text("pages/gate.en.html", "<p>See\n<a href=\"tour:rund\">all of it</a>.</p>");
	CHECK(build(&built) == -EINVAL);
	CHECK(was_told("pages/gate.en.html", 2, "no tour has that id"));
}

/* A walk in centimetres that rests in its middle; and two Viewpoints that stand still. */
static void write_scenes(void)
{
	char path[100];

	snprintf(path, sizeof(path), "%s/scenes", folder);
	mkdir(path, 0755);
	write_text("scenes.json",
		   "{\"scenes\": [{\"file\": \"scenes/walk.wrl\", \"unit\": \"cm\"},\n"
		   "{\"file\": \"scenes/still.wrl\", \"up\": \"z\"}]}");
	write_text("scenes/walk.wrl",
		   "#VRML V2.0 utf8\nDEF V Viewpoint {}\nDEF C TimeSensor { cycleInterval 10 }\n"
		   "DEF P PositionInterpolator { key [ 0 0.4 0.7 1 ]\n"
		   "  keyValue [ 0 200 0, 400 200 0, 400 200 0, 400 200 300 ] }\n"
		   "ROUTE C.fraction_changed TO P.set_fraction\n"
		   "ROUTE P.value_changed TO V.position");
	write_text("scenes/still.wrl", "#VRML V2.0 utf8\nViewpoint { position 1 2 3 }\n"
				       "Viewpoint { position 4 5 6 }");
}

#define SCENE_TOUR(more) "{\"tours\": [\n{\"id\": \"a\", \"title\": {\"en\": \"A\"}, " more "}]}"

static void a_scene_gives_the_stops_of_a_tour(void **state)
{
	const struct info_tour *tour;
	struct info_built built;
	struct info *info;

	(void)state;
	write_scenes();
	write_text("tours.json",
		   SCENE_TOUR("\"scene\": \"scenes/walk.wrl\",\n\"stops\": [{},\n"
			      "{\"part\": \"naga\", \"caption\": {\"en\": \"Here\"}}]"));
	CHECK(build(&built) == 0 && built.tour_lines[0].stops[0] == 3);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	tour = info_tour(info, 0);
	CHECK(tour->stop_count == 3);
	/* y of the file is up, and the way that a Viewpoint looks, -z, is y of the site. */
	CHECK(fabsf(tour->stops[1].eye_m[0] - 4) < 1e-4f);
	CHECK(fabsf(tour->stops[1].eye_m[2] - 2) < 1e-4f);
	CHECK(fabsf(tour->stops[2].eye_m[1] + 3) < 1e-4f);
	CHECK(tour->stops[2].target_m[1] > tour->stops[2].eye_m[1]);
	CHECK(tour->stops[0].stay_s == 2 && tour->stops[2].stay_s == 2);
	CHECK(fabsf(tour->stops[1].stay_s - 3) < 1e-4f); /* where the keys rest */
	CHECK(fabsf(tour->stops[1].travel_s - 4) < 1e-4f);
	CHECK(fabsf(tour->stops[2].travel_s - 3) < 1e-4f);
	CHECK(tour->stops[1].part == info_find(info, "naga") && tour->stops[0].part == -1);
	CHECK(strcmp(info_stop_caption(info, 0, 1, "en"), "Here") == 0);
	info_close(info);
	info_built_finish(&built);

	write_text("tours.json", SCENE_TOUR("\"scene\": \"scenes/still.wrl\", \"stops\": []"));
	CHECK(build(&built) == 0);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	tour = info_tour(info, 0);
	CHECK(tour->stop_count == 2 && tour->stops[1].eye_m[2] == 6);
	CHECK(tour->stops[0].stay_s == 6 && tour->stops[1].travel_s == 0);
	info_close(info);
	info_built_finish(&built);
}

/* What ISO/IEC 14772-1 6.36 says of a PositionInterpolator, along the x and y of a file. */
static void interpolate(float out[2], const float *keys, const float (*values)[2], uint32_t count,
			float share)
{
	uint32_t at = 0;
	float part;

	while (at + 2 < count && keys[at + 1] <= share)
		at++;
	part = (share - keys[at]) / (keys[at + 1] - keys[at]);
	for (int k = 0; k < 2; k++)
		out[k] = values[at][k] + part * (values[at + 1][k] - values[at][k]);
}

/* Keys at uneven times, a pause between two equal ones, and a timer that rests at its end. */
static void a_tour_keeps_the_times_of_a_scenes_keys(void **state)
{
	static const float keys[] = { 0, 0.05f, 0.3f, 0.4f, 0.45f, 0.9f, 1 };
	static const float values[][2] = { { 0, 0 }, { 5, 0 },  { 6, 3 }, { 6, 3 },
					   { 9, 9 }, { 0, 12 }, { 0, 12 } };
	static struct tour_path path;
	struct info_built built;
	struct info *info;

	(void)state;
	write_scenes();
	write_text("scenes/walk.wrl",
		   "#VRML V2.0 utf8\nDEF V Viewpoint {}\nDEF C TimeSensor { cycleInterval 20 }\n"
		   "DEF P PositionInterpolator { key [ 0 0.05 0.3 0.4 0.45 0.9 ]\n"
		   "  keyValue [ 0 0 0, 500 0 0, 600 300 0, 600 300 0, 900 900 0, 0 1200 0 ] }\n"
		   "ROUTE C.fraction_changed TO P.set_fraction\n"
		   "ROUTE P.value_changed TO V.position");
	write_text("tours.json", SCENE_TOUR("\"scene\": \"scenes/walk.wrl\""));
	CHECK(build(&built) == 0);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	tour_way(&path, info_tour(info, 0), 30);
	CHECK(path.duration_ms == 2000 + 20000);
	for (int64_t ms = 0; ms <= 20000; ms += 50) {
		struct tour_pose pose;
		float expected[2];

		interpolate(expected, keys, values, ARRAY_COUNT(keys), (float)ms / 20000);
		tour_path_pose(&path, 2000 + ms, &pose);
		CHECK(fabsf(pose.eye_m[0] - expected[0]) < 2e-3f);
		CHECK(fabsf(pose.eye_m[2] - expected[1]) < 2e-3f);
	}
	info_close(info);
	info_built_finish(&built);
}

/* A camera of glTF in a scene of its own, which scenes.json names. */
static void a_camera_of_gltf_is_a_tour_too(void **state)
{
	/* times 0 1 4; the places 0 0 0, 6 0 0 and 6 3 0 */
	static const char fly[] =
		"{\"asset\": {\"version\": \"2.0\"}, \"buffers\": [{\"byteLength\": 48, \"uri\":"
		" \"data:application/octet-stream;base64,"
		"AAAAAAAAgD8AAIBAAAAAAAAAAAAAAAAAAADAQAAAAAAAAAAAAADAQAAAQEAAAAAA\"}],"
		"\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 48}], \"accessors\": ["
		"{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"SCALAR\"},"
		"{\"bufferView\": 0, \"byteOffset\": 12, \"componentType\": 5126, \"count\": 3,"
		" \"type\": \"VEC3\"}], \"cameras\": [{\"type\": \"perspective\"}],"
		"\"scenes\": [{\"name\": \"empty\"}, {\"name\": \"film\", \"nodes\": [0]}],"
		"\"nodes\": [{\"name\": \"eye\", \"camera\": 0}], \"animations\": [{\"channels\":"
		" [{\"sampler\": 0, \"target\": {\"node\": 0, \"path\": \"translation\"}}],"
		" \"samplers\": [{\"input\": 0, \"output\": 1}]}]}";
	const struct info_tour *tour;
	struct info_built built;
	struct info *info;

	(void)state;
	write_scenes();
	write_text("scenes/fly.gltf", fly);
	write_text("scenes.json",
		   "{\"scenes\": [{\"file\": \"scenes/fly.gltf\", \"scene\": \"film\"}]}");
	write_text("tours.json",
		   SCENE_TOUR("\"scene\": \"scenes/fly.gltf\", \"viewpoint\": \"eye\""));
	CHECK(build(&built) == 0);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	tour = info_tour(info, 0);
	CHECK(tour->stop_count == 3 && tour->stops[1].travel_s == 1 &&
	      tour->stops[2].travel_s == 3);
	CHECK(!tour->stops[0].is_even && tour->stops[1].is_even && tour->stops[2].is_even);
	/* y of the file is up, and a camera looks along -z, which is y of the site. */
	CHECK(fabsf(tour->stops[2].eye_m[0] - 6) < 1e-4f &&
	      fabsf(tour->stops[2].eye_m[2] - 3) < 1e-4f);
	CHECK(fabsf(tour->stops[2].target_m[1] - 1) < 1e-4f);
	info_close(info);
	info_built_finish(&built);
}

/* A film of 300 keys along a circle: fewer are flown, and the way is kept. */
static void a_film_has_as_many_keys_as_it_needs(void **state)
{
	enum { KEYS = 300 };
	static struct tour_path path;
	static char text[32768];
	struct info_built built;
	struct info *info;
	bool says_so = false;
	size_t at = 0;

	(void)state;
	write_scenes();
	at += (size_t)snprintf(text, sizeof(text),
			       "#VRML V2.0 utf8\nDEF V Viewpoint {}\nDEF C TimeSensor "
			       "{ cycleInterval 20 }\nDEF P PositionInterpolator { key [");
	for (int i = 0; i < KEYS; i++)
		at += (size_t)snprintf(text + at, sizeof(text) - at, " %.6f",
				       (double)i / (KEYS - 1));
	at += (size_t)snprintf(text + at, sizeof(text) - at, " ]\nkeyValue [");
	for (int i = 0; i < KEYS; i++)
		at += (size_t)snprintf(text + at, sizeof(text) - at, " %.3f 0 %.3f,",
				       1000 * cos(6.0 * i / (KEYS - 1)),
				       1000 * sin(6.0 * i / (KEYS - 1)));
	snprintf(text + at, sizeof(text) - at,
		 " ] }\nROUTE C.fraction_changed TO P.set_fraction\n"
		 "ROUTE P.value_changed TO V.position");
	write_text("scenes/walk.wrl", text);
	write_text("tours.json", SCENE_TOUR("\"scene\": \"scenes/walk.wrl\""));
	CHECK(build(&built) == 0);
	for (uint32_t i = 0; i < told.count; i++)
		says_so |= strstr(diagnostics_get(&told, i)->text,
				  "tours.json:2: tour \"a\": of the 300 keys") != NULL;
	CHECK(says_so);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	CHECK(info_tour(info, 0)->stop_count > 16 && info_tour(info, 0)->stop_count <= 64);
	tour_way(&path, info_tour(info, 0), 30);
	for (int64_t ms = 0; ms <= 20000; ms += 100) {
		const float angle = 6 * (float)ms / 20000;
		struct tour_pose pose;

		tour_path_pose(&path, 2000 + ms, &pose);
		CHECK(fabsf(pose.eye_m[0] - 10 * cosf(angle)) < 0.04f);
		CHECK(fabsf(pose.eye_m[1] + 10 * sinf(angle)) < 0.04f);
	}
	info_close(info);
	info_built_finish(&built);
}

static void faults_of_a_tour_through_a_scene_are_named(void **state)
{
	static const struct {
		const char *json, *words;
	} cases[] = {
		{ SCENE_TOUR("\"scene\": 7"), "\"scene\" must be a file that scenes.json names" },
		{ SCENE_TOUR("\"scene\": \"scenes/no.wrl\""), "does not name \"scenes/no.wrl\"" },
		{ SCENE_TOUR("\"scene\": \"scenes/walk.wrl\", \"viewpoint\": 7"),
		  "\"viewpoint\" must be the description" },
		{ SCENE_TOUR("\"scene\": \"scenes/walk.wrl\", \"stops\": [{}, {}, {}, {}]"),
		  "a list of at most 3" },
		{ SCENE_TOUR("\"scene\": \"scenes/walk.wrl\", \"stops\": [{\"eye\": [1, 2, 3]}]"),
		  "stop 1: \"eye\" is not one of its keys" },
		{ SCENE_TOUR("\"scene\": \"scenes/walk.wrl\", \"stops\": [7]"),
		  "stop 1: must be an object" },
	};
	struct info_built built;
	char path[100];

	(void)state;
	write_scenes();
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		write_text("tours.json", cases[i].json);
		CHECK(build(&built) == -EINVAL);
		if (!was_told("tours.json", 2, cases[i].words))
			fail_msg("case %zu: %s", i, diagnostics_cause(&told, 0));
	}
	write_text("scenes/still.wrl", "#VRML V2.0 utf8\nViewpoint {}");
	write_text("tours.json", SCENE_TOUR("\"scene\": \"scenes/still.wrl\""));
	CHECK(build(&built) == -EINVAL);
	CHECK(was_told("tours.json", 2, "has 1 Viewpoints or cameras: a tour needs 2"));
	write_text("tours.json", SCENE_TOUR("\"scene\": \"scenes/still.wrl\", "
					    "\"viewpoint\": \"x\""));
	CHECK(build(&built) == -EINVAL);
	snprintf(path, sizeof(path), "%s/scenes/still.wrl", folder);
	CHECK(was_told(path, 0, "has no moving Viewpoint"));
}

#define TOUR(stops)                                                                                \
	"{\"tours\": [{\"id\": \"a\", \"title\": {\"en\": \"A\"},\n\"stops\": [\n" stops "]}]}"
#define STOP "{\"eye\": [1, 2, 3], \"target\": [4, 5, 6]}"

static void faults_are_named_with_file_line_and_cure(void **state)
{
	static const struct {
		const char *json, *words;
		unsigned line;
	} cases[] = {
		{ "{\"tours\": [\n{]}", "is not valid JSON from here on", 2 },
		{ "[]", "must be {\"tours\": [...]} at the top level", 1 },
		{ "{\"tours\": [7]}", "entry 1 of \"tours\" is not an object", 0 },
		{ "{\"tours\": [\n{\"id\": \"A b\", \"title\": {\"en\": \"A\"}, \"stops\": [" STOP
		  ", " STOP "]}]}",
		  "use 1 to 64 of a-z", 2 },
		{ "{\"tours\": [{\"id\": \"a\", \"stops\": [" STOP "," STOP "]}]}",
		  "no title in \"en\", the first language", 1 },
		{ "{\"tours\": [{\"id\": \"a\", \"title\": {\"en\": \"A\"}, \"stops\": [" STOP
		  "]}]}",
		  "needs 2 to 64 \"stops\", it has 1", 1 },
		{ "{\"tours\": [{\"id\": \"a\", \"titel\": 1, \"title\": {\"en\": \"A\"}, "
		  "\"stops\": [" STOP "," STOP "]}]}",
		  "\"titel\" is not one of its keys", 1 },
		{ "{\"tours\": [{\"id\": \"a\", \"title\": {\"en\": \"A\"}, \"attract\": 1, "
		  "\"stops\": [" STOP "," STOP "]}]}",
		  "\"attract\" must be true or false", 1 },
		{ "{\"tours\": [{\"id\": \"a\", \"title\": {\"en\": \"A\"}, \"attract\": true, "
		  "\"stops\": [" STOP "," STOP "]},\n{\"id\": \"b\", \"title\": {\"en\": \"B\"}, "
		  "\"attract\": true, \"stops\": [" STOP "," STOP "]}]}",
		  "only one can be shown", 2 },
		{ "{\"tours\": [{\"id\": \"a\", \"title\": {\"en\": \"A\"}, \"stops\": [" STOP
		  "," STOP "]},\n{\"id\": \"a\", \"title\": {\"en\": \"B\"}, \"stops\": [" STOP
		  "," STOP "]}]}",
		  "is defined twice", 2 },
		{ "{\"tours\": [{\"id\": \"a\", \"title\": {\"en\": \"A\"}, \"thumbnail\": "
		  "\"pictures/none.jpg\", \"stops\": [" STOP "," STOP "]}]}",
		  "is not there", 1 },
		{ TOUR(STOP ",\n{\"eye\": [1, 2], \"target\": [4, 5, 6]}"),
		  "stop 2: \"eye\" must be three numbers", 4 },
		{ TOUR(STOP ",\n{\"eye\": [1, 2, 1e99], \"target\": [4, 5, 6]}"),
		  "\"eye\" must be three numbers", 4 },
		{ TOUR(STOP ",\n{\"eye\": [1, 2, -2e9], \"target\": [4, 5, 6]}"),
		  "\"eye\" must be three numbers, metres, up to 1e+09", 4 },
		{ TOUR(STOP ",\n{\"eye\": [4, 5, 6], \"target\": [4, 5, 6]}"), "are one place", 4 },
		{ TOUR(STOP ",\n{\"eye\": [1, 2, 3]}"), "\"eye\" alone is not a view", 4 },
		{ TOUR(STOP ",\n{\"target\": [1, 2, 3]}"), "\"target\" alone is not a view", 4 },
		{ TOUR(STOP ",\n{\"stay\": 3}"), "it has no view: add", 4 },
		{ TOUR(STOP ",\n{\"part\": \"gat\"}"), "part \"gat\": no part has that id", 4 },
		{ TOUR("{\"part\": \"gate\"},\n" STOP), "stop 1: a part is shown from where", 3 },
		{ TOUR(STOP ",\n" STOP ",\n{\"part\": \"naga\", \"stay\": 121}"),
		  "stop 3: \"stay\" must be 1 to 120 seconds", 5 },
		{ TOUR(STOP ",\n{\"part\": \"naga\", \"stay\": 0}"), "\"stay\" must be 1 to 120",
		  4 },
		{ TOUR(STOP ",\n{\"part\": \"naga\", \"stay\": \"a\"},\n" STOP),
		  "\"stay\" must be 0 or 1 to 120", 4 },
		{ TOUR(STOP ",\n{\"part\": \"naga\", \"travel\": 0}"), "\"travel\" must be 1 to",
		  4 },
		{ TOUR(STOP ",\n{\"part\": \"naga\", \"caption\": \"Naga\"}"),
		  "\"caption\" must be texts by language", 4 },
		{ TOUR(STOP ",\n{\"part\": \"naga\", \"caption\": {\"km\": \"នាគ\"}}"),
		  "no caption in \"en\"", 4 },
		{ TOUR(STOP ",\n7"), "stop 2: must be an object", 1 },
		{ TOUR(STOP ",\n" STOP ",\n{\"part\": \"caf\xe9\"}"), "not UTF-8", 5 },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct info_built built;

		write_text("tours.json", cases[i].json);
		CHECK(build(&built) == -EINVAL);
		if (!was_told("tours.json", cases[i].line, cases[i].words))
			fail_msg("case %zu: %s", i, told.first.text);
	}
}

/* What is read of a damaged image is within bounds, or refused; sanitizers look on. */
static void a_damaged_image_breaks_nothing(void **state)
{
	struct info_built built;
	uint32_t random = 3, opened = 0;

	(void)state;
	write_text("tours.json", good_tours);
	CHECK(build(&built) == 0);
	for (int i = 0; i < 1500; i++) {
		struct buffer *image = &built.database;
		size_t at = (random = random * 1664525u + 1013904223u) % image->size;
		uint8_t before = image->data[at];
		struct info *info;

		image->data[at] ^= (uint8_t)(1 + (random >> 24) % 255);
		if (info_open(&info, buffer_bytes(image)) == 0) {
			for (uint32_t t = 0; t < info_tour_count(info); t++) {
				const struct info_tour *tour = info_tour(info, t);

				CHECK(info_tour_text(info, t, "km").title && tour->stop_count >= 2);
				for (uint32_t s = 0; s < tour->stop_count; s++) {
					CHECK(info_stop_caption(info, t, s, "km"));
					CHECK(tour->stops[s].part < (int)info_part_count(info));
					CHECK(isfinite(tour->stops[s].eye_m[0]));
				}
			}
			opened++;
		}
		info_close(info);
		image->data[at] = before;
	}
	CHECK(opened > 0 && opened < 1500);
	info_built_finish(&built);
}

int main(void)
{
#define IN_A_FOLDER(claim) cmocka_unit_test_setup_teardown(claim, set_up, tear_down)
	const struct CMUnitTest tests[] = {
		IN_A_FOLDER(gives_back_the_tours_of_the_folder),
		IN_A_FOLDER(a_stop_that_names_a_part_alone_is_the_view_of_it),
		IN_A_FOLDER(a_folder_without_tours_gives_none),
		IN_A_FOLDER(links_lead_to_tours_that_are_there),
		IN_A_FOLDER(a_scene_gives_the_stops_of_a_tour),
		IN_A_FOLDER(a_tour_keeps_the_times_of_a_scenes_keys),
		IN_A_FOLDER(a_camera_of_gltf_is_a_tour_too),
		IN_A_FOLDER(a_film_has_as_many_keys_as_it_needs),
		IN_A_FOLDER(faults_of_a_tour_through_a_scene_are_named),
		IN_A_FOLDER(faults_are_named_with_file_line_and_cure),
		IN_A_FOLDER(a_damaged_image_breaks_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
