/* gopura-content inspect: shows what an object, a file or a release contains. */
#include "pipeline/commands.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "pipeline/release/inspect.h"
#include "pipeline/release/inspect_release.h"

static const char help[] =
	"gopura-content inspect: show what an object, a file or a release contains\n"
	"\n"
	"usage: gopura-content inspect FILE\n"
	"       gopura-content inspect RELEASE [HASH ...] [--target PATH] [--ca FILE]\n"
	"\n"
	"FILE is a locator, a signed file, an object in a file of its own, an information database or a\n"
	"picture. RELEASE is a folder or a URL: without HASH, shows its signed file, locator and first\n"
	"pages; with HASH, shows that object, its page and its place in the packs. PATH is that of\n"
	"its release among the targets of The Update Framework, where one server has several temples.\n"
	"\n"
	"Examples:\n"
	"  gopura-content inspect release\n"
	"  gopura-content inspect release 4ad8f0e51c5f3f36b2d1f0a6d6a5c7e1\n"
	"  gopura-content inspect release/timestamp.json\n";

static int inspect_file(const char *path)
{
	struct buffer file;
	int rc;

	buffer_init(&file, 256 << 20);
	rc = buffer_read_file(&file, path);
	if (rc < 0)
		fprintf(stderr, "gopura-content inspect: %s: %s\n", path, strerror(-rc));
	else
		rc = inspect_bytes(stdout, buffer_bytes(&file));
	buffer_finish(&file);
	return rc < 0 ? 1 : 0;
}

static int inspect_place(const char *place, const char *ca_file, const char *target, char **names,
			 int name_count)
{
	const struct release_reader_options options = { .place = place, .ca_file = ca_file };
	struct release_reader *reader;
	struct hash object;
	int rc = release_reader_create(&reader, &options);

	if (rc < 0)
		fprintf(stderr, "gopura-content inspect: %s: %s\n", place, strerror(-rc));
	if (rc == 0 && name_count == 0)
		rc = inspect_release(stdout, reader, target);
	for (int i = 0; rc == 0 && i < name_count; i++) {
		rc = hash_from_hex(&object, names[i]);
		if (rc < 0)
			fprintf(stderr,
				"gopura-content inspect: %s: an object's name is 32 digits of 0-9 and a-f\n",
				names[i]);
		else
			rc = inspect_object(stdout, reader, target, object);
	}
	release_reader_destroy(reader);
	return rc < 0 ? 1 : 0;
}

int command_inspect(int argc, char **argv)
{
	static const struct option options[] = {
		{ "target", required_argument, NULL, 'T' },
		{ "ca", required_argument, NULL, 'c' },
		{ "help", no_argument, NULL, 'h' },
		{ NULL, 0, NULL, 0 },
	};
	const char *ca_file = NULL, *target = NULL, *place;
	struct stat info;
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) >= 0) {
		if (option == 'h') {
			fputs(help, stdout);
			return 0;
		}
		if (option != 'c' && option != 'T')
			return 2;
		*(option == 'c' ? &ca_file : &target) = optarg;
	}
	if (optind == argc) {
		fputs("gopura-content inspect: name a file or a release; see --help\n", stderr);
		return 2;
	}
	place = argv[optind++];
	if (stat(place, &info) == 0 && !S_ISDIR(info.st_mode))
		return inspect_file(place);
	return inspect_place(place, ca_file, target, argv + optind, argc - optind);
}
