/* Collects a mebibyte before it writes. */
#include "base/chunk_file.h"

#include <errno.h>
#include <unistd.h>

enum { CHUNK_BYTES = 1 << 20 };

void chunk_file_begin(struct chunk_file *file, const char *path)
{
	buffer_init(&file->chunk, 2 * CHUNK_BYTES);
	file->path = path;
	file->fd = bytes_begin_file(file->temporary, path);
	file->error = file->fd < 0 ? file->fd : 0;
}

static void write_out(struct chunk_file *file)
{
	if (file->error == 0)
		file->error = file->chunk.error;
	if (file->error == 0)
		file->error = bytes_write_to(file->fd, buffer_bytes(&file->chunk));
	buffer_clear(&file->chunk);
}

bool chunk_file_pass(struct chunk_file *file)
{
	if (file->chunk.size >= CHUNK_BYTES || file->chunk.error)
		write_out(file);
	return file->error == 0;
}

int chunk_file_end(struct chunk_file *file)
{
	write_out(file);
	if (file->error == 0 && fsync(file->fd) < 0)
		file->error = -errno;
	buffer_finish(&file->chunk);
	return file->fd < 0 ? file->error
			    : bytes_end_file(file->fd, file->temporary, file->path, file->error);
}
