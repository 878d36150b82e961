/* Translates a terminal's gopura.conf into files in one folder, which units of the appliance link
 * in (docs/terminal.md has the list). */
#ifndef GOPURA_SYSTEM_SETUP_H
#define GOPURA_SYSTEM_SETUP_H

#include "system/terminal.h"

struct setup {
	/* borrowed, like all pointers here */
	const struct terminal *terminal;
	const struct diagnostics *diagnostics;
	const char *conf_path; /* the file that was read; NULL: none was found */
	const char *out;       /* the folder; created if missing */
	uint32_t cache_mib;    /* of the board profile; 0: the fetcher's default */
};

/* Writes all files. Each is complete or unchanged. Returns 0, or the negative errno of the first
 * file that could not be written (logged). -EAGAIN: all were, but without the certificate
 * authority, which could not be read now. */
must_check int setup_write(const struct setup *setup);

/* Maximum length of a name: the SSID in hexadecimal, '=', the extension and the end. */
enum { SETUP_WIFI_NAME_BYTES = 1 + 2 * 32 + 6 };
/* Writes the file name under which iwd looks for the network's settings: NAME.psk or NAME.open,
 * where NAME is the SSID or '=' and its hexadecimal form. */
void setup_wifi_name(const struct terminal *terminal, char out[SETUP_WIFI_NAME_BYTES]);

#endif
