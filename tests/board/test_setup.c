#include "board/setup.h"

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

static void apply(const char *conf)
{
	static struct terminal terminal;
	static struct faults faults;
	const struct setup setup = { .terminal = &terminal,
				     .faults = &faults,
				     .conf_path = "/efi/gopura.conf",
				     .out = out };

	memset(&faults, 0, sizeof(faults));
	terminal_parse(&terminal, (struct bytes){ (const uint8_t *)conf, strlen(conf) }, &faults);
	CHECK(setup_write(&setup) == 0);
}

static void without_a_word_the_cable_is_asked(void **state)
{
	char link[256], target[256] = "";

	(void)state;
	apply(RELEASE);
	has("network/10-wired.network", "[Match]\nType=ether\n");
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

static void the_fetcher_is_told_what_is_its(void **state)
{
	(void)state;
	apply(RELEASE
	      "ca = ca.pem\npoll_s = 300\nrate_limit_kib = 2000\n[terminal]\n"
	      "name = East gate\ntime_zone = Asia/Phnom_Penh\n[health]\nlisten = [::]:9200\n");
	has("fetch.env", "FETCH_OPTIONS=\" --poll-s 300 --rate-limit 2000 --ca /efi/ca.pem\"\n");
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
	has("network/20-wifi.network", "Type=wlan\n");
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
	static struct faults faults;
	const struct setup setup = { .terminal = &terminal,
				     .faults = &faults,
				     .out = "/proc/nowhere" };

	(void)state;
	terminal = terminal_default;
	CHECK(setup_write(&setup) < 0);
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

static int make_folder(void **state)
{
	(void)state;
	return mkdtemp(out) ? 0 : -1;
}

static int remove_folder(void **state)
{
	char command[300];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf %s", out);
	return system(command);
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(without_a_word_the_cable_is_asked),
		cmocka_unit_test(an_address_of_its_own_has_its_gateway_and_servers),
		cmocka_unit_test(the_fetcher_is_told_what_is_its),
		cmocka_unit_test(a_radio_network_is_named_as_iwd_looks_for_it),
		cmocka_unit_test(the_radio_has_the_address_and_old_networks_go),
		cmocka_unit_test(the_network_is_told_of_the_health_page_where_asked_for),
		cmocka_unit_test(faults_are_written_a_line_each_and_the_rest_holds),
		cmocka_unit_test(says_where_it_cannot_write),
		cmocka_unit_test(every_profile_that_comes_along_is_right),
	};

	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
