/* An information database that is built as at publishing, and so always of today's format. */
#ifndef GOPURA_TESTS_FUZZ_BUILT_INFO_H
#define GOPURA_TESTS_FUZZ_BUILT_INFO_H

#include "pipeline/content/info_build.h"
#include "tests/fuzz/scratch.h"

/* Two parts, one of them with a page, and a tour between them. */
static const char parts_json[] =
	"{\"credits\": {\"rights\": {\"en\": \"(c)\"}, \"date\": \"2026\"}, \"parts\": ["
	"{\"id\": \"tower\", \"page\": false, \"region\": {\"kind\": \"box\", \"centre\": [0, 1, 20],"
	" \"half\": [3, 4, 5]}, \"title\": {\"en\": \"Tower\", \"km\": \"T\"}, \"caption\": {\"en\": \"High.\"}},"
	"{\"id\": \"gate\", \"region\": {\"kind\": \"prism\", \"floor\": 0, \"roof\": 4, \"corners\": [[0, 0],"
	" [0, 2], [2, 2]]}, \"title\": {\"en\": \"Gate\"}}]}";
static const char tours_json[] =
	"{\"tours\": [{\"id\": \"round\", \"title\": {\"en\": \"Round\"}, \"stops\": [{\"eye\": [34, -40, 15],"
	" \"target\": [0, 0, 8], \"stay\": 7, \"travel\": 12, \"caption\": {\"en\": \"One\"}},"
	" {\"part\": \"gate\", \"stay\": 8}]}]}";

static inline void built_info(struct info_built *out)
{
	static const char *const languages[] = { "en", "km" };
	static const char page[] = "<h1>Gate</h1><p>A gate tower.</p>";
	struct diagnostics diagnostics = { .max = INFO_DIAGNOSTICS_MAX };
	const struct info_build_options options = { .folder = scratch,
						    .languages = languages,
						    .language_count = ARRAY_COUNT(languages),
						    .tools = INFO_TOOL_MEASURE,
						    .scan_error_m = 0.01,
						    .diagnostics = &diagnostics };

	scratch_begin();
	if (mkdir(scratch_path("pages"), 0700) < 0)
		abort();
	scratch_write("pages/gate.en.html", (const uint8_t *)page, sizeof(page) - 1);
	scratch_write("parts.json", (const uint8_t *)parts_json, sizeof(parts_json) - 1);
	scratch_write("tours.json", (const uint8_t *)tours_json, sizeof(tours_json) - 1);
	if (info_build(out, &options) < 0) {
		fprintf(stderr, "%s\n", diagnostics.first.text);
		abort();
	}
	diagnostics_finish(&diagnostics);
}

#endif
