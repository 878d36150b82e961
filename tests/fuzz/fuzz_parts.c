/* parts.json, tours.json and the page of the part "gate" in English of a content folder, with lines
 * "====" between them: refused with diagnostics, or a database that opens and has as many parts and
 * tours. Of an odd size they are also read as what a curator is about to save. */
#include <errno.h>

#include "pipeline/content/info_build.h"
#include "storage/info_tools.h"
#include "storage/info_tour.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/small_png.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { FLIGHT_KEYS = 70 }; /* more than a tour has stops */

static const char usual_page[] = "<h1>Gate</h1><p>One enters <a href=\"part:tower\">here</a>.</p>";

/* Each names its file and says something. Returns how many are errors, and empties the list. */
static uint32_t count_errors(struct diagnostics *diagnostics)
{
	const uint32_t errors = diagnostics->error_count;

	for (uint32_t i = 0; i < diagnostics->count; i++) {
		const struct diagnostic *found = diagnostics_get(diagnostics, i);

		if (found->place_bytes < 5 || strlen(found->text + found->place_bytes) < 10)
			abort();
	}
	diagnostics_finish(diagnostics);
	return errors;
}

static void write_text(const char *name, const char *text)
{
	scratch_write(name, (const uint8_t *)text, strlen(text));
}

/* Takes what is before the next mark, or the rest, from *in. */
static struct bytes take_file(struct bytes *in)
{
	static const char mark[] = "====\n";
	const uint8_t *between =
		in->size ? memmem(in->data, in->size, mark, sizeof(mark) - 1) : NULL;
	const struct bytes found = { in->data, between ? (size_t)(between - in->data) : in->size };
	const size_t used = found.size + (between ? sizeof(mark) - 1 : 0);

	*in = (struct bytes){ between ? in->data + used : NULL, in->size - used };
	return found;
}

enum { FILES = 3 };
static const char *const names[FILES] = { "parts.json", "tours.json", "pages/gate.en.html" };

static void write_files(struct bytes in)
{
	unlink(scratch_path(names[1]));
	write_text(names[2], usual_page);
	for (size_t i = 0; i < FILES && in.data; i++) {
		const struct bytes file = take_file(&in);

		scratch_write(names[i], file.data, file.size);
	}
}

/* Scenes that a tour may name: a walk that halts, two views, and a flight of many keys. */
static void write_scenes(void)
{
	static const char end[] = "ROUTE C.fraction_changed TO P.set_fraction\n"
				  "ROUTE P.value_changed TO V.position\n";
	char text[8000];
	int size;

	write_text(
		"scenes.json",
		"{\"scenes\": [{\"file\": \"scenes/walk.wrl\", \"unit\": \"cm\", \"scene\": \"a\"},"
		"{\"file\": \"scenes/still.wrl\", \"up\": \"z\"}, {\"file\": \"scenes/fly.wrl\"},"
		"{\"file\": \"scenes/one.wrl\"}, {\"file\": \"scenes/none.wrl\"}]}");
	snprintf(text, sizeof(text),
		 "#VRML V2.0 utf8\nDEF V Viewpoint { description \"v\" }\n"
		 "DEF C TimeSensor { cycleInterval 10 }\n"
		 "DEF P PositionInterpolator { key [ 0 0.4 0.7 1 ]\n"
		 "keyValue [ 0 200 0, 400 200 0, 400 200 0, 400 200 300 ] }\n%s",
		 end);
	write_text("scenes/walk.wrl", text);
	write_text("scenes/still.wrl", "#VRML V2.0 utf8\nViewpoint { position 1 2 3 }\n"
				       "Viewpoint { position 4 5 6 }");
	size = snprintf(
		text, sizeof(text),
		"#VRML V2.0 utf8\nDEF V Viewpoint {}\nDEF C TimeSensor { cycleInterval 70 }\n"
		"DEF P PositionInterpolator { key [");
	for (int i = 0; i < FLIGHT_KEYS; i++)
		size += snprintf(text + size, sizeof(text) - (size_t)size, " %g",
				 (double)i / (FLIGHT_KEYS - 1));
	size += snprintf(text + size, sizeof(text) - (size_t)size, " ]\nkeyValue [");
	for (int i = 0; i < FLIGHT_KEYS; i++)
		size += snprintf(text + size, sizeof(text) - (size_t)size, " %d 2 %d", i,
				 i / 9 * 9);
	snprintf(text + size, sizeof(text) - (size_t)size, " ] }\n%s", end);
	write_text("scenes/fly.wrl", text);
}

/* The other files of the folder are always the same. */
static void begin(void)
{
	static const char *const folders[] = { "pages", "pictures", "scenes" };

	if (scratch[0])
		return;
	scratch_begin();
	for (size_t i = 0; i < ARRAY_COUNT(folders); i++)
		if (mkdir(scratch_path(folders[i]), 0700) < 0)
			abort();
	scratch_write("pictures/a.png", small_png, sizeof(small_png));
	scratch_write("pictures/b.png", small_png, sizeof(small_png) - 20);
	write_text("pages/history.en.html", "<p>It is <img src=\"pictures/a.png\"> old.</p>");
	write_text("pages/rules.km.html", "<p>No hats.");
	write_scenes();
}

/* Lists of faces with even names are there. */
static int find_faces(void *data, struct info_faces *faces, struct diagnostics *diagnostics)
{
	(void)data;
	if (strlen(faces->file) % 2)
		return diagnostics_add(diagnostics, -EINVAL, faces->file, 1, "is not there");
	faces->centre_m[2] = faces->anchor_m[2] = 7;
	faces->radius_m = 2;
	return 0;
}

static int place_faces(void *data, struct info_faces *faces, struct diagnostics *diagnostics)
{
	if (faces->file[0] == 'x')
		return diagnostics_add(diagnostics, -EINVAL, faces->file, 1,
				       "has none of the scan's");
	return find_faces(data, faces, diagnostics);
}

static void save(struct info_build_options options, struct bytes in)
{
	struct info_text_instead instead[FILES];
	struct draft *draft;
	int rc;

	for (size_t i = 0; i < FILES; i++)
		instead[i] = (struct info_text_instead){ names[i], take_file(&in) };
	options.instead = instead;
	options.instead_count = FILES;
	options.skims_pictures = true;
	rc = info_read(&draft, &options);
	if ((rc == -EINVAL) != (count_errors(options.diagnostics) > 0) ||
	    (rc != 0 && rc != -EINVAL))
		abort();
	info_draft_destroy(draft);
}

static void publish(const struct info_build_options *options)
{
	struct info_built built;
	struct info *info;
	int rc = info_build(&built, options);

	if ((rc == -EINVAL) != (count_errors(options->diagnostics) > 0) ||
	    (rc != 0 && rc != -EINVAL))
		abort();
	if (rc < 0)
		return;
	if (info_open(&info, buffer_bytes(&built.database)) < 0)
		abort();
	if (info_part_count(info) != built.part_count || info_tour_count(info) != built.tour_count)
		abort();
	info_close(info);
	info_built_finish(&built);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const char *const languages[] = { "en", "km" };
	struct diagnostics diagnostics = { .max = INFO_DIAGNOSTICS_MAX };
	const struct info_build_options options = { .folder = scratch,
						    .languages = languages,
						    .language_count = ARRAY_COUNT(languages),
						    .tools = size % 4 ? 0 : INFO_TOOL_MEASURE,
						    .scan_error_m = 0.01,
						    .diagnostics = &diagnostics,
						    .judge_faces = find_faces,
						    .place_faces = place_faces };

	begin();
	write_files((struct bytes){ data, size });
	if (size % 2)
		save(options, (struct bytes){ data, size });
	publish(&options);
	return 0;
}
