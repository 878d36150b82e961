/* The commands of gopura-content, one source file each. argv[0] is the command's own name; each
 * returns an exit status, prints its own errors, and answers --help. */
#ifndef GOPURA_PIPELINE_COMMANDS_H
#define GOPURA_PIPELINE_COMMANDS_H

#include <stdbool.h>
#include <stdint.h>

struct command {
	const char *name;
	const char *summary; /* one line */
	int (*run)(int argc, char **argv);
};

int command_annotations(int argc, char **argv);
int command_build(int argc, char **argv);
int command_hierarchy(int argc, char **argv);
int command_import(int argc, char **argv);
int command_inspect(int argc, char **argv);
int command_keys(int argc, char **argv);
int command_publish(int argc, char **argv);
int command_verify(int argc, char **argv);
int command_render(int argc, char **argv);
int command_sample(int argc, char **argv);
int command_temple(int argc, char **argv);

/* Says what is wrong with the options of a command, value behind it, and gives its exit status. */
int command_wrong(const char *command, const char *what, const char *value);
/* A whole number in least..most, nothing before or behind it; false: it is not. */
bool command_number(const char *text, uint64_t least, uint64_t most, uint64_t *out);

#endif
