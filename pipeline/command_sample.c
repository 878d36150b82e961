/* gopura-content sample: renders the sampling images of a content folder. */
#include "pipeline/commands.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/build.h"

static const char help[] =
	"gopura-content sample: render the sampling images of a content folder\n"
	"\n"
	"usage: gopura-content sample [OPTIONS] DIR\n"
	"\n"
	"  --jobs N        number of processes (default: one per core)\n"
	"  --shard I/N     only part I of N equal parts, counted from 0, for machines that share DIR;\n"
	"                  where the hierarchy is missing, they make it together\n"
	"  --for-budget    store each tile at five qualities, as 'build --budget' needs\n"
	"  --below-ground  also sample points below the lowest point of the model\n"
	"\n"
	"Section [grid] of DIR/temple.ini sets grid and resolution. The images stay in\n"
	"DIR/.work/samples; another run renders only what is missing or has changed.\n"
	"Exit status: 0 all images exist, 1 failed, 2 wrong command line.\n"
	"\n"
	"Examples:\n"
	"  gopura-content sample temple\n"
	"  parallel gopura-content sample --shard {}/8 temple ::: 0 1 2 3 4 5 6 7\n";

struct settings {
	struct sampler_options options;
	bool is_for_budget;
	const char *dir; /* borrowed from argv */
};

static bool read_settings(int argc, char **argv, struct settings *settings)
{
	struct sampler_options *options = &settings->options;
	static const struct option names[] = { { "jobs", required_argument, NULL, 'j' },
					       { "shard", required_argument, NULL, 's' },
					       { "for-budget", no_argument, NULL, 'f' },
					       { "below-ground", no_argument, NULL, 'b' },
					       { "help", no_argument, NULL, 'h' },
					       { NULL, 0, NULL, 0 } };
	uint64_t jobs;
	int option;

	optind = 1;
	while ((option = getopt_long(argc, argv, "h", names, NULL)) != -1) {
		switch (option) {
		case 'j':
			if (!command_number(optarg, 1, 64, &jobs))
				return false;
			options->jobs = (uint32_t)jobs;
			break;
		case 's':
			if (!command_shard(optarg, &options->shard))
				return false;
			break;
		case 'f':
			settings->is_for_budget = true;
			break;
		case 'b':
			options->below_ground = true;
			break;
		case 'h':
			fputs(help, stdout);
			exit(EXIT_SUCCESS);
		default:
			return false;
		}
	}
	settings->dir = argv[optind];
	return argc == optind + 1;
}

/* The master comes first: what is far from a point is drawn from its coarser patches. */
static int run(struct scans *scans, const struct sampler_options *options,
	       struct diagnostics *diagnostics)
{
	const struct build_master_options mastering = { .jobs = options->jobs,
							.shard = options->shard };
	struct build_master_report report;
	struct master *master;
	int rc = build_master(&master, scans, &mastering, &report, diagnostics);

	if (rc == 0)
		rc = build_samples(scans, master, options, diagnostics);
	master_destroy(master);
	return rc;
}

static void report(const char *dir)
{
	struct samples_store *store;
	uint32_t counts[SAMPLE_STATES];

	if (samples_store_open(&store, dir) < 0)
		return;
	samples_store_states(store, counts);
	printf("%s: %u points rendered, %u see nothing, %u in solid matter, %u below the ground\n",
	       dir, counts[SAMPLE_RENDERED], counts[SAMPLE_EMPTY], counts[SAMPLE_INSIDE],
	       counts[SAMPLE_GROUND]);
	samples_store_close(store);
}

int command_sample(int argc, char **argv)
{
	struct settings settings = { 0 };
	struct diagnostics diagnostics = { 0 };
	struct content content;
	struct scans *scans = NULL;
	int rc;

	if (!read_settings(argc, argv, &settings)) {
		fputs("gopura-content sample: give one content folder; see --help\n", stderr);
		return 2;
	}
	rc = command_read_content(&content, settings.dir);
	if (rc < 0)
		return EXIT_FAILURE;
	content.import.jobs = settings.options.jobs;
	if (settings.is_for_budget)
		content.budget_bytes =
			UINT64_MAX; /* any: samples depend only on whether there is one */
	rc = scans_create(&scans, &content);
	if (rc == 0)
		rc = run(scans, &settings.options, &diagnostics);
	scans_destroy(scans);
	content_release(&content);
	if (rc < 0) {
		fprintf(stderr, "%s\n", diagnostics_cause(&diagnostics, rc));
		return EXIT_FAILURE;
	}
	if (settings.options.shard.count <= 1)
		report(settings.dir);
	return EXIT_SUCCESS;
}
