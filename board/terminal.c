#include "board/terminal.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#define LETTERS     "abcdefghijklmnopqrstuvwxyz"
#define BIG_LETTERS "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
#define DIGITS      "0123456789"

const struct terminal terminal_default = {
	.rotation_deg = -1,
	.hours = { .open = { [0 ... HOURS_MINUTES / 8 - 1] = 0xff } },
	.shift = true,
	.listen_address = "127.0.0.1",
	.listen_port = 9100,
};

/* ---- texts */

/* Into the field, if it has room. */
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

static bool set_name(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;

	(void)setting;
	return put(terminal->name, sizeof(terminal->name), value);
}

/* km, pt-BR, zh_Hant */
static bool set_language(const struct setting *setting, void *target, const char *value)
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

static bool set_time_zone(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	char path[PATH_MAX];
	struct stat found;

	(void)setting;
	if (!only(value, LETTERS BIG_LETTERS DIGITS "_+-/") || *value == '/')
		return false;
	snprintf(path, sizeof(path), "/usr/share/zoneinfo/%s", value);
	return stat(path, &found) == 0 && S_ISREG(found.st_mode) &&
	       put(terminal->time_zone, sizeof(terminal->time_zone), value);
}

static bool set_board(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;

	(void)setting;
	return only(value, LETTERS DIGITS "-_") &&
	       put(terminal->board, sizeof(terminal->board), value);
}

/* ---- the release */

/* An address that stands in a command line and in a file of the service manager's. */
static bool set_url(const struct setting *setting, void *target, const char *value)
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
	return put(terminal->release_url, sizeof(terminal->release_url), value);
}

static bool set_file(const struct setting *setting, void *target, const char *value)
{
	return *value != '.' && *value != '-' && only(value, LETTERS BIG_LETTERS DIGITS "._-") &&
	       put((char *)target + setting->offset, TERMINAL_NAME_BYTES, value);
}

static bool set_download(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	int from, to;

	(void)setting;
	if (!hours_clock(&value, &from))
		return false;
	value += strspn(value, " ");
	if (*value++ != '-')
		return false;
	value += strspn(value, " ");
	if (!hours_clock(&value, &to) || *value || from == to || from == 24 * 60)
		return false;
	terminal->has_download = true;
	terminal->download_from_min = from;
	terminal->download_to_min = to;
	return true;
}

/* ---- the panel */

/* 1920x1080, 1920x1080@60 */
static bool set_mode(const struct setting *setting, void *target, const char *value)
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

static bool set_rotation(const struct setting *setting, void *target, const char *value)
{
	double number;

	return settings_numbers(setting, value, &number, 1) && fmod(number, 90) == 0 &&
	       settings_whole(setting, target, value);
}

static bool set_hours(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	struct hours hours;

	(void)setting;
	if (!hours_parse(&hours, value))
		return false;
	terminal->hours = hours;
	return true;
}

static bool set_shift(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;

	(void)setting;
	if (strcasecmp(value, "yes") != 0 && strcasecmp(value, "no") != 0)
		return false;
	terminal->shift = strcasecmp(value, "yes") == 0;
	return true;
}

/* ---- networks */

static bool is_address(const char *text)
{
	struct in6_addr bytes;

	return inet_pton(AF_INET, text, &bytes) == 1 || inet_pton(AF_INET6, text, &bytes) == 1;
}

/* dhcp, or 192.168.1.20/24. Of a network of its own no host is the first or the last. */
static bool set_address(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;
	char address[INET6_ADDRSTRLEN];
	const char *slash = strchr(value, '/');
	struct in6_addr bytes;
	unsigned long bits;
	uint32_t host;

	(void)setting;
	if (strcasecmp(value, "dhcp") == 0)
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

static bool set_gateway(const struct setting *setting, void *target, const char *value)
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
		if (servers.count == TERMINAL_SERVERS_MOST || length >= sizeof(servers.names[0]))
			return false;
		memcpy(servers.names[servers.count], value, length);
		if (!is_good(servers.names[servers.count++]))
			return false;
		value += length;
	}
	*out = servers;
	return servers.count > 0;
}

static bool set_dns(const struct setting *setting, void *target, const char *value)
{
	(void)setting;
	return set_servers(&((struct terminal *)target)->dns, value, is_address);
}

static bool set_ntp(const struct setting *setting, void *target, const char *value)
{
	(void)setting;
	return set_servers(&((struct terminal *)target)->ntp, value, is_host);
}

static bool set_ssid(const struct setting *setting, void *target, const char *value)
{
	struct terminal *terminal = target;

	(void)setting;
	return put(terminal->ssid, sizeof(terminal->ssid), value);
}

static bool set_passphrase(const struct setting *setting, void *target, const char *value)
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

/* As the time zones' list of countries has it; any two letters where the system has no list. */
static bool set_country(const struct setting *setting, void *target, const char *value)
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

/* 127.0.0.1:9100, [::1]:9100 */
static bool set_listen(const struct setting *setting, void *target, const char *value)
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

/* ---- the table */

enum {
	AT_BOARD = 3,
	AT_URL,
	AT_TRUST,
	AT_CA,
	AT_ADDRESS = 14,
	AT_GATEWAY,
	AT_SSID = 18,
	AT_PASSPHRASE,
	AT_COUNTRY,
};

static const struct setting settings[] = {
	{ .section = "terminal",
	  .name = "name",
	  .expects = "a name of up to 63 bytes, such as East gate",
	  .set = set_name,
	  .free_text = true },
	{ .section = "terminal",
	  .name = "language",
	  .expects = "the code of a language, such as km, en or pt-BR",
	  .set = set_language },
	{ .section = "terminal",
	  .name = "time_zone",
	  .expects = "a time zone such as Asia/Phnom_Penh or Europe/Berlin",
	  .set = set_time_zone },
	[AT_BOARD] = { .section = "terminal",
		       .name = "board",
		       .expects = "the name of a board's profile, such as generic",
		       .set = set_board },
	[AT_URL] = { .section = "release",
		     .name = "url",
		     .expects = "an address such as https://museum.example/temple/, or a folder "
				"such as /media/release",
		     .set = set_url },
	[AT_TRUST] = { .section = "release",
		       .name = "trust",
		       .expects = "the name of a file beside this one, without folders or spaces, "
				  "such as 1.json",
		       .set = set_file,
		       .offset = offsetof(struct terminal, trust) },
	[AT_CA] = { .section = "release",
		    .name = "ca",
		    .expects = "the name of a file beside this one, without folders or spaces, "
			       "such as ca.pem",
		    .set = set_file,
		    .offset = offsetof(struct terminal, ca) },
	{ .section = "release",
	  .name = "poll_s",
	  .expects = "whole seconds from 60 to 86400",
	  .set = settings_whole,
	  .offset = offsetof(struct terminal, poll_s),
	  .least = 60,
	  .most = 86400 },
	{ .section = "release",
	  .name = "download",
	  .expects = "two times of day such as 22:00-06:00",
	  .set = set_download },
	{ .section = "release",
	  .name = "rate_limit_kib",
	  .expects = "a whole number of KiB a second from 1 to 1048576",
	  .set = settings_whole,
	  .offset = offsetof(struct terminal, rate_limit_kib),
	  .least = 1,
	  .most = 1048576 },
	{ .section = "panel",
	  .name = "mode",
	  .expects = "a size such as 1920x1080, or with its frequency 1920x1080@60",
	  .set = set_mode },
	{ .section = "panel",
	  .name = "rotation",
	  .expects = "0, 90, 180 or 270",
	  .set = set_rotation,
	  .offset = offsetof(struct terminal, rotation_deg),
	  .least = 0,
	  .most = 270 },
	{ .section = "panel",
	  .name = "hours",
	  .expects = "days and times such as Mo-Fr 09:00-18:00, Sa 10:00-17:00",
	  .set = set_hours },
	{ .section = "panel", .name = "shift", .expects = "yes or no", .set = set_shift },
	[AT_ADDRESS] = { .section = "network",
			 .name = "address",
			 .expects = "dhcp, or an address with its network's bits such as "
				    "192.168.1.20/24",
			 .set = set_address },
	[AT_GATEWAY] = { .section = "network",
			 .name = "gateway",
			 .expects = "an address such as 192.168.1.1",
			 .set = set_gateway },
	{ .section = "network",
	  .name = "dns",
	  .expects = "up to 4 addresses such as 192.168.1.1, 9.9.9.9",
	  .set = set_dns },
	{ .section = "network",
	  .name = "ntp",
	  .expects = "up to 4 time servers such as 192.168.1.1, pool.ntp.org",
	  .set = set_ntp },
	[AT_SSID] = { .section = "wifi",
		      .name = "ssid",
		      .expects = "a network's name of 1 to 32 bytes",
		      .set = set_ssid,
		      .free_text = true },
	[AT_PASSPHRASE] = { .section = "wifi",
			    .name = "passphrase",
			    .expects = "8 to 63 letters, digits and signs (no accents), or 64 "
				       "hexadecimal digits",
			    .set = set_passphrase,
			    .free_text = true,
			    .secret = true },
	[AT_COUNTRY] = { .section = "wifi",
			 .name = "country",
			 .expects = "the two letters of a country such as KH or GB",
			 .set = set_country },
	{ .section = "health",
	  .name = "listen",
	  .expects = "an address and a port such as 127.0.0.1:9100 or [::1]:9100",
	  .set = set_listen },
};

/* ---- the whole */

static bool in_one_network(const char *a, const char *b, uint32_t bits)
{
	uint8_t bytes[2][16];
	const int family = strchr(a, ':') ? AF_INET6 : AF_INET;

	if (inet_pton(family, a, bytes[0]) != 1 || inet_pton(family, b, bytes[1]) != 1)
		return false;
	/* A router's own address of the cable it stands at does always. */
	if (family == AF_INET6 && bytes[1][0] == 0xfe && bytes[1][1] == 0x80)
		return true;
	for (uint32_t i = 0; i < bits; i++)
		if ((bytes[0][i / 8] ^ bytes[1][i / 8]) >> (7 - i % 8) & 1)
			return false;
	return true;
}

/* What is wrong between right lines. A line that was refused has been complained of already. */
static void check_together(const struct terminal *t, const unsigned *lines, struct faults *faults)
{
	if (lines[AT_TRUST] && !lines[AT_URL])
		faults_add(faults, 0,
			   "under [release] the line url = ... is missing; say where the release "
			   "is, such as https://museum.example/temple/");
	if (lines[AT_URL] && !lines[AT_TRUST])
		faults_add(faults, 0,
			   "under [release] the line trust = ... is missing; copy the release's "
			   "root/1.json beside this file and write trust = 1.json");
	if (t->gateway[0] && !lines[AT_ADDRESS])
		faults_add(faults, lines[AT_GATEWAY],
			   "gateway is of use only beside address = 192.168.1.20/24 or the like; "
			   "write the address too, or take gateway out");
	else if (t->gateway[0] && t->is_static &&
		 !in_one_network(t->address, t->gateway, t->prefix_bits))
		faults_add(faults, lines[AT_GATEWAY],
			   "gateway %s cannot be reached from %s/%u; one of the two has a slip",
			   t->gateway, t->address, t->prefix_bits);
	if (lines[AT_PASSPHRASE] && !lines[AT_SSID])
		faults_add(faults, lines[AT_PASSPHRASE],
			   "passphrase stands without ssid; write the network's name too");
	if (lines[AT_SSID] && !lines[AT_COUNTRY])
		faults_add(faults, lines[AT_SSID],
			   "with ssid the line country = ... is needed: the radio must keep that "
			   "country's rules");
}

static void parse(struct terminal *out, struct bytes text, unsigned *lines, struct faults *faults)
{
	_Static_assert(ARRAY_COUNT(settings) <= SETTINGS_MOST, "each has a line");
	*out = terminal_default;
	settings_read(text, settings, ARRAY_COUNT(settings), out, lines, faults);
	check_together(out, lines, faults);
}

void terminal_parse(struct terminal *out, struct bytes text, struct faults *faults)
{
	unsigned lines[ARRAY_COUNT(settings)];

	parse(out, text, lines, faults);
}

/* A file that is named and not there is as good as not named. */
static void look_beside(const char *path, char *name, unsigned line, struct faults *faults)
{
	const char *slash = strrchr(path, '/');
	char beside[PATH_MAX];

	snprintf(beside, sizeof(beside), "%.*s%s", slash ? (int)(slash - path) + 1 : 0, path, name);
	if (!*name || access(beside, R_OK) == 0)
		return;
	faults_add(faults, line, "there is no file %s beside %s; copy it there", name,
		   slash ? slash + 1 : path);
	*name = '\0';
}

/* "generic, weak-arm" */
static void list_profiles(const char *boards, char *out, size_t bytes)
{
	struct dirent **entries = NULL;
	int count = scandir(boards, &entries, NULL, alphasort);

	out[0] = '\0';
	for (int i = 0; i < count; i++) {
		const char *name = entries[i]->d_name, *dot = strrchr(name, '.');
		const size_t length = strlen(out);

		if (dot && strcmp(dot, ".ini") == 0)
			snprintf(out + length, bytes - length, "%s%.*s", length ? ", " : "",
				 (int)(dot - name), name);
		free(entries[i]);
	}
	free(entries);
}

static void look_for_profile(const char *boards, char *name, unsigned line, struct faults *faults)
{
	char path[PATH_MAX], known[160];

	snprintf(path, sizeof(path), "%s/%s.ini", boards, name);
	if (!*name || access(path, R_OK) == 0)
		return;
	list_profiles(boards, known, sizeof(known));
	if (known[0])
		faults_add(faults, line, "there is no board profile '%s'; there are %s", name,
			   known);
	else
		faults_add(faults, line, "there is no board profile '%s', nor any other in %s",
			   name, boards);
	*name = '\0';
}

int terminal_read(struct terminal *out, const char *path, const char *boards, struct faults *faults)
{
	unsigned lines[ARRAY_COUNT(settings)];
	struct buffer file;
	int rc;

	*out = terminal_default;
	buffer_init(&file, SETTINGS_FILE_MOST);
	rc = buffer_read_file(&file, path);
	if (rc == 0) {
		parse(out, buffer_bytes(&file), lines, faults);
		look_beside(path, out->trust, lines[AT_TRUST], faults);
		look_beside(path, out->ca, lines[AT_CA], faults);
		if (boards)
			look_for_profile(boards, out->board, lines[AT_BOARD], faults);
	} else if (rc != -ENOENT) {
		faults_add(faults, 0, "the file cannot be read: %s", strerror(-rc));
	}
	buffer_finish(&file);
	return rc == -ENOENT ? rc : 0;
}

void terminal_host_name(const struct terminal *terminal, char out[TERMINAL_NAME_BYTES])
{
	size_t length = 0;

	for (const char *c = terminal->name; *c; c++) {
		const bool plain = isalnum((unsigned char)*c) && (unsigned char)*c < 0x80;

		if (plain)
			out[length++] = (char)tolower((unsigned char)*c);
		else if (length > 0 && out[length - 1] != '-')
			out[length++] = '-';
	}
	while (length > 0 && out[length - 1] == '-')
		length--;
	out[length] = '\0';
	if (length == 0)
		snprintf(out, TERMINAL_NAME_BYTES, "gopura");
}
