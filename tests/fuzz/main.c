/* Runs a fuzz target over its corpus without a fuzzing engine: each file as it is, every
 * truncation of small files, and seeded mutations. The same target links to libFuzzer as it is. */
#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MUTATIONS_PER_FILE = 200, TRUNCATIONS_MOST = 600 };

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
	for (size_t n = 0; n < file.size && n < TRUNCATIONS_MOST; n++)
		run_exact(file.data, file.size <= TRUNCATIONS_MOST ? n : random_next() % file.size);
	for (int n = 0; n < MUTATIONS_PER_FILE && file.size; n++)
		run_mutated(file.data, file.size);
	buffer_finish(&file);
}

int main(int argc, char **argv)
{
	int files = 0;

	for (int i = 1; i < argc; i++) {
		DIR *folder = opendir(argv[i]);
		struct dirent *entry;

		if (!folder) {
			if (errno != ENOTDIR) {
				fprintf(stderr, "%s: %s\n", argv[i], strerror(errno));
				return 1;
			}
			run_file(argv[i]);
			files++;
			continue;
		}
		while ((entry = readdir(folder))) {
			char path[PATH_MAX];

			if (entry->d_name[0] == '.')
				continue;
			snprintf(path, sizeof(path), "%s/%s", argv[i], entry->d_name);
			run_file(path);
			files++;
		}
		closedir(folder);
	}
	printf("%d corpus files\n", files);
	return files > 0 ? 0 : 1;
}
