/* gopura-curator user: makes, changes and lists the accounts of a content folder. */
#ifndef GOPURA_CURATOR_USER_COMMAND_H
#define GOPURA_CURATOR_USER_COMMAND_H

/* argv[0] is "user". Returns the program's exit status. */
int user_command(int argc, char **argv);

#endif
