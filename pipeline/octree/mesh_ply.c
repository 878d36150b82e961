/* Writes binary PLY files. */
#include "pipeline/octree/mesh_ply.h"

#include <errno.h>
#include <stdio.h>
#include <unistd.h>

#include "base/bytes.h"
#include "base/spill.h"

enum { CHUNK_BYTES = 1 << 20, VERTEX_BYTES_MAX = 16, FACE_BYTES = 13 };

static int flush(struct buffer *chunk, FILE *file, size_t at_least)
{
	if (chunk->error)
		return chunk->error;
	if (chunk->size < at_least || chunk->size == 0)
		return 0;
	if (fwrite(chunk->data, chunk->size, 1, file) != 1)
		return errno ? -errno : -EIO;
	buffer_clear(chunk);
	return 0;
}

static int write_all(const struct mesh *mesh, FILE *file, struct buffer *chunk)
{
	int rc = 0;

	buffer_print(chunk,
		     "ply\nformat binary_little_endian 1.0\nelement vertex %u\n"
		     "property float x\nproperty float y\nproperty float z\n%s"
		     "element face %u\nproperty list uchar uint vertex_indices\nend_header\n",
		     mesh->vertex_count,
		     mesh->colours ? "property uchar red\nproperty uchar green\n"
				     "property uchar blue\n"
				   : "",
		     mesh->triangle_count);
	for (uint32_t i = 0; i < mesh->vertex_count && rc == 0; i++) {
		for (int k = 0; k < 3; k++)
			buffer_put_f32(chunk, mesh->positions[i][k]);
		if (mesh->colours)
			buffer_put(chunk, mesh->colours[i], 3);
		rc = flush(chunk, file, CHUNK_BYTES);
		spill_pass(i);
	}
	for (uint32_t i = 0; i < mesh->triangle_count && rc == 0; i++) {
		buffer_put_u8(chunk, 3);
		for (int k = 0; k < 3; k++)
			buffer_put_u32(chunk, mesh->triangles[i][k]);
		rc = flush(chunk, file, CHUNK_BYTES);
		spill_pass(i);
	}
	return rc < 0 ? rc : flush(chunk, file, 0);
}

int mesh_ply_write(const struct mesh *mesh, const char *path)
{
	char temporary[BYTES_PATH_MAX];
	struct buffer chunk;
	FILE *file;
	int fd = bytes_begin_file(temporary, path), copy, rc;

	if (fd < 0)
		return fd;
	copy = dup(fd);
	file = copy >= 0 ? fdopen(copy, "wb") : NULL;
	rc = file ? 0 : -errno;
	if (copy >= 0 && !file)
		close(copy);
	buffer_init(&chunk, 2 * CHUNK_BYTES);
	errno = 0;
	if (rc == 0)
		rc = write_all(mesh, file, &chunk);
	if (file && fclose(file) != 0 && rc == 0)
		rc = -errno;
	buffer_finish(&chunk);
	return bytes_end_file(fd, temporary, path, rc);
}
