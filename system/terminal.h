/* gopura.conf: the one file that turns an appliance into this museum's terminal (docs/terminal.md).
 * Every value is checked: code that gets a struct terminal can rely on it. */
#ifndef GOPURA_SYSTEM_TERMINAL_H
#define GOPURA_SYSTEM_TERMINAL_H

#include <netinet/in.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/bytes.h"
#include "base/compiler.h"
#include "base/daily.h"
#include "base/settings.h"
#include "system/hours.h"

enum {
	TERMINAL_SERVERS_MAX = 4,
	TERMINAL_NAME_BYTES = 64,
	TERMINAL_URL_BYTES = 512,
	TERMINAL_TARGET_BYTES = 97
};
/* Maximum size of a file that gopura.conf names. All certificate authorities of a system together
 * take a quarter of it. */
enum { TERMINAL_FILE_BYTES_MAX = 1 << 20 };

/* Kinds of USB device that are used only if gopura.conf allows them; storage and touch always are.
 * These are the bits of usb_allow. */
enum terminal_usb {
	TERMINAL_USB_KEYBOARD = 1,
	TERMINAL_USB_NETWORK = 2, /* wired */
	TERMINAL_USB_WIFI = 4,
	TERMINAL_USB_PANEL = 8, /* DisplayLink */
};

struct terminal_servers {
	char names[TERMINAL_SERVERS_MAX][254]; /* addresses; time servers may also be names */
	uint32_t count;
};

/* A string is "" if the file does not set it. */
struct terminal {
	/* [terminal] */
	char name[TERMINAL_NAME_BYTES]; /* UTF-8, as people call it */
	char language[16];              /* for example km or pt-BR */
	char time_zone[64];             /* relative to /usr/share/zoneinfo */
	char board[32];                 /* name of a profile, without .ini */
	/* [release] */
	char release_url[TERMINAL_URL_BYTES]; /* https://, http:// or an absolute folder */
	char trust[TERMINAL_NAME_BYTES];    /* name of a file beside gopura.conf, without slashes */
	char ca[TERMINAL_NAME_BYTES];       /* the same */
	char target[TERMINAL_TARGET_BYTES]; /* path among the targets of The Update Framework */
	char redirect_hosts[TERMINAL_URL_BYTES]; /* "cdn.example,cdn2.example:8443" */
	uint32_t poll_s;                         /* 60 .. 86400; 0: not set */
	struct daily download;                   /* local time of day; both ends equal: always */
	uint32_t rate_limit_kib;                 /* KiB per second; 0: no limit */
	uint32_t wait_ms;                        /* [network]: 50 .. 60000; 0: not set */
	/* [panel] */
	int width_px, height_px; /* 0: the panel's preferred mode */
	int hz;                  /* whole number; 0: any */
	int rotation_deg;        /* 0, 90, 180, 270, clockwise; -1: the board profile decides */
	struct hours hours;      /* always open if the file does not set them */
	/* minutes the panel stays on after a touch outside the hours; 0: it stays off */
	uint32_t wake_min;
	bool shift; /* pixels are shifted now and then; true if the file does not set it */
	/* [network] */
	bool is_dhcp;                   /* the file says so; without an address it is too */
	bool is_static;                 /* true: address and prefix_bits are valid; false: DHCP */
	char address[INET6_ADDRSTRLEN]; /* without the prefix length */
	uint32_t prefix_bits;
	char gateway[INET6_ADDRSTRLEN];
	struct terminal_servers dns, ntp;
	/* [wifi] */
	char ssid[33]; /* valid UTF-8 */
	/* 8 to 63 printable ASCII characters, or 64 hexadecimal digits (a key) */
	char passphrase[65];
	char country[3]; /* two capital letters */
	/* [health] */
	char listen_address[INET6_ADDRSTRLEN];
	uint32_t listen_port;
	bool mdns; /* announce the health page on the network */
	/* [usb] */
	uint32_t usb_allow; /* bits of enum terminal_usb */
	/* [visit] */
	uint32_t idle_s;   /* seconds without a touch before the visitor is asked; 5 .. 3600 */
	uint32_t loudness; /* of spoken texts, up to 100; 0: they are not offered */
};

/* The values that hold for everything the file does not set. */
extern const struct terminal terminal_default;

/* Parses text. *out starts as terminal_default; valid lines are applied even if others are wrong.
 * Faults are added to *diagnostics, ordered by lines. */
void terminal_parse(struct terminal *out, struct bytes text, struct diagnostics *diagnostics);
/* Reads the file at path, and looks for the files it names beside it and for the board profile in
 * the folder `boards` (NULL: no check). A name without a readable file is reported and cleared.
 * -ENOENT: there is no file at path; this is not added. A file that cannot be read is
 * added, and the result is 0. */
must_check int terminal_read(struct terminal *out, const char *path, const char *boards,
			     struct diagnostics *diagnostics);

/* Reads a file named by the gopura.conf at `path` into *out (cleared first). Only a regular file in
 * the same folder is read. Errors: base/safe_open.h. */
must_check int terminal_read_beside(struct buffer *out, const char *path, const char *name);

/* Length of a checksum as hexadecimal text, with its end. */
enum { TERMINAL_SUM_BYTES = 65 };
/* Writes a checksum over the gopura.conf at `path` and the files that it names, as hexadecimal
 * text: equal contents give equal sums. A named file that cannot be read counts as empty, unless
 * the next try may work (base/transient.h). Errors: those, and for gopura.conf itself those of
 * base/safe_open.h. */
must_check int terminal_sum(const char *path, char out[TERMINAL_SUM_BYTES]);
/* Length of the result of terminal_usb_words, with its end. */
enum { TERMINAL_USB_WORDS_BYTES = 64 };
/* Writes the kinds in usb_allow as gopura.conf calls them, separated by spaces; "" if there are
 * none. */
void terminal_usb_words(const struct terminal *terminal, char out[TERMINAL_USB_WORDS_BYTES]);

/* Writes the terminal's name as a host name: lower-case letters, digits and dashes; "gopura" if
 * nothing is left. */
void terminal_host_name(const struct terminal *terminal, char out[TERMINAL_NAME_BYTES]);

#endif
