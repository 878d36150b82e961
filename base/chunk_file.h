/* A large file that is written from its begin to its end, and replaces one of that name only when
 * it is complete. */
#ifndef GOPURA_BASE_CHUNK_FILE_H
#define GOPURA_BASE_CHUNK_FILE_H

#include "base/bytes.h"

struct chunk_file {
	struct buffer
		chunk; /* append to it what comes next, at most 1 MiB before each call below */
	const char *path;
	char temporary[BYTES_PATH_MAX];
	int fd, error; /* error: the first one, a negative errno; 0: none */
};

/* Begins to replace a file; path is borrowed until the end. An error is told at the end. */
void chunk_file_begin(struct chunk_file *file, const char *path);
/* Writes the chunk once it is large. Returns whether there was no error so far. */
bool chunk_file_pass(struct chunk_file *file);
/* Writes what is left, to the disk itself, and gives the file its name. Returns 0 or the first
 * error; then the file that was there is as before. */
must_check int chunk_file_end(struct chunk_file *file);

#endif
