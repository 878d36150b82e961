/* The set function of each setting in gopura.conf: checks the text of a value and stores it. */
#include "system/terminal_values.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/transient.h"

#define LETTERS     "abcdefghijklmnopqrstuvwxyz"
#define BIG_LETTERS "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
#define DIGITS      "0123456789"

#define STICK_FOLDER "/run/gopura-stick" /* where the appliance mounts a stick */

/* ---- texts */

/* Copies value into the field if it fits. */
static bool put(char *to, size_t bytes, const char *value)
{
	const size_t length = strlen(value);

	if (length >= bytes)
		return false;
	memcpy(to, value, length + 1);
	return true;
}

static bool only(const char *text, const char *chars)
{
	return text[strspn(text, chars)] == '\0';
}

/* Returns true for tabs and U+0080 to U+009F; settings_read has refused other control
 * characters. */
static bool has_control(const char *text)
{
	for (; *text; text++)
		if ((unsigned char)*text < 0x20 || *text == 0x7f ||
		    ((unsigned char)*text == 0xc2 && (unsigned char)text[1] < 0xa0))
			return true;
	return false;
}

bool terminal_set_name(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;

	(void)setting;
	return !has_control(value) && put(terminal->name, sizeof(terminal->name), value);
}

/* For example km, pt-BR, zh_Hant. */
bool terminal_set_language(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	const size_t letters = strspn(value, LETTERS), rest = strlen(value) - letters;

	(void)setting;
	if (letters < 2 || letters > 3)
		return false;
	if (rest > 0 && (!strchr("-_", value[letters]) || rest < 3 ||
			 !only(value + letters + 1, LETTERS BIG_LETTERS DIGITS "-_")))
		return false;
	return put(terminal->language, sizeof(terminal->language), value);
}

bool terminal_set_time_zone(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	char path[PATH_MAX];
	struct stat found;

	(void)setting;
	if (!only(value, LETTERS BIG_LETTERS DIGITS "_+-/") || *value == '/')
		return false;
	snprintf(path, sizeof(path), "/usr/share/zoneinfo/%s", value);
	/* One that cannot be looked up now may be right. */
	return (stat(path, &found) == 0 ? S_ISREG(found.st_mode) : is_transient(-errno)) &&
	       put(terminal->time_zone, sizeof(terminal->time_zone), value);
}

bool terminal_set_board(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;

	(void)setting;
	return only(value, LETTERS DIGITS "-_") &&
	       put(terminal->board, sizeof(terminal->board), value);
}

/* ---- the release */

bool terminal_url_is_of_stick(const char *url)
{
	static const char *const places[] = { "", "/", "/release", "/release/" };

	for (size_t i = 0; i < ARRAY_COUNT(places); i++)
		if (strncmp(url, STICK_FOLDER, strlen(STICK_FOLDER)) == 0 &&
		    strcmp(url + strlen(STICK_FOLDER), places[i]) == 0)
			return true;
	return false;
}

/* The url is used in a command line and in a systemd file, so only these characters are allowed. */
bool terminal_set_url(const struct setting *setting, void *target, const char *value)
{
	static const char signs[] = LETTERS BIG_LETTERS DIGITS "-._~:/?[]@!&()*+,;=%";
	struct terminal *terminal = target;
	const char *host = NULL;

	(void)setting;
	if (!only(value, signs))
		return false;
	if (strncmp(value, "https://", 8) == 0)
		host = value + 8;
	else if (strncmp(value, "http://", 7) == 0)
		host = value + 7;
	if (host ? !isalnum((unsigned char)*host) && *host != '[' : *value != '/')
		return false;
	if (strncmp(value, STICK_FOLDER, strlen(STICK_FOLDER)) == 0 &&
	    !terminal_url_is_of_stick(value))
		return false;
	return put(terminal->release_url, sizeof(terminal->release_url), value);
}

bool terminal_set_file(const struct setting *setting, void *target, const char *value)
{
	return *value != '.' && *value != '-' && only(value, LETTERS BIG_LETTERS DIGITS "._-") &&
	       put((char *)target + setting->offset, TERMINAL_NAME_BYTES, value);
}

/* No part of the path is empty or begins with a dot. */
bool terminal_set_target(const struct setting *setting, void *target, const char *value)
{
	const size_t size = strlen(value);

	(void)setting;
	return only(value, LETTERS BIG_LETTERS DIGITS "._-/") && size > 0 && *value != '.' &&
	       *value != '/' && value[size - 1] != '/' && !strstr(value, "//") &&
	       !strstr(value, "/.") &&
	       put(((struct terminal *)target)->target, TERMINAL_TARGET_BYTES, value);
}

bool terminal_set_download(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	struct daily daily;

	(void)setting;
	if (daily_parse(&daily, value) < 0 || daily.from_min == daily.until_min)
		return false;
	terminal->download = daily;
	return true;
}

/* ---- the panel */

/* For example 1920x1080 or 1920x1080@60. */
bool terminal_set_mode(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	int width, height, length = 0;
	double hz = 0;

	(void)setting;
	if (!only(value, DIGITS "x@.") || sscanf(value, "%4dx%4d%n", &width, &height, &length) != 2)
		return false;
	value += length;
	if (*value == '@') {
		char *end;

		hz = strtod(value + 1, &end);
		if (end == value + 1 || !(hz >= 10 && hz <= 240))
			return false;
		value = end;
	}
	if (*value || width < 64 || width > 8192 || height < 64 || height > 8192)
		return false;
	terminal->width_px = width;
	terminal->height_px = height;
	terminal->hz = (int)lround(hz);
	return true;
}

bool terminal_set_rotation(const struct setting *setting, void *target, const char *value)
{
	double number;

	return settings_numbers(setting, value, &number, 1) && fmod(number, 90) == 0 &&
	       settings_whole(setting, target, value);
}

bool terminal_set_hours(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	struct hours hours;

	(void)setting;
	if (!hours_parse(&hours, value))
		return false;
	terminal->hours = hours;
	return true;
}

/* ---- networks */

static bool is_address(const char *text)
{
	struct in6_addr bytes;

	return inet_pton(AF_INET, text, &bytes) == 1 || inet_pton(AF_INET6, text, &bytes) == 1;
}

/* dhcp, or for example 192.168.1.20/24. The first and last address of an IPv4 network are refused,
 * because they belong to no host. */
bool terminal_set_address(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	char address[INET6_ADDRSTRLEN];
	const char *slash = strchr(value, '/');
	struct in6_addr bytes;
	unsigned long bits;
	uint32_t host;

	(void)setting;
	terminal->is_dhcp = strcasecmp(value, "dhcp") == 0;
	if (terminal->is_dhcp)
		return true;
	if (!slash || (size_t)(slash - value) >= sizeof(address) || !slash[1] ||
	    !only(slash + 1, DIGITS) || strlen(slash) > 4)
		return false;
	snprintf(address, sizeof(address), "%.*s", (int)(slash - value), value);
	bits = strtoul(slash + 1, NULL, 10);
	if (inet_pton(AF_INET, address, &bytes) == 1) {
		if (bits < 1 || bits > 32)
			return false;
		memcpy(&host, &bytes, sizeof(host));
		host = bits == 32 ? 1 : ntohl(host) & (UINT32_MAX >> bits);
		if (bits < 31 && (host == 0 || host == UINT32_MAX >> bits))
			return false;
	} else if (inet_pton(AF_INET6, address, &bytes) != 1 || bits < 1 || bits > 128) {
		return false;
	}
	terminal->is_static = true;
	terminal->prefix_bits = (uint32_t)bits;
	return put(terminal->address, sizeof(terminal->address), address);
}

bool terminal_set_gateway(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;

	(void)setting;
	return is_address(value) && put(terminal->gateway, sizeof(terminal->gateway), value);
}

static bool is_host(const char *text)
{
	return is_address(text) ||
	       (only(text, LETTERS BIG_LETTERS DIGITS ".-") && isalnum((unsigned char)*text) &&
		!strstr(text, "..") && strpbrk(text, LETTERS BIG_LETTERS));
}

static bool set_servers(struct terminal_servers *out, const char *value,
			bool (*is_good)(const char *text))
{
	struct terminal_servers servers = { .count = 0 };

	for (;;) {
		size_t length;

		value += strspn(value, " \t,");
		length = strcspn(value, " \t,");
		if (length == 0)
			break;
		if (servers.count == TERMINAL_SERVERS_MAX || length >= sizeof(servers.names[0]))
			return false;
		memcpy(servers.names[servers.count], value, length);
		if (!is_good(servers.names[servers.count++]))
			return false;
		value += length;
	}
	*out = servers;
	return servers.count > 0;
}

bool terminal_set_dns(const struct setting *setting, void *target, const char *value)
{
	(void)setting;
	return set_servers(&((struct terminal *)target)->dns, value, is_address);
}

bool terminal_set_ntp(const struct setting *setting, void *target, const char *value)
{
	(void)setting;
	return set_servers(&((struct terminal *)target)->ntp, value, is_host);
}

/* For example cdn.example or cdn.example:8443, as gopura-fetch accepts them. */
static bool is_host_with_port(const char *text)
{
	char host[254];
	const size_t length = strcspn(text, ":");

	if (length >= sizeof(host))
		return false;
	memcpy(host, text, length);
	host[length] = '\0';
	if (!only(host, LETTERS BIG_LETTERS DIGITS ".-") || !isalnum((unsigned char)*host) ||
	    strstr(host, ".."))
		return false;
	if (!text[length])
		return true;
	return only(text + length + 1, DIGITS) && strlen(text + length + 1) <= 5 &&
	       strtoul(text + length + 1, NULL, 10) - 1 < 65535;
}

/* The list is used in a command line, so hosts are separated only by commas. */
bool terminal_set_redirect_hosts(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	struct terminal_servers hosts;
	char list[sizeof(terminal->redirect_hosts)] = "";
	size_t used = 0;

	(void)setting;
	if (!set_servers(&hosts, value, is_host_with_port))
		return false;
	for (uint32_t i = 0; i < hosts.count && used < sizeof(list); i++)
		used += (size_t)snprintf(list + used, sizeof(list) - used, "%s%s", i ? "," : "",
					 hosts.names[i]);
	return used < sizeof(list) && put(terminal->redirect_hosts, sizeof(list), list);
}

bool terminal_set_ssid(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;

	(void)setting;
	return !has_control(value) && put(terminal->ssid, sizeof(terminal->ssid), value);
}

bool terminal_set_passphrase(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	const size_t length = strlen(value);

	(void)setting;
	for (size_t i = 0; i < length; i++)
		if (value[i] < 0x20 || value[i] > 0x7e)
			return false;
	if (length < 8 || (length == 64 && !only(value, DIGITS "abcdefABCDEF")))
		return false;
	return put(terminal->passphrase, sizeof(terminal->passphrase), value);
}

/* Checks the list of countries of the time zone package. Without that list any two letters are
 * valid. */
bool terminal_set_country(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	FILE *list;
	char line[256];
	bool known = false;

	(void)setting;
	if (strlen(value) != 2 || !only(value, LETTERS BIG_LETTERS))
		return false;
	list = fopen("/usr/share/zoneinfo/iso3166.tab", "re");
	while (list && !known && fgets(line, sizeof(line), list))
		known = strncasecmp(line, value, 2) == 0 && line[2] == '\t';
	if (list)
		fclose(list);
	if (list && !known)
		return false;
	for (int i = 0; i < 2; i++)
		terminal->country[i] = (char)toupper((unsigned char)value[i]);
	return true;
}

/* For example 127.0.0.1:9100 or [::1]:9100. */
bool terminal_set_listen(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	const char *colon = strrchr(value, ':');
	const bool brackets = *value == '[';
	char address[INET6_ADDRSTRLEN] = "";
	unsigned long port;

	(void)setting;
	if (!colon || (brackets && (colon < value + 2 || colon[-1] != ']')) ||
	    !only(colon + 1, DIGITS) || strlen(colon + 1) > 5)
		return false;
	port = strtoul(colon + 1, NULL, 10);
	if ((size_t)(colon - value) >= sizeof(address) || port < 1 || port > 65535)
		return false;
	memcpy(address, value + brackets, (size_t)(colon - value) - 2 * brackets);
	if (!is_address(address) || brackets != !!strchr(address, ':'))
		return false;
	terminal->listen_port = (uint32_t)port;
	return put(terminal->listen_address, sizeof(terminal->listen_address), address);
}

/* ---- USB */

static const struct {
	const char *word;
	uint32_t bit;
} usb_kinds[] = {
	{ "keyboard", TERMINAL_USB_KEYBOARD },
	{ "network", TERMINAL_USB_NETWORK },
	{ "wifi", TERMINAL_USB_WIFI },
	{ "panel", TERMINAL_USB_PANEL },
};

/* For example "keyboard, network". */
bool terminal_set_usb(const struct setting *setting, void *target, const char *value)
{
	uint32_t allow = 0;

	(void)setting;
	for (;;) {
		size_t length, i = 0;

		value += strspn(value, " \t,");
		length = strcspn(value, " \t,");
		if (length == 0)
			break;
		while (i < ARRAY_COUNT(usb_kinds) &&
		       (strlen(usb_kinds[i].word) != length ||
			strncasecmp(usb_kinds[i].word, value, length) != 0))
			i++;
		if (i == ARRAY_COUNT(usb_kinds))
			return false;
		allow |= usb_kinds[i].bit;
		value += length;
	}
	((struct terminal *)target)->usb_allow = allow;
	return allow != 0;
}

void terminal_usb_words(const struct terminal *terminal, char out[TERMINAL_USB_WORDS_BYTES])
{
	size_t length = 0;

	out[0] = '\0';
	for (size_t i = 0; i < ARRAY_COUNT(usb_kinds); i++)
		if (terminal->usb_allow & usb_kinds[i].bit)
			length += (size_t)snprintf(out + length, TERMINAL_USB_WORDS_BYTES - length,
						   "%s%s", length ? " " : "", usb_kinds[i].word);
}
