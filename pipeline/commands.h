/* The commands of gopura-content, one source file each. argv[0] is the command's own name; each
 * returns an exit status, prints its own errors, and answers --help. */
#ifndef GOPURA_PIPELINE_COMMANDS_H
#define GOPURA_PIPELINE_COMMANDS_H

struct command {
	const char *name;
	const char *summary; /* one line */
	int (*run)(int argc, char **argv);
};

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

#endif
