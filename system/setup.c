/* Translates gopura.conf into one file for each program or unit that needs part of it. */
#include "system/setup.h"

#include <arpa/inet.h>
#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/bytes.h"
#include "base/log.h"
#include "base/safe_open.h"
#include "base/transient.h"
#include "system/terminal_values.h"

enum { FILE_MAX = 65536, WIRED_METRIC = 100, WIFI_METRIC = 600 };

/* ---- files: the first failure is kept; what comes later neither writes nor deletes anything */

struct writing {
	const struct setup *setup;
	struct buffer text;
	int rc;
	bool again; /* a file beside gopura.conf could not be read, which may pass */
};

static void path_of(const struct writing *writing, const char *name, char out[PATH_MAX])
{
	snprintf(out, PATH_MAX, "%s/%s", writing->setup->out, name);
}

static void failed(struct writing *writing, const char *path, int rc)
{
	if (writing->rc < 0)
		return;
	log_error("setup", "%s: %s", path, strerror(-rc));
	writing->rc = rc;
}

static void folder(struct writing *writing, const char *name, mode_t mode)
{
	char path[PATH_MAX];

	path_of(writing, name, path);
	if (writing->rc == 0 && mkdir(path, mode) < 0 && errno != EEXIST)
		failed(writing, path, -errno);
}

/* Writes the text collected since the last file. */
static void finish_file(struct writing *writing, const char *name)
{
	char path[PATH_MAX];
	int rc = writing->text.error;

	path_of(writing, name, path);
	if (writing->rc == 0 && rc == 0)
		rc = bytes_write_file(buffer_bytes(&writing->text), path);
	if (rc < 0)
		failed(writing, path, rc);
	buffer_clear(&writing->text);
}

/* Deletes a file that an earlier gopura.conf produced. */
static void remove_file(struct writing *writing, const char *name)
{
	char path[PATH_MAX];

	path_of(writing, name, path);
	if (writing->rc == 0)
		unlink(path);
}

static void empty_folder(struct writing *writing, const char *name)
{
	char path[PATH_MAX];
	struct dirent *entry;
	DIR *files;

	if (writing->rc < 0)
		return;
	path_of(writing, name, path);
	files = opendir(path);
	while (files && (entry = readdir(files)))
		if (entry->d_name[0] != '.')
			unlinkat(dirfd(files), entry->d_name, 0);
	if (files)
		closedir(files);
}

/* ---- options of the programs */

/* Returns whether the text may be written to a systemd file as one word without escapes. */
static bool is_plain_word(const char *text)
{
	static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
				    "0123456789-_./+,:=@";

	return text[strspn(text, plain)] == '\0';
}

/* Copies the certificate authority named in gopura.conf, because the stick it came from may be
 * removed. Writes its absolute path, which does not depend on a unit's working folder, to out.
 * Returns false if there is none. */
static bool copy_authority(struct writing *writing, char out[PATH_MAX])
{
	const struct setup *setup = writing->setup;
	struct buffer file;
	char path[PATH_MAX];
	int rc;

	folder(writing, "conf", 0755);
	path_of(writing, "conf/ca.pem", path);
	if (!setup->terminal->ca[0] || !setup->conf_path) {
		remove_file(writing, "conf/ca.pem");
		return false;
	}
	buffer_init(&file, TERMINAL_FILE_BYTES_MAX);
	rc = terminal_read_beside(&file, setup->conf_path, setup->terminal->ca);
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&file), path);
	buffer_finish(&file);
	if (rc == 0 && !realpath(path, out))
		rc = -errno;
	/* The rest of the set-up continues. Without the file the fetcher trusts the system's
	 * authorities. */
	writing->again |= is_transient(rc);
	if (rc < 0)
		log_error("setup", "%s: %s", setup->terminal->ca, open_problem(rc));
	else if (!is_plain_word(out))
		log_error(
			"setup",
			"%s: choose an --out folder without spaces and special characters in its name",
			out);
	return rc == 0 && is_plain_word(out);
}

/* Addresses that the fetcher's unit denies: loopback and link-local ones. */
static bool is_denied(const char *host)
{
	struct in6_addr v6;
	struct in_addr v4;

	if (inet_pton(AF_INET, host, &v4) == 1)
		return ntohl(v4.s_addr) >> 24 == 127 || ntohl(v4.s_addr) >> 16 == 0xa9fe;
	return inet_pton(AF_INET6, host, &v6) == 1 &&
	       (IN6_IS_ADDR_LOOPBACK(&v6) || IN6_IS_ADDR_LINKLOCAL(&v6));
}

/* Allows a museum server that gopura.conf names by such an address. */
static void write_fetch_address(struct writing *writing)
{
	const char *host = strstr(writing->setup->terminal->release_url, "://");
	char address[INET6_ADDRSTRLEN] = "";

	if (host) {
		host += 3;
		host += *host == '[';
		snprintf(address, sizeof(address), "%.*s",
			 (int)strcspn(host, host[-1] == '[' ? "]%" : ":/"), host);
	}
	if (is_denied(address))
		buffer_print(&writing->text, "%s\n", address);
	finish_file(writing, "fetch-address");
}

static void write_fetcher(struct writing *writing)
{
	const struct terminal *t = writing->setup->terminal;
	char authority[PATH_MAX];
	const bool has_authority = copy_authority(writing, authority);

	/* A release on the stick is read by the fetcher's stick thread, not treated as a server. */
	if (t->release_url[0] && !terminal_url_is_of_stick(t->release_url))
		buffer_print(&writing->text, "RELEASE_URL=\"%s\"\n", t->release_url);
	buffer_print(&writing->text, "FETCH_OPTIONS=\"");
	if (writing->setup->cache_mib > 0)
		buffer_print(&writing->text, " --cache-budget %u", writing->setup->cache_mib);
	if (t->poll_s > 0)
		buffer_print(&writing->text, " --poll-s %u", t->poll_s);
	if (t->rate_limit_kib > 0)
		buffer_print(&writing->text, " --rate-limit %u", t->rate_limit_kib);
	if (t->wait_ms > 0)
		buffer_print(&writing->text, " --wait-ms %u", t->wait_ms);
	if (t->redirect_hosts[0])
		buffer_print(&writing->text, " --redirect-hosts %s", t->redirect_hosts);
	if (has_authority)
		buffer_print(&writing->text, " --ca %s", authority);
	buffer_print(&writing->text, "\"\n");
	finish_file(writing, "fetch.env");
	write_fetch_address(writing);
}

static void write_health(struct writing *writing)
{
	const struct terminal *t = writing->setup->terminal;
	const bool brackets = strchr(t->listen_address, ':');

	buffer_print(&writing->text, "%s%s%s:%u\n", brackets ? "[" : "", t->listen_address,
		     brackets ? "]" : "", t->listen_port);
	finish_file(writing, "health-address");
}

/* The service that systemd-resolved announces to clients that search for web pages (DNS-SD). */
static void write_announcement(struct writing *writing)
{
	const struct terminal *t = writing->setup->terminal;

	folder(writing, "dnssd", 0755);
	empty_folder(writing, "dnssd");
	if (!t->mdns)
		return;
	buffer_print(&writing->text,
		     "[Service]\nName=%%H\nType=_http._tcp\nPort=%u\nTxtText=path=/\n",
		     t->listen_port);
	finish_file(writing, "dnssd/gopura-health.dnssd");
}

/* ---- networks */

static void put_servers(struct writing *writing, const char *name,
			const struct terminal_servers *servers)
{
	for (uint32_t i = 0; i < servers->count; i++)
		buffer_print(&writing->text, "%s=%s\n", name, servers->names[i]);
}

/* Servers named in gopura.conf replace those that the network offers. */
static void put_uses(struct writing *writing, const char *section, bool has_ntp)
{
	const struct terminal *t = writing->setup->terminal;

	buffer_print(&writing->text, "\n[%s]\n", section);
	if (t->dns.count > 0)
		buffer_print(&writing->text, "UseDNS=no\n");
	if (t->ntp.count > 0 && has_ntp)
		buffer_print(&writing->text, "UseNTP=no\n");
}

/* To a DHCP server a terminal is its card. networkd would send the machine's id, which is that of
 * another terminal on a copied disk, and a new one wherever the data partition is created anew. */
static void write_network(struct writing *writing, const char *file, const char *type, int metric,
			  bool is_static)
{
	const struct terminal *t = writing->setup->terminal;
	char host[TERMINAL_NAME_BYTES];

	terminal_host_name(t, host);
	/* udev sets this property (70-gopura-usb.rules) for network cards on the board and for
	 * those allowed under [usb]. */
	buffer_print(
		&writing->text,
		"[Match]\nType=%s\nProperty=GOPURA_NETWORK=yes\n\n[Link]\nRequiredForOnline=no\n\n"
		"[Network]\n",
		type);
	if (t->mdns)
		buffer_print(&writing->text, "MulticastDNS=yes\n");
	if (!is_static)
		buffer_print(&writing->text, "DHCP=yes\n");
	else
		buffer_print(&writing->text, "DHCP=no\nAddress=%s/%u\n", t->address,
			     t->prefix_bits);
	put_servers(writing, "DNS", &t->dns);
	put_servers(writing, "NTP", &t->ntp);
	if (is_static && t->gateway[0])
		buffer_print(&writing->text, "\n[Route]\nGateway=%s\nMetric=%d\n", t->gateway,
			     metric);
	if (!is_static) {
		put_uses(writing, "DHCPv4", true);
		buffer_print(&writing->text,
			     "ClientIdentifier=mac\nRouteMetric=%d\nUseHostname=no\n"
			     "SendHostname=yes\nHostname=%s\n",
			     metric, host);
		put_uses(writing, "DHCPv6", true);
		buffer_print(&writing->text, "DUIDType=link-layer\n");
		put_uses(writing, "IPv6AcceptRA", false);
		buffer_print(&writing->text, "RouteMetric=%d\n", metric);
	}
	finish_file(writing, file);
}

void setup_wifi_name(const struct terminal *terminal, char out[SETUP_WIFI_NAME_BYTES])
{
	static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
				    "0123456789-_ ";
	const char *kind = terminal->passphrase[0] ? "psk" : "open";
	const char *ssid = terminal->ssid;
	size_t length = 1;

	if (ssid[strspn(ssid, plain)] == '\0') {
		snprintf(out, SETUP_WIFI_NAME_BYTES, "%s.%s", ssid, kind);
		return;
	}
	out[0] = '=';
	for (; *ssid; ssid++, length += 2)
		snprintf(out + length, SETUP_WIFI_NAME_BYTES - length, "%02x",
			 (unsigned char)*ssid);
	snprintf(out + length, SETUP_WIFI_NAME_BYTES - length, ".%s", kind);
}

/* iwd's text values escape every backslash, and a space at the beginning. */
static void put_escaped(struct writing *writing, const char *text)
{
	if (*text == ' ') {
		buffer_print(&writing->text, "\\s");
		text++;
	}
	for (; *text; text++)
		buffer_print(&writing->text, "%s%c", *text == '\\' ? "\\" : "", *text);
}

static void write_wifi(struct writing *writing)
{
	const struct terminal *t = writing->setup->terminal;
	char name[SETUP_WIFI_NAME_BYTES], path[sizeof("iwd/") + SETUP_WIFI_NAME_BYTES];

	folder(writing, "iwd", 0700); /* only root may read passphrases */
	empty_folder(writing, "iwd");
	if (!t->ssid[0]) {
		remove_file(writing, "network/20-wifi.network");
		return;
	}
	if (strlen(t->passphrase) == 64) {
		buffer_print(&writing->text, "[Security]\nPreSharedKey=%s\n", t->passphrase);
	} else if (t->passphrase[0]) {
		buffer_print(&writing->text, "[Security]\nPassphrase=");
		put_escaped(writing, t->passphrase);
		buffer_print(&writing->text, "\n");
	} else {
		buffer_print(&writing->text, "[Settings]\nAutoConnect=true\n");
	}
	setup_wifi_name(t, name);
	snprintf(path, sizeof(path), "iwd/%s", name);
	finish_file(writing, path);
	if (t->country[0]) {
		buffer_print(&writing->text, "[General]\nCountry=%s\n", t->country);
		finish_file(writing, "iwd/main.conf");
	}
	write_network(writing, "network/20-wifi.network", "wlan", WIFI_METRIC, t->is_static);
}

/* If there is Wi-Fi, it gets the static address: with the same address on two cards neither would
 * work. */
static void write_networks(struct writing *writing)
{
	const struct terminal *t = writing->setup->terminal;

	folder(writing, "network", 0755);
	write_network(writing, "network/10-wired.network", "ether", WIRED_METRIC,
		      t->is_static && !t->ssid[0]);
	write_wifi(writing);
}

/* ---- USB */

/* For gopura-usb, which decides about plugged-in devices. Empty: only storage and touch. */
static void write_usb(struct writing *writing)
{
	char words[TERMINAL_USB_WORDS_BYTES];

	terminal_usb_words(writing->setup->terminal, words);
	if (words[0])
		buffer_print(&writing->text, "%s\n", words);
	finish_file(writing, "usb");
}

/* ---- the system */

static void write_time_zone(struct writing *writing)
{
	const char *zone = writing->setup->terminal->time_zone;
	char path[PATH_MAX], temporary[PATH_MAX + 8], target[PATH_MAX];

	snprintf(target, sizeof(target), "/usr/share/zoneinfo/%s", zone[0] ? zone : "Etc/UTC");
	path_of(writing, "localtime", path);
	snprintf(temporary, sizeof(temporary), "%s.new", path);
	unlink(temporary);
	if (writing->rc == 0 && (symlink(target, temporary) < 0 || rename(temporary, path) < 0))
		failed(writing, path, -errno);
}

static void write_host_name(struct writing *writing)
{
	char host[TERMINAL_NAME_BYTES];

	terminal_host_name(writing->setup->terminal, host);
	buffer_print(&writing->text, "%s\n", host);
	finish_file(writing, "hostname");
}

static void write_faults(struct writing *writing)
{
	const struct diagnostics *diagnostics = writing->setup->diagnostics;

	for (unsigned i = 0; i < diagnostics->count; i++)
		buffer_print(&writing->text, "%s\n", diagnostics_get(diagnostics, i)->text);
	if (diagnostics->dropped > 0)
		buffer_print(&writing->text, "and %u more\n", diagnostics->dropped);
	finish_file(writing, "faults");
}

int setup_write(const struct setup *setup)
{
	struct writing writing = { .setup = setup };

	buffer_init(&writing.text, FILE_MAX);
	folder(&writing, "", 0755);
	/* first, so that the faults are reported even if a later file fails */
	write_faults(&writing);
	write_fetcher(&writing);
	write_health(&writing);
	write_announcement(&writing);
	write_networks(&writing);
	write_usb(&writing);
	write_time_zone(&writing);
	write_host_name(&writing);
	buffer_finish(&writing.text);
	return writing.rc == 0 && writing.again ? -EAGAIN : writing.rc;
}
