/* A build does nothing only where nothing has changed since the last one read its files. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/build.h"
#include "tests/check.h"
#include "tests/pipeline/temple_folder.h"

/* Builds what *content says, and releases it. Returns whether nothing had changed. */
static bool nothing_changed(struct content *content)
{
	const struct build_options options = { .keys = temple.keys };
	struct build_report report;

	CHECK(build_content(&report, content, &options) == 0);
	content_release(content);
	return report.nothing_changed;
}

static bool nothing_changed_now(void)
{
	struct content content;

	temple_read(&content);
	return nothing_changed(&content);
}

static void settings_that_change_after_they_were_read_are_built_next(void **state)
{
	struct content content;

	(void)state;
	CHECK(!nothing_changed_now() && nothing_changed_now());
	temple_put("temple.ini", TEMPLE_INI "[view]\ntools = light\n");
	temple_read(&content);
	temple_put("temple.ini", TEMPLE_INI "[view]\ntools = section\n");
	CHECK(!nothing_changed(&content));
	CHECK(!nothing_changed_now() && nothing_changed_now());
}

static void a_file_that_changes_in_a_folder_within_one_is_seen(void **state)
{
	char path[128];

	(void)state;
	snprintf(path, sizeof(path), "%s/pictures", temple.folder);
	CHECK(mkdir(path, 0755) == 0);
	snprintf(path, sizeof(path), "%s/pictures/east", temple.folder);
	CHECK(mkdir(path, 0755) == 0);
	temple_put("pictures/east/gate.jpg", "x");
	CHECK(!nothing_changed_now() && nothing_changed_now());
	temple_put("pictures/east/gate.jpg", "xx");
	CHECK(!nothing_changed_now() && nothing_changed_now());
}

/* An archive of photographs, of which pages show some. */
static void thousands_of_pictures_are_no_hindrance(void **state)
{
	enum { PICTURES = 20000 };
	char path[400], name[200];

	(void)state;
	memset(name, 'x', sizeof(name) - 1);
	name[sizeof(name) - 1] = '\0';
	snprintf(path, sizeof(path), "%s/pictures", temple.folder);
	CHECK(mkdir(path, 0755) == 0 || errno == EEXIST);
	snprintf(path, sizeof(path), "%s/pictures/archive", temple.folder);
	CHECK(mkdir(path, 0755) == 0);
	for (int i = 0; i < PICTURES; i++) {
		snprintf(path, sizeof(path), "%s/pictures/archive/%s-%d.jpg", temple.folder, name,
			 i);
		CHECK(mknod(path, S_IFREG | 0644, 0) == 0);
	}
	CHECK(!nothing_changed_now() && nothing_changed_now());
}

/* `publish` warns of others. */
static void samples_by_either_kind_of_hierarchy_are_those_of_today(void **state)
{
	struct content content;
	struct scans *scans;

	(void)state;
	temple_read(&content);
	content.binary_tree = true;
	CHECK(!nothing_changed(&content));
	temple_read(&content);
	CHECK(!content.binary_tree && scans_create(&scans, &content) == 0);
	CHECK(build_is_current(scans));
	content.sun[0] = -content.sun[0];
	CHECK(!build_is_current(scans));
	scans_destroy(scans);
	content_release(&content);
}

static void keys_that_cannot_publish_are_told_before_the_long_work(void **state)
{
	const struct build_options options = { .keys = temple.keys };
	struct build_report report;
	struct content content;
	char command[200];

	(void)state;
	(void)nothing_changed_now();
	snprintf(command, sizeof(command), "rm -r '%s'", temple.keys);
	CHECK(system(command) == 0); /* others are made */
	temple_put("temple.ini", TEMPLE_INI "[hierarchy]\npatch_triangles = 300\n");
	temple_read(&content);
	CHECK(build_content(&report, &content, &options) == -EKEYREJECTED);
	CHECK(!report.stages[BUILD_HIERARCHY].name);
	content_release(&content);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(settings_that_change_after_they_were_read_are_built_next),
		cmocka_unit_test(a_file_that_changes_in_a_folder_within_one_is_seen),
		cmocka_unit_test(thousands_of_pictures_are_no_hindrance),
		cmocka_unit_test(samples_by_either_kind_of_hierarchy_are_those_of_today),
		cmocka_unit_test(keys_that_cannot_publish_are_told_before_the_long_work),
	};

	return cmocka_run_group_tests(tests, temple_make, temple_remove);
}
