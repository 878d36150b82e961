/* Set functions for the table of settings in terminal.c (base/settings.h). Each stores its value in
 * one field of a struct terminal. Private to system/terminal. */
#ifndef GOPURA_SYSTEM_TERMINAL_VALUES_H
#define GOPURA_SYSTEM_TERMINAL_VALUES_H

#include "system/terminal.h"

/* Each function returns false if value is not valid; target, a struct terminal, is then unchanged.
 * `setting` is the row of the table; some functions use its offset and range. */
bool terminal_set_name(const struct setting *setting, void *target, const char *value);
bool terminal_set_language(const struct setting *setting, void *target, const char *value);
bool terminal_set_time_zone(const struct setting *setting, void *target, const char *value);
bool terminal_set_board(const struct setting *setting, void *target, const char *value);
bool terminal_set_url(const struct setting *setting, void *target, const char *value);
bool terminal_set_file(const struct setting *setting, void *target, const char *value);
bool terminal_set_download(const struct setting *setting, void *target, const char *value);
bool terminal_set_mode(const struct setting *setting, void *target, const char *value);
bool terminal_set_rotation(const struct setting *setting, void *target, const char *value);
bool terminal_set_hours(const struct setting *setting, void *target, const char *value);
bool terminal_set_yes_no(const struct setting *setting, void *target, const char *value);
bool terminal_set_address(const struct setting *setting, void *target, const char *value);
bool terminal_set_gateway(const struct setting *setting, void *target, const char *value);
bool terminal_set_dns(const struct setting *setting, void *target, const char *value);
bool terminal_set_redirect_hosts(const struct setting *setting, void *target, const char *value);
bool terminal_set_ntp(const struct setting *setting, void *target, const char *value);
bool terminal_set_ssid(const struct setting *setting, void *target, const char *value);
bool terminal_set_passphrase(const struct setting *setting, void *target, const char *value);
bool terminal_set_country(const struct setting *setting, void *target, const char *value);
bool terminal_set_listen(const struct setting *setting, void *target, const char *value);
bool terminal_set_usb(const struct setting *setting, void *target, const char *value);

/* Returns whether url names the mounted stick itself or release/ on it. These are the two places
 * where the fetcher looks for a release on a stick. */
bool terminal_url_is_of_stick(const char *url);

#endif
