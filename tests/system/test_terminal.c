#include "system/terminal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/check.h"

#define RELEASE "[release]\nurl = https://museum.example/temple/\ntrust = 1.json\n"

static struct terminal terminal;
static struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };

static void parse_bytes(const void *text, size_t size)
{
	diagnostics_finish(&diagnostics);
	terminal_parse(&terminal, (struct bytes){ text, size }, &diagnostics);
}

static void parse(const char *text)
{
	parse_bytes(text, strlen(text));
}

static void says(const char *text)
{
	for (unsigned i = 0; i < diagnostics.count; i++)
		if (strstr(diagnostics_get(&diagnostics, i)->text, text))
			return;
	for (unsigned i = 0; i < diagnostics.count; i++)
		print_message("  said: %s\n", diagnostics_get(&diagnostics, i)->text);
	fail_msg("not said: %s", text);
}

static void says_only(const char *text)
{
	says(text);
	if (diagnostics.count != 1)
		fail_msg("%u faults, the second: %s", diagnostics.count,
			 diagnostics_get(&diagnostics, 1)->text);
}

static void takes_every_value(void **state)
{
	(void)state;
	parse("[terminal]\nname = East gate\nlanguage = pt-BR\ntime_zone = Europe/Berlin\n"
	      "board = weak-arm\n" RELEASE
	      "ca = ca.pem\ntarget = angkor/release.json\npoll_s = 600\ndownload = 22:00-06:00\nrate_limit_kib = 500\n"
	      "[panel]\nmode = 3840x2160@59.94\nrotation = 270\nhours = Mo-Fr 09:00-18:00\n"
	      "wake_min = 0\nshift = no\n"
	      "[network]\naddress = 192.168.1.20/24\ngateway = 192.168.1.1\n"
	      "dns = 192.168.1.1, 2620:fe::fe\nntp = pool.ntp.org 192.168.1.1\nwait_ms = 2000\n"
	      "[wifi]\nssid = Musée d'Angkor\npassphrase = stone and water\ncountry = kh\n"
	      "[health]\nlisten = [::]:9200\nmdns = yes\n"
	      "[visit]\nidle_s = 90\n");
	if (diagnostics.count)
		fail_msg("%s", diagnostics.first.text);
	CHECK(strcmp(terminal.name, "East gate") == 0 && strcmp(terminal.language, "pt-BR") == 0);
	CHECK(strcmp(terminal.time_zone, "Europe/Berlin") == 0);
	CHECK(strcmp(terminal.board, "weak-arm") == 0);
	CHECK(strcmp(terminal.release_url, "https://museum.example/temple/") == 0);
	CHECK(strcmp(terminal.trust, "1.json") == 0 && strcmp(terminal.ca, "ca.pem") == 0);
	CHECK(strcmp(terminal.target, "angkor/release.json") == 0);
	CHECK(terminal.wait_ms == 2000);
	CHECK(terminal.poll_s == 600 && terminal.rate_limit_kib == 500);
	CHECK(terminal.download.from_min == 22 * 60);
	CHECK(terminal.download.until_min == 6 * 60);
	CHECK(terminal.width_px == 3840 && terminal.height_px == 2160);
	CHECK(terminal.hz == 60 && terminal.rotation_deg == 270 && !terminal.shift);
	CHECK(terminal.wake_min == 0);
	CHECK(hours_open_at(&terminal.hours, &(struct tm){ .tm_wday = 1, .tm_hour = 9 }));
	CHECK(!hours_open_at(&terminal.hours, &(struct tm){ .tm_wday = 0, .tm_hour = 9 }));
	CHECK(terminal.is_static && strcmp(terminal.address, "192.168.1.20") == 0);
	CHECK(terminal.prefix_bits == 24 && strcmp(terminal.gateway, "192.168.1.1") == 0);
	CHECK(terminal.dns.count == 2 && strcmp(terminal.dns.names[1], "2620:fe::fe") == 0);
	CHECK(terminal.ntp.count == 2 && strcmp(terminal.ntp.names[0], "pool.ntp.org") == 0);
	CHECK(strcmp(terminal.ssid, "Musée d'Angkor") == 0);
	CHECK(strcmp(terminal.passphrase, "stone and water") == 0);
	CHECK(strcmp(terminal.country, "KH") == 0);
	CHECK(strcmp(terminal.listen_address, "::") == 0 && terminal.listen_port == 9200);
	CHECK(terminal.mdns && terminal.idle_s == 90);
}

static void keeps_defaults_where_nothing_is_said(void **state)
{
	(void)state;
	parse(RELEASE);
	CHECK(diagnostics.count == 0);
	CHECK(terminal.rotation_deg == -1 && terminal.shift && !terminal.is_static);
	CHECK(terminal.wake_min == 5 && !terminal.mdns && terminal.idle_s == 60);
	CHECK(terminal.download.from_min == terminal.download.until_min && terminal.poll_s == 0 &&
	      terminal.width_px == 0);
	CHECK(hours_open_at(&terminal.hours, &(struct tm){ .tm_wday = 0, .tm_hour = 3 }));
	CHECK(strcmp(terminal.listen_address, "127.0.0.1") == 0 && terminal.listen_port == 9100);
	parse(RELEASE "[network]\naddress = dhcp\n");
	CHECK(diagnostics.count == 0 && !terminal.is_static);
}

static void refuses_each_wrong_value_by_its_line_and_says_the_cure(void **state)
{
	static const struct {
		const char *section, *line, *cure;
	} wrong[] = {
		{ "panel", "rotation = 45", "must be 0, 90, 180 or 270, not '45'" },
		{ "panel", "rotation = 360", "must be 0, 90, 180 or 270, not '360'" },
		{ "panel", "mode = 1080p", "such as 1920x1080" },
		{ "panel", "mode = 1920x1080@", "such as 1920x1080" },
		{ "panel", "mode = 1920x1080@1000", "such as 1920x1080" },
		{ "panel", "mode = 1920x99999", "such as 1920x1080" },
		{ "panel", "hours = 9 to 5", "such as Mo-Fr 09:00-18:00" },
		{ "panel", "wake_min = -1", "whole minutes from 0 to 1440" },
		{ "panel", "wake_min = 1441", "whole minutes from 0 to 1440" },
		{ "panel", "wake_min = 2.5", "whole minutes from 0 to 1440" },
		{ "visit", "idle_s = 4", "whole seconds from 5 to 3600" },
		{ "visit", "idle_s = 3601", "whole seconds from 5 to 3600" },
		{ "health", "mdns = 1", "yes or no" },
		{ "panel", "shift = maybe", "yes or no" },
		{ "panel", "shift =", "has no value" },
		{ "terminal", "language = English", "such as km" },
		{ "terminal", "language = e", "such as km" },
		{ "terminal", "language = en-", "such as km" },
		{ "terminal", "time_zone = Europe/Angkor", "such as Asia/Phnom_Penh" },
		{ "terminal", "time_zone = Europe", "such as Asia/Phnom_Penh" },
		{ "terminal", "time_zone = ../../../etc/passwd", "such as Asia/Phnom_Penh" },
		{ "terminal", "board = ../generic", "board's profile" },
		{ "terminal",
		  "name = 0123456789012345678901234567890123456789012345678901234567890123",
		  "up to 63 bytes" },
		{ "terminal", "name = \"East\tgate\"", "without control characters" },
		{ "terminal", "name = East\xc2\x85gate", "without control characters" },
		{ "release", "ca = keys/ca.pem", "without folders" },
		{ "release", "ca = ..", "without folders" },
		{ "release", "ca = -x", "without folders" },
		{ "release", "target = /release.json", "such as angkor/release.json" },
		{ "release", "target = a/../release.json", "such as angkor/release.json" },
		{ "release", "target = a//release.json", "such as angkor/release.json" },
		{ "release", "target = a b", "such as angkor/release.json" },
		{ "release", "poll_s = 5", "60 to 86400" },
		{ "release", "poll_s = 90000", "60 to 86400" },
		{ "release", "poll_s = 60.5", "60 to 86400" },
		{ "release", "download = 22:00", "such as 22:00-06:00" },
		{ "release", "download = 22:00-22:00", "such as 22:00-06:00" },
		{ "release", "download = 22:00-26:00", "such as 22:00-06:00" },
		{ "release", "rate_limit_kib = 0", "from 1 to 1048576" },
		{ "network", "wait_ms = 0", "from 50 to 60000" },
		{ "network", "address = 192.168.1.20", "such as 192.168.1.20/24" },
		{ "network", "address = 192.168.1.0/24", "such as 192.168.1.20/24" },
		{ "network", "address = 192.168.1.255/24", "such as 192.168.1.20/24" },
		{ "network", "address = 192.168.1.20/33", "such as 192.168.1.20/24" },
		{ "network", "address = 192.168.1.20/", "such as 192.168.1.20/24" },
		{ "network", "address = 1.2.3/24", "such as 192.168.1.20/24" },
		{ "network", "dns = dns.example", "up to 4 addresses" },
		{ "network", "dns = 1.1.1.1 2.2.2.2 3.3.3.3 4.4.4.4 5.5.5.5", "up to 4 addresses" },
		{ "network", "ntp = pool..org", "up to 4 time servers" },
		{ "network", "ntp = 300.1.1.1", "up to 4 time servers" },
		{ "network", "ntp = -a.org", "up to 4 time servers" },
		{ "health", "listen = 9100", "such as 127.0.0.1:9100" },
		{ "health", "listen = 127.0.0.1:0", "such as 127.0.0.1:9100" },
		{ "health", "listen = 127.0.0.1:70000", "such as 127.0.0.1:9100" },
		{ "health", "listen = ::1:9100", "such as 127.0.0.1:9100" },
		{ "health", "listen = [127.0.0.1]:9100", "such as 127.0.0.1:9100" },
		{ "health", "listen = [:9100", "such as 127.0.0.1:9100" },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(wrong); i++) {
		char text[512], begins[64];

		snprintf(text, sizeof(text), RELEASE "\n[%s]\n# here\n%s\n", wrong[i].section,
			 wrong[i].line);
		parse(text);
		says_only(wrong[i].cure);
		snprintf(begins, sizeof(begins), "line 7: %.*s ", (int)strcspn(wrong[i].line, " ="),
			 wrong[i].line);
		CHECK(strncmp(diagnostics.first.text, begins, strlen(begins)) == 0);
		CHECK(diagnostics.first.line == 7);
	}
}

static void refuses_addresses_that_are_none(void **state)
{
	static const char *const bad[] = {
		"museum.example/temple", "ftp://museum.example/", "https://",     "https:///temple",
		"https://a b/",          "https://a\"b/",         "https://a$b/", "temple"
	};
	static const char *const good[] = { "https://museum.example:8443/a/b/",
					    "http://192.168.1.2/", "http://[::1]:80/",
					    "/media/release" };
	char text[256];

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
		snprintf(text, sizeof(text), "[release]\nurl = %s\ntrust = 1.json\n", bad[i]);
		parse(text);
		says_only("line 2: url must be an address such as https://");
		CHECK(terminal.release_url[0] == '\0');
	}
	for (size_t i = 0; i < ARRAY_COUNT(good); i++) {
		snprintf(text, sizeof(text), "[release]\nurl = %s\ntrust = 1.json\n", good[i]);
		parse(text);
		CHECK(diagnostics.count == 0 && strcmp(terminal.release_url, good[i]) == 0);
	}
}

static void takes_hosts_that_the_server_may_redirect_to(void **state)
{
	static const char *const bad[] = { "https://cdn.example/",
					   "cdn.example:0",
					   "cdn.example:65536",
					   "cdn.example:",
					   "a, b, c, d, e",
					   "-c",
					   "a..b",
					   "a\"b" };
	char text[256];

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
		snprintf(text, sizeof(text), RELEASE "redirect_hosts = %s\n", bad[i]);
		parse(text);
		says_only("line 4: redirect_hosts must be up to 4 hosts such as cdn.example");
		CHECK(terminal.redirect_hosts[0] == '\0');
	}
	parse(RELEASE "redirect_hosts = cdn.example, 192.168.1.4:8443\n");
	CHECK(diagnostics.count == 0);
	CHECK(strcmp(terminal.redirect_hosts, "cdn.example,192.168.1.4:8443") == 0);
}

static void keeps_what_is_right_beside_what_is_wrong(void **state)
{
	(void)state;
	parse("[terminal]\nname = Gate\nlanguage = Khmer\n" RELEASE
	      "[panel]\nrotation = upright\nmode = 1280x720\n[colours]\nred = 1\n[panel]\n"
	      "shift = no\n");
	CHECK(diagnostics.count == 3);
	CHECK(strcmp(terminal.name, "Gate") == 0 && terminal.language[0] == '\0');
	CHECK(terminal.width_px == 1280 && !terminal.shift && terminal.rotation_deg == -1);
	CHECK(terminal.release_url[0] != '\0');
}

static void names_what_was_meant(void **state)
{
	(void)state;
	parse("[relese]\nurl = https://a.example/\n" RELEASE);
	says_only("line 1: there is no section [relese]; did you mean [release]?");
	parse(RELEASE "[panel]\nrotaton = 90\n");
	says_only("line 5: [panel] has no 'rotaton'; did you mean 'rotation'?");
	parse(RELEASE "[terminal]\nrotation = 90\n");
	says_only("line 5: rotation belongs under [panel]; move it there");
	parse(RELEASE "[panel]\nbrightness = 90\n");
	says_only("[panel] has no 'brightness'; it has mode, rotation, hours, wake_min, shift");
	parse(RELEASE "[sound]\nvolume = 3\n");
	says_only("the sections are [terminal], [release], [panel], [network], [wifi], [health]");
	parse("colour = red\n" RELEASE);
	says_only("line 1: 'colour' comes before the first [section]");
	parse(RELEASE "[PANEL]\nRotation = 90\n");
	CHECK(diagnostics.count == 0 && terminal.rotation_deg == 90);
}

static void says_what_a_line_lacks(void **state)
{
	(void)state;
	parse(RELEASE "[panel\nrotation = 90\n");
	says_only("line 4: the section name is not closed; write ] after it");
	parse(RELEASE "rotate it\n");
	says_only("line 4: 'rotate it' is neither a [section] nor name = value");
	parse(RELEASE "url = https://b.example/\n");
	says_only("line 4: url is set in line 2 already");
	CHECK(strcmp(terminal.release_url, "https://museum.example/temple/") == 0);
	parse("[terminal]\nname = x\n"); /* its release may be inside */
	CHECK(diagnostics.count == 0);
	parse("[release]\ntrust = 1.json\n");
	says_only("section [release] has no url");
	CHECK(diagnostics.first.line == 0);
	parse("[release]\nurl = https://museum.example/temple/\n");
	says_only("section [release] has no trust");
	parse("[release]\nurl = nonsense\ntrust = 1.json\n");
	CHECK(diagnostics.count == 1); /* not missing as well */
}

static void sees_what_does_not_fit_together(void **state)
{
	(void)state;
	parse(RELEASE "[network]\naddress = 192.168.1.20/24\ngateway = 192.168.2.1\n");
	says_only("line 6: gateway 192.168.2.1 is not in the network of 192.168.1.20/24");
	parse(RELEASE "[network]\naddress = 10.0.0.5/8\ngateway = fe80::1\n");
	says_only("is not in the network of");
	parse(RELEASE "[network]\naddress = 2001:db8::5/64\ngateway = fe80::1\n");
	CHECK(diagnostics.count == 0);
	parse(RELEASE "[network]\ngateway = 192.168.2.1\n");
	says_only("line 5: gateway needs a static address");
	parse(RELEASE "[network]\naddress = dhcp\ngateway = 192.168.2.1\n");
	says_only("line 6: gateway needs a static address");
	parse(RELEASE "[network]\naddress = 192.168.2\ngateway = 192.168.2.1\n");
	says_only("line 5: address must be dhcp");
	parse(RELEASE "[health]\nmdns = yes\n");
	says_only("line 5: mdns announces the health page, but");
	parse(RELEASE "[health]\nmdns = yes\nlisten = [::1]:9100\n");
	says_only("line 5: mdns announces the health page, but");
	parse(RELEASE "[wifi]\npassphrase = 12345678\n");
	says_only("line 5: passphrase needs ssid");
	parse(RELEASE "[wifi]\nssid = x\n");
	says_only("line 5: ssid needs country");
	parse(RELEASE "[wifi]\nssid = x\ncountry = UK\n");
	says_only("such as KH or GB, not 'UK'");
}

static void knows_names_and_passphrases_of_radio_networks(void **state)
{
	char text[256];

	(void)state;
	for (size_t length = 0; length <= 65; length++) {
		snprintf(text, sizeof(text),
			 RELEASE "[wifi]\nssid=s\ncountry=DE\npassphrase=\"%.*s\"", (int)length,
			 "gggggggggggggggggggggggggggggggggggggggggggggggggggggggggggggggggggggg");
		parse(text);
		CHECK((diagnostics.count == 0) == (length >= 8 && length <= 63));
		snprintf(text, sizeof(text), RELEASE "[wifi]\nssid=\"%.*s\"\ncountry=DE\n",
			 (int)length,
			 "gggggggggggggggggggggggggggggggggggggggggggggggggggggggggggggggggggggg");
		parse(text);
		CHECK((diagnostics.count == 0) == (length >= 1 && length <= 32));
	}
	parse(RELEASE "[wifi]\nssid=s\ncountry=DE\npassphrase="
		      "0123456789abcdef0123456789ABCDEF0123456789abcdef0123456789abcdef\n");
	CHECK(diagnostics.count == 0 && strlen(terminal.passphrase) == 64);
	parse(RELEASE "[wifi]\ncountry=DE\nssid = \"East\tgate\"\n");
	says_only("line 6: ssid must be a network's name of 1 to 32 bytes without control");
	parse(RELEASE "[wifi]\nssid=s\ncountry=DE\npassphrase = Straße 12\n");
	says_only("line 7: passphrase must be 8 to 63");
	CHECK(!strstr(diagnostics.first.text, "Stra")); /* it goes to logs and onto the panel */
}

static void never_cuts_a_passphrase_silently(void **state)
{
	(void)state;
	parse(RELEASE "[wifi]\nssid=s\ncountry=DE\npassphrase = stone #1 water\n");
	says_only("line 7: passphrase contains ' #': if that is part of the value, put");
	parse(RELEASE
	      "[wifi]\nssid=s\ncountry=DE\npassphrase = \"stone #1 water\" # of the guests\n");
	CHECK(diagnostics.count == 0 && strcmp(terminal.passphrase, "stone #1 water") == 0);
	parse(RELEASE "[wifi]\nssid=s\ncountry=DE\npassphrase = \" \"stone\";water\"\n");
	CHECK(diagnostics.count == 0 && strcmp(terminal.passphrase, " \"stone\";water") == 0);
	parse(RELEASE "[wifi]\nssid=s\ncountry=DE\npassphrase = \"stone and water\n");
	says_only("line 7: passphrase has no closing quote");
	parse(RELEASE "[panel]\nrotation = 90 ; upright\nshift = no\t# why\n");
	CHECK(diagnostics.count == 0 && terminal.rotation_deg == 90 && !terminal.shift);
}

static void takes_files_as_windows_saves_them(void **state)
{
	static const char crlf[] = "\xef\xbb\xbf[release]\r\nurl = https://a.example/\r\n"
				   "trust = 1.json\r\n\r\n; done\r\n[panel]\r\nrotation = 45\r\n";
	static const char wide[] = "\xff\xfe[\0r\0]\0";
	static const char ansi[] = RELEASE "[terminal]\nname = Mus\xe9"
					   "e\n# caf\xe9\n";

	(void)state;
	parse_bytes(crlf, sizeof(crlf) - 1);
	says_only("line 7: rotation must be 0, 90, 180 or 270, not '45'");
	CHECK(strcmp(terminal.release_url, "https://a.example/") == 0);
	parse_bytes(wide, sizeof(wide) - 1);
	says("the file is saved as UTF-16; save it as UTF-8");
	parse_bytes(ansi, sizeof(ansi) - 1);
	says_only("line 5: the line is not valid UTF-8; save the file as UTF-8");
	parse_bytes("a\0b", 3);
	says("the file contains zero bytes");
}

static void bounds_the_list_and_counts_the_rest(void **state)
{
	char text[8192] = RELEASE, value[1200];

	(void)state;
	for (int i = 0; i < 50; i++)
		strncat(text, "what is this\n", sizeof(text) - strlen(text) - 1);
	parse(text);
	CHECK(diagnostics.count == SETTINGS_DIAGNOSTICS_MAX &&
	      diagnostics.dropped == 50 - SETTINGS_DIAGNOSTICS_MAX);
	CHECK(diagnostics.first.line == 4 &&
	      diagnostics_get(&diagnostics, SETTINGS_DIAGNOSTICS_MAX - 1)->line ==
		      3 + SETTINGS_DIAGNOSTICS_MAX);
	memset(value, 'x', sizeof(value) - 1);
	value[sizeof(value) - 1] = '\0';
	snprintf(text, sizeof(text), RELEASE "ca = %s\n", value);
	parse(text);
	says_only("line 4: the line is longer than 1000 bytes");
	/* What is quoted is cut between characters. */
	snprintf(text, sizeof(text),
		 RELEASE "[panel]\nshift = ប្រាសាទអង្គរវត្តប្រាសាទអង្គរវត្តប្រាសាទអង្គរវត្តប្រាសាទ\n");
	parse(text);
	says_only("yes or no, not '");
	CHECK(!strchr(diagnostics.first.text, '?') && strlen(diagnostics.first.text) < 120);
}

static void looks_for_the_files_it_names(void **state)
{
	char folder[] = "/tmp/gopura-terminal-XXXXXX", path[64], beside[64];
	FILE *file;

	(void)state;
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/gopura.conf", folder);
	snprintf(beside, sizeof(beside), "%s/1.json", folder);
	diagnostics_finish(&diagnostics);
	CHECK(terminal_read(&terminal, path, NULL, &diagnostics) == -ENOENT &&
	      diagnostics.count == 0);
	file = fopen(path, "w");
	CHECK(file && fputs(RELEASE, file) >= 0 && fclose(file) == 0);
	CHECK(terminal_read(&terminal, path, NULL, &diagnostics) == 0);
	says_only("line 3: there is no file 1.json beside gopura.conf; copy it there");
	CHECK(terminal.trust[0] == '\0');
	file = fopen(beside, "w");
	CHECK(file && fclose(file) == 0);
	diagnostics_finish(&diagnostics);
	CHECK(terminal_read(&terminal, path, NULL, &diagnostics) == 0 && diagnostics.count == 0);
	diagnostics_finish(&diagnostics);
	CHECK(terminal_read(&terminal, folder, NULL, &diagnostics) == 0);
	says_only("the file cannot be read: it is a folder; put a file there");
	file = fopen(path, "w");
	CHECK(file && fputs("[terminal]\nboard = toaster\n" RELEASE, file) >= 0 &&
	      fclose(file) == 0);
	diagnostics_finish(&diagnostics);
	CHECK(terminal_read(&terminal, path, "board", &diagnostics) == 0);
	says_only("line 2: there is no board profile 'toaster'; the profiles are ");
	says("generic");
	CHECK(terminal.board[0] == '\0');
	diagnostics_finish(&diagnostics);
	CHECK(terminal_read(&terminal, path, folder, &diagnostics) == 0);
	says_only("line 2: there is no board profile 'toaster', and no other one in /tmp/");
	unlink(beside);
	unlink(path);
	rmdir(folder);
}

/* What is wrong with gopura.conf at path, or with what stands beside it. */
static void read_and_find(const char *path, const char *text)
{
	diagnostics_finish(&diagnostics);
	CHECK(terminal_read(&terminal, path, NULL, &diagnostics) == 0);
	says_only(text);
}

static void waits_for_no_pipe_and_follows_no_link(void **state)
{
	static const struct {
		const char *target; /* of the link that is named; NULL: a pipe, "": a folder */
		const char *why;
	} beside[] = {
		{ NULL, "not a regular file but a pipe, a device or a socket; put a file there" },
		{ "", "it is a folder; put a file there" },
		{ "/dev/zero", "links are not followed; copy the file itself" },
		{ "gopura.conf", "links are not followed; copy the file itself" },
	};
	char folder[] = "/tmp/gopura-terminal-XXXXXX", path[64], named[64], said[128];
	char sum[TERMINAL_SUM_BYTES];
	FILE *file;

	(void)state;
	parse("[release]\nurl = https://a.example/\ntrust = ../../dev/zero\n");
	says_only("line 3: trust must be the name of a file beside this one, without folders");
	alarm(60); /* what hangs ends the test */
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/gopura.conf", folder);
	snprintf(named, sizeof(named), "%s/1.json", folder);
	CHECK(mkfifo(path, 0600) == 0);
	read_and_find(path, "the file cannot be read: it is not a regular file but a pipe");
	CHECK(terminal_sum(path, sum) < 0);
	unlink(path);
	CHECK(symlink("/dev/zero", path) == 0);
	read_and_find(path, "the file cannot be read: it is a link");
	unlink(path);
	file = fopen(path, "w");
	CHECK(file && fputs(RELEASE, file) >= 0 && fclose(file) == 0);
	for (size_t i = 0; i < ARRAY_COUNT(beside); i++) {
		const char *target = beside[i].target;

		CHECK((!target   ? mkfifo(named, 0600)
		       : *target ? symlink(target, named)
				 : mkdir(named, 0700)) == 0);
		snprintf(said, sizeof(said),
			 "line 3: 1.json beside gopura.conf cannot be read: it is");
		read_and_find(path, said);
		says(beside[i].why);
		CHECK(terminal.trust[0] == '\0');
		CHECK(terminal_sum(path, sum) == 0); /* counts as empty */
		CHECK(remove(named) == 0);
	}
	unlink(path);
	rmdir(folder);
	alarm(0);
}

static void the_sum_tells_what_means_another_thing(void **state)
{
	static const char *const texts[][2] = {
		{ RELEASE, "root" },
		{ RELEASE "\n", "root" },
		{ RELEASE, "other root" },
		{ RELEASE, NULL },
	};
	char folder[] = "/tmp/gopura-terminal-XXXXXX", path[64], named[64];
	char sums[ARRAY_COUNT(texts)][TERMINAL_SUM_BYTES], again[TERMINAL_SUM_BYTES];
	FILE *file;

	(void)state;
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/gopura.conf", folder);
	snprintf(named, sizeof(named), "%s/1.json", folder);
	CHECK(terminal_sum(path, again) == -ENOENT);
	for (size_t i = 0; i < ARRAY_COUNT(texts); i++) {
		file = fopen(path, "w");
		CHECK(file && fputs(texts[i][0], file) >= 0 && fclose(file) == 0);
		unlink(named);
		file = texts[i][1] ? fopen(named, "w") : NULL;
		CHECK(!file || (fputs(texts[i][1], file) >= 0 && fclose(file) == 0));
		CHECK(terminal_sum(path, sums[i]) == 0 && strlen(sums[i]) == 64);
		CHECK(terminal_sum(path, again) == 0 && strcmp(again, sums[i]) == 0);
		for (size_t j = 0; j < i; j++)
			CHECK(strcmp(sums[i], sums[j]) != 0);
	}
	unlink(named);
	unlink(path);
	rmdir(folder);
}

static void the_example_is_without_fault(void **state)
{
	struct buffer file;

	(void)state;
	buffer_init(&file, SETTINGS_FILE_MAX);
	CHECK(buffer_read_file(&file, "system/gopura.conf.example") == 0);
	parse_bytes(file.data, file.size);
	buffer_finish(&file);
	if (diagnostics.count)
		fail_msg("%s", diagnostics.first.text);
	CHECK(terminal.is_static && terminal.ssid[0] && terminal.download.from_min > 0);
}

static void makes_a_host_name_of_any_name(void **state)
{
	static const struct {
		const char *name, *host;
	} names[] = {
		{ "East gate", "east-gate" },
		{ "", "gopura" },
		{ "ប្រាសាទ", "gopura" },
		{ " --Nº 5 / Hall B-- ", "n-5-hall-b" },
		{ "x", "x" },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		char host[TERMINAL_NAME_BYTES];

		terminal = terminal_default;
		snprintf(terminal.name, sizeof(terminal.name), "%s", names[i].name);
		terminal_host_name(&terminal, host);
		if (strcmp(host, names[i].host) != 0)
			fail_msg("%s became %s", names[i].name, host);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(takes_every_value),
		cmocka_unit_test(keeps_defaults_where_nothing_is_said),
		cmocka_unit_test(refuses_each_wrong_value_by_its_line_and_says_the_cure),
		cmocka_unit_test(refuses_addresses_that_are_none),
		cmocka_unit_test(takes_hosts_that_the_server_may_redirect_to),
		cmocka_unit_test(keeps_what_is_right_beside_what_is_wrong),
		cmocka_unit_test(names_what_was_meant),
		cmocka_unit_test(says_what_a_line_lacks),
		cmocka_unit_test(sees_what_does_not_fit_together),
		cmocka_unit_test(knows_names_and_passphrases_of_radio_networks),
		cmocka_unit_test(never_cuts_a_passphrase_silently),
		cmocka_unit_test(takes_files_as_windows_saves_them),
		cmocka_unit_test(bounds_the_list_and_counts_the_rest),
		cmocka_unit_test(looks_for_the_files_it_names),
		cmocka_unit_test(waits_for_no_pipe_and_follows_no_link),
		cmocka_unit_test(the_sum_tells_what_means_another_thing),
		cmocka_unit_test(the_example_is_without_fault),
		cmocka_unit_test(makes_a_host_name_of_any_name),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
