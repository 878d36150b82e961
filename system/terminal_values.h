/* How each value of gopura.conf reads: the set functions of its table (base/settings.h), each into
 * its field of a struct terminal. Private to system/terminal. */
#ifndef GOPURA_SYSTEM_TERMINAL_VALUES_H
#define GOPURA_SYSTEM_TERMINAL_VALUES_H

#include "system/terminal.h"

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

/* The url names the stick itself, or release/ on it: the two places where the fetcher looks there.
 */
bool terminal_url_is_of_stick(const char *url);

#endif
