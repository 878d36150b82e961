/* A file of annotations of anybody's: refused with a diagnostic and nothing left behind, or a
 * content folder that goes out again. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/content/annotations.h"
#include "pipeline/content/annotations_export.h"
#include "pipeline/content/annotations_import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static char base[64], file[100], folder[100];

/* Each says something. Returns how many are errors, and empties the list. */
static uint32_t count_errors(struct diagnostics *diagnostics)
{
	const uint32_t errors = diagnostics->error_count;

	for (uint32_t i = 0; i < diagnostics->count; i++) {
		const struct diagnostic *found = diagnostics_get(diagnostics, i);

		if (strlen(found->text + found->place_bytes) < 10)
			abort();
	}
	diagnostics_finish(diagnostics);
	return errors;
}

static void clean(void)
{
	char command[150];

	snprintf(command, sizeof(command), "rm -rf %s", base);
	if (system(command) != 0)
		abort();
}

/* A file written as any tool writes one: it need not outlive the power. */
static void write_input(const uint8_t *data, size_t size)
{
	FILE *out = fopen(file, "wb");

	if (!out || fwrite(data, 1, size, out) != size || fclose(out) != 0)
		abort();
}

static void begin(void)
{
	snprintf(base, sizeof(base), "/tmp/gopura-fuzz-XXXXXX");
	if (!mkdtemp(base) || atexit(clean) != 0)
		abort();
	snprintf(file, sizeof(file), "%s/in.jsonld", base);
	snprintf(folder, sizeof(folder), "%s/content", base);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct diagnostics diagnostics = { .max = INFO_DIAGNOSTICS_MAX };
	const struct annotations_import_options options = { .file = file,
							    .folder = folder,
							    .skip_unknown = size % 2,
							    .diagnostics = &diagnostics };
	const struct annotations_export_options export = { .folder = folder,
							   .diagnostics = &diagnostics };
	struct annotations_imported report;
	struct annotations annotations;
	char command[150];
	uint32_t errors;
	int rc;

	if (!base[0])
		begin();
	write_input(data, size);
	rc = annotations_import(&report, &options);
	errors = count_errors(&diagnostics);
	if (rc != 0 && (rc != -EINVAL || errors == 0 || access(folder, F_OK) == 0))
		abort();
	if (rc != 0)
		return 0;
	if (annotations_export(&annotations, &export) != 0 ||
	    annotations.count != report.part_count)
		abort();
	annotations_finish(&annotations);
	count_errors(&diagnostics);
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	if (system(command) != 0)
		abort();
	return 0;
}
