/* gopura-content verify: checks a whole release and prints a summary. */
#include "pipeline/commands.h"

#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "pipeline/release/verify.h"

static const char help[] =
	"gopura-content verify: check everything in a release\n"
	"\n"
	"usage: gopura-content verify URL|DIR [--trust FILE] [--target PATH] [--ca FILE]\n"
	"\n"
	"  --trust FILE  the root that terminals were given, root/1.json or, to verify the form of The\n"
	"                Update Framework alone, tuf/1.root.json; without it the release's own root is\n"
	"                trusted, which shows that the release is complete but not whose it is\n"
	"  --target PATH the release's path among the targets of The Update Framework\n"
	"                (default: release.json)\n"
	"  --ca FILE     certificate authority of an https server\n"
	"\n"
	"Checks signatures and expiry, the locator, the hash of every pack and object, that every page,\n"
	"patch group, tile and the information database can be decoded, and that pages describe their\n"
	"children correctly. If anything is wrong, prints one line that says what and where, and exits\n"
	"with status 1.\n"
	"\n"
	"Examples:\n"
	"  gopura-content verify release --trust ~/.config/gopura/keys/temple/root/1.json\n"
	"  gopura-content verify https://museum.example/ --ca ca.pem\n";

static void print_day(const char *what, int64_t seconds)
{
	time_t time = (time_t)seconds;
	char text[32] = "?";
	struct tm parts;

	if (gmtime_r(&time, &parts))
		strftime(text, sizeof(text), "%Y-%m-%d", &parts);
	printf("  %-20s expires %s\n", what, text);
}

static void print_sum(const char *what, const struct verify_sum *sum)
{
	printf("  %-20s %9" PRIu64 "  %14" PRIu64 " bytes\n", what, sum->count, sum->bytes);
}

static void print_objects(const struct verify_report *report)
{
	static const char *const kinds[] = {
		[PAGE_ROOT] = "root page",       [PAGE_HIERARCHY] = "hierarchy page",
		[PAGE_SAMPLES] = "samples page", [PAGE_BRICK] = "brick pages",
		[PAGE_FACE] = "face pages",      [PAGE_INFO] = "information page",
		[PAGE_LABELS] = "labels page",   [PAGE_STREAM] = "stream page",
	};
	uint64_t pages = 0, all;

	for (int kind = PAGE_ROOT; kind < PAGE_KINDS; kind++) {
		print_sum(kinds[kind], &report->pages[kind]);
		pages += report->pages[kind].bytes;
	}
	print_sum("stream blocks", &report->stream_blocks);
	print_sum("patch groups", &report->groups);
	print_sum("tiles", &report->tiles);
	print_sum("labels", &report->labels);
	print_sum("scenery", &report->scenery);
	print_sum("space for the eye", &report->solid);
	print_sum("information", &report->database);
	print_sum("pictures, sound", &report->files);
	all = pages + report->groups.bytes + report->tiles.bytes + report->database.bytes +
	      report->files.bytes + report->labels.bytes + report->stream_blocks.bytes +
	      report->scenery.bytes + report->solid.bytes;
	printf("  %-20s %9s  %14" PRIu64 " bytes\n", "all", "", all);
	printf("  pages are %.2f %% of that, the locator %u bytes, in %u packs\n",
	       100.0 * (double)pages / (double)all, report->locator_bytes, report->pack_count);
}

static void print_report(const struct verify_report *report, bool trusted)
{
	const struct root_page *root = &report->root;
	char hex[HASH_HEX_BYTES];

	hash_to_hex(report->release.root, hex);
	printf("release %" PRIu64 " of \"%s\", root %s\n", report->release.sequence, root->name,
	       hex);
	if (report->release.comment[0])
		printf("  \"%s\"\n", report->release.comment);
	print_day("root", report->trust.expires_s);
	print_day("release.json", report->release.expires_s);
	print_day("timestamp.json", report->timestamp.expires_s);
	print_objects(report);
	printf("  %u patches, %u sampling points with %u faces, %u parts\n", report->patches,
	       report->points, report->faces, report->parts);
	printf("  published share: %" PRIu64 " of %" PRIu64 " triangles, %.2f %%\n",
	       root->published_triangles, root->source_triangles,
	       100.0 * (double)root->published_triangles / (double)root->source_triangles);
	printf("verified: %" PRIu64 " bytes read, no faults found%s\n", report->read_bytes,
	       trusted ? "" : " (against its own root; use --trust to check whose it is)");
}

static int verify(const char *place, const char *ca_file, const char *trust, const char *target)
{
	const struct release_reader_options reader = { .place = place, .ca_file = ca_file };
	struct verify_options options = { .now_s = clock_wall_s(), .target = target };
	struct verify_report report;
	struct buffer root;
	int rc;

	buffer_init(&root, METADATA_FILE_BYTES_MAX);
	if (trust && (rc = buffer_read_file(&root, trust)) < 0) {
		fprintf(stderr, "gopura-content verify: %s: %s\n", trust, strerror(-rc));
		buffer_finish(&root);
		return 1;
	}
	options.trusted_root = buffer_bytes(&root);
	rc = release_reader_create(&options.reader, &reader);
	if (rc < 0) {
		fprintf(stderr, "gopura-content verify: %s: %s\n", place, strerror(-rc));
	} else {
		rc = verify_release(&report, &options);
		if (rc < 0)
			fprintf(stderr, "gopura-content verify: %s\n",
				diagnostics_cause(&report.diagnostics, rc));
		else
			print_report(&report, trust != NULL);
		release_reader_destroy(options.reader);
	}
	buffer_finish(&root);
	return rc < 0 ? 1 : 0;
}

int command_verify(int argc, char **argv)
{
	static const struct option options[] = {
		{ "trust", required_argument, NULL, 't' },
		{ "target", required_argument, NULL, 'T' },
		{ "ca", required_argument, NULL, 'c' },
		{ "help", no_argument, NULL, 'h' },
		{ NULL, 0, NULL, 0 },
	};
	const char *trust = NULL, *target = NULL, *ca_file = NULL;
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) >= 0) {
		switch (option) {
		case 't':
			trust = optarg;
			break;
		case 'T':
			target = optarg;
			break;
		case 'c':
			ca_file = optarg;
			break;
		case 'h':
			fputs(help, stdout);
			return 0;
		default:
			return 2;
		}
	}
	if (optind + 1 == argc)
		return verify(argv[optind], ca_file, trust, target);
	fputs("gopura-content verify: name one release, a URL or a folder; see --help\n", stderr);
	return 2;
}
