/* gopura-content build: makes a signed release from a content folder. */
#include "pipeline/commands.h"

#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/log.h"
#include "pipeline/build.h"
#include "pipeline/content/work_lock.h"
#include "pipeline/estimate.h"

static const char help[] =
	"gopura-content build: make a signed release of a content folder\n"
	"\n"
	"usage: gopura-content build DIR [OPTIONS]\n"
	"\n"
	"  --out RELEASE     the release folder (default: DIR/../release)\n"
	"  --jobs N          number of threads and processes (default: one per core); the result does\n"
	"                    not depend on it\n"
	"  --hierarchy KIND  groups or tree (default: as in temple.ini)\n"
	"  --budget SIZE     the release has at most SIZE, and at least 98 % of it if its best tiles take\n"
	"                    as much: 80MB, 1.5GB, 500kB (powers of 1000). Tiles are then stored at five\n"
	"                    qualities, of which each gets one (temple.ini: [samples] quality)\n"
	"  --comment TEXT    what is new in this release, for people\n"
	"  --keys FOLDER     the signing keys (default: ~/.config/gopura/keys/NAME of DIR; see keys)\n"
	"  --dry-run         build nothing: check the content, and say what time, memory and disk a\n"
	"                    build would take\n"
	"\n"
	"Reads DIR/temple.ini, the scans it names (range images become one surface first), parts.json, tours.json, pages/ and pictures/. The\n"
	"intermediate files stay in DIR/.work: an interrupted build continues where it stopped, and a\n"
	"later build does only what changed. The first build makes the signing keys (see keys).\n"
	"Exit status: 0 done, 1 failed (the reason is printed), 2 wrong command line.\n"
	"\n"
	"Examples:\n"
	"  gopura-content build temple --dry-run\n"
	"  gopura-content build temple\n"
	"  gopura-content build temple --budget 80MB\n"
	"  gopura-content build temple --out /srv/museum --jobs 8\n";

static void print_report(const struct build_report *report)
{
	const struct report_stage *stages = report->stages;

	publish_content_print(stdout, &report->publish);
	if (report->nothing_changed) {
		printf("nothing changed since the last build; %.1f s\n",
		       (double)report->all_ms / 1000.0);
		return;
	}
	printf("published %" PRIu64 " of the scan's %" PRIu64 " triangles, %.2f %%\n",
	       report->publish.published_triangles, report->source_triangles,
	       100.0 * (double)report->publish.published_triangles /
		       (double)report->source_triangles);
	if (stages[BUILD_SURFACE].name)
		printf("surface %.1f s%s, ", (double)stages[BUILD_SURFACE].ms / 1000.0,
		       stages[BUILD_SURFACE].was_there ? " (was there)" : "");
	printf("hierarchy %.1f s%s, samples %.1f s, publishing %.1f s; all %.1f s\n",
	       (double)stages[BUILD_HIERARCHY].ms / 1000.0,
	       stages[BUILD_HIERARCHY].was_there ? " (was there)" : "",
	       (double)stages[BUILD_SAMPLES].ms / 1000.0,
	       (double)stages[BUILD_PUBLISHING].ms / 1000.0, (double)report->all_ms / 1000.0);
	if (report->page[0])
		printf("report for people: %s\n", report->page);
}

static void print_budget(const struct publish_budget_report *budget, uint64_t budget_bytes,
			 uint64_t release_bytes)
{
	if (budget->choice_count == 0)
		return;
	printf("budget %.1f MB, %.1f %% used; possible were %.1f to %.1f MB; tiles by quality:",
	       (double)budget_bytes / 1e6, 100.0 * (double)release_bytes / (double)budget_bytes,
	       (double)budget->least_bytes / 1e6, (double)budget->most_bytes / 1e6);
	for (uint32_t i = 0; i < budget->choice_count; i++)
		printf("%s %" PRIu32 " of %" PRIu8, i ? "," : "", budget->counts[i],
		       budget->qualities[i]);
	printf("; mean SSIM %.4f\n", budget->similarity);
}

/* Before hours of work, refuses a budget that cannot be met. What a release takes at least is a
 * prediction until tiles were made, which was wrong by up to 2.4 (docs/estimate.md); closer budgets
 * are judged after sampling, before anything is published. */
static int check_budget(const struct content *content, const struct build_options *options)
{
	const double sure = 3;
	struct estimate estimate;
	int rc;

	if (content->budget_bytes == 0)
		return 0;
	rc = estimate_build(&estimate, content, options);
	if (rc < 0 || (double)content->budget_bytes * sure >= (double)estimate.least_bytes)
		return rc;
	log_error("pipeline",
		  "a budget of %.3g MB is too small: a release of this content has at least about "
		  "%.3g MB; give a larger one, or reduce [grid] points or face_px, or [release] "
		  "publish_share",
		  (double)content->budget_bytes / 1e6, (double)estimate.least_bytes / 1e6);
	return -E2BIG;
}

/* What the command line changes in a content. */
struct changes {
	const char *kind; /* NULL: as in temple.ini */
	uint64_t budget_bytes;
};

static void apply(const struct changes *changes, struct content *content)
{
	if (changes->kind)
		content->binary_tree = strcmp(changes->kind, "tree") == 0;
	content->budget_bytes = changes->budget_bytes;
}

static int run(const char *folder, const struct build_options *options,
	       const struct changes *changes)
{
	struct build_report report;
	struct content content;
	int lock = -1;
	int rc = command_read_content(&content, folder);

	if (rc < 0)
		return EXIT_FAILURE;
	content.import.jobs = options->jobs;
	apply(changes, &content);
	rc = work_lock(&lock, &content);
	if (rc == 0)
		rc = check_budget(&content, options);
	if (rc == 0)
		rc = build_content(&report, &content, options);
	if (rc == 0) {
		print_report(&report);
		print_budget(&report.publish.budget, content.budget_bytes,
			     report.publish.release_bytes);
	} else {
		fprintf(stderr,
			"gopura-content build: %s: %s; correct that and run it again; it "
			"continues where it stopped\n",
			folder,
			rc == -EINVAL  ? "the content has faults"
			: rc == -E2BIG ? "it does not fit"
				       : strerror(-rc));
	}
	if (lock >= 0)
		close(lock);
	content_release(&content);
	return rc < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

static int run_dry(const char *folder, const struct build_options *options,
		   const struct changes *changes)
{
	struct estimate estimate;
	struct content content;
	int rc = command_read_content(&content, folder);

	if (rc < 0)
		return EXIT_FAILURE;
	apply(changes, &content);
	rc = estimate_build(&estimate, &content, options);
	if (rc == 0)
		estimate_print(stdout, &estimate);
	else
		fprintf(stderr, "gopura-content build: %s: %s\n", folder,
			rc == -EINVAL ? "the content has faults; correct them first"
				      : strerror(-rc));
	content_release(&content);
	return rc < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

int command_build(int argc, char **argv)
{
	static const struct option options[] = {
		{ "out", required_argument, NULL, 'o' },
		{ "jobs", required_argument, NULL, 'j' },
		{ "hierarchy", required_argument, NULL, 'k' },
		{ "budget", required_argument, NULL, 'b' },
		{ "comment", required_argument, NULL, 'c' },
		{ "keys", required_argument, NULL, 'K' },
		{ "dry-run", no_argument, NULL, 'n' },
		{ "help", no_argument, NULL, 'h' },
		{ NULL, 0, NULL, 0 },
	};
	struct build_options build = { 0 };
	struct changes changes = { 0 };
	bool is_dry = false;
	int option;
	uint64_t jobs = 0;

	while ((option = getopt_long(argc, argv, "", options, NULL)) >= 0) {
		switch (option) {
		case 'o':
			build.out = optarg;
			break;
		case 'j':
			if (!command_number(optarg, 1, 64, &jobs))
				return command_wrong(argv[0], "--jobs must be 1 to 64, not ",
						     optarg);
			build.jobs = (uint32_t)jobs;
			break;
		case 'k':
			if (strcmp(optarg, "groups") != 0 && strcmp(optarg, "tree") != 0)
				return command_wrong(argv[0],
						     "--hierarchy must be groups or tree, not ",
						     optarg);
			changes.kind = optarg;
			break;
		case 'b':
			if (!command_size(optarg, &changes.budget_bytes))
				return command_wrong(
					argv[0],
					"--budget must be a size such as 80MB, 1.5GB or "
					"500kB, not ",
					optarg);
			break;
		case 'c':
			build.comment = optarg;
			break;
		case 'K':
			build.keys = optarg;
			break;
		case 'n':
			is_dry = true;
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
	return is_dry ? run_dry(argv[optind], &build, &changes)
		      : run(argv[optind], &build, &changes);
}
