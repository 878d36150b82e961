/* gopura-content import: reads scans, reports what was found and repaired, and can save the joined
 * mesh. */
#include "pipeline/commands.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/import/alignment.h"
#include "pipeline/import/import.h"
#include "pipeline/import/import_report.h"
#include "pipeline/import/mesh_file.h"

static const char help[] =
	"gopura-content import: read scans, report what was found and repaired\n"
	"\n"
	"usage: gopura-content import [OPTIONS] FILE...\n"
	"\n"
	"FILE is a scan, an alignment (MeshLab's .aln and .mlp, Stanford's .conf) or a IIIF manifest\n"
	"(.json): the scans it names, each in its place.\n"
	"\n"
	"  --up AXIS       axis that points up in the files: z (default), y or x\n"
	"  --unit UNIT     unit of the files: m (default), cm, mm, in, or its length in metres (0.0254)\n"
	"  --out FILE      save the mesh of all files together as a cache file\n"
	"  --jobs N        number of threads (default: one per core); the result does not depend on it\n"
	"\n"
	"Reads PLY, OBJ with MTL and JPEG or PNG pictures, STL, OFF, glTF, GLB and\n"
	"VRML97.\n"
	"Exit status: 0 all files were read, 1 at least one was refused, 2 wrong command line.\n"
	"\n"
	"Examples:\n"
	"  gopura-content import statue.ply\n"
	"  gopura-content import --up y --unit mm tower.obj gallery.obj --out temple.mesh\n"
	"  gopura-content import site.mlp\n";

struct settings {
	struct import_options import;
	const char *out; /* borrowed from argv */
};

static int read_scan(struct mesh *all, const char *path, const struct transform *transform,
		     const struct settings *settings)
{
	struct import_options options = settings->import;
	struct import_report report;
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	int rc;

	options.transform = transform;
	rc = import_scan(&mesh, path, &options, &report, &diagnostics);
	if (rc < 0) {
		fprintf(stderr, "%s\n", diagnostics_cause(&diagnostics, rc));
		return rc;
	}
	import_report_print(stdout, path, &report);
	if (settings->out && all->scan_count == 0) {
		*all = mesh;
		mesh = (struct mesh){ 0 };
	} else if (settings->out) {
		rc = mesh_append(all, &mesh);
	}
	mesh_finish(&mesh);
	if (rc < 0)
		fprintf(stderr, "%s: cannot be merged with the other files: %s\n", path,
			strerror(-rc));
	return rc;
}

static int read_alignment(struct mesh *all, const char *path, const struct settings *settings)
{
	struct diagnostics diagnostics = { .max = ALIGNMENT_SCANS_MAX };
	struct alignment alignment;
	int rc = alignment_read(&alignment, path, &diagnostics);

	if (rc < 0)
		diagnostics_print(&diagnostics, stderr, "");
	diagnostics_print(&alignment.left_out, stderr, "warning: ");
	if (rc == 0 && alignment.y_is_up && settings->import.up != IMPORT_Y_UP) {
		fprintf(stderr, "%s: in a manifest y is up: give --up y\n", path);
		alignment_finish(&alignment);
		return -EINVAL;
	}
	for (uint32_t i = 0; i < alignment.count; i++) {
		const struct alignment_scan *scan = &alignment.scans[i];
		int failed = read_scan(all, scan->path, &scan->transform, settings);

		rc = rc == 0 ? failed : rc;
	}
	alignment_finish(&alignment);
	diagnostics_finish(&diagnostics);
	return rc;
}

static int read_one(struct mesh *all, const char *path, const struct settings *settings)
{
	return alignment_is_named(path) ? read_alignment(all, path, settings)
					: read_scan(all, path, NULL, settings);
}

static int read_all(char **paths, int count, const struct settings *settings)
{
	const struct hash no_key = { { 0 } };
	struct mesh all = { 0 };
	int status = EXIT_SUCCESS;

	for (int i = 0; i < count; i++)
		if (read_one(&all, paths[i], settings) < 0)
			status = EXIT_FAILURE;
	if (settings->out && status == EXIT_SUCCESS) {
		int rc = mesh_file_move(&all, no_key, settings->out);

		if (rc < 0) {
			fprintf(stderr, "%s: %s\n", settings->out, strerror(-rc));
			status = EXIT_FAILURE;
		}
	}
	mesh_finish(&all);
	return status;
}

int command_import(int argc, char **argv)
{
	static const struct option options[] = {
		{ "up", required_argument, NULL, 'a' },  { "unit", required_argument, NULL, 'u' },
		{ "out", required_argument, NULL, 'o' }, { "jobs", required_argument, NULL, 'j' },
		{ "help", no_argument, NULL, 'h' },      { NULL, 0, NULL, 0 },
	};
	struct settings settings = { 0 };
	uint64_t jobs;
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) >= 0) {
		switch (option) {
		case 'a':
			if (!import_axis_named(optarg, &settings.import.up))
				return command_wrong(argv[0], "--up must be x, y or z, not ",
						     optarg);
			break;
		case 'u':
			if (!import_unit_named(optarg, &settings.import.metres_per_unit))
				return command_wrong(
					argv[0], "--unit must be m, cm, mm, in or a number, not ",
					optarg);
			break;
		case 'o':
			settings.out = optarg;
			break;
		case 'j':
			if (!command_number(optarg, 1, 64, &jobs))
				return command_wrong(argv[0], "--jobs must be 1 to 64, not ",
						     optarg);
			settings.import.jobs = (uint32_t)jobs;
			break;
		case 'h':
			fputs(help, stdout);
			return 0;
		default:
			return 2;
		}
	}
	if (optind == argc)
		return command_wrong(argv[0], "name at least one file", "");
	return read_all(argv + optind, argc - optind, &settings);
}
