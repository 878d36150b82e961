/* What gopura.conf says of this terminal, under what the command line says, and what is wrong with
 * it. */
#ifndef GOPURA_APP_RELEASE_PROVISION_H
#define GOPURA_APP_RELEASE_PROVISION_H

#include <limits.h>

#include "app/options.h"
#include "board/profile.h"
#include "system/terminal.h"

struct provision {
	struct terminal terminal; /* terminal_default where there is no file */
	struct faults faults;
	const char *path; /* the file that was read; NULL: none was there, or none asked for */
	char trust_path[PATH_MAX], ca_path[PATH_MAX], board_path[PATH_MAX];
};

/* provision is zeroed. Fills in the options that the command line leaves open, and the profile;
 * logs the faults. What it fills in is borrowed from provision. Negative errno (logged): the
 * profile of --board does not do, and holds what is right of it. */
must_check int provision_read(struct provision *provision, struct options *options,
			      struct profile *profile);

#endif
