/* What a terminal's gopura.conf means for the system under it, as files in one folder that units of
 * the appliance link in (docs/terminal.md has the list). */
#ifndef GOPURA_SYSTEM_SETUP_H
#define GOPURA_SYSTEM_SETUP_H

#include "system/terminal.h"

struct setup {
	const struct terminal *terminal;
	const struct faults *faults;
	const char *conf_path; /* that was read; NULL: none is there */
	const char *out;       /* the folder; made where it is not there */
};

/* Each file is whole or as it was before. Negative errno (logged) at the first that cannot be
 * written. */
must_check int setup_write(const struct setup *setup);

/* The name under which iwd looks for the network: FILE.psk or FILE.open. */
enum { SETUP_WIFI_NAME_BYTES = 1 + 2 * 32 + 6 };
void setup_wifi_name(const struct terminal *terminal, char out[SETUP_WIFI_NAME_BYTES]);

#endif
