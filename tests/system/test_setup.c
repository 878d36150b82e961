#include "system/setup.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "board/profile.h"
#include "tests/check.h"

#define RELEASE "[release]\nurl = https://museum.example/temple/\ntrust = 1.json\n"

static char out[] = "/tmp/gopura-setup-XXXXXX";
static char read_text[16384];

static void path_of(const char *name, char path[256])
{
	snprintf(path, 256, "%s/%s", out, name);
}

static bool is_there(const char *name)
{
	char path[256];

	path_of(name, path);
	return access(path, F_OK) == 0;
}

static const char *text_of(const char *name)
{
	struct buffer file;
	char path[256];

	path_of(name, path);
	buffer_init(&file, sizeof(read_text) - 1);
	if (buffer_read_file(&file, path) < 0)
		fail_msg("there is no %s", name);
	if (file.size)
		memcpy(read_text, file.data, file.size);
	read_text[file.size] = '\0';
	buffer_finish(&file);
	return read_text;
}

static void has(const char *name, const char *text)
{
	if (!strstr(text_of(name), text))
		fail_msg("%s has no\n%s\nbut\n%s", name, text, read_text);
}

static void has_not(const char *name, const char *text)
{
	if (strstr(text_of(name), text))
		fail_msg("%s has\n%s", name, text);
}

static char conf_path[256]; /* in folder/, with a ca.pem beside it */

static void apply(const char *conf)
{
	static struct terminal terminal;
	static struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	const struct setup setup = { .terminal = &terminal,
				     .diagnostics = &diagnostics,
				     .conf_path = conf_path,
				     .out = out };

	diagnostics_finish(&diagnostics);
	terminal_parse(&terminal, (struct bytes){ (const uint8_t *)conf, strlen(conf) },
		       &diagnostics);
	CHECK(setup_write(&setup) == 0);
}

static void without_a_word_the_cable_is_asked(void **state)
{
	char link[256], target[256] = "";

	(void)state;
	apply(RELEASE);
	has("network/10-wired.network", "[Match]\nType=ether\nProperty=GOPURA_NETWORK=yes\n\n");
	has("network/10-wired.network", "[Network]\nDHCP=yes\n");
	has_not("network/10-wired.network", "UseDNS");
	CHECK(!is_there("network/20-wifi.network") && !is_there("iwd/main.conf"));
	CHECK(strcmp(text_of("fetch.env"), "RELEASE_URL=\"https://museum.example/temple/\"\n"
					   "FETCH_OPTIONS=\"\"\n") == 0);
	CHECK(strcmp(text_of("health-address"), "127.0.0.1:9100\n") == 0);
	CHECK(strcmp(text_of("hostname"), "gopura\n") == 0);
	CHECK(strcmp(text_of("faults"), "") == 0);
	path_of("localtime", link);
	CHECK(readlink(link, target, sizeof(target) - 1) > 0);
	CHECK(strcmp(target, "/usr/share/zoneinfo/Etc/UTC") == 0);
}

static void an_address_of_its_own_has_its_gateway_and_servers(void **state)
{
	(void)state;
	apply(RELEASE "[network]\naddress = 192.168.1.20/24\ngateway = 192.168.1.1\n"
		      "dns = 192.168.1.1 9.9.9.9\nntp = pool.ntp.org\n");
	has("network/10-wired.network", "DHCP=no\nAddress=192.168.1.20/24\n");
	has("network/10-wired.network", "DNS=192.168.1.1\nDNS=9.9.9.9\nNTP=pool.ntp.org\n");
	has("network/10-wired.network", "[Route]\nGateway=192.168.1.1\n");
	apply(RELEASE "[network]\ndns = 9.9.9.9\n");
	has("network/10-wired.network", "DHCP=yes\nDNS=9.9.9.9\n");
	has("network/10-wired.network", "[DHCPv4]\nUseDNS=no\n");
	has_not("network/10-wired.network", "UseNTP");
}

/* The machine's id is that of another terminal where a disk was copied. */
static void a_dhcp_server_knows_a_terminal_by_its_card(void **state)
{
	(void)state;
	apply(RELEASE "[wifi]\nssid = Museum\ncountry = KH\n");
	has("network/10-wired.network", "[DHCPv4]\nClientIdentifier=mac\n");
	has("network/10-wired.network", "[DHCPv6]\nDUIDType=link-layer\n");
	has("network/20-wifi.network", "[DHCPv4]\nClientIdentifier=mac\n");
	has("network/20-wifi.network", "[DHCPv6]\nDUIDType=link-layer\n");
}

static void the_fetcher_is_told_what_is_its(void **state)
{
	char options[256];

	(void)state;
	apply(RELEASE
	      "ca = ca.pem\npoll_s = 300\nrate_limit_kib = 2000\n"
	      "redirect_hosts = cdn.example cdn2.example:8443\n[terminal]\n"
	      "name = East gate\ntime_zone = Asia/Phnom_Penh\n[health]\nlisten = [::]:9200\n"
	      "[network]\nwait_ms = 300\n");
	snprintf(options, sizeof(options),
		 "FETCH_OPTIONS=\" --poll-s 300 --rate-limit 2000 --wait-ms 300 "
		 "--redirect-hosts cdn.example,cdn2.example:8443 --ca %s/conf/ca.pem\"\n",
		 out);
	has("fetch.env", options);
	has("health-address", "[::]:9200\n");
	CHECK(strcmp(text_of("hostname"), "east-gate\n") == 0);
	has("network/10-wired.network", "UseHostname=no\nSendHostname=yes\nHostname=east-gate\n");
}

static void a_radio_network_is_named_as_iwd_looks_for_it(void **state)
{
	static const struct {
		const char *ssid, *passphrase, *file;
	} names[] = {
		{ "Museum 2-a_B", "12345678", "Museum 2-a_B.psk" },
		{ "Museum #2", "12345678", "=4d757365756d202332.psk" },
		{ "Mus\xc3\xa9"
		  "e",
		  "", "=4d7573c3a965.open" },
		{ "../../etc/x", "", "=2e2e2f2e2e2f6574632f78.open" },
		{ "\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9"
		  "\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9",
		  "12345678",
		  "=c3a9c3a9c3a9c3a9c3a9c3a9c3a9c3a9c3a9c3a9c3a9c3a9c3a9c3a9c3a9c3a9.psk" },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		struct terminal terminal = terminal_default;
		char name[SETUP_WIFI_NAME_BYTES];

		snprintf(terminal.ssid, sizeof(terminal.ssid), "%s", names[i].ssid);
		snprintf(terminal.passphrase, sizeof(terminal.passphrase), "%s",
			 names[i].passphrase);
		setup_wifi_name(&terminal, name);
		if (strcmp(name, names[i].file) != 0)
			fail_msg("%s instead of %s", name, names[i].file);
	}
}

static void the_radio_has_the_address_and_old_networks_go(void **state)
{
	struct stat found;
	char path[256];

	(void)state;
	apply(RELEASE "[wifi]\nssid = Museum\npassphrase = \" stone\\water \"\ncountry = KH\n"
		      "[network]\naddress = 192.168.1.20/24\n");
	has("iwd/Museum.psk", "[Security]\nPassphrase=\\sstone\\\\water \n");
	has("iwd/main.conf", "[General]\nCountry=KH\n");
	has("network/20-wifi.network", "Type=wlan\nProperty=GOPURA_NETWORK=yes\n\n");
	has("network/20-wifi.network", "Address=192.168.1.20/24\n");
	has("network/10-wired.network", "DHCP=yes\n");
	path_of("iwd", path);
	CHECK(stat(path, &found) == 0 && (found.st_mode & 0777) == 0700);
	apply(RELEASE "[wifi]\nssid = Other\ncountry = KH\npassphrase = "
		      "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef\n");
	CHECK(!is_there("iwd/Museum.psk"));
	has("iwd/Other.psk", "PreSharedKey=0123456789abcdef");
	apply(RELEASE);
	CHECK(!is_there("iwd/Other.psk") && !is_there("network/20-wifi.network"));
	CHECK(!is_there("iwd/main.conf"));
}

static void faults_are_written_a_line_each_and_the_rest_holds(void **state)
{
	(void)state;
	apply(RELEASE
	      "[panel]\nrotation = 45\n[netwrk]\naddress = dhcp\n[terminal]\nname = Gate\n");
	CHECK(strcmp(text_of("faults"),
		     "line 5: rotation must be 0, 90, 180 or 270, not '45'\n"
		     "line 6: there is no section [netwrk]; did you mean [network]?\n") == 0);
	CHECK(strcmp(text_of("hostname"), "gate\n") == 0);
}

static void says_where_it_cannot_write(void **state)
{
	static struct terminal terminal;
	static struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	const struct setup setup = { .terminal = &terminal,
				     .diagnostics = &diagnostics,
				     .out = "/proc/nowhere" };

	(void)state;
	terminal = terminal_default;
	CHECK(setup_write(&setup) < 0);
}

static void what_cannot_be_written_takes_nothing_else_away(void **state)
{
	static struct terminal terminal;
	static struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	const struct setup setup = { .terminal = &terminal,
				     .diagnostics = &diagnostics,
				     .out = out };
	char path[256], inside[300];

	(void)state;
	apply(RELEASE "ca = ca.pem\n[wifi]\nssid = Museum\npassphrase = 12345678\ncountry = KH\n"
		      "[health]\nlisten = 0.0.0.0:9200\nmdns = yes\n");
	terminal = terminal_default;
	path_of("faults", path); /* a folder there cannot be replaced by a file */
	snprintf(inside, sizeof(inside), "%s/x", path);
	CHECK(unlink(path) == 0 && mkdir(path, 0700) == 0 && mkdir(inside, 0700) == 0);
	CHECK(setup_write(&setup) < 0);
	CHECK(rmdir(inside) == 0 && rmdir(path) == 0);
	CHECK(is_there("iwd/Museum.psk") && is_there("network/20-wifi.network"));
	CHECK(is_there("dnssd/gopura-health.dnssd") && is_there("conf/ca.pem"));
}

static void every_profile_that_comes_along_is_right(void **state)
{
	DIR *files = opendir("board");
	struct dirent *entry;
	int count = 0;

	(void)state;
	CHECK(files);
	while ((entry = readdir(files))) {
		const char *dot = strrchr(entry->d_name, '.');
		struct profile profile;
		char path[300];

		if (!dot || strcmp(dot, ".ini") != 0)
			continue;
		snprintf(path, sizeof(path), "board/%s", entry->d_name);
		if (profile_read(&profile, path) != 0)
			fail_msg("%s is at fault", path);
		count++;
	}
	closedir(files);
	CHECK(count >= 2);
}

static void write_text(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");

	CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static char stick[] = "/tmp/gopura-stick-XXXXXX";

static int make_folder(void **state)
{
	char path[256];

	(void)state;
	CHECK(mkdtemp(out) && mkdtemp(stick));
	snprintf(conf_path, sizeof(conf_path), "%s/gopura.conf", stick);
	snprintf(path, sizeof(path), "%s/ca.pem", stick);
	write_text(path, "authority");
	return 0;
}

static int remove_folder(void **state)
{
	char command[300];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf %s %s", out, stick);
	return system(command);
}

static void the_authority_outlives_its_stick(void **state)
{
	char path[256];

	(void)state;
	apply(RELEASE "ca = ca.pem\n");
	CHECK(strcmp(text_of("conf/ca.pem"), "authority") == 0);
	has_not("fetch.env", stick);
	apply(RELEASE);
	CHECK(!is_there("conf/ca.pem"));
	has_not("fetch.env", "--ca");
	/* It was there when the file was read, and is gone now. */
	snprintf(path, sizeof(path), "%s/ca.pem", stick);
	CHECK(unlink(path) == 0);
	apply(RELEASE "ca = ca.pem\n");
	has_not("fetch.env", "--ca");
	CHECK(strcmp(text_of("hostname"), "gopura\n") == 0); /* the rest is set up */
	write_text(path, "authority");
}

/* ---- hostile values */

/* Every setting once, and %s in the place of one value. */
static const char *const settings[][2] = {
	{ "terminal", "name" },
	{ "terminal", "language" },
	{ "terminal", "time_zone" },
	{ "terminal", "board" },
	{ "release", "url" },
	{ "release", "trust" },
	{ "release", "ca" },
	{ "release", "target" },
	{ "release", "poll_s" },
	{ "release", "download" },
	{ "release", "rate_limit_kib" },
	{ "panel", "mode" },
	{ "panel", "rotation" },
	{ "panel", "hours" },
	{ "panel", "wake_min" },
	{ "panel", "shift" },
	{ "network", "address" },
	{ "network", "gateway" },
	{ "network", "dns" },
	{ "network", "wait_ms" },
	{ "network", "ntp" },
	{ "wifi", "ssid" },
	{ "wifi", "passphrase" },
	{ "wifi", "country" },
	{ "health", "listen" },
	{ "health", "mdns" },
	{ "visit", "idle_s" },
	{ "release", "redirect_hosts" },
	{ "usb", "allow" },
};

#define EVIL "LD_PRELOAD=/tmp/evil.so"

static const char *const hostile[] = {
	"x\" " EVIL,
	"\"x\" " EVIL "\"",
	"x\\\" " EVIL,
	"x\n" EVIL,
	"x\r" EVIL,
	"\"x\r" EVIL "\"",
	"x\v" EVIL,
	"x\f" EVIL,
	"\"x\t" EVIL "\"",
	"x\x1b[2J" EVIL,
	"x\x7f" EVIL,
	"x\xc2\x85" EVIL,     /* U+0085, a line's end to some */
	"x\xe2\x80\xa8" EVIL, /* U+2028 */
	"x\\n" EVIL,
	"x\\",
	"$(touch /tmp/evil)",
	"`touch /tmp/evil`",
	"${LD_PRELOAD}",
	"%n%s%h",
	"https://x/\" " EVIL,
	"https://x/\\\n" EVIL,
	"https://x/ " EVIL,
	"/media/x\" " EVIL,
	"/media/../../" EVIL,
	"../../../../etc/passwd",
	"..",
	"-x",
	"--conf=/etc/shadow",
	"192.168.1.20/24\" " EVIL,
	"192.168.1.1\nGateway=6.6.6.6",
	"127.0.0.1:9100\nExecStart=/tmp/evil",
	"\"12345678\n[Settings]\nAutoConnect=true\"",
	"\"] = [Service]\"",
};

/* A file that gopura-setup writes: which lines a program may find in it. */
static const struct {
	const char *name;      /* begins so */
	const char *lines[16]; /* begin so; what follows is a value */
	const char *value;     /* characters of values; NULL: all but control characters */
} written[] = {
	{ "fetch.env",
	  { "RELEASE_URL=\"", "FETCH_OPTIONS=\"" },
	  "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._~:/?[]@!&()*+,;=% \"" },
	{ "hostname", { "" }, "abcdefghijklmnopqrstuvwxyz0123456789-" },
	{ "network/",
	  { "[Match]", "[Link]", "[Network]", "[Route]", "[DHCPv4]", "[DHCPv6]", "[IPv6AcceptRA]",
	    "Type=", "RequiredForOnline=", "DHCP=", "Address=", "DNS=", "NTP=", "Gateway=",
	    "Property=GOPURA_NETWORK=yes" },
	  "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-.:/" },
	{ "iwd/main.conf", { "[General]", "Country=" }, "ABCDEFGHIJKLMNOPQRSTUVWXYZ" },
	{ "iwd/",
	  { "[Security]", "[Settings]", "Passphrase=", "PreSharedKey=", "AutoConnect=true" },
	  NULL },
	{ "dnssd/gopura-health.dnssd",
	  { "[Service]", "Name=%H", "Type=_http._tcp", "Port=", "TxtText=path=/" },
	  "0123456789" },
	{ "fetch-address", { "" }, "0123456789abcdefABCDEF:." },
	{ "health-address", { "" }, "0123456789abcdefABCDEF:.[]" },
	{ "usb", { "" }, "abcdefghijklmnopqrstuvwxyz " },
	{ "faults", { "" }, NULL },
	{ "conf/ca.pem", { "authority" }, "" },
};

static bool has_control(const char *text)
{
	for (; *text; text++)
		if ((unsigned char)*text < 0x20 || *text == 0x7f)
			return true;
	return false;
}

/* What follows the line's known beginning; NULL: it has none. */
static const char *value_of(const char *line, size_t file)
{
	const char *value = NULL;

	for (size_t i = 0; i < ARRAY_COUNT(written[0].lines) && written[file].lines[i]; i++) {
		const size_t length = strlen(written[file].lines[i]);

		if (strncmp(line, written[file].lines[i], length) == 0)
			value = line + length;
	}
	/* How a wired or radio network asks; nothing of gopura.conf but the host's name. */
	if (!value && strncmp(written[file].name, "network/", 8) == 0 && strchr(line, '='))
		for (const char *known = "UseDNS=UseNTP=UseHostname=SendHostname=Hostname="
					 "RouteMetric=Metric=MulticastDNS="
					 "ClientIdentifier=DUIDType=";
		     *known; known = strchr(known, '=') + 1)
			if (strncmp(line, known, (size_t)(strchr(known, '=') - known) + 1) == 0)
				value = strchr(line, '=') + 1;
	return value;
}

/* Quotes of fetch.env stand at the ends of a value alone. */
static bool is_harmless(const char *line, size_t file)
{
	const char *value = *line ? value_of(line, file) : line;

	if (!value || has_control(line))
		return false;
	if (file == 0 && strchr(value, '"') != value + strlen(value) - 1)
		return false;
	return !written[file].value || value[strspn(value, written[file].value)] == '\0';
}

static void check_file(const char *name, const char *said)
{
	char text[sizeof(read_text)];
	size_t file = 0;

	if (strcmp(name, "localtime") == 0)
		return; /* a link; terminal_set_time_zone has looked for its target */
	while (file < ARRAY_COUNT(written) &&
	       strncmp(name, written[file].name, strlen(written[file].name)) != 0)
		file++;
	if (file == ARRAY_COUNT(written) || has_control(name))
		fail_msg("%s\nmade a file %s", said, name);
	snprintf(text, sizeof(text), "%s", text_of(name));
	for (char *line = text, *end; (end = strchr(line, '\n')) || *line; line = end + 1) {
		if (end)
			*end = '\0';
		if (!is_harmless(line, file))
			fail_msg("%s\nmade in %s the line %s", said, name, line);
		if (!end)
			break;
	}
}

static void check_folder(const char *name, const char *said)
{
	char path[256], below[600];
	struct dirent *entry;
	DIR *files;

	path_of(name, path);
	files = opendir(path);
	CHECK(files);
	while ((entry = readdir(files))) {
		if (entry->d_name[0] == '.')
			continue;
		snprintf(below, sizeof(below), "%s%s%s", name, *name ? "/" : "", entry->d_name);
		if (entry->d_type == DT_DIR)
			check_folder(below, said);
		else
			check_file(below, said);
	}
	closedir(files);
}

static void no_value_says_more_than_its_own(void **state)
{
	static const char rest[] = "\n[network]\naddress = dhcp\n[wifi]\nssid = Hall\n"
				   "passphrase = 12345678\ncountry = KH\n[release]\n"
				   "url = https://museum.example/\ntrust = 1.json\nca = ca.pem\n"
				   "[health]\nlisten = 0.0.0.0:9100\nmdns = yes\n";

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(settings); i++)
		for (size_t j = 0; j < ARRAY_COUNT(hostile); j++) {
			char conf[1024];

			/* First, so that it is the one that counts. */
			snprintf(conf, sizeof(conf), "[%s]\n%s = %s%s", settings[i][0],
				 settings[i][1], hostile[j], rest);
			apply(conf);
			check_folder("", conf);
		}
}

static void no_folders_name_says_more_than_its_own(void **state)
{
	static const char evil[] = "x\"\nLD_PRELOAD=evil.so\n#\"";
	char folder[300], kept[256], path[400];

	(void)state;
	snprintf(kept, sizeof(kept), "%s", conf_path);
	snprintf(folder, sizeof(folder), "%s/%s", stick, evil);
	CHECK(mkdir(folder, 0700) == 0);
	snprintf(path, sizeof(path), "%s/ca.pem", folder);
	write_text(path, "authority");
	snprintf(conf_path, sizeof(conf_path), "%.230s/gopura.conf", folder);
	apply(RELEASE "ca = ca.pem\n");
	has_not("fetch.env", "LD_PRELOAD");
	check_folder("", folder);
	CHECK(strcmp(text_of("conf/ca.pem"), "authority") == 0);
	snprintf(conf_path, sizeof(conf_path), "%s", kept);
}

static void a_release_on_the_stick_is_left_to_the_sticks_own_reader(void **state)
{
	(void)state;
	apply("[release]\nurl = /run/gopura-stick/release\ntrust = 1.json\n");
	CHECK(strcmp(text_of("faults"), "") == 0);
	has_not("fetch.env", "RELEASE_URL");
	apply("[release]\nurl = /run/gopura-stick/elsewhere\ntrust = 1.json\n");
	has("faults", "line 2: url must be");
	apply("[release]\nurl = /media/release\ntrust = 1.json\n");
	has("fetch.env", "RELEASE_URL=\"/media/release\"");
}

static void only_a_server_that_would_be_denied_is_named_to_the_fetchers_unit(void **state)
{
	static const char *const cases[][2] = {
		{ "https://museum.example/temple/", "" },
		{ "http://192.168.1.2:8080/", "" },
		{ "http://169.254.7.9:8080/", "169.254.7.9\n" },
		{ "https://127.0.0.1/temple/", "127.0.0.1\n" },
		{ "https://[fe80::1%25eth0]:8443/", "fe80::1\n" },
		{ "https://[::1]/", "::1\n" },
		{ "https://[2001:db8::1]/", "" },
		{ "https://169.254.7.9.museum.example/", "" },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		char conf[256];

		snprintf(conf, sizeof(conf), "[release]\nurl = %s\ntrust = 1.json\n", cases[i][0]);
		apply(conf);
		CHECK(strcmp(text_of("fetch-address"), cases[i][1]) == 0);
	}
}

static void the_network_is_told_of_the_health_page_where_asked_for(void **state)
{
	(void)state;
	apply(RELEASE "[health]\nlisten = 0.0.0.0:9200\nmdns = yes\n"
		      "[wifi]\nssid = x\npassphrase = 12345678\ncountry = KH\n");
	CHECK(strcmp(text_of("dnssd/gopura-health.dnssd"),
		     "[Service]\nName=%H\nType=_http._tcp\nPort=9200\nTxtText=path=/\n") == 0);
	has("network/10-wired.network", "[Network]\nMulticastDNS=yes\n");
	has("network/20-wifi.network", "[Network]\nMulticastDNS=yes\n");
	apply(RELEASE "[health]\nlisten = 0.0.0.0:9200\n");
	CHECK(is_there("dnssd") && !is_there("dnssd/gopura-health.dnssd"));
	has_not("network/10-wired.network", "MulticastDNS");
}

static void what_usb_may_bring_is_nothing_unless_it_is_named(void **state)
{
	(void)state;
	apply(RELEASE);
	CHECK(strcmp(text_of("usb"), "") == 0);
	apply(RELEASE "[usb]\nallow = WiFi, keyboard\n");
	CHECK(strcmp(text_of("usb"), "keyboard wifi\n") == 0);
	apply(RELEASE "[usb]\nallow = network panel\n");
	CHECK(strcmp(text_of("usb"), "network panel\n") == 0);
	apply(RELEASE "[usb]\nallow = keyboard, mouse\n");
	CHECK(strcmp(text_of("usb"), "") == 0);
	CHECK(strcmp(text_of("faults"),
		     "line 5: allow must be keyboard, network, wifi or panel, or several of them "
		     "(storage and touch always work), not 'keyboard, mouse'\n") == 0);
	apply(RELEASE "[usb]\nallow = key\n");
	CHECK(strcmp(text_of("usb"), "") == 0);
	apply(RELEASE);
	CHECK(strcmp(text_of("usb"), "") == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(without_a_word_the_cable_is_asked),
		cmocka_unit_test(an_address_of_its_own_has_its_gateway_and_servers),
		cmocka_unit_test(a_dhcp_server_knows_a_terminal_by_its_card),
		cmocka_unit_test(the_fetcher_is_told_what_is_its),
		cmocka_unit_test(a_radio_network_is_named_as_iwd_looks_for_it),
		cmocka_unit_test(the_radio_has_the_address_and_old_networks_go),
		cmocka_unit_test(the_network_is_told_of_the_health_page_where_asked_for),
		cmocka_unit_test(the_authority_outlives_its_stick),
		cmocka_unit_test(a_release_on_the_stick_is_left_to_the_sticks_own_reader),
		cmocka_unit_test(only_a_server_that_would_be_denied_is_named_to_the_fetchers_unit),
		cmocka_unit_test(no_value_says_more_than_its_own),
		cmocka_unit_test(no_folders_name_says_more_than_its_own),
		cmocka_unit_test(what_usb_may_bring_is_nothing_unless_it_is_named),
		cmocka_unit_test(faults_are_written_a_line_each_and_the_rest_holds),
		cmocka_unit_test(says_where_it_cannot_write),
		cmocka_unit_test(what_cannot_be_written_takes_nothing_else_away),
		cmocka_unit_test(every_profile_that_comes_along_is_right),
	};

	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
