/* gopura-content: turns scans into signed releases. Dispatches to the commands in
 * pipeline/command_*.c. */
#include <stdio.h>
#include <string.h>

#include "base/compiler.h"
#include "base/crash.h"
#include "pipeline/commands.h"

static const struct command commands[] = {
	{ "build", "make a signed release of a content folder", command_build },
	{ "import", "read scans, report what was found and repaired", command_import },
	{ "temple", "write the demo temple with any number of triangles", command_temple },
	{ "reconstruct", "make one surface of aligned range images", command_reconstruct },
	{ "deform", "bend a scan, such as a leaning pillar into a straight one", command_deform },
	{ "publish", "make a signed release from what is built, or undo a release",
	  command_publish },
	{ "verify", "check everything in a release", command_verify },
	{ "inspect", "show what an object, a file or a release contains", command_inspect },
	{ "export", "make one model of the scans, for web pages and viewers", command_export },
	{ "annotations", "export parts and pages as W3C Web Annotations, or import them",
	  command_annotations },
	{ "keys", "make or exchange the signing keys of a content folder", command_keys },
	{ "delegate", "let the teams of several temples publish on one server", command_delegate },
	{ "hierarchy", "make the multiresolution hierarchy of a content folder",
	  command_hierarchy },
	{ "render", "draw reference pictures of the scan at full detail", command_render },
	{ "sample", "render the sampling images of a content folder", command_sample },
	{ NULL, NULL, NULL },
};

static void print_help(void)
{
	puts("gopura-content: makes signed releases of static files from scans\n"
	     "\n"
	     "usage: gopura-content COMMAND [OPTIONS]\n");
	for (const struct command *c = commands; c->name; c++)
		printf("  %-12s %s\n", c->name, c->summary);
	puts("\ngopura-content COMMAND --help explains a command, with examples.");
}

int main(int argc, char **argv)
{
	const char *name = argc > 1 ? argv[1] : "";

	crash_tell("pipeline");
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
	if (*name)
		fprintf(stderr,
			"gopura-content: there is no command '%s'; see gopura-content --help\n",
			name);
	else
		fputs("gopura-content: give a command; see gopura-content --help\n", stderr);
	return 2;
}
