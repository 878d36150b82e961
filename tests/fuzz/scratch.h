/* A folder of a fuzz target's own, for readers that take a path; removed when the program ends. In
 * memory where the machine has such a place: a target writes thousands of files a second. */
#ifndef GOPURA_TESTS_FUZZ_SCRATCH_H
#define GOPURA_TESTS_FUZZ_SCRATCH_H

#include <fcntl.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/hash.h"

static char scratch[64];

static inline void scratch_remove(void)
{
	char command[80];

	snprintf(command, sizeof(command), "rm -rf %s", scratch);
	if (system(command) != 0)
		abort();
}

/* The first call makes the folder. */
static inline void scratch_begin(void)
{
	if (scratch[0])
		return;
	snprintf(scratch, sizeof(scratch), "%s/gopura-fuzz-XXXXXX",
		 access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
	if (!mkdtemp(scratch) || atexit(scratch_remove) != 0)
		abort();
}

static inline const char *scratch_path(const char *name)
{
	static char path[128];

	snprintf(path, sizeof(path), "%s/%s", scratch, name);
	return path;
}

static inline void scratch_write(const char *name, const uint8_t *data, size_t size)
{
	int fd = open(scratch_path(name), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);

	if (fd < 0 || write(fd, data, size) != (ssize_t)size || close(fd) != 0)
		abort();
}

/* data without its last HASH_BYTES, and the right hash there; owned by the caller. NULL: too short.
 * What stands behind the check of a hash is met only so. is_mesh: the hash of a mesh file
 * (pipeline/import/mesh_file.h) of less than a MiB. */
static inline uint8_t *scratch_sealed(const uint8_t *data, size_t size, bool is_mesh)
{
	uint8_t *copy = size >= HASH_BYTES ? malloc(size) : NULL;
	struct hash seal;

	if (!copy)
		return NULL;
	memcpy(copy, data, size);
	seal = hash_of((struct bytes){ copy, size - HASH_BYTES });
	if (is_mesh)
		seal = hash_of((struct bytes){ seal.bytes, HASH_BYTES });
	memcpy(copy + size - HASH_BYTES, seal.bytes, HASH_BYTES);
	return copy;
}

#endif
