/* gopura.conf: the one file that makes an appliance this museum's terminal (docs/terminal.md).
 * Every value is checked; who has a struct terminal need not doubt it. */
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

enum { TERMINAL_SERVERS_MAX = 4, TERMINAL_NAME_BYTES = 64, TERMINAL_URL_BYTES = 512 };
/* A file that gopura.conf names is no larger; all authorities of a system take a quarter of it. */
enum { TERMINAL_FILE_BYTES_MAX = 1 << 20 };

/* Kinds of USB device that are taken up only where gopura.conf says so; storage and touch always
 * are. As bits of usb_allow. */
enum terminal_usb {
	TERMINAL_USB_KEYBOARD = 1,
	TERMINAL_USB_NETWORK = 2, /* by cable */
	TERMINAL_USB_WIFI = 4,
	TERMINAL_USB_PANEL = 8, /* DisplayLink */
};

struct terminal_servers {
	char names[TERMINAL_SERVERS_MAX][254]; /* addresses; of time servers names too */
	uint32_t count;
};

/* Strings are "" where the file says nothing. */
struct terminal {
	/* [terminal] */
	char name[TERMINAL_NAME_BYTES]; /* UTF-8, as people call it */
	char language[16];              /* such as km or pt-BR */
	char time_zone[64];             /* of /usr/share/zoneinfo */
	char board[32];                 /* a profile's name, without .ini */
	/* [release] */
	char release_url[TERMINAL_URL_BYTES];    /* https://, http:// or an absolute folder */
	char trust[TERMINAL_NAME_BYTES];         /* file beside gopura.conf, no slashes */
	char ca[TERMINAL_NAME_BYTES];            /* the same */
	char redirect_hosts[TERMINAL_URL_BYTES]; /* "cdn.example,cdn2.example:8443" */
	uint32_t poll_s;                         /* 60 .. 86400; 0: not said */
	struct daily download;                   /* of the local day; its ends equal: always */
	uint32_t rate_limit_kib;                 /* a second; 0: none */
	/* [panel] */
	int width_px, height_px; /* 0: what the panel prefers */
	int hz;                  /* whole; 0: any */
	int rotation_deg;        /* 0, 90, 180, 270, clockwise; -1: the board's profile says it */
	struct hours hours;      /* always open where the file says nothing */
	uint32_t wake_min;       /* a touch switches it on outside of hours; 0: it does not */
	bool shift;              /* pixels move now and then; yes where the file says nothing */
	/* [network] */
	bool is_static;                 /* address and prefix_bits hold; else by DHCP */
	char address[INET6_ADDRSTRLEN]; /* without the prefix */
	uint32_t prefix_bits;
	char gateway[INET6_ADDRSTRLEN];
	struct terminal_servers dns, ntp;
	/* [wifi] */
	char ssid[33];       /* bytes that make UTF-8 */
	char passphrase[65]; /* 8 to 63 printable ASCII characters, or 64 hexadecimal digits (a key)
			      */
	char country[3];     /* two capital letters */
	/* [health] */
	char listen_address[INET6_ADDRSTRLEN];
	uint32_t listen_port;
	bool mdns; /* the network is told of it */
	/* [usb] */
	uint32_t usb_allow; /* enum terminal_usb */
	/* [visit] */
	uint32_t idle_s; /* without a touch until a visitor is asked; 5 .. 3600 */
};

extern const struct terminal terminal_default;

/* *out starts as terminal_default; what is right is set although other lines are wrong. */
void terminal_parse(struct terminal *out, struct bytes text, struct faults *faults);
/* Reads the file, looks beside it for the files that it names and in the folder `boards` (NULL: no
 * look) for the profile; a name without a file is at fault, and "" then. -ENOENT: there is no
 * gopura.conf at path; that is not among the faults. What cannot be read is one. */
must_check int terminal_read(struct terminal *out, const char *path, const char *boards,
			     struct faults *faults);

/* A file that the gopura.conf at path names, into *out (cleared first); nothing else than a regular
 * file in the same folder is read. Errors: base/safe_open.h. */
must_check int terminal_read_beside(struct buffer *out, const char *path, const char *name);

/* A checksum over the gopura.conf at path and the files that it names, as hexadecimal text: the
 * same for two that mean the same. A named file that cannot be read counts as empty. Errors:
 * base/safe_open.h, of gopura.conf itself. */
enum { TERMINAL_SUM_BYTES = 65 };
must_check int terminal_sum(const char *path, char out[TERMINAL_SUM_BYTES]);
/* The kinds of usb_allow as gopura.conf calls them, with spaces between; "" where there is none. */
enum { TERMINAL_USB_WORDS_BYTES = 64 };
void terminal_usb_words(const struct terminal *terminal, char out[TERMINAL_USB_WORDS_BYTES]);

/* The terminal's name as computers say it: letters, digits and dashes; "gopura" where nothing is
 * left of it. */
void terminal_host_name(const struct terminal *terminal, char out[TERMINAL_NAME_BYTES]);

#endif
