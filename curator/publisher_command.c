/* The command line of the publisher. */
#include "curator/publisher_command.h"

#include <getopt.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "curator/publish/publisher.h"

static const char help[] =
	"gopura-curator publisher: publish what curators ask for on the page (docs/curator.md)\n"
	"\n"
	"usage: gopura-curator publisher DIR --out RELEASE [OPTIONS]\n"
	"\n"
	"  --out RELEASE   the release folder\n"
	"  --keys FOLDER   the signing keys (default: as gopura-content keys DIR says)\n"
	"  --jobs N        number of threads of gopura-content (default: one per core)\n"
	"  --once          work off what waits, and end\n"
	"\n"
	"Runs gopura-content, which lies beside this program. Let it be another user than the one who\n"
	"runs the page, and let only that user read the keys.\n"
	"\n"
	"Example:\n"
	"  gopura-curator publisher temple --out /srv/museum/release\n";

/* gopura-content lies beside this program. */
static int find_program(char path[PATH_MAX])
{
	static const char name[] = "gopura-content";
	const ssize_t bytes = readlink("/proc/self/exe", path, PATH_MAX - sizeof(name));
	char *slash;

	if (bytes <= 0)
		return -1;
	path[bytes] = '\0';
	slash = strrchr(path, '/');
	if (!slash)
		return -1;
	memcpy(slash + 1, name, sizeof(name));
	return access(path, X_OK);
}

static int wrong(const char *sentence)
{
	fprintf(stderr, "gopura-curator publisher: %s; see --help\n", sentence);
	return 2;
}

static int run(struct publisher_options *options)
{
	struct diagnostics diagnostics = { 0 };
	char program[PATH_MAX];
	int rc;

	if (find_program(program) < 0) {
		fputs("gopura-curator publisher: gopura-content is not beside this program\n",
		      stderr);
		return EXIT_FAILURE;
	}
	options->program = program;
	rc = publisher_run(options, &diagnostics);
	if (rc < 0 && diagnostics.count > 0)
		fprintf(stderr, "gopura-curator publisher: %s\n",
			diagnostics_cause(&diagnostics, rc));
	return rc < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

int publisher_command(int argc, char **argv)
{
	static const struct option options[] = {
		{ "out", required_argument, NULL, 'o' },  { "keys", required_argument, NULL, 'k' },
		{ "jobs", required_argument, NULL, 'j' }, { "once", no_argument, NULL, '1' },
		{ "help", no_argument, NULL, 'h' },       { 0 },
	};
	struct publisher_options publisher = { 0 };
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) != -1)
		switch (option) {
		case 'o':
			publisher.release = optarg;
			break;
		case 'k':
			publisher.keys = optarg;
			break;
		case 'j':
			publisher.jobs = optarg;
			break;
		case '1':
			publisher.once = true;
			break;
		case 'h':
			fputs(help, stdout);
			return 0;
		default:
			return 2;
		}
	if (optind + 1 != argc)
		return wrong("name one content folder");
	if (!publisher.release)
		return wrong("name the release folder with --out");
	publisher.folder = argv[optind];
	return run(&publisher);
}
