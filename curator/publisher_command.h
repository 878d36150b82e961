/* gopura-curator publisher: publishes what the web page asks for, as the user who has the keys. */
#ifndef GOPURA_CURATOR_PUBLISHER_COMMAND_H
#define GOPURA_CURATOR_PUBLISHER_COMMAND_H

/* argv[0] is "publisher". Returns the program's exit status. */
int publisher_command(int argc, char **argv);

#endif
