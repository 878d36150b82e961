/* gopura-content annotations: exports and imports W3C Web Annotations and IIIF manifests. */
#include "pipeline/commands.h"

#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "pipeline/content/annotations.h"
#include "pipeline/content/annotations_export.h"
#include "pipeline/content/annotations_import.h"

static const char help[] =
	"gopura-content annotations: export parts and pages as W3C Web Annotations or as a IIIF manifest,\n"
	"or import them\n"
	"\n"
	"usage: gopura-content annotations export CONTENT --out FILE [OPTIONS]\n"
	"       gopura-content annotations import FILE --into CONTENT [OPTIONS]\n"
	"\n"
	"export writes one annotation for each part of CONTENT/parts.json, and the pictures beside FILE.\n"
	"  --languages LIST  such as en,fr; every part must have a title in the first one (default: the\n"
	"                    languages of the titles, in the order in which they appear)\n"
	"  --iiif            write a IIIF manifest: the scans of temple.ini, and a comment for each part\n"
	"                    (docs/iiif.md)\n"
	"  --base ADDRESS    where the manifest and the scans will be published (default:\n"
	"                    https://example.org/iiif/)\n"
	"  --model FILE.glb  with --iiif: show this file beside the manifest, which gopura-content export\n"
	"                    makes, in place of the scans\n"
	"\n"
	"import writes parts.json, pages/ and pictures/ into CONTENT, which must not have parts yet. FILE\n"
	"may be a IIIF manifest of 3D scenes, whose comments become parts (docs/iiif.md).\n"
	"  --language CODE   language of texts that do not name one (default: en)\n"
	"  --up AXIS         up axis of PointSelectors: z (default) or y; in a IIIF manifest always y\n"
	"  --skip-unknown    skip annotations whose selectors name no place on a model; without this\n"
	"                    option they are refused\n"
	"\n"
	"The formats are in docs/annotations.md and docs/iiif.md. Exit status: 0 done, 1 refused, 2 wrong command\n"
	"line.\n"
	"\n"
	"Examples:\n"
	"  gopura-content annotations export temple --out exchange/temple.jsonld\n"
	"  gopura-content annotations export temple --iiif --out exchange/temple.json\n"
	"  gopura-content annotations import exchange/temple.jsonld --into copy\n";

/* Prints what was found, and empties the list. */
static void print_found(struct diagnostics *diagnostics)
{
	for (uint32_t i = 0; i < diagnostics->count; i++) {
		const struct diagnostic *found = diagnostics_get(diagnostics, i);

		fprintf(stderr, "%s: %s\n", found->error < 0 ? "error" : "warning", found->text);
	}
	if (diagnostics->dropped > 0)
		fprintf(stderr, "and %" PRIu32 " more\n", diagnostics->dropped);
	diagnostics_finish(diagnostics);
}

/* Splits a list such as "en,fr" in place. Returns the count; 0: not a valid list. */
static uint32_t split_languages(char *list, const char *languages[INFO_LANGUAGES_MAX])
{
	uint32_t count = 0;

	for (char *code; (code = strsep(&list, ",")); count++) {
		if (!*code || count == INFO_LANGUAGES_MAX)
			return 0;
		languages[count] = code;
	}
	return count;
}

static int fail(const char *what, int rc)
{
	if (rc != -EINVAL) /* -EINVAL was already reported in detail */
		fprintf(stderr, "gopura-content annotations: %s: %s\n", what, strerror(-rc));
	return EXIT_FAILURE;
}

/* ---- export */

static int copy_picture(const char *content, const char *beside, const char *name)
{
	char from[PATH_MAX], to[PATH_MAX];
	struct stat a, b;
	struct buffer file;
	int rc;

	if (snprintf(from, sizeof(from), "%s/%s", content, name) >= PATH_MAX ||
	    snprintf(to, sizeof(to), "%s/%s", beside, name) >= PATH_MAX)
		return -ENAMETOOLONG;
	if (stat(from, &a) == 0 && stat(to, &b) == 0 && a.st_dev == b.st_dev &&
	    a.st_ino == b.st_ino)
		return 0; /* the export is written into the content folder itself */
	buffer_init(&file, 64 << 20);
	rc = buffer_read_file(&file, from);
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&file), to);
	buffer_finish(&file);
	return rc;
}

static int write_export(const struct annotations *annotations, const char *content, const char *out)
{
	char folder[PATH_MAX], pictures[PATH_MAX];
	const char *slash = strrchr(out, '/');
	int rc = bytes_write_file(buffer_bytes(&annotations->json), out);

	snprintf(folder, sizeof(folder), "%.*s", slash ? (int)(slash - out) : 1, slash ? out : ".");
	if (slash == out)
		snprintf(folder, sizeof(folder), "/");
	if (snprintf(pictures, sizeof(pictures), "%s/pictures", folder) >= PATH_MAX)
		rc = -ENAMETOOLONG;
	if (rc == 0 && annotations->picture_count > 0 && mkdir(pictures, 0755) < 0 &&
	    errno != EEXIST)
		rc = -errno;
	for (uint32_t i = 0; rc == 0 && i < annotations->picture_count; i++)
		rc = copy_picture(content, folder, annotations->pictures[i]);
	return rc;
}

static int run_export(const char *content, const char *out, char *language_list,
		      const char *manifest_base, const char *model)
{
	const char *languages[INFO_LANGUAGES_MAX];
	struct diagnostics found = { .max = INFO_DIAGNOSTICS_MAX };
	struct annotations_export_options options = { .folder = content,
						      .manifest_base = manifest_base,
						      .manifest_model = model,
						      .diagnostics = &found };
	struct annotations annotations;
	int rc;

	if (!out)
		return command_wrong("annotations", "export needs --out FILE", "");
	if (language_list) {
		options.languages = languages;
		options.language_count = split_languages(language_list, languages);
		if (options.language_count == 0)
			return command_wrong("annotations", "--languages takes codes such as en,fr",
					     "");
	}
	rc = annotations_export(&annotations, &options);
	print_found(&found);
	if (rc < 0)
		return fail(content, rc);
	rc = write_export(&annotations, content, out);
	if (rc == 0)
		printf("%s: %u annotations, %u pictures beside it\n", out, annotations.count,
		       annotations.picture_count);
	annotations_finish(&annotations);
	return rc == 0 ? EXIT_SUCCESS : fail(out, rc);
}

/* ---- import */

static int run_import(struct annotations_import_options *options)
{
	struct diagnostics found = { .max = INFO_DIAGNOSTICS_MAX };
	struct annotations_imported report;
	int rc;

	if (!options->folder)
		return command_wrong("annotations", "import needs --into CONTENT", "");
	options->diagnostics = &found;
	rc = annotations_import(&report, options);
	print_found(&found);
	if (rc < 0)
		return fail(options->file, rc);
	printf("%s: %u parts, %u pages, %u pictures", options->folder, report.part_count,
	       report.page_count, report.picture_count);
	if (report.skipped_count > 0)
		printf("; %u annotations left out", report.skipped_count);
	putchar('\n');
	return EXIT_SUCCESS;
}

int command_annotations(int argc, char **argv)
{
	static const struct option options[] = {
		{ "out", required_argument, NULL, 'o' },
		{ "into", required_argument, NULL, 'i' },
		{ "languages", required_argument, NULL, 'L' },
		{ "language", required_argument, NULL, 'l' },
		{ "iiif", no_argument, NULL, 'm' },
		{ "base", required_argument, NULL, 'b' },
		{ "model", required_argument, NULL, 'M' },
		{ "up", required_argument, NULL, 'u' },
		{ "skip-unknown", no_argument, NULL, 's' },
		{ "help", no_argument, NULL, 'h' },
		{ NULL, 0, NULL, 0 },
	};
	struct annotations_import_options import = { 0 };
	const char *out = NULL;
	const char *base = "https://example.org/iiif/";
	const char *model = NULL;
	bool is_manifest = false;
	char *languages = NULL;
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) >= 0) {
		switch (option) {
		case 'o':
			out = optarg;
			break;
		case 'i':
			import.folder = optarg;
			break;
		case 'L':
			languages = optarg;
			break;
		case 'l':
			import.language = optarg;
			break;
		case 'u':
			if (strcmp(optarg, "y") != 0 && strcmp(optarg, "z") != 0)
				return command_wrong(argv[0], "--up must be y or z, not ", optarg);
			import.y_is_up = *optarg == 'y';
			break;
		case 'm':
			is_manifest = true;
			break;
		case 'b':
			base = optarg;
			break;
		case 'M':
			model = optarg;
			break;
		case 's':
			import.skip_unknown = true;
			break;
		case 'h':
			fputs(help, stdout);
			return 0;
		default:
			return 2;
		}
	}
	if (argc - optind != 2)
		return command_wrong(argv[0], "give export CONTENT or import FILE", "");
	import.file = argv[optind + 1];
	if (model && !is_manifest)
		return command_wrong(argv[0], "--model is for --iiif", "");
	if (strcmp(argv[optind], "export") == 0)
		return run_export(argv[optind + 1], out, languages, is_manifest ? base : NULL,
				  model);
	if (strcmp(argv[optind], "import") == 0)
		return run_import(&import);
	return command_wrong(argv[0], "export or import, not ", argv[optind]);
}
