/* gopura-content: turns scans into signed releases. Dispatches to the commands in
 * pipeline/command_*.c. */
#include <stdio.h>
#include <string.h>

#include "base/compiler.h"
#include "pipeline/commands.h"

static const struct command commands[] = {
	{ "build", "from a content folder to a signed release, all that is needed", command_build },
	{ "import", "read scans, say what was found and repaired", command_import },
	{ "temple", "write the demo temple, any number of triangles", command_temple },
	{ "publish", "make a signed release of what is built, or undo one", command_publish },
	{ "verify", "walk a whole release and check everything in it", command_verify },
	{ "inspect", "say what an object, a file or a release holds", command_inspect },
	{ "annotations", "parts and pages to and from W3C Web Annotations", command_annotations },
	{ "keys", "make the signing keys of a content folder", command_keys },
	{ "hierarchy", "make the multiresolution hierarchy of a content folder",
	  command_hierarchy },
	{ "render", "draw reference pictures of the scan at its finest", command_render },
	{ "sample", "render the sampling images of a content folder", command_sample },
	{ NULL, NULL, NULL },
};

static void print_help(void)
{
	puts("gopura-content: from scans to a signed release of static files\n"
	     "\n"
	     "usage: gopura-content COMMAND [OPTIONS]\n");
	for (const struct command *c = commands; c->name; c++)
		printf("  %-11s %s\n", c->name, c->summary);
	puts("\ngopura-content COMMAND --help says more, with examples.");
}

int main(int argc, char **argv)
{
	const char *name = argc > 1 ? argv[1] : "";

	for (const struct command *c = commands; c->name; c++)
		if (strcmp(name, c->name) == 0)
			return c->run(argc - 1, argv + 1);
	if (strcmp(name, "--version") == 0) {
		puts("gopura-content " GOPURA_VERSION);
		return 0;
	}
	if (strcmp(name, "--help") == 0 || strcmp(name, "help") == 0) {
		print_help();
		return 0;
	}
	fprintf(stderr, "gopura-content: %s'%s'; see gopura-content --help\n",
		*name ? "no such command: " : "a command is needed: ", name);
	return 2;
}
