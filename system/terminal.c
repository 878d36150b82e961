/* Reads gopura.conf: holds the table of its settings, checks them against each other, and looks for
 * the files they name. */
#include "system/terminal.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <sodium.h>

#include "base/safe_open.h"
#include "base/transient.h"
#include "system/terminal_values.h"

const struct terminal terminal_default = {
	.rotation_deg = -1,
	.hours = { .open = { [0 ... HOURS_MINUTES / 8 - 1] = 0xff } },
	.wake_min = 5,
	.idle_s = 60,
	.shift = true,
	.listen_address = "127.0.0.1",
	.listen_port = 9100,
};

/* ---- the table */

enum {
	AT_BOARD = 3,
	AT_URL,
	AT_TRUST,
	AT_CA,
	AT_ADDRESS = 16,
	AT_GATEWAY,
	AT_SSID = 21,
	AT_PASSPHRASE,
	AT_COUNTRY,
	AT_MDNS = 25,
};

static const struct setting settings[] = {
	{ .section = "terminal",
	  .name = "name",
	  .expects = "a name of up to 63 bytes without control characters, such as East gate",
	  .set = terminal_set_name,
	  .free_text = true },
	{ .section = "terminal",
	  .name = "language",
	  .expects = "the code of a language, such as km, en or pt-BR",
	  .set = terminal_set_language },
	{ .section = "terminal",
	  .name = "time_zone",
	  .expects = "a time zone such as Asia/Phnom_Penh or Europe/Berlin",
	  .set = terminal_set_time_zone },
	[AT_BOARD] = { .section = "terminal",
		       .name = "board",
		       .expects = "the name of a board's profile, such as generic",
		       .set = terminal_set_board },
	[AT_URL] = { .section = "release",
		     .name = "url",
		     .expects = "an address such as https://museum.example/temple/, or a folder "
				"such as /media/release; on a stick /run/gopura-stick/release",
		     .set = terminal_set_url },
	[AT_TRUST] = { .section = "release",
		       .name = "trust",
		       .expects = "the name of a file beside this one, without folders or spaces, "
				  "such as 1.json",
		       .set = terminal_set_file,
		       .offset = offsetof(struct terminal, trust) },
	[AT_CA] = { .section = "release",
		    .name = "ca",
		    .expects = "the name of a file beside this one, without folders or spaces, "
			       "such as ca.pem",
		    .set = terminal_set_file,
		    .offset = offsetof(struct terminal, ca) },
	{ .section = "release",
	  .name = "target",
	  .expects = "the path of a target of The Update Framework, such as angkor/release.json",
	  .set = terminal_set_target },
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
	  .set = terminal_set_download },
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
	  .set = terminal_set_mode },
	{ .section = "panel",
	  .name = "rotation",
	  .expects = "0, 90, 180 or 270",
	  .set = terminal_set_rotation,
	  .offset = offsetof(struct terminal, rotation_deg),
	  .least = 0,
	  .most = 270 },
	{ .section = "panel",
	  .name = "hours",
	  .expects = "days and times such as Mo-Fr 09:00-18:00, Sa 10:00-17:00",
	  .set = terminal_set_hours },
	{ .section = "panel",
	  .name = "wake_min",
	  .expects = "whole minutes from 0 to 1440",
	  .set = settings_whole,
	  .offset = offsetof(struct terminal, wake_min),
	  .least = 0,
	  .most = 1440 },
	{ .section = "panel",
	  .name = "shift",
	  .expects = "yes or no",
	  .set = settings_yes_no,
	  .offset = offsetof(struct terminal, shift) },
	[AT_ADDRESS] = { .section = "network",
			 .name = "address",
			 .expects = "dhcp, or an address with its prefix length such as "
				    "192.168.1.20/24",
			 .set = terminal_set_address },
	[AT_GATEWAY] = { .section = "network",
			 .name = "gateway",
			 .expects = "an address such as 192.168.1.1",
			 .set = terminal_set_gateway },
	{ .section = "network",
	  .name = "dns",
	  .expects = "up to 4 addresses such as 192.168.1.1, 9.9.9.9",
	  .set = terminal_set_dns },
	{ .section = "network",
	  .name = "ntp",
	  .expects = "up to 4 time servers such as 192.168.1.1, pool.ntp.org",
	  .set = terminal_set_ntp },
	{ .section = "network",
	  .name = "wait_ms",
	  .expects = "whole milliseconds from 50 to 60000",
	  .set = settings_whole,
	  .offset = offsetof(struct terminal, wait_ms),
	  .least = 50,
	  .most = 60000 },
	[AT_SSID] = { .section = "wifi",
		      .name = "ssid",
		      .expects = "a network's name of 1 to 32 bytes without control characters",
		      .set = terminal_set_ssid,
		      .free_text = true },
	[AT_PASSPHRASE] = { .section = "wifi",
			    .name = "passphrase",
			    .expects = "8 to 63 ASCII letters, digits and signs, or 64 "
				       "hexadecimal digits",
			    .set = terminal_set_passphrase,
			    .free_text = true,
			    .secret = true },
	[AT_COUNTRY] = { .section = "wifi",
			 .name = "country",
			 .expects = "the two letters of a country such as KH or GB",
			 .set = terminal_set_country },
	{ .section = "health",
	  .name = "listen",
	  .expects = "an address and a port such as 127.0.0.1:9100 or [::1]:9100",
	  .set = terminal_set_listen },
	[AT_MDNS] = { .section = "health",
		      .name = "mdns",
		      .expects = "yes or no",
		      .set = settings_yes_no,
		      .offset = offsetof(struct terminal, mdns) },
	{ .section = "visit",
	  .name = "idle_s",
	  .expects = "whole seconds from 5 to 3600",
	  .set = settings_whole,
	  .offset = offsetof(struct terminal, idle_s),
	  .least = 5,
	  .most = 3600 },
	{ .section = "visit",
	  .name = "loudness",
	  .expects = "a whole number from 0 (no sound) to 100",
	  .set = settings_whole,
	  .offset = offsetof(struct terminal, loudness),
	  .least = 0,
	  .most = 100 },
	{ .section = "release",
	  .name = "redirect_hosts",
	  .expects = "up to 4 hosts such as cdn.example, cdn2.example:8443",
	  .set = terminal_set_redirect_hosts },
	{ .section = "usb",
	  .name = "allow",
	  .expects = "keyboard, network, wifi or panel, or several of them (storage and touch "
		     "always work)",
	  .set = terminal_set_usb },
};

/* ---- checks across settings */

static bool in_one_network(const char *a, const char *b, uint32_t bits)
{
	uint8_t bytes[2][16];
	const int family = strchr(a, ':') ? AF_INET6 : AF_INET;

	if (inet_pton(family, a, bytes[0]) != 1 || inet_pton(family, b, bytes[1]) != 1)
		return false;
	/* A router's link-local address is always reachable on its own cable. */
	if (family == AF_INET6 && bytes[1][0] == 0xfe && bytes[1][1] == 0x80)
		return true;
	for (uint32_t i = 0; i < bits; i++)
		if ((bytes[0][i / 8] ^ bytes[1][i / 8]) >> (7 - i % 8) & 1)
			return false;
	return true;
}

static bool is_loopback(const char *address)
{
	return strncmp(address, "127.", 4) == 0 || strcmp(address, "::1") == 0;
}

/* Reports contradictions between valid lines. Invalid lines have been reported already. */
static void check_together(const struct terminal *t, const unsigned *lines,
			   struct diagnostics *diagnostics)
{
	if (lines[AT_TRUST] && !lines[AT_URL])
		diagnostics_add(
			diagnostics, -EINVAL, NULL, 0,
			"section [release] has no url; add the address of the release, such as "
			"url = https://museum.example/temple/");
	if (lines[AT_URL] && !lines[AT_TRUST])
		diagnostics_add(
			diagnostics, -EINVAL, NULL, 0,
			"section [release] has no trust; copy the release's root/1.json beside "
			"this file and add trust = 1.json");
	if (t->gateway[0] && (!lines[AT_ADDRESS] || t->is_dhcp))
		diagnostics_add(diagnostics, -EINVAL, NULL, lines[AT_GATEWAY],
				"gateway needs a static address; add one, such as address = "
				"192.168.1.20/24, or remove gateway");
	else if (t->gateway[0] && t->is_static &&
		 !in_one_network(t->address, t->gateway, t->prefix_bits))
		diagnostics_add(diagnostics, -EINVAL, NULL, lines[AT_GATEWAY],
				"gateway %s is not in the network of %s/%u; correct one of the two",
				t->gateway, t->address, t->prefix_bits);
	if (lines[AT_PASSPHRASE] && !lines[AT_SSID])
		diagnostics_add(diagnostics, -EINVAL, NULL, lines[AT_PASSPHRASE],
				"passphrase needs ssid; add the name of the network");
	if (lines[AT_SSID] && !lines[AT_COUNTRY])
		diagnostics_add(
			diagnostics, -EINVAL, NULL, lines[AT_SSID],
			"ssid needs country, because the radio must keep that country's rules; "
			"add it, such as country = KH");
	if (t->mdns && is_loopback(t->listen_address))
		diagnostics_add(
			diagnostics, -EINVAL, NULL, lines[AT_MDNS],
			"mdns announces the health page, but the page listens to the terminal "
			"alone; add listen = 0.0.0.0:9100 or the terminal's own address, or "
			"remove mdns");
}

static void parse(struct terminal *out, struct bytes text, unsigned *lines,
		  struct diagnostics *diagnostics)
{
	_Static_assert(ARRAY_COUNT(settings) <= SETTINGS_MAX, "each has a line");
	*out = terminal_default;
	settings_read(text, settings, ARRAY_COUNT(settings), out, lines, diagnostics);
	check_together(out, lines, diagnostics);
	diagnostics_sort(diagnostics);
}

void terminal_parse(struct terminal *out, struct bytes text, struct diagnostics *diagnostics)
{
	unsigned lines[ARRAY_COUNT(settings)];

	parse(out, text, lines, diagnostics);
}

int terminal_read_beside(struct buffer *out, const char *path, const char *name)
{
	const char *slash = strrchr(path, '/');
	char folder[PATH_MAX];

	if (slash && slash - path + 1 >= PATH_MAX)
		return -ENAMETOOLONG;
	snprintf(folder, sizeof(folder), "%.*s", slash ? (int)(slash - path) + 1 : 0, path);
	return buffer_read_beneath(out, folder, name);
}

/* Checks that a named file can be read. If not, reports it and clears the name. */
static void look_beside(const char *path, char *name, unsigned line,
			struct diagnostics *diagnostics)
{
	const char *slash = strrchr(path, '/'), *conf = slash ? slash + 1 : path;
	struct buffer file;
	int rc;

	if (!*name)
		return;
	buffer_init(&file, TERMINAL_FILE_BYTES_MAX);
	rc = terminal_read_beside(&file, path, name);
	buffer_finish(&file);
	if (rc == 0)
		return;
	if (rc == -ENOENT)
		diagnostics_add(diagnostics, -EINVAL, NULL, line,
				"there is no file %s beside %s; copy it there", name, conf);
	else
		diagnostics_add(diagnostics, rc, NULL, line, "%s beside %s cannot be read: %s",
				name, conf, open_problem(rc));
	*name = '\0';
}

/* Writes the names of all profiles as "generic, weak-arm". */
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

static void look_for_profile(const char *boards, char *name, unsigned line,
			     struct diagnostics *diagnostics)
{
	char path[PATH_MAX], known[160];

	snprintf(path, sizeof(path), "%s/%s.ini", boards, name);
	/* One that cannot be looked up now may be there. */
	if (!*name || access(path, R_OK) == 0 || is_transient(-errno))
		return;
	list_profiles(boards, known, sizeof(known));
	if (known[0])
		diagnostics_add(diagnostics, -EINVAL, NULL, line,
				"there is no board profile '%s'; the profiles are %s", name, known);
	else
		diagnostics_add(diagnostics, -EINVAL, NULL, line,
				"there is no board profile '%s', and no other one in %s", name,
				boards);
	*name = '\0';
}

int terminal_read(struct terminal *out, const char *path, const char *boards,
		  struct diagnostics *diagnostics)
{
	unsigned lines[ARRAY_COUNT(settings)];
	struct buffer file;
	int rc;

	*out = terminal_default;
	buffer_init(&file, SETTINGS_FILE_MAX);
	rc = buffer_read_foreign(&file, path);
	if (rc == 0) {
		parse(out, buffer_bytes(&file), lines, diagnostics);
		look_beside(path, out->trust, lines[AT_TRUST], diagnostics);
		look_beside(path, out->ca, lines[AT_CA], diagnostics);
		if (boards)
			look_for_profile(boards, out->board, lines[AT_BOARD], diagnostics);
		diagnostics_sort(diagnostics);
	} else if (rc != -ENOENT) {
		diagnostics_add(diagnostics, rc, NULL, 0, "the file cannot be read: %s",
				open_problem(rc));
	}
	buffer_finish(&file);
	return rc == -ENOENT ? rc : 0;
}

/* Hashes a file with its length in front, so that moving bytes from one file to the next changes
 * the checksum. */
static void sum_file(crypto_generichash_state *sum, const struct buffer *file)
{
	uint8_t length[8];

	for (size_t i = 0; i < sizeof(length); i++)
		length[i] = (uint8_t)((uint64_t)file->size >> 8 * i);
	crypto_generichash_update(sum, length, sizeof(length));
	crypto_generichash_update(sum, file->data, file->size);
}

int terminal_sum(const char *path, char out[TERMINAL_SUM_BYTES])
{
	struct terminal terminal;
	struct diagnostics ignored = { 0 };
	const char *const names[] = { terminal.trust, terminal.ca };
	uint8_t digest[(TERMINAL_SUM_BYTES - 1) / 2];
	crypto_generichash_state sum;
	struct buffer file;
	int rc;

	crypto_generichash_init(&sum, NULL, 0, sizeof(digest));
	buffer_init(&file, TERMINAL_FILE_BYTES_MAX);
	rc = buffer_read_foreign(&file, path);
	if (rc == 0) {
		sum_file(&sum, &file);
		terminal_parse(&terminal, buffer_bytes(&file), &ignored);
		for (size_t i = 0; i < ARRAY_COUNT(names) && rc == 0; i++) {
			const int read =
				*names[i] ? terminal_read_beside(&file, path, names[i]) : -ENOENT;

			if (read < 0)
				buffer_clear(&file);
			if (is_transient(read))
				rc = read;
			sum_file(&sum, &file);
		}
		crypto_generichash_final(&sum, digest, sizeof(digest));
		sodium_bin2hex(out, TERMINAL_SUM_BYTES, digest, sizeof(digest));
	}
	buffer_finish(&file);
	return rc;
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
