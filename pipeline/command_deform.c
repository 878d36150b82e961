/* gopura-content deform: bends a scan, such as a leaning pillar into a straight one. */
#include "pipeline/commands.h"

#include <getopt.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/parallel.h"
#include "base/resource_usage.h"
#include "pipeline/deform/deform.h"
#include "pipeline/deform/mesh_obj.h"
#include "pipeline/import/import.h"
#include "pipeline/octree/mesh_ply.h"

static const char help[] =
	"gopura-content deform: bend a scan, such as a leaning pillar into a straight one\n"
	"\n"
	"usage: gopura-content deform --with FILE.json --out FILE.ply|FILE.obj SCAN\n"
	"\n"
	"  --with FILE.json  how: lattices around the scan, and how their points move; docs/deform.md\n"
	"                    explains it\n"
	"  --out FILE        the file to write; it keeps the scan's unit and axes. Both keep its\n"
	"                    colours, an .obj its textures too, in files of that name beside it\n"
	"  --jobs N          number of threads (default: one per core); the result does not depend\n"
	"                    on it\n"
	"\n"
	"Triangles are divided where they bend, and nowhere else. What would fold over is refused.\n"
	"Exit status: 0 done, 1 failed (the reason is printed), 2 wrong command line.\n"
	"\n"
	"Example:\n"
	"  gopura-content deform --with upright.json --out upright.ply pillar.ply\n";

struct settings {
	const char *with, *out, *scan; /* borrowed from argv */
	uint32_t jobs;
};

static bool ends_with(const char *name, const char *extension)
{
	const char *end = strrchr(name, '.');

	return end && strcmp(end, extension) == 0;
}

static void print_measure(const char *when, const struct mesh_measure *m, const double length[3])
{
	printf("%-7s box %g x %g x %g, lines through its middle %.6g, %.6g, %.6g\n", when,
	       (double)(m->high[0] - m->low[0]), (double)(m->high[1] - m->low[1]),
	       (double)(m->high[2] - m->low[2]), length[0], length[1], length[2]);
	printf("        area %.6g, ", m->area);
	if (m->border_edges == 0)
		printf("volume %.6g", m->volume);
	else
		printf("open (%u border edges), so it has no volume", m->border_edges);
	printf(", %u triangles\n", m->triangles);
}

static void print_report(const struct deform_report *report, int64_t began_ms)
{
	struct resource_usage usage;

	print_measure("before:", &report->before, report->length_before);
	print_measure("after:", &report->after, report->length_after);
	printf("around a vertex, space grew %.4g to %.4g times\n", report->least_growth,
	       report->most_growth);
	resource_usage_now(&usage);
	printf("tolerance %g; %.1f s, at most %.0f MB resident\n", report->tolerance,
	       (double)(clock_now_ms() - began_ms) / 1000, (double)usage.own_bytes / 1e6);
}

/* A scan without colours gets none, and one with textures loses them in a PLY. */
static int write(struct mesh *mesh, const struct import_report *imported, const char *out)
{
	const bool is_obj = ends_with(out, ".obj");
	uint8_t(*colours)[4] = mesh->colours;
	int rc;

	if (!imported->had_colours && imported->textures == 0)
		mesh->colours = NULL;
	rc = is_obj ? mesh_obj_write(mesh, out) : mesh_ply_write(mesh, out);
	mesh->colours = colours;
	if (rc == 0 && !is_obj && imported->textures > 0)
		fprintf(stderr,
			"%s: a PLY has colours at its vertices instead of the %u textures of the scan; "
			"give --out FILE.obj to keep these\n",
			out, imported->textures);
	if (rc < 0)
		fprintf(stderr, "%s: %s; is the disk full, or the folder missing?\n", out,
			strerror(-rc));
	return rc;
}

static int run(const struct settings *settings)
{
	const struct import_options options = { .jobs = settings->jobs };
	const int64_t began_ms = clock_now_ms();
	struct diagnostics diagnostics = { 0 };
	struct import_report imported;
	struct deform_report report;
	struct deform_plan plan;
	struct mesh mesh = { 0 };
	int rc = deform_plan_read(&plan, settings->with, &diagnostics);

	if (rc == 0)
		rc = import_scan(&mesh, settings->scan, &options, &imported, &diagnostics);
	if (rc == 0)
		diagnostics_print(&imported.warning, stderr, "warning: ");
	if (rc == 0)
		rc = deform(&mesh, &plan, settings->with, settings->jobs, &report, &diagnostics);
	if (rc < 0)
		fprintf(stderr, "%s\n", diagnostics_cause(&diagnostics, rc));
	if (rc == 0)
		rc = write(&mesh, &imported, settings->out);
	if (rc == 0)
		print_report(&report, began_ms);
	mesh_finish(&mesh);
	deform_plan_finish(&plan);
	return rc < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

int command_deform(int argc, char **argv)
{
	static const struct option options[] = {
		{ "with", required_argument, NULL, 'w' },
		{ "out", required_argument, NULL, 'o' },
		{ "jobs", required_argument, NULL, 'j' },
		{ "help", no_argument, NULL, 'h' },
		{ NULL, 0, NULL, 0 },
	};
	struct settings settings = { .jobs = parallel_cores() };
	uint64_t jobs;
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) >= 0) {
		switch (option) {
		case 'w':
			settings.with = optarg;
			break;
		case 'o':
			settings.out = optarg;
			break;
		case 'j':
			if (!command_number(optarg, 1, 64, &jobs))
				return command_wrong(argv[0], "--jobs must be 1 to 64, not ",
						     optarg);
			settings.jobs = (uint32_t)jobs;
			break;
		case 'h':
			fputs(help, stdout);
			return 0;
		default:
			return 2;
		}
	}
	if (!settings.with || !settings.out)
		return command_wrong(argv[0],
				     "give --with FILE.json and --out FILE.ply or FILE.obj", "");
	if (!ends_with(settings.out, ".ply") && !ends_with(settings.out, ".obj"))
		return command_wrong(argv[0], "give --out FILE.ply or FILE.obj, not ",
				     settings.out);
	if (argc - optind != 1)
		return command_wrong(argv[0], "name one scan", "");
	settings.scan = argv[optind];
	if (command_check_out(argv[0], settings.out, settings.scan) < 0 ||
	    command_check_out(argv[0], settings.out, settings.with) < 0)
		return EXIT_FAILURE;
	return run(&settings);
}
