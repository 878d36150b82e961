/* Runs a fuzz target over its corpus without a fuzzing engine: each file as it is, truncations of
 * it, and seeded mutations; of a large corpus fewer of both. The same target links to libFuzzer as
 * it is (make fuzz). */
#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "tests/close_once.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MUTATIONS_PER_FILE = 200, TRUNCATIONS_MAX = 600, RUNS_MAX = 4000 };

static size_t mutations = MUTATIONS_PER_FILE, truncations = TRUNCATIONS_MAX, runs;

static uint32_t random_state = 1;

static uint32_t random_next(void)
{
	random_state ^= random_state << 13;
	random_state ^= random_state >> 17;
	random_state ^= random_state << 5;
	return random_state;
}

/* In an allocation of its exact size, so that the sanitizer sees one byte too far. */
static void run_exact(const uint8_t *data, size_t size)
{
	uint8_t *exact = malloc(size ? size : 1);

	if (!exact)
		abort();
	if (size)
		memcpy(exact, data, size);
	LLVMFuzzerTestOneInput(exact, size);
	runs++;
	free(exact);
}

static void run_mutated(const uint8_t *data, size_t size)
{
	uint8_t *copy = malloc(size);

	if (!copy)
		abort();
	memcpy(copy, data, size);
	for (uint32_t n = 1 + random_next() % 4; n > 0; n--) {
		static const uint8_t extreme[] = { 0x00, 0x7f, 0x80, 0xff };
		size_t at = random_next() % (random_next() % 2 && size > 64 ? 64 : size);

		if (random_next() % 2)
			copy[at] ^= (uint8_t)(1u << random_next() % 8);
		else
			copy[at] = extreme[random_next() % 4];
	}
	run_exact(copy, size);
	free(copy);
}

static void run_file(const char *path)
{
	struct buffer file;

	buffer_init(&file, 64 << 20);
	if (buffer_read_file(&file, path) < 0) {
		fprintf(stderr, "cannot read %s\n", path);
		exit(1);
	}
	run_exact(file.data, file.size);
	for (size_t n = 0; n < file.size && n < truncations; n++)
		run_exact(file.data, file.size <= truncations ? n : random_next() % file.size);
	for (size_t n = 0; n < mutations && file.size; n++)
		run_mutated(file.data, file.size);
	buffer_finish(&file);
}

static void run_folder(DIR *folder, const char *name)
{
	struct dirent *entry;

	while ((entry = readdir(folder))) {
		char path[PATH_MAX];

		if (entry->d_name[0] == '.')
			continue;
		snprintf(path, sizeof(path), "%s/%s", name, entry->d_name);
		run_file(path);
	}
}

static size_t count_files(DIR *folder)
{
	struct dirent *entry;
	size_t count = 0;

	while ((entry = readdir(folder)))
		count += entry->d_name[0] != '.';
	rewinddir(folder);
	return count;
}

/* Shared fairly among the files of a folder. */
static void limit_runs(size_t files)
{
	const size_t each = RUNS_MAX / (files ? files : 1);

	mutations = each / 4 < MUTATIONS_PER_FILE ? each / 4 + 1 : MUTATIONS_PER_FILE;
	truncations = each * 3 / 4 < TRUNCATIONS_MAX ? each * 3 / 4 + 1 : TRUNCATIONS_MAX;
}

int main(int argc, char **argv)
{
	size_t files = 0;

	for (int i = 1; i < argc; i++) {
		DIR *folder = opendir(argv[i]);

		if (!folder && errno != ENOTDIR) {
			fprintf(stderr, "%s: %s\n", argv[i], strerror(errno));
			return 1;
		}
		if (!folder) { /* a single file is to be reproduced: as it is */
			mutations = truncations = 0;
			run_file(argv[i]);
			files++;
			continue;
		}
		files += count_files(folder);
		limit_runs(count_files(folder));
		run_folder(folder, argv[i]);
		closedir(folder);
	}
	printf("%zu corpus files, %zu runs\n", files, runs);
	return files > 0 ? 0 : 1;
}
