/* The settings of this terminal: gopura.conf, overridden by the command line, and the faults found
 * in the file. */
#ifndef GOPURA_APP_SETTINGS_PROVISION_H
#define GOPURA_APP_SETTINGS_PROVISION_H

#include <limits.h>

#include "app/settings/options.h"
#include "board/profile.h"
#include "system/terminal.h"

struct provision {
	struct terminal terminal; /* terminal_default if there is no file */
	struct diagnostics diagnostics;
	const char *path; /* the file that was read; NULL: none exists, or none was asked for */
	char trust_path[PATH_MAX], ca_path[PATH_MAX], board_path[PATH_MAX];
};

/* Reads gopura.conf and the board profile. *provision is zeroed by the caller. Completes the
 * options that the command line left open and fills in *profile; the options then borrow from
 * *provision. Logs the faults. Returns 0, or a negative errno (logged) if the profile of --board
 * has faults; *profile then has its valid entries. */
must_check int provision_read(struct provision *provision, struct options *options,
			      struct profile *profile);
/* Frees the faults. Zeroed is fine. */
void provision_finish(struct provision *provision);

#endif
