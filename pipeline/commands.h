/* The commands of gopura-content, one source file each. argv[0] is the name of the command. Each
 * returns an exit status (0 done, 1 failed, 2 wrong command line), prints its own errors, and
 * supports --help. */
#ifndef GOPURA_PIPELINE_COMMANDS_H
#define GOPURA_PIPELINE_COMMANDS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/processes.h"
#include "pipeline/content/content.h"

struct command {
	const char *name;
	const char *summary; /* one line */
	int (*run)(int argc, char **argv);
};

/* annotations: exports and imports W3C Web Annotations. */
int command_annotations(int argc, char **argv);
/* build: makes a signed release from a content folder. */
int command_build(int argc, char **argv);
/* deform: bends a scan. */
int command_deform(int argc, char **argv);
/* delegate: lets teams publish in one release folder, each by keys of its own. */
int command_delegate(int argc, char **argv);
/* export: makes one model of the scans. */
int command_export(int argc, char **argv);
/* hierarchy: makes the multiresolution hierarchy. */
int command_hierarchy(int argc, char **argv);
/* import: reads scans and reports what was repaired. */
int command_import(int argc, char **argv);
/* inspect: shows what an object, a file or a release contains. */
int command_inspect(int argc, char **argv);
/* keys: creates or exchanges the signing keys, or shows where they are. */
int command_keys(int argc, char **argv);
/* publish: signs a release of what was built. */
int command_publish(int argc, char **argv);
/* verify: checks a whole release. */
int command_verify(int argc, char **argv);
/* reconstruct: makes a surface of aligned range images. */
int command_reconstruct(int argc, char **argv);
/* render: draws reference pictures of the scan. */
int command_render(int argc, char **argv);
/* sample: renders the sampling images. */
int command_sample(int argc, char **argv);
/* temple: writes the demo temple as a PLY file. */
int command_temple(int argc, char **argv);

/* Prints what is wrong with the options of a command, followed by value, and returns its exit
 * status, 2. */
int command_wrong(const char *command, const char *what, const char *value);
/* Parses a whole number in least..most; the text must contain nothing else. Returns false
 * otherwise; *out is then undefined. */
bool command_number(const char *text, uint64_t least, uint64_t most, uint64_t *out);

/* Checks, before the work, a file that is to be written at its end: it must not be `input`, which
 * would be lost, and its folder must be there. Prints why not. Returns 0 or a negative errno. */
must_check int command_check_out(const char *command, const char *out, const char *input);

/* Parses a number of bytes: a number, of which parts may follow a point, and B, kB, MB or GB, which
 * are powers of 1000, with or without a space between. It is at least 1 byte. Returns false
 * otherwise; *out is then undefined. */
bool command_size(const char *text, uint64_t *out);

/* Parses I/N, I below N. Returns false otherwise; *out is then undefined. */
bool command_shard(const char *text, struct shard *out);

/* Reads a content folder, as content_read, and prints every fault of its temple.ini. Returns 0 or a
 * negative errno. */
must_check int command_read_content(struct content *out, const char *folder);

#endif
