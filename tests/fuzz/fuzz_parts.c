/* parts.json and tours.json of a content folder, with a line "====" between them: refused with
 * diagnostics, or a database that opens and has as many parts and tours. */
#include <errno.h>

#include "pipeline/content/info_build.h"
#include "storage/info_tour.h"
#include "tests/fuzz/scratch.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

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

static void write_files(const uint8_t *data, size_t size)
{
	static const char mark[] = "====\n";
	const uint8_t *between = size ? memmem(data, size, mark, sizeof(mark) - 1) : NULL;
	const size_t parts = between ? (size_t)(between - data) : size;

	scratch_write("parts.json", data, parts);
	if (between)
		scratch_write("tours.json", between + sizeof(mark) - 1,
			      size - parts - (sizeof(mark) - 1));
	else
		unlink(scratch_path("tours.json"));
}

/* "gate" has a page in English. */
static void begin(void)
{
	static const char page[] =
		"<h1>Gate</h1><p>One enters <a href=\"part:tower\">here</a>.</p>";

	if (scratch[0])
		return;
	scratch_begin();
	if (mkdir(scratch_path("pages"), 0700) < 0)
		abort();
	scratch_write("pages/gate.en.html", (const uint8_t *)page, sizeof(page) - 1);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const char *const languages[] = { "en", "km" };
	struct diagnostics diagnostics = { .max = INFO_DIAGNOSTICS_MAX };
	const struct info_build_options options = { .folder = scratch,
						    .languages = languages,
						    .language_count = ARRAY_COUNT(languages),
						    .diagnostics = &diagnostics };
	struct info_built built;
	struct info *info;
	int rc;

	begin();
	write_files(data, size);
	rc = info_build(&built, &options);
	if ((rc == -EINVAL) != (count_errors(&diagnostics) > 0) || (rc != 0 && rc != -EINVAL))
		abort();
	if (rc < 0)
		return 0;
	if (info_open(&info, buffer_bytes(&built.database)) < 0)
		abort();
	if (info_part_count(info) != built.part_count || info_tour_count(info) != built.tour_count)
		abort();
	info_close(info);
	info_built_finish(&built);
	return 0;
}
