/* gopura-content reconstruct: makes one surface of aligned range images or clouds of points. */
#include "pipeline/commands.h"

#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/clock.h"
#include "base/resource_usage.h"
#include "pipeline/import/alignment.h"
#include "pipeline/import/import.h"
#include "pipeline/octree/budget_mesh.h"
#include "pipeline/octree/mesh_ply.h"
#include "pipeline/octree/reconstruct.h"

static const char help[] =
	"gopura-content reconstruct: make one surface of aligned range images\n"
	"\n"
	"usage: gopura-content reconstruct [OPTIONS] --out FILE.ply FILE...\n"
	"\n"
	"FILE is a range image, a cloud of points with normals or a mesh, as PLY; or a file that names\n"
	"such scans and where each lies: MeshLab's .aln and .mlp, Stanford's .conf. The result keeps\n"
	"their unit and axes.\n"
	"\n"
	"  --out FILE.ply  the file to write\n"
	"  --cell MM       side of a leaf cube in millimetres (default: 1.5 times the distance of\n"
	"                  neighbouring points)\n"
	"  --depth N       instead: 2^N leaf cubes along the longest side, 1 to 16\n"
	"  --closed        close all holes, so that the surface is watertight (default: it is open\n"
	"                  where nothing was scanned)\n"
	"  --budget-triangles N\n"
	"                  with --closed: at most N triangles, and as near to N as a watertight surface\n"
	"                  can be: detail where it adds most area, by the marching-cube octree\n"
	"  --keep-small    keep parts with less than a thousandth of the largest one's triangles, which\n"
	"                  are left out as noise otherwise\n"
	"  --unit UNIT     unit of the files: m (default), cm, mm, in, or its length in metres\n"
	"  --sight WHERE   where the scanner stood, in the axes of each range image: origin (at 0 0 0),\n"
	"                  or +x -x +y -y +z -z (far away on that side, with parallel lines of sight);\n"
	"                  default: parallel if the grid is even, else origin\n"
	"\n"
	"Exit status: 0 done, 1 failed (the reason is printed), 2 wrong command line.\n"
	"\n"
	"Examples:\n"
	"  gopura-content reconstruct happyStandRight.conf --cell 0.5 --closed --out buddha.ply\n"
	"  gopura-content reconstruct scans.aln --closed --budget-triangles 50000 --out small.ply\n"
	"  gopura-content reconstruct --unit mm --depth 9 --out wall.ply wall-*.ply\n";

struct settings {
	struct reconstruct_options reconstruct;
	double cell_mm, metres_per_unit;
	uint32_t budget; /* triangles; 0: all */
	const char *out;
};

struct inputs {
	struct alignment *alignments; /* one for each argument; most are empty; owned */
	uint32_t alignment_count;
	struct reconstruct_scan *scans; /* owned; borrow from the arguments and alignments */
	uint32_t count, room;
};

static int add_input(struct inputs *inputs, const char *path, const struct transform *transform)
{
	int rc = ARRAY_RESERVE(inputs->scans, inputs->room, inputs->count + 1, 1u << 20);

	if (rc < 0)
		fprintf(stderr, "gopura-content reconstruct: %s: %s\n", path, strerror(-rc));
	else
		inputs->scans[inputs->count++] = (struct reconstruct_scan){ path, transform };
	return rc;
}

static int add_argument(struct inputs *inputs, const char *path)
{
	struct diagnostics diagnostics = { .max = ALIGNMENT_SCANS_MAX };
	struct alignment *alignment = &inputs->alignments[inputs->alignment_count];
	int rc;

	if (!alignment_is_named(path))
		return add_input(inputs, path, NULL);
	rc = alignment_read(alignment, path, &diagnostics);
	if (rc < 0)
		diagnostics_print(&diagnostics, stderr, "");
	diagnostics_finish(&diagnostics);
	inputs->alignment_count++;
	diagnostics_print(&alignment->left_out, stderr, "warning: ");
	for (uint32_t i = 0; i < alignment->count && rc == 0; i++)
		rc = add_input(inputs, alignment->scans[i].path, &alignment->scans[i].transform);
	return rc;
}

static int list_inputs(struct inputs *inputs, char **paths, int count)
{
	int rc = 0;

	inputs->alignments = calloc((size_t)count, sizeof(*inputs->alignments));
	if (!inputs->alignments) {
		fprintf(stderr, "gopura-content reconstruct: %s\n", strerror(ENOMEM));
		return -ENOMEM;
	}
	for (int i = 0; i < count && rc == 0; i++)
		rc = add_argument(inputs, paths[i]);
	return rc;
}

/* Checks --out against all that is read: the scans, and the files that place them. */
static int check_out(const char *out, const struct inputs *inputs, char **paths, int count)
{
	int rc = 0;

	for (int i = 0; i < count && rc == 0; i++)
		rc = command_check_out("reconstruct", out, paths[i]);
	for (uint32_t i = 0; i < inputs->count && rc == 0; i++)
		rc = command_check_out("reconstruct", out, inputs->scans[i].path);
	return rc;
}

static void inputs_finish(struct inputs *inputs)
{
	for (uint32_t i = 0; i < inputs->alignment_count; i++)
		alignment_finish(&inputs->alignments[i]);
	free(inputs->alignments);
	free(inputs->scans);
}

static void print_report(const struct reconstruct_report *report, const struct inputs *inputs,
			 const struct mesh *mesh, const struct settings *settings, int64_t began_ms)
{
	const double mm = settings->metres_per_unit * 1000;
	struct resource_usage usage;

	resource_usage_now(&usage);
	printf("%u scans (%u range images), %" PRIu64 " points, %" PRIu64 " left out\n",
	       inputs->count, report->range_images, report->points, report->dropped);
	if (report->spacing > 0)
		printf("distance of neighbouring points: %.4g mm (median)\n", report->spacing * mm);
	printf("leaf cubes: %.4g mm; box %.4g x %.4g x %.4g m\n", report->cell * mm,
	       (report->high[0] - report->low[0]) * settings->metres_per_unit,
	       (report->high[1] - report->low[1]) * settings->metres_per_unit,
	       (report->high[2] - report->low[2]) * settings->metres_per_unit);
	printf("surface: %u triangles, %u vertices, %u parts (%u small ones left out), %u border "
	       "edges, %u crowded edges\n",
	       mesh->triangle_count, mesh->vertex_count, report->parts, report->dropped_parts,
	       report->border_edges, report->crowded_edges);
	printf("%.1f s, at most %.0f MB resident\n", (double)(clock_now_ms() - began_ms) / 1000,
	       (double)usage.own_bytes / 1e6);
}

/* Replaces the mesh by one with at most the budget of triangles. */
static int meet_budget(struct mesh *mesh, struct budget_leaves *leaves,
		       struct reconstruct_report *report, const struct settings *settings)
{
	const bool has_colour = mesh->colours != NULL;
	const uint32_t all = mesh->triangle_count;
	struct lod_model model = { 0 };
	int64_t began_us = clock_now_us(), made_us;
	int rc = budget_model_create(&model, leaves, mesh, report);

	mesh_finish(mesh);
	made_us = clock_now_us();
	if (rc == 0)
		rc = budget_mesh_make(mesh, &model, report, has_colour, settings->budget);
	if (rc == -ENODATA)
		fprintf(stderr, "no surface has only %u triangles; allow more\n", settings->budget);
	else if (rc < 0)
		fprintf(stderr, "octree: %s; choose larger leaf cubes\n", strerror(-rc));
	else
		printf("budget: %u of %u triangles; octree %.2f s, mesh %.1f ms\n",
		       mesh->triangle_count, all, (double)(made_us - began_us) / 1e6,
		       (double)(clock_now_us() - made_us) / 1e3);
	lod_model_finish(&model);
	return rc == 0 ? reconstruct_judge(mesh, report) : rc;
}

static int run(const struct settings *settings, char **paths, int count)
{
	struct reconstruct_options options = settings->reconstruct;
	struct budget_leaves leaves = { 0 };
	struct diagnostics diagnostics = { 0 };
	struct reconstruct_report report;
	struct inputs inputs = { 0 };
	struct mesh mesh = { 0 };
	const int64_t began_ms = clock_now_ms();
	int rc = list_inputs(&inputs, paths, count);

	if (rc == 0)
		rc = check_out(settings->out, &inputs, paths, count);
	if (settings->budget > 0) {
		options.leaf = budget_leaf_add;
		options.data = &leaves;
	}
	if (rc == 0) {
		rc = reconstruct(&mesh, inputs.scans, inputs.count, &options, &report,
				 &diagnostics);
		if (rc < 0)
			fprintf(stderr, "%s\n", diagnostics_cause(&diagnostics, rc));
	}
	if (rc == 0 && settings->budget > 0)
		rc = meet_budget(&mesh, &leaves, &report, settings);
	if (rc == 0) {
		rc = mesh_ply_write(&mesh, settings->out);
		if (rc < 0)
			fprintf(stderr, "%s: %s; is the disk full, or the folder missing?\n",
				settings->out, strerror(-rc));
	}
	if (rc == 0)
		print_report(&report, &inputs, &mesh, settings, began_ms);
	mesh_finish(&mesh);
	budget_leaves_finish(&leaves);
	inputs_finish(&inputs);
	return rc < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* Parses a length above 0. Returns false otherwise. */
static bool length_named(const char *text, double *out)
{
	char *end;

	*out = strtod(text, &end);
	return end != text && *end == '\0' && *out > 0 && *out <= 1e9;
}

/* Returns 0 to go on, otherwise the exit status plus one. */
static int take_option(struct settings *settings, const char *command, int option)
{
	uint64_t number = 0;

	switch (option) {
	case 'o':
		settings->out = optarg;
		return 0;
	case 'c':
		if (!length_named(optarg, &settings->cell_mm))
			return command_wrong(command, "--cell must be millimetres above 0, not ",
					     optarg) +
			       1;
		return 0;
	case 'd':
		if (!command_number(optarg, 1, RECONSTRUCT_DEPTH_MAX, &number))
			return command_wrong(command, "--depth must be 1 to 16, not ", optarg) + 1;
		settings->reconstruct.depth = (uint32_t)number;
		return 0;
	case 'w':
		settings->reconstruct.is_closed = true;
		return 0;
	case 'b':
		if (!command_number(optarg, 1, UINT32_MAX - 1, &number))
			return command_wrong(command, "--budget-triangles must be a number, not ",
					     optarg) +
			       1;
		settings->budget = (uint32_t)number;
		return 0;
	case 'k':
		settings->reconstruct.keep_small = true;
		return 0;
	case 'u':
		if (!import_unit_named(optarg, &settings->metres_per_unit))
			return command_wrong(command,
					     "--unit must be m, cm, mm, in or a number, not ",
					     optarg) +
			       1;
		return 0;
	case 's':
		if (!range_sight_named(optarg, &settings->reconstruct.sight))
			return command_wrong(command,
					     "--sight must be auto, origin, +x, -x, +y, -y, +z or "
					     "-z, not ",
					     optarg) +
			       1;
		return 0;
	case 'h':
		fputs(help, stdout);
		return 1;
	default:
		return 3;
	}
}

int command_reconstruct(int argc, char **argv)
{
	static const struct option options[] = {
		{ "out", required_argument, NULL, 'o' },
		{ "cell", required_argument, NULL, 'c' },
		{ "depth", required_argument, NULL, 'd' },
		{ "closed", no_argument, NULL, 'w' },
		{ "unit", required_argument, NULL, 'u' },
		{ "sight", required_argument, NULL, 's' },
		{ "budget-triangles", required_argument, NULL, 'b' },
		{ "keep-small", no_argument, NULL, 'k' },
		{ "help", no_argument, NULL, 'h' },
		{ NULL, 0, NULL, 0 },
	};
	struct settings settings = { .metres_per_unit = 1 };
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) >= 0) {
		const int stop = take_option(&settings, argv[0], option);

		if (stop)
			return stop - 1;
	}
	if (settings.cell_mm > 0 && settings.reconstruct.depth > 0)
		return command_wrong(argv[0], "give --cell or --depth, not both", "");
	if (settings.budget > 0 && !settings.reconstruct.is_closed)
		return command_wrong(argv[0], "--budget-triangles needs --closed", "");
	if (!settings.out)
		return command_wrong(argv[0], "give --out FILE.ply", "");
	if (optind == argc)
		return command_wrong(argv[0], "name at least one scan", "");
	settings.reconstruct.cell = settings.cell_mm / 1000 / settings.metres_per_unit;
	return run(&settings, argv + optind, argc - optind);
}
