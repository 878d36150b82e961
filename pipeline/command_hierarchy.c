/* gopura-content hierarchy: makes the multiresolution hierarchy of a content folder and reports its
 * levels. */
#include "pipeline/commands.h"

#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/build.h"
#include "pipeline/content/scans.h"
#include "pipeline/hierarchy/master.h"
#include "pipeline/hierarchy/master_cut.h"

static const char help[] =
	"gopura-content hierarchy: make the multiresolution hierarchy of a content folder\n"
	"\n"
	"usage: gopura-content hierarchy DIR [OPTIONS]\n"
	"\n"
	"  --hierarchy KIND   groups or tree (default: as in temple.ini, [hierarchy] kind)\n"
	"  --jobs N           number of threads (default: one per core); the result does not depend on\n"
	"                     it\n"
	"  --shard I/N        for N machines that share DIR: each begins with another part of the work\n"
	"                     and goes on with what is left; I is counted from 0\n"
	"  --force            make it again even if nothing changed\n"
	"\n"
	"Reads the scans named in DIR/temple.ini and writes DIR/.work/master. Does nothing if scans and\n"
	"options have not changed.\n"
	"Exit status: 0 done, 1 failed (the reason is printed), 2 wrong command line.\n"
	"\n"
	"Examples:\n"
	"  gopura-content hierarchy temple\n"
	"  gopura-content hierarchy temple --hierarchy tree --jobs 8\n"
	"  parallel gopura-content hierarchy --shard {}/4 temple ::: 0 1 2 3\n";

struct settings {
	const char *folder; /* borrowed from argv */
	const char *kind;   /* NULL: as in temple.ini */
	uint32_t jobs;
	struct shard shard;
	bool force;
};

static void print_master(const struct master *master, double share)
{
	const struct hierarchy *hierarchy = &master->hierarchy;
	struct master_cut cut;
	uint64_t triangles = 0;

	for (uint32_t p = 0; p < hierarchy->groups[0].patch_count; p++)
		triangles += hierarchy->patches[p].triangle_count;
	printf("coarsest cut: %" PRIu64 " triangles, %" PRIu32 " bytes\n", triangles,
	       master->sizes[0]);
	if (master_cut_create(&cut, master, share) < 0) {
		printf("published: nothing fits in %.3g %% of the scan's triangles\n",
		       100.0 * share);
		return;
	}
	printf("published: %" PRIu32 " of %" PRIu32 " groups, %" PRIu64 " triangles (%.2f %%)\n",
	       cut.hierarchy.group_count, hierarchy->group_count, cut.triangle_count,
	       100.0 * (double)cut.triangle_count / (double)master->source_triangles);
	master_cut_finish(&cut);
}

static void print_report(const struct master_report *report, uint64_t source_triangles)
{
	const struct multires_stats *stats = &report->stats;
	double seconds = (double)report->duration_ms / 1000.0;

	if (stats->level_count == 0) {
		puts("another process completed it");
		return;
	}
	for (uint32_t i = 0; i < stats->level_count; i++)
		printf("level %2" PRIu32 ": %9" PRIu64 " triangles, %6" PRIu32 " patches, %5" PRIu32
		       " groups\n",
		       i, stats->levels[i].triangle_count, stats->levels[i].patch_count,
		       stats->levels[i].group_count);
	printf("merged %" PRIu32 " vertices, dropped %" PRIu32 " degenerate and %" PRIu32
	       " duplicate triangles; %" PRIu32 " open edges, %" PRIu32 " crowded edges\n",
	       report->counts.merged_vertices, report->counts.degenerate_triangles,
	       report->counts.duplicate_triangles, report->counts.border_edges,
	       report->counts.crowded_edges);
	printf("%" PRIu64 " bytes, %.1f bits a vertex; %.1f s, %.2f million triangles a second\n",
	       stats->object_bytes, 8.0 * (double)stats->object_bytes / (double)stats->vertex_count,
	       seconds, (double)source_triangles / 1e6 / (seconds > 0.0 ? seconds : 1e-3));
}

static int make(const struct settings *settings, struct scans *scans)
{
	const struct build_master_options options = { .jobs = settings->jobs,
						      .shard = settings->shard,
						      .force = settings->force };
	struct diagnostics diagnostics = { 0 };
	struct build_master_report report;
	struct master *master;
	int rc = build_master(&master, scans, &options, &report, &diagnostics);

	if (rc < 0) {
		fprintf(stderr, "gopura-content hierarchy: %s\n",
			diagnostics_cause(&diagnostics, rc));
		return rc;
	}
	if (report.made)
		print_report(&report.master, master->source_triangles);
	else
		puts("nothing changed");
	print_master(master, scans_content(scans)->publish_share);
	master_destroy(master);
	return 0;
}

static int run(const struct settings *settings)
{
	struct content content;
	struct scans *scans = NULL;
	int rc = command_read_content(&content, settings->folder);

	if (rc < 0)
		return EXIT_FAILURE;
	content.import.jobs = settings->jobs;
	if (settings->kind)
		content.binary_tree = strcmp(settings->kind, "tree") == 0;
	rc = scans_create(&scans, &content);
	if (rc == 0)
		rc = make(settings, scans);
	scans_destroy(scans);
	content_release(&content);
	return rc < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

int command_hierarchy(int argc, char **argv)
{
	static const struct option options[] = {
		{ "hierarchy", required_argument, NULL, 'k' },
		{ "jobs", required_argument, NULL, 'j' },
		{ "shard", required_argument, NULL, 's' },
		{ "force", no_argument, NULL, 'f' },
		{ "help", no_argument, NULL, 'h' },
		{ NULL, 0, NULL, 0 },
	};
	struct settings settings = { 0 };
	int option;
	uint64_t jobs = 0;

	while ((option = getopt_long(argc, argv, "", options, NULL)) >= 0) {
		switch (option) {
		case 'k':
			if (strcmp(optarg, "groups") != 0 && strcmp(optarg, "tree") != 0)
				return command_wrong(argv[0],
						     "--hierarchy must be groups or tree, not ",
						     optarg);
			settings.kind = optarg;
			break;
		case 'j':
			if (!command_number(optarg, 1, 64, &jobs))
				return command_wrong(argv[0], "--jobs must be 1 to 64, not ",
						     optarg);
			settings.jobs = (uint32_t)jobs;
			break;
		case 's':
			if (!command_shard(optarg, &settings.shard))
				return command_wrong(argv[0],
						     "--shard must be I/N with I below N, not ",
						     optarg);
			break;
		case 'f':
			settings.force = true;
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
	settings.folder = argv[optind];
	return run(&settings);
}
