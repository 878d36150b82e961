/* A file of annotations of anybody's: refused with a diagnostic and nothing left behind, or a
 * content folder that goes out again. What goes out comes in as the same; as a manifest, which
 * cannot say all, it is taken or refused. */
#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/content/annotations.h"
#include "pipeline/content/annotations_export.h"
#include "pipeline/content/annotations_import.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/small_png.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static char folder[100], again[100]; /* that imports make */

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

static int remove_one(const char *path, const struct stat *info, int kind, struct FTW *place)
{
	(void)info;
	(void)kind;
	(void)place;
	return remove(path);
}

static void remove_folder(const char *path)
{
	if (nftw(path, remove_one, 8, FTW_DEPTH | FTW_PHYS) != 0)
		abort();
}

/* Beside the inputs are a picture and one that is none. */
static void begin(void)
{
	scratch_begin();
	if (mkdir(scratch_path("pictures"), 0700) < 0)
		abort();
	scratch_write("pictures/a.png", small_png, sizeof(small_png));
	scratch_write("pictures/b.png", small_png, sizeof(small_png) - 20);
	snprintf(folder, sizeof(folder), "%s", scratch_path("content"));
	snprintf(again, sizeof(again), "%s", scratch_path("again"));
}

/* Returns whether the file was taken. */
static bool import(struct annotations_imported *report, const char *name, const char *into,
		   size_t size)
{
	struct diagnostics diagnostics = { .max = INFO_DIAGNOSTICS_MAX };
	char file[128];
	const struct annotations_import_options options = { .file = file,
							    .folder = into,
							    .y_is_up = size / 2 % 2,
							    .skip_unknown = size % 2,
							    .diagnostics = &diagnostics };
	uint32_t errors;
	int rc;

	snprintf(file, sizeof(file), "%s", scratch_path(name));
	rc = annotations_import(report, &options);
	errors = count_errors(&diagnostics);
	if ((rc == 0) != (errors == 0) || (rc != 0 && (rc != -EINVAL || access(into, F_OK) == 0)))
		abort();
	return rc == 0;
}

/* Into name; manifest_base as in the options. */
static void export(struct annotations *out, const char *from, const char *manifest_base,
		   const char *name)
{
	struct diagnostics diagnostics = { .max = INFO_DIAGNOSTICS_MAX };
	const struct annotations_export_options options = { .folder = from,
							    .manifest_base = manifest_base,
							    .diagnostics = &diagnostics };

	if (annotations_export(out, &options) != 0 || count_errors(&diagnostics) > 0)
		abort();
	scratch_write(name, out->json.data, out->json.size);
}

static void comes_back(void)
{
	struct annotations first, second;
	struct annotations_imported report;

	export(&first, folder, NULL, "out.jsonld");
	if (!import(&report, "out.jsonld", again, 0) || report.part_count != first.count)
		abort();
	export(&second, again, NULL, "out.jsonld");
	if (first.json.size != second.json.size ||
	    memcmp(first.json.data, second.json.data, first.json.size) != 0)
		abort();
	annotations_finish(&first);
	annotations_finish(&second);
	remove_folder(again);
}

/* With scans that are turned, sheared and in their place. */
static void is_a_manifest(void)
{
	static const char ini[] = "[model]\nscans = a.ply b.glb site.aln\nunit = m\n";
	static const char site[] = "4\na.ply\n#\n0 -2 0 5\n2 0 0 6\n0 0 2 7\n0 0 0 1\n"
				   "a.ply\n#\n1 0.5 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
				   "a.ply\n#\n1 0 0 0\n0 0 -1 0\n0 1 0 0\n0 0 0 1\n"
				   "a.ply\n#\n0 0 1 0\n0 -1 0 0\n1 0 0 0\n0 0 0 1\n0\n";
	struct annotations manifest;
	struct annotations_imported report;

	scratch_write("content/temple.ini", (const uint8_t *)ini, sizeof(ini) - 1);
	scratch_write("content/site.aln", (const uint8_t *)site, sizeof(site) - 1);
	scratch_write("content/a.ply", (const uint8_t *)"ply\n", 4);
	scratch_write("content/b.glb", (const uint8_t *)"glTF", 4);
	export(&manifest, folder, "https://example.org/t", "out.json");
	if (import(&report, "out.json", again, 0)) {
		if (report.part_count != manifest.count)
			abort();
		remove_folder(again);
	}
	annotations_finish(&manifest);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct annotations_imported report;

	if (!scratch[0])
		begin();
	scratch_write("in.jsonld", data, size);
	if (!import(&report, "in.jsonld", folder, size))
		return 0;
	comes_back();
	is_a_manifest();
	remove_folder(folder);
	return 0;
}
