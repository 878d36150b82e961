/* What gopura.conf says goes under what the command line says; what is wrong with it is told and
 * never stops a start. */
#include "app/settings/provision.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/check.h"

static char folder[] = "/tmp/gopura-provision-XXXXXX";
static char conf_path[64], none_path[64];
static struct provision provision;
static struct options options;
static struct profile profile;

static void write_text(const char *name, const char *text)
{
	char path[64];
	FILE *file;

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	file = fopen(path, "w");
	CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

/* As the command line leaves them that says no more than where the files are. */
static void bare_options(void)
{
	provision_finish(&provision);
	memset(&provision, 0, sizeof(provision));
	options = (struct options){ .conf_paths = { none_path, conf_path },
				    .conf_count = 2,
				    .boards_dir = "board",
				    .wake_min = -1,
				    .loudness = -1 };
	hours_always(&options.hours);
}

static int take(const char *text)
{
	write_text("gopura.conf", text);
	return provision_read(&provision, &options, &profile);
}

static bool is_faulty(const char *text)
{
	for (unsigned i = 0; i < provision.diagnostics.count; i++)
		if (strstr(diagnostics_get(&provision.diagnostics, i)->text, text))
			return true;
	return false;
}

static const char full[] =
	"[terminal]\nlanguage = km\ntime_zone = Asia/Phnom_Penh\nboard = weak-arm\n"
	"[release]\nurl = https://museum.example/temple/\npoll_s = 600\n"
	"download = 22:00-06:00\nca = ca.pem\n"
	"[panel]\nmode = 1280x800@50\nrotation = 270\nhours = 09:00-18:00\nwake_min = 20\n";

static void takes_from_the_file_what_the_command_line_leaves_open(void **state)
{
	char ca[64];

	(void)state;
	bare_options();
	CHECK(take(full) == 0);
	snprintf(ca, sizeof(ca), "%s/ca.pem", folder);
	CHECK(strcmp(provision.path, conf_path) == 0);
	CHECK(strcmp(options.release_url, "https://museum.example/temple/") == 0);
	CHECK(strcmp(options.language, "km") == 0 && options.poll_s == 600);
	CHECK(strcmp(options.ca_path, ca) == 0);
	CHECK(options.width_px == 1280 && options.height_px == 800 && options.hz == 50);
	CHECK(options.download.from_min == 22 * 60 && options.shift);
	CHECK(options.wake_min == 20);
	CHECK(!hours_open_at(&options.hours, &(struct tm){ .tm_hour = 8 }));
	CHECK(hours_open_at(&options.hours, &(struct tm){ .tm_hour = 9 }));
	CHECK(profile.rotation_deg == 270 && profile.texture_mib == 32);
}

static void the_command_line_overrides(void **state)
{
	(void)state;
	bare_options();
	options.release_url = "/media/release";
	options.language = "en";
	options.ca_path = "/etc/ca.pem";
	options.poll_s = 5;
	options.wake_min = 0;
	options.width_px = 640;
	options.height_px = 360;
	options.download = (struct daily){ 60, 120 };
	options.board_path = "board/panel-4k.ini";
	options.budget_triangles = 54321;
	CHECK(hours_parse(&options.hours, "10:00-11:00"));
	CHECK(take(full) == 0);
	CHECK(strcmp(options.release_url, "/media/release") == 0);
	CHECK(strcmp(options.language, "en") == 0 && options.poll_s == 5);
	CHECK(strcmp(options.ca_path, "/etc/ca.pem") == 0);
	CHECK(options.width_px == 640 && options.hz == 0);
	CHECK(options.download.from_min == 60 && options.wake_min == 0);
	CHECK(!hours_open_at(&options.hours, &(struct tm){ .tm_hour = 9 }));
	CHECK(profile.texture_mib == 256 && profile.triangles == 54321);
}

static void the_terminal_has_its_own_time_but_not_against_who_starts_it(void **state)
{
	const time_t noon = 1785326400; /* 2026-07-29 12:00 UTC */
	struct tm local;

	(void)state;
	unsetenv("TZ");
	bare_options();
	CHECK(take(full) == 0);
	CHECK(localtime_r(&noon, &local) && local.tm_hour == 19);
	setenv("TZ", "Europe/Berlin", 1);
	tzset();
	bare_options();
	CHECK(take(full) == 0);
	CHECK(localtime_r(&noon, &local) && local.tm_hour == 14);
}

static void faults_are_told_and_stop_nothing(void **state)
{
	(void)state;
	bare_options();
	CHECK(take("[panel]\nrotation = 90\nmode = 1080p\n[terminal]\nboard = toaster\n"
		   "[release]\nurl = https://a.example/\ntrust = none.json\n") == 0);
	CHECK(provision.diagnostics.count == 3);
	CHECK(is_faulty("line 3: mode") &&
	      is_faulty("line 5: there is no board profile 'toaster'"));
	CHECK(is_faulty("line 8: there is no file none.json"));
	CHECK(profile.rotation_deg == 90 && profile.triangles == profile_default.triangles);
	CHECK(!options.trust_path && options.release_url);
}

static void a_trust_file_that_is_none_is_not_used(void **state)
{
	(void)state;
	write_text("1.json", "{}");
	bare_options();
	CHECK(take("[release]\nurl = https://a.example/\ntrust = 1.json\n") == 0);
	CHECK(provision.diagnostics.count == 1 && is_faulty("1.json is no trust root ("));
	CHECK(!options.trust_path);
}

static void a_broken_profile_of_its_own_stops_nothing_but_one_of_the_command_line_does(void **state)
{
	char path[64];

	(void)state;
	write_text("ill.ini", "[render]\nworkers = 99\ntexture_mib = 32\n");
	bare_options();
	options.boards_dir = folder;
	CHECK(take("[terminal]\nboard = ill\n") == 0);
	CHECK(provision.diagnostics.count == 1 &&
	      is_faulty("the profile of the board 'ill' has faults"));
	CHECK(profile.texture_mib == 32);
	bare_options();
	snprintf(path, sizeof(path), "%s/ill.ini", folder);
	options.board_path = path;
	CHECK(take("[terminal]\nname = x\n") < 0);
}

static void without_a_file_everything_is_as_the_command_line_has_it(void **state)
{
	(void)state;
	unlink(conf_path);
	bare_options();
	CHECK(provision_read(&provision, &options, &profile) == 0);
	CHECK(!provision.path && provision.diagnostics.count == 0 && !options.shift);
	CHECK(options.wake_min == 5);
	CHECK(memcmp(&profile, &profile_default, sizeof(profile)) == 0);
}

static int make_folder(void **state)
{
	(void)state;
	if (!mkdtemp(folder))
		return -1;
	snprintf(conf_path, sizeof(conf_path), "%s/gopura.conf", folder);
	snprintf(none_path, sizeof(none_path), "%s/none.conf", folder);
	write_text("ca.pem", "");
	return 0;
}

static int remove_folder(void **state)
{
	static const char *const names[] = { "gopura.conf", "ca.pem", "1.json", "ill.ini" };
	char path[64];

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		snprintf(path, sizeof(path), "%s/%s", folder, names[i]);
		unlink(path);
	}
	return rmdir(folder);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(takes_from_the_file_what_the_command_line_leaves_open),
		cmocka_unit_test(the_command_line_overrides),
		cmocka_unit_test(the_terminal_has_its_own_time_but_not_against_who_starts_it),
		cmocka_unit_test(faults_are_told_and_stop_nothing),
		cmocka_unit_test(a_trust_file_that_is_none_is_not_used),
		cmocka_unit_test(
			a_broken_profile_of_its_own_stops_nothing_but_one_of_the_command_line_does),
		cmocka_unit_test(without_a_file_everything_is_as_the_command_line_has_it),
	};

	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
