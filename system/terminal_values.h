/* Set functions for the table of settings in terminal.c (base/settings.h). Each stores its value in
 * one field of a struct terminal. Private to system/terminal.
 *
 * Each returns false if value is not valid; target, a struct terminal, is then unchanged. `setting`
 * is the row of the table; some functions use its offset and range. */
#ifndef GOPURA_SYSTEM_TERMINAL_VALUES_H
#define GOPURA_SYSTEM_TERMINAL_VALUES_H

#include "system/terminal.h"

/* [terminal] name: at most 63 bytes without control characters. */
bool terminal_set_name(const struct setting *setting, void *target, const char *value);
/* [terminal] language: a tag such as km, pt-BR or zh_Hant. */
bool terminal_set_language(const struct setting *setting, void *target, const char *value);
/* [terminal] time_zone: must exist in /usr/share/zoneinfo. */
bool terminal_set_time_zone(const struct setting *setting, void *target, const char *value);
/* [terminal] board: the name of a profile; terminal_read checks that it exists. */
bool terminal_set_board(const struct setting *setting, void *target, const char *value);
/* [release] url: https, http or an absolute folder; of the stick only the two places of the
 * fetcher. */
bool terminal_set_url(const struct setting *setting, void *target, const char *value);
/* [release] trust and ca: a file name without folders; stored at setting->offset. */
bool terminal_set_file(const struct setting *setting, void *target, const char *value);
/* [release] target: the path of a target, without empty parts and parts that begin with a dot. */
bool terminal_set_target(const struct setting *setting, void *target, const char *value);
/* [release] download: two different times of day. */
bool terminal_set_download(const struct setting *setting, void *target, const char *value);
/* [panel] mode: WIDTHxHEIGHT or WIDTHxHEIGHT@HZ; 64 to 8192 pixels, 10 to 240 Hz. */
bool terminal_set_mode(const struct setting *setting, void *target, const char *value);
/* [panel] rotation: a multiple of 90 in the range of the setting. */
bool terminal_set_rotation(const struct setting *setting, void *target, const char *value);
/* [panel] hours: as system/hours.h reads them. */
bool terminal_set_hours(const struct setting *setting, void *target, const char *value);
/* [network] address: dhcp, or an address with its prefix length. */
bool terminal_set_address(const struct setting *setting, void *target, const char *value);
/* [network] gateway: an IPv4 or IPv6 address. */
bool terminal_set_gateway(const struct setting *setting, void *target, const char *value);
/* [network] dns: 1 to TERMINAL_SERVERS_MAX addresses. */
bool terminal_set_dns(const struct setting *setting, void *target, const char *value);
/* [release] redirect_hosts: 1 to TERMINAL_SERVERS_MAX hosts, each with or without a port. */
bool terminal_set_redirect_hosts(const struct setting *setting, void *target, const char *value);
/* [network] ntp: 1 to TERMINAL_SERVERS_MAX addresses or host names. */
bool terminal_set_ntp(const struct setting *setting, void *target, const char *value);
/* [wifi] ssid: at most 32 bytes without control characters. */
bool terminal_set_ssid(const struct setting *setting, void *target, const char *value);
/* [wifi] passphrase: 8 to 63 printable ASCII characters, or 64 hexadecimal digits. */
bool terminal_set_passphrase(const struct setting *setting, void *target, const char *value);
/* [wifi] country: two letters, stored as capitals; checked against the list of countries. */
bool terminal_set_country(const struct setting *setting, void *target, const char *value);
/* [health] listen: ADDRESS:PORT, or [ADDRESS]:PORT for IPv6. */
bool terminal_set_listen(const struct setting *setting, void *target, const char *value);
/* [usb] allow: one or more of keyboard, network, wifi, panel. An empty list returns false and
 * clears the field. */
bool terminal_set_usb(const struct setting *setting, void *target, const char *value);

/* Returns whether url names the mounted stick itself or release/ on it. These are the two places
 * where the fetcher looks for a release on a stick. */
bool terminal_url_is_of_stick(const char *url);

#endif
