/* gopura-content export: makes one model of the scans, for a web page or a viewer of IIIF. */
#include "pipeline/commands.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/content/scans.h"
#include "pipeline/texmesh/texmesh.h"

static const char help[] =
	"gopura-content export: make one model of the scans within a number of bytes\n"
	"\n"
	"usage: gopura-content export DIR --out FILE.glb [OPTIONS]\n"
	"\n"
	"  --out FILE.glb   the file to write: glTF 2.0, for web pages, viewers of IIIF and modelling\n"
	"                   programs\n"
	"  --budget SIZE    the most that the file may take, such as 800kB or 5MB; 10kB to 1GB\n"
	"                   (default: 10MB)\n"
	"  --uniform        give all of a picture one quality; otherwise what has more relief has a\n"
	"                   better one\n"
	"  --jobs N         number of threads for reading the scans (default: one per core)\n"
	"\n"
	"Triangles become fewer, and pictures coarser, until both fit. docs/export.md explains how.\n"
	"Exit status: 0 done, 1 failed (the reason is printed), 2 wrong command line.\n"
	"\n"
	"Example:\n"
	"  gopura-content export temple --budget 5MB --out temple.glb\n";

enum { BUDGET_BYTES = 10000000 };

struct settings {
	const char *folder, *out; /* borrowed from argv */
	struct texmesh_options options;
	uint32_t jobs;
};

static void print_report(const struct texmesh_report *report, const char *out, size_t bytes)
{
	printf("%s: %.6g MB; triangles %.6g MB, pictures %.6g MB\n", out, (double)bytes / 1e6,
	       (double)report->mesh_bytes / 1e6, (double)report->picture_bytes / 1e6);
	printf("%u of %u triangles, %u vertices\n", report->triangle_count,
	       report->source_triangles, report->vertex_count);
	if (report->picture_count == 0)
		return;
	printf("%u pictures, their sides %s; %u fragments with qualities of %u to %u, "
	       "%.3g where feature points are as many as in the mean%s",
	       report->picture_count, report->halvings ? "made smaller" : "as they were",
	       report->fragment_count, report->quality_least, report->quality_most, report->quality,
	       report->scale ? "" : "\n");
	if (report->scale)
		printf(" (scale %u)\n", report->scale);
}

static int explain(int rc, const struct settings *settings, const struct texmesh_report *report)
{
	if (rc == -E2BIG)
		fprintf(stderr,
			"gopura-content export: %s does not fit into %.6g MB: give --budget %.3gMB or "
			"more\n",
			settings->folder, (double)settings->options.budget_bytes / 1e6,
			1.05 * (double)report->least_bytes / 1e6 + 0.001);
	else if (rc == -EFBIG)
		fprintf(stderr,
			"gopura-content export: %s has %u triangles, which are more than one file can "
			"be made of: export a part of the scans, in a temple.ini of its own\n",
			settings->folder, report->source_triangles);
	else
		fprintf(stderr, "gopura-content export: %s: %s\n", settings->folder, strerror(-rc));
	return rc;
}

static int make(struct settings *settings, struct scans *scans)
{
	const struct content *content = scans_content(scans);
	struct diagnostics diagnostics = { 0 };
	const struct scans_shape *shape;
	struct texmesh_report report;
	const struct mesh *mesh;
	struct buffer file;
	int rc = scans_get_mesh(scans, &mesh, &diagnostics);

	if (rc == 0)
		rc = scans_get_shape(scans, &shape, &diagnostics);
	if (rc < 0) {
		fprintf(stderr, "gopura-content export: %s\n", diagnostics_cause(&diagnostics, rc));
		return rc;
	}
	settings->options.lit = content_is_lit(content, shape->had_pictures);
	settings->options.look = (struct reduced_look){
		.is_stone = content->colours == CONTENT_COLOURS_PROCEDURAL,
		.substance = content->substance,
	};
	buffer_init(&file, TEXMESH_BUDGET_MOST_BYTES);
	rc = texmesh_make(&file, mesh, &settings->options, &report);
	scans_drop_mesh(scans);
	if (rc < 0) {
		rc = explain(rc, settings, &report);
	} else {
		rc = bytes_write_file(buffer_bytes(&file), settings->out);
		if (rc < 0)
			fprintf(stderr, "%s: %s; is the disk full, or the folder missing?\n",
				settings->out, strerror(-rc));
	}
	if (rc == 0)
		print_report(&report, settings->out, file.size);
	buffer_finish(&file);
	return rc;
}

static int run(struct settings *settings)
{
	struct content content;
	struct scans *scans = NULL;
	int rc = command_read_content(&content, settings->folder);

	if (rc < 0)
		return EXIT_FAILURE;
	content.import.jobs = settings->jobs;
	rc = scans_create(&scans, &content);
	if (rc == 0)
		rc = make(settings, scans);
	scans_destroy(scans);
	content_release(&content);
	return rc < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

static bool is_glb(const char *path)
{
	const size_t length = strlen(path);

	return length > 4 && strcmp(path + length - 4, ".glb") == 0;
}

int command_export(int argc, char **argv)
{
	static const struct option options[] = {
		{ "out", required_argument, NULL, 'o' }, { "budget", required_argument, NULL, 'b' },
		{ "uniform", no_argument, NULL, 'u' },   { "jobs", required_argument, NULL, 'j' },
		{ "help", no_argument, NULL, 'h' },      { NULL, 0, NULL, 0 },
	};
	struct settings settings = { .options = { .budget_bytes = BUDGET_BYTES } };
	uint64_t number;
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) >= 0) {
		switch (option) {
		case 'o':
			settings.out = optarg;
			break;
		case 'b':
			if (!command_size(optarg, &number) || number < TEXMESH_BUDGET_LEAST_BYTES ||
			    number > 1000000000)
				return command_wrong(
					argv[0], "--budget must be 10kB to 1GB, such as 5MB, not ",
					optarg);
			settings.options.budget_bytes = number;
			break;
		case 'u':
			settings.options.uniform = true;
			break;
		case 'j':
			if (!command_number(optarg, 1, 64, &number))
				return command_wrong(argv[0], "--jobs must be 1 to 64, not ",
						     optarg);
			settings.jobs = (uint32_t)number;
			break;
		case 'h':
			fputs(help, stdout);
			return 0;
		default:
			return 2;
		}
	}
	if (optind + 1 != argc)
		return command_wrong(argv[0], "name one content folder", "");
	if (!settings.out || !is_glb(settings.out))
		return command_wrong(argv[0], "give --out FILE.glb, not ",
				     settings.out ? settings.out : "none");
	settings.folder = argv[optind];
	return run(&settings);
}
