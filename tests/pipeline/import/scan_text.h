/* Small scans written to temporary files. */
#ifndef GOPURA_TESTS_PIPELINE_IMPORT_SCAN_TEXT_H
#define GOPURA_TESTS_PIPELINE_IMPORT_SCAN_TEXT_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* path is filled with the name of a new file in a new folder; the file is called name. */
static inline void scan_write(char path[256], const char *name, const void *data, size_t size)
{
	char folder[] = "/tmp/gopura-scan-XXXXXX";
	FILE *file;

	if (!mkdtemp(folder))
		abort();
	snprintf(path, 256, "%s/%s", folder, name);
	file = fopen(path, "wb");
	if (!file || (size && fwrite(data, size, 1, file) != 1) || fclose(file) != 0)
		abort();
}

/* Another file beside the one of path. */
static inline void scan_write_beside(const char *path, const char *name, const void *data,
				     size_t size)
{
	char other[512];
	FILE *file;

	snprintf(other, sizeof(other), "%.*s%s", (int)(strrchr(path, '/') - path) + 1, path, name);
	file = fopen(other, "wb");
	if (!file || (size && fwrite(data, size, 1, file) != 1) || fclose(file) != 0)
		abort();
}

static inline void scan_remove(const char *path)
{
	char command[512];

	snprintf(command, sizeof(command), "rm -rf '%.*s'", (int)(strrchr(path, '/') - path), path);
	if (system(command) != 0)
		abort();
}

#endif
