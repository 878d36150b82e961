/* An empty content folder with the files of publishing. */
#ifndef GOPURA_TESTS_CURATOR_PUBLISH_PUBLISH_FOLDER_H
#define GOPURA_TESTS_CURATOR_PUBLISH_PUBLISH_FOLDER_H

#include <stdio.h>
#include <stdlib.h>

#include "curator/publish/publish_files.h"
#include "tests/check.h"

static char folder[64];

static int start(void **state)
{
	struct diagnostics diagnostics = { 0 };

	(void)state;
	snprintf(folder, sizeof(folder), "/tmp/gopura-publish-XXXXXX");
	CHECK(mkdtemp(folder));
	CHECK(publish_files_make(folder, &diagnostics) == 0);
	return 0;
}

static int stop(void **state)
{
	static const char *const names[] = { "/.curator/publish", "/.curator", "" };
	char path[128];

	(void)state;
	for (unsigned n = 0; n < ARRAY_COUNT(names); n++) {
		snprintf(path, sizeof(path), "%s%s", folder, names[n]);
		bytes_remove_folder(path);
	}
	return 0;
}

#endif
