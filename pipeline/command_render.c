/* gopura-content render: draws reference pictures of the scan at full resolution. */
#include "pipeline/commands.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/samples/reference.h"

static const char help[] =
	"gopura-content render: draw reference pictures of a content folder's scan at full detail\n"
	"\n"
	"usage: gopura-content render DIR --views FILE --size WxH --out DIR [OPTIONS]\n"
	"\n"
	"  --views FILE      one view a line: eye x y z, target x y z, vertical field of view in\n"
	"                    degrees; metres, z up; # begins a comment\n"
	"  --size WxH        size in pixels, at most 4096 a side\n"
	"  --out DIR         folder for view-0000.png and so on; their alpha is coverage. Not in the\n"
	"                    content folder, where a new picture may be one of the scan's\n"
	"  --supersample N   N x N samples per pixel (default: 1, at most 16)\n"
	"\n"
	"Keeps pictures that exist already for the same scan, view and options.\n"
	"Exit status: 0 all pictures exist, 1 failed, 2 wrong command line.\n"
	"\n"
	"Example:\n"
	"  gopura-content render temple --views path.txt --size 1280x720 --supersample 4 --out truth\n";

struct settings {
	struct reference_options reference;
	const char *dir, *views; /* borrowed from argv */
};

static bool read_size(const char *text, struct reference_options *out)
{
	char rest;

	return sscanf(text, "%dx%d%c", &out->width_px, &out->height_px, &rest) == 2 &&
	       out->width_px > 0 && out->width_px <= REFERENCE_SIDE_PX_MAX && out->height_px > 0 &&
	       out->height_px <= REFERENCE_SIDE_PX_MAX;
}

static bool read_supersample(const char *text, struct reference_options *out)
{
	char rest;

	return sscanf(text, "%u%c", &out->supersample, &rest) == 1 && out->supersample >= 1 &&
	       out->supersample <= REFERENCE_SUPERSAMPLE_MAX;
}

static bool read_options(int argc, char **argv, struct settings *settings)
{
	static const struct option names[] = { { "views", required_argument, NULL, 'v' },
					       { "size", required_argument, NULL, 's' },
					       { "out", required_argument, NULL, 'o' },
					       { "supersample", required_argument, NULL, 'n' },
					       { "help", no_argument, NULL, 'h' },
					       { NULL, 0, NULL, 0 } };
	bool good = true;
	int option;

	optind = 1;
	while ((option = getopt_long(argc, argv, "h", names, NULL)) != -1) {
		switch (option) {
		case 'v':
			settings->views = optarg;
			break;
		case 's':
			good = good && read_size(optarg, &settings->reference);
			break;
		case 'o':
			settings->reference.out_dir = optarg;
			break;
		case 'n':
			good = good && read_supersample(optarg, &settings->reference);
			break;
		case 'h':
			fputs(help, stdout);
			exit(EXIT_SUCCESS);
		default:
			good = false;
		}
	}
	settings->dir = argv[optind];
	return good && argc == optind + 1 && settings->views && settings->reference.out_dir &&
	       settings->reference.width_px;
}

static int read_views(const char *path, struct camera **views, uint32_t *count,
		      struct diagnostics *diagnostics)
{
	struct buffer text;
	int rc;

	buffer_init(&text, 16 << 20);
	rc = buffer_read_file(&text, path);
	if (rc < 0)
		diagnostics_add(diagnostics, rc, path, 0, "%s", strerror(-rc));
	else
		rc = reference_views(views, count, buffer_bytes(&text), path, diagnostics);
	buffer_finish(&text);
	return rc;
}

int command_render(int argc, char **argv)
{
	struct settings settings = { .reference = { .supersample = 1 } };
	struct reference_report report;
	struct content content;
	struct scans *scans = NULL;
	struct camera *views = NULL;
	struct diagnostics diagnostics = { 0 };
	uint32_t count;
	int rc;

	if (!read_options(argc, argv, &settings)) {
		fputs("gopura-content render: give a content folder, --views, --size and --out; "
		      "see --help\n",
		      stderr);
		return 2;
	}
	if (command_read_content(&content, settings.dir) < 0)
		return EXIT_FAILURE;
	rc = read_views(settings.views, &views, &count, &diagnostics);
	if (rc == 0)
		rc = scans_create(&scans, &content);
	if (rc == 0)
		rc = reference_draw(scans, views, count, &settings.reference, &report,
				    &diagnostics);
	if (rc == 0)
		printf("%s: %u pictures drawn, %u kept\n", settings.reference.out_dir, report.drawn,
		       report.kept);
	else
		fprintf(stderr, "%s\n", diagnostics_cause(&diagnostics, rc));
	scans_destroy(scans);
	content_release(&content);
	free(views);
	return rc == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
