#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "health/verdict.h"
#include "tests/health/snapshots.h"

static struct snapshot snapshot;
static struct verdict verdict;

static int begin(void **state)
{
	(void)state;
	make_well(&snapshot);
	return 0;
}

static int end(void **state)
{
	(void)state;
	snapshot_finish(&snapshot);
	return 0;
}

/* One finding, of that level, whose title says that. */
static bool finds(enum level level, const char *what)
{
	verdict_judge(&verdict, &snapshot);
	return verdict.count == 1 && verdict.level == level && verdict.findings[0].level == level &&
	       strstr(verdict.findings[0].what, what);
}

static bool finds_nothing(void)
{
	verdict_judge(&verdict, &snapshot);
	return verdict.count == 0 && verdict.level == LEVEL_OK;
}

static void a_terminal_that_works_has_no_finding(void **state)
{
	(void)state;
	CHECK(finds_nothing());
}

static void a_program_that_does_not_respond_is_critical_and_its_state_is_told(void **state)
{
	static const struct {
		int rc;
		const char *detail;
	} ways[] = {
		{ -ENOENT, "not running" },    { -ECONNREFUSED, "has exited" },
		{ -ETIMEDOUT, "hangs" },       { -EBADMSG, "not valid" },
		{ -EACCES, "Permission den" },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(ways); i++) {
		buffer_clear(&snapshot.answers[PROGRAM_FETCH].text);
		snapshot.answers[PROGRAM_FETCH].rc = ways[i].rc;
		CHECK(finds(LEVEL_CRITICAL, "download program"));
		CHECK(strstr(verdict.findings[0].detail, ways[i].detail));
		CHECK(strstr(verdict.findings[0].action, "switch the terminal off"));
	}
	set_text(&snapshot, PROGRAM_FETCH, WELL_FETCH);
	buffer_clear(&snapshot.answers[PROGRAM_KIOSK].text);
	snapshot.answers[PROGRAM_KIOSK].rc = -ECONNREFUSED;
	CHECK(finds(LEVEL_CRITICAL, "display program"));
}

static void no_picture_is_ill_after_two_minutes(void **state)
{
	(void)state;
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_picture 1", "gopura_kiosk_picture 0");
	CHECK(finds(LEVEL_CRITICAL, "No picture"));
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_uptime_seconds",
	       "gopura_kiosk_uptime_seconds 100");
	CHECK(finds_nothing());
}

static void no_touchscreen_is_ill_unless_none_was_looked_for(void **state)
{
	(void)state;
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_touch", "gopura_kiosk_touch_devices 0");
	CHECK(finds(LEVEL_CRITICAL, "touchscreen"));
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_touch", "");
	CHECK(finds_nothing());
}

static void a_slow_board_is_told_with_its_reason(void **state)
{
	(void)state;
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_late",
	       "gopura_kiosk_late_frames_total 1001");
	CHECK(finds(LEVEL_WARNING, "smoothly"));
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_gl_info",
	       "gopura_kiosk_gl_info{renderer=\"llvmpipe (LLVM 15)\"} 1");
	CHECK(finds(LEVEL_WARNING, "graphics driver"));
	set_text(&snapshot, PROGRAM_KIOSK, WELL_KIOSK);
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_late", "gopura_kiosk_late_frames_total 300");
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_frames", "gopura_kiosk_frames_total 400");
	CHECK(finds_nothing()); /* too few to judge by */
}

static void a_server_away_for_five_minutes_is_a_remark(void **state)
{
	(void)state;
	change(&snapshot, PROGRAM_FETCH, "gopura_fetch_online", "gopura_fetch_online 0");
	change(&snapshot, PROGRAM_FETCH, "gopura_fetch_offline",
	       "gopura_fetch_offline_since_seconds 1699999800");
	CHECK(finds_nothing());
	change(&snapshot, PROGRAM_FETCH, "gopura_fetch_offline",
	       "gopura_fetch_offline_since_seconds 1699989000");
	CHECK(finds(LEVEL_WARNING, "server does not respond"));
	CHECK(strcmp(verdict.findings[0].detail, "No response for 3 hours.") == 0);
}

static void why_a_server_is_not_reached_is_told(void **state)
{
	static const struct {
		const char *refused_at, *detail;
	} ways[] = {
		{ "1699989060", "No response for 3 hours: certificate has expired." },
		{ "1699980000", "No response for 3 hours." }, /* while it was reached */
	};
	char line[200];

	(void)state;
	change(&snapshot, PROGRAM_FETCH, "gopura_fetch_offline",
	       "gopura_fetch_offline_since_seconds 1699989000");
	for (size_t i = 0; i < ARRAY_COUNT(ways); i++) {
		snprintf(line, sizeof(line),
			 "gopura_fetch_uptime_seconds 90000\ngopura_fetch_refused_at_seconds %s\n"
			 "gopura_fetch_refusal_info{what=\"https://museum/\",why=\"certificate has "
			 "expired\"} 1",
			 ways[i].refused_at);
		change(&snapshot, PROGRAM_FETCH, "gopura_fetch_uptime_seconds", line);
		CHECK(finds(LEVEL_WARNING, "server does not respond"));
		CHECK(strcmp(verdict.findings[0].detail, ways[i].detail) == 0);
		change(&snapshot, PROGRAM_FETCH, "gopura_fetch_refused_at", "");
		change(&snapshot, PROGRAM_FETCH, "gopura_fetch_refusal_info", "");
	}
}

static void a_refusal_is_a_remark_for_a_day(void **state)
{
	static char text[4096];

	(void)state;
	snprintf(text, sizeof(text), "%s%s", WELL_KIOSK,
		 "gopura_kiosk_refused_at_seconds 1699999400\n"
		 "gopura_kiosk_refusal_info{what=\"release.json\",why=\"it has expired\"} 1\n");
	set_text(&snapshot, PROGRAM_KIOSK, text);
	CHECK(finds(LEVEL_WARNING, "rejected"));
	CHECK(strcmp(verdict.findings[0].detail, "release.json, 10 minutes ago: it has expired") ==
	      0);
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_refused_at",
	       "gopura_kiosk_refused_at_seconds 1699913600");
	CHECK(finds_nothing());
}

static void programs_that_do_not_meet_and_a_disk_that_refuses_are_remarks(void **state)
{
	(void)state;
	change(&snapshot, PROGRAM_FETCH, "gopura_fetch_kiosk", "gopura_fetch_kiosk_connected 0");
	CHECK(finds(LEVEL_WARNING, "not connected"));
	set_text(&snapshot, PROGRAM_FETCH, WELL_FETCH);
	change(&snapshot, PROGRAM_FETCH, "gopura_fetch_cache_ref",
	       "gopura_fetch_cache_refused_total 3\n"
	       "gopura_fetch_cache_refused_at_seconds 1699999400");
	CHECK(finds(LEVEL_WARNING, "disk cannot be written"));
	CHECK(strcmp(verdict.findings[0].detail, "3 writes failed, the last one 10 minutes ago.") ==
	      0);
	change(&snapshot, PROGRAM_FETCH, "gopura_fetch_cache_refused_at",
	       "gopura_fetch_cache_refused_at_seconds 1699913600");
	CHECK(finds_nothing()); /* a disk that was full for a while is not worn out */
}

static void heat_and_want_of_memory_have_two_degrees(void **state)
{
	struct machine *m = &snapshot.machine;

	(void)state;
	m->temperature_c = 79.9;
	CHECK(finds_nothing());
	m->temperature_c = 80;
	CHECK(finds(LEVEL_WARNING, "too hot"));
	m->temperature_c = 95;
	CHECK(finds(LEVEL_CRITICAL, "too hot"));
	m->temperature_c = NAN;
	CHECK(finds_nothing());
	m->memory_free_bytes = 0.07 * m->memory_bytes;
	CHECK(finds(LEVEL_WARNING, "Memory"));
	m->memory_free_bytes = 0.02 * m->memory_bytes;
	CHECK(finds(LEVEL_CRITICAL, "Memory"));
	m->memory_free_bytes = m->memory_bytes = NAN;
	CHECK(finds_nothing());
	m->data_free_bytes = 0.04 * m->data_bytes;
	CHECK(finds(LEVEL_WARNING, "disk is nearly full"));
}

static void a_clock_that_nobody_set_is_a_remark_after_a_quarter_of_an_hour(void **state)
{
	(void)state;
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_clock", "gopura_kiosk_clock_trusted 0");
	CHECK(finds(LEVEL_WARNING, "clock"));
	snapshot.machine.uptime_s = 600;
	CHECK(finds_nothing());
}

static void says_days_before_what_must_be_signed_anew(void **state)
{
	static const struct {
		const char *name, *what, *cure;
		int days;
	} files[] = {
		{ "gopura_kiosk_trust_root_expires_at_seconds", "trust root", "next root", 60 },
		{ "gopura_kiosk_trust_release_expires_at_seconds", "release must be signed",
		  "delegate --renew", 30 },
		{ "gopura_kiosk_trust_timestamp_expires_at_seconds", "timestamp is old",
		  "publish --renew", 3 },
	};
	char line[96];

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(files); i++) {
		const long limit_s = NOW_S + files[i].days * 86400;

		snprintf(line, sizeof(line), "%s %ld", files[i].name, limit_s);
		change(&snapshot, PROGRAM_KIOSK, files[i].name, line);
		CHECK(finds_nothing());
		snprintf(line, sizeof(line), "%s %ld", files[i].name, limit_s - 1);
		change(&snapshot, PROGRAM_KIOSK, files[i].name, line);
		CHECK(finds(LEVEL_WARNING, files[i].what));
		CHECK(strstr(verdict.findings[0].detail, " days left."));
		CHECK(strstr(verdict.findings[0].action, files[i].cure));
		snprintf(line, sizeof(line), "%s %d", files[i].name, NOW_S - 3 * 86400);
		change(&snapshot, PROGRAM_KIOSK, files[i].name, line);
		CHECK(finds(LEVEL_WARNING, files[i].what));
		CHECK(strcmp(verdict.findings[0].detail, "Expired 3 days ago.") == 0);
		change(&snapshot, PROGRAM_KIOSK, files[i].name, ""); /* not known */
		CHECK(finds_nothing());
	}
}

static void a_clock_that_nobody_set_judges_no_expiry(void **state)
{
	(void)state;
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_trust_root_expires",
	       "gopura_kiosk_trust_root_expires_at_seconds 1");
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_clock", "gopura_kiosk_clock_trusted 0");
	CHECK(finds(LEVEL_WARNING, "clock"));
}

static void a_restart_is_told_for_an_hour(void **state)
{
	(void)state;
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_starts", "gopura_kiosk_starts_total 3");
	CHECK(finds_nothing());
	change(&snapshot, PROGRAM_KIOSK, "gopura_kiosk_uptime", "gopura_kiosk_uptime_seconds 130");
	CHECK(finds(LEVEL_WARNING, "was restarted"));
	CHECK(strcmp(verdict.findings[0].detail,
		     "2 minutes ago; 2 restarts since the computer started.") == 0);
}

static void data_that_should_be_encrypted_and_is_not_is_a_warning(void **state)
{
	(void)state;
	snprintf(snapshot.machine.data_plain, sizeof(snapshot.machine.data_plain), "No TPM.");
	CHECK(finds(LEVEL_WARNING, "not encrypted"));
	CHECK(strcmp(verdict.findings[0].detail, "No TPM.") == 0);
}

static void an_older_system_than_was_good_here_is_a_warning(void **state)
{
	(void)state;
	snprintf(snapshot.machine.newer, sizeof(snapshot.machine.newer), "v120");
	CHECK(finds(LEVEL_WARNING, "An older system runs"));
	CHECK(strcmp(verdict.findings[0].detail, "The newer one is v120.") == 0);
}

static void a_terminal_without_settings_is_a_warning(void **state)
{
	(void)state;
	snapshot.machine.is_set_up = false;
	CHECK(finds(LEVEL_WARNING, "gopura.conf was not applied"));
	snapshot.machine.slot[0] = '\0'; /* a desk computer, which has none */
	verdict_judge(&verdict, &snapshot);
	CHECK(verdict.count == 0);
}

static void memory_instead_of_the_disk_is_a_warning_and_never_nearly_full(void **state)
{
	(void)state;
	snprintf(snapshot.machine.data_lost, sizeof(snapshot.machine.data_lost), "Unreadable.");
	snapshot.machine.data_free_bytes = 0;
	CHECK(finds(LEVEL_WARNING, "Nothing is stored"));
	CHECK(strcmp(verdict.findings[0].detail, "Unreadable.") == 0);
}

static void each_error_of_gopura_conf_is_a_warning_and_the_worst_comes_first(void **state)
{
	(void)state;
	snprintf(snapshot.machine.faults, sizeof(snapshot.machine.faults),
		 "gopura.conf, line 3: no\n\ngopura.conf, line 9: no");
	snapshot.answers[PROGRAM_FETCH].rc = -ENOENT;
	buffer_clear(&snapshot.answers[PROGRAM_FETCH].text);
	verdict_judge(&verdict, &snapshot);
	CHECK(verdict.count == 3 && verdict.level == LEVEL_CRITICAL);
	CHECK(verdict.findings[0].level == LEVEL_CRITICAL);
	CHECK(strcmp(verdict.findings[1].detail, "gopura.conf, line 3: no") == 0);
	CHECK(strcmp(verdict.findings[2].detail, "gopura.conf, line 9: no") == 0);
}

static void more_faults_than_have_room_leave_what_is_ill(void **state)
{
	(void)state;
	for (int i = 0; i < 100; i++)
		memcpy(snapshot.machine.faults + 6 * i, "again\n", 7);
	snapshot.machine.temperature_c = 99;
	verdict_judge(&verdict, &snapshot);
	CHECK(verdict.count == FINDINGS_MAX && verdict.level == LEVEL_CRITICAL);
	CHECK(strstr(verdict.findings[0].what, "too hot"));
}

static void durations_are_in_the_unit_that_says_most(void **state)
{
	static const struct {
		double seconds;
		const char *text;
	} cases[] = {
		{ 0, "0 seconds" },   { 1.9, "1 second" },     { 119, "119 seconds" },
		{ 120, "2 minutes" }, { 7199, "119 minutes" }, { 7200, "2 hours" },
		{ 172800, "2 days" }, { -5, "0 seconds" },
	};
	char text[40];

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		verdict_duration(text, sizeof(text), cases[i].seconds);
		if (strcmp(text, cases[i].text) != 0)
			fail_msg("%s and not %s", text, cases[i].text);
	}
}

#define CASE(name) cmocka_unit_test_setup_teardown(name, begin, end)

int main(void)
{
	const struct CMUnitTest tests[] = {
		CASE(a_terminal_that_works_has_no_finding),
		CASE(a_program_that_does_not_respond_is_critical_and_its_state_is_told),
		CASE(no_picture_is_ill_after_two_minutes),
		CASE(no_touchscreen_is_ill_unless_none_was_looked_for),
		CASE(a_slow_board_is_told_with_its_reason),
		CASE(a_server_away_for_five_minutes_is_a_remark),
		CASE(why_a_server_is_not_reached_is_told),
		CASE(a_refusal_is_a_remark_for_a_day),
		CASE(programs_that_do_not_meet_and_a_disk_that_refuses_are_remarks),
		CASE(heat_and_want_of_memory_have_two_degrees),
		CASE(a_clock_that_nobody_set_is_a_remark_after_a_quarter_of_an_hour),
		CASE(a_restart_is_told_for_an_hour),
		CASE(says_days_before_what_must_be_signed_anew),
		CASE(a_clock_that_nobody_set_judges_no_expiry),
		CASE(data_that_should_be_encrypted_and_is_not_is_a_warning),
		CASE(memory_instead_of_the_disk_is_a_warning_and_never_nearly_full),
		CASE(each_error_of_gopura_conf_is_a_warning_and_the_worst_comes_first),
		CASE(an_older_system_than_was_good_here_is_a_warning),
		CASE(a_terminal_without_settings_is_a_warning),
		CASE(more_faults_than_have_room_leave_what_is_ill),
		CASE(durations_are_in_the_unit_that_says_most),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
