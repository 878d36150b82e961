/* Writes and reads mesh files. The reader checks sizes, hash and indices before it trusts
 * anything. */
#include "pipeline/import/mesh_file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <sodium.h>

#include "base/spill.h"

enum {
	BYTE_ORDER_PROBE = 0x01020304,
	HAS_COLOURS = 1,
	HAS_UVS = 2,
	HAS_MATERIALS = 4,
	HAS_FACES = 8,
	COUNTS = 5,
	CHUNK_BYTES = 1 << 20,
	ALIGNMENT = 8, /* of each array in the file */
};

static const char magic[8] = { 'g', 'o', 'p', 'm', 'e', 's', 'h', 3 };

/* A file and the hash of the bytes that passed through it. The first error is kept. */
struct stream {
	int fd;
	int error;
	crypto_generichash_state hash;
};

static void stream_init(struct stream *stream, int fd)
{
	*stream = (struct stream){ .fd = fd };
	crypto_generichash_init(&stream->hash, NULL, 0, HASH_BYTES);
}

static void put(struct stream *stream, const void *data, size_t size)
{
	const uint8_t *bytes = data;

	while (size > 0 && !stream->error) {
		size_t chunk = size < CHUNK_BYTES ? size : CHUNK_BYTES;
		ssize_t done = write(stream->fd, bytes, chunk);

		if (done < 0 && errno != EINTR)
			stream->error = -errno;
		if (done <= 0)
			continue;
		crypto_generichash_update(&stream->hash, bytes, (size_t)done);
		bytes += done;
		size -= (size_t)done;
		spill_breathe();
	}
}

static size_t padded(size_t bytes)
{
	return (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

static void put_array(struct stream *stream, const void *data, size_t bytes)
{
	static const uint8_t zeros[ALIGNMENT];

	put(stream, data, bytes);
	put(stream, zeros, padded(bytes) - bytes);
}

static void get(struct stream *stream, void *data, size_t size)
{
	uint8_t *bytes = data;

	while (size > 0 && !stream->error) {
		size_t chunk = size < CHUNK_BYTES ? size : CHUNK_BYTES;
		ssize_t done = read(stream->fd, bytes, chunk);

		if (done == 0)
			stream->error = -EBADMSG;
		if (done < 0 && errno != EINTR)
			stream->error = -errno;
		if (done <= 0)
			continue;
		crypto_generichash_update(&stream->hash, bytes, (size_t)done);
		bytes += done;
		size -= (size_t)done;
	}
}

/* The arrays of a mesh, in file order. */
struct section {
	void **data;
	size_t bytes;
};

enum { SECTIONS = 6 };

static void lay_out(struct mesh *mesh, uint32_t flags, struct section sections[SECTIONS])
{
	size_t vertices = mesh->vertex_count, triangles = mesh->triangle_count;

	sections[0] = (struct section){ (void **)&mesh->positions, vertices * 12 };
	sections[1] =
		(struct section){ (void **)&mesh->colours, flags & HAS_COLOURS ? vertices * 4 : 0 };
	sections[2] = (struct section){ (void **)&mesh->uvs, flags & HAS_UVS ? vertices * 8 : 0 };
	sections[3] = (struct section){ (void **)&mesh->triangles, triangles * 12 };
	sections[4] = (struct section){ (void **)&mesh->materials,
					flags & HAS_MATERIALS ? triangles * 2 : 0 };
	sections[5] =
		(struct section){ (void **)&mesh->faces, flags & HAS_FACES ? triangles * 4 : 0 };
}

static size_t texture_bytes(const struct mesh_texture *texture)
{
	return (size_t)texture->width * texture->height * 3;
}

int mesh_file_write(int fd, const struct mesh *mesh, struct hash key)
{
	struct mesh shape = *mesh;
	uint32_t head[5] = { BYTE_ORDER_PROBE };
	uint32_t counts[COUNTS] = { mesh->vertex_count, mesh->triangle_count, mesh->texture_count,
				    (mesh->colours ? HAS_COLOURS : 0u) |
					    (mesh->uvs ? HAS_UVS : 0u) |
					    (mesh->materials ? HAS_MATERIALS : 0u) |
					    (mesh->faces ? HAS_FACES : 0u),
				    mesh->scan_count };
	struct section sections[SECTIONS];
	struct stream stream;
	uint8_t digest[HASH_BYTES];

	stream_init(&stream, fd);
	put(&stream, magic, sizeof(magic));
	put(&stream, head, sizeof(head[0]));
	put(&stream, key.bytes, HASH_BYTES);
	put(&stream, counts, sizeof(counts));
	for (uint32_t i = 0; i < mesh->scan_count; i++)
		put(&stream,
		    (uint32_t[]){ mesh->scans[i].triangle_count, mesh->scans[i].face_count }, 8);
	for (uint32_t i = 0; i < mesh->texture_count; i++)
		put(&stream, (uint32_t[]){ mesh->textures[i].width, mesh->textures[i].height }, 8);
	lay_out(&shape, counts[3], sections);
	for (int i = 0; i < SECTIONS; i++)
		put_array(&stream, *sections[i].data, sections[i].bytes);
	for (uint32_t i = 0; i < mesh->texture_count; i++)
		put_array(&stream, mesh->textures[i].rgb, texture_bytes(&mesh->textures[i]));
	crypto_generichash_final(&stream.hash, digest, sizeof(digest));
	put(&stream, digest, sizeof(digest));
	return stream.error;
}

int mesh_file_save(const struct mesh *mesh, struct hash key, const char *path)
{
	char temporary[BYTES_PATH_MAX];
	int fd = bytes_begin_file(temporary, path);

	if (fd < 0)
		return fd;
	return bytes_end_file(fd, temporary, path, mesh_file_write(fd, mesh, key));
}

/* ---- reading: allocates only what the file is long enough for */

static int64_t bytes_left(int fd)
{
	struct stat status;
	off_t at = lseek(fd, 0, SEEK_CUR);

	if (at < 0 || fstat(fd, &status) < 0)
		return -errno;
	return status.st_size - at;
}

static int read_textures_sizes(struct stream *stream, struct mesh *mesh, int64_t *left)
{
	if ((int64_t)mesh->texture_count * 8 > *left || mesh->texture_count > MESH_TEXTURES_MAX)
		return -EBADMSG;
	mesh->textures = calloc(mesh->texture_count, sizeof(*mesh->textures));
	if (!mesh->textures)
		return -ENOMEM;
	for (uint32_t i = 0; i < mesh->texture_count; i++) {
		uint32_t size[2] = { 0 };

		get(stream, size, sizeof(size));
		mesh->textures[i].width = size[0];
		mesh->textures[i].height = size[1];
		if (stream->error)
			return stream->error;
		if (size[0] == 0 || size[1] == 0 || size[0] > 65535 || size[1] > 65535)
			return -EBADMSG;
		*left -= 8 + (int64_t)padded(texture_bytes(&mesh->textures[i]));
		if (*left < 0)
			return -EBADMSG;
	}
	return 0;
}

/* Hashes size bytes of the file without keeping them. */
static void skip(struct stream *stream, int64_t size)
{
	uint8_t *chunk = malloc(CHUNK_BYTES);

	if (!chunk)
		stream->error = -ENOMEM;
	for (int64_t left = size; left > 0 && !stream->error; left -= CHUNK_BYTES)
		get(stream, chunk, left < CHUNK_BYTES ? (size_t)left : CHUNK_BYTES);
	free(chunk);
}

/* Maps bytes of the file at *offset to *out, and moves *offset behind them. */
static int map_array(int fd, uint64_t *offset, void **out, size_t bytes)
{
	*out = spill_map(fd, *offset, bytes);
	*offset += padded(bytes);
	return *out ? 0 : -errno;
}

static int read_arrays(struct stream *stream, struct mesh *mesh, uint32_t flags, int64_t left)
{
	off_t at = lseek(stream->fd, 0, SEEK_CUR);
	uint64_t offset = (uint64_t)at;
	struct section sections[SECTIONS];
	int rc = 0;

	lay_out(mesh, flags, sections);
	for (int i = 0; i < SECTIONS; i++)
		left -= (int64_t)padded(sections[i].bytes);
	if (at < 0 || left != HASH_BYTES)
		return at < 0 ? -errno : -EBADMSG;
	for (int i = 0; i < SECTIONS && rc == 0; i++)
		if (sections[i].bytes > 0 || i == 0 || i == 3)
			rc = map_array(stream->fd, &offset, sections[i].data, sections[i].bytes);
	for (uint32_t i = 0; i < mesh->texture_count && rc == 0; i++)
		rc = map_array(stream->fd, &offset, (void **)&mesh->textures[i].rgb,
			       texture_bytes(&mesh->textures[i]));
	if (rc == 0)
		skip(stream, (int64_t)offset - at);
	return rc < 0 ? rc : stream->error;
}

static bool scans_are_sound(const struct mesh *mesh)
{
	uint64_t triangles = 0;

	for (uint32_t s = 0; s < mesh->scan_count; s++) {
		uint64_t next = triangles + mesh->scans[s].triangle_count;

		if (next > mesh->triangle_count)
			return false;
		for (uint64_t t = triangles; mesh->faces && t < next; t++)
			if (mesh->faces[t] != MESH_NO_FACE &&
			    mesh->faces[t] >= mesh->scans[s].face_count)
				return false;
		triangles = next;
	}
	return mesh->scan_count == 0 || triangles == mesh->triangle_count;
}

static int read_scans(struct stream *stream, struct mesh *mesh, uint32_t count, int64_t *left)
{
	if (count > MESH_SCANS_MAX)
		return -EBADMSG;
	for (uint32_t s = 0; s < count; s++) {
		uint32_t numbers[2] = { 0 };

		get(stream, numbers, sizeof(numbers));
		mesh->scans[s] = (struct mesh_scan){ numbers[0], numbers[1] };
	}
	mesh->scan_count = count;
	*left -= 8 * (int64_t)count;
	return stream->error;
}

/* The hash detects accidental damage. These checks also catch a file with a correct hash but bad
 * indices. */
static bool is_sound(const struct mesh *mesh)
{
	for (uint32_t i = 0; i < mesh->triangle_count; i++) {
		for (int k = 0; k < 3; k++)
			if (mesh->triangles[i][k] >= mesh->vertex_count)
				return false;
		spill_pass(i);
	}
	for (uint32_t i = 0; mesh->materials && i < mesh->triangle_count; i++)
		if (mesh->materials[i] >= mesh->texture_count)
			return false;
	return scans_are_sound(mesh);
}

static int read_body(struct stream *stream, struct mesh *mesh, struct hash key, int64_t left)
{
	uint32_t probe = 0, counts[COUNTS] = { 0 };
	uint8_t start[sizeof(magic)] = { 0 }, digest[HASH_BYTES], stored[HASH_BYTES] = { 0 };
	struct hash made_from = { { 0 } };
	int rc;

	get(stream, start, sizeof(start));
	get(stream, &probe, sizeof(probe));
	get(stream, made_from.bytes, HASH_BYTES);
	get(stream, counts, sizeof(counts));
	if (stream->error)
		return stream->error;
	if (memcmp(start, magic, sizeof(magic)) != 0 || probe != BYTE_ORDER_PROBE)
		return -EBADMSG;
	if (memcmp(made_from.bytes, key.bytes, HASH_BYTES) != 0)
		return -ESTALE;
	left -= (int64_t)(sizeof(start) + sizeof(probe) + HASH_BYTES + sizeof(counts));
	mesh->vertex_count = counts[0];
	mesh->triangle_count = counts[1];
	mesh->texture_count = counts[2];
	if (!(counts[3] & HAS_UVS) != !(counts[3] & HAS_MATERIALS) ||
	    !(counts[3] & HAS_UVS) != (counts[2] == 0))
		return -EBADMSG;
	rc = read_scans(stream, mesh, counts[4], &left);
	if (rc == 0 && mesh->texture_count)
		rc = read_textures_sizes(stream, mesh, &left);
	if (rc == 0)
		rc = read_arrays(stream, mesh, counts[3], left);
	if (rc < 0)
		return rc;
	crypto_generichash_final(&stream->hash, digest, sizeof(digest));
	get(stream, stored, sizeof(stored));
	if (stream->error || memcmp(digest, stored, sizeof(digest)) != 0 || !is_sound(mesh))
		return -EBADMSG;
	return 0;
}

int mesh_file_read(struct mesh *out, struct hash key, int fd)
{
	struct stream stream;
	int64_t left = bytes_left(fd);
	int rc;

	*out = (struct mesh){ 0 };
	if (left < 0)
		return (int)left;
	stream_init(&stream, fd);
	rc = read_body(&stream, out, key, left);
	if (rc < 0)
		mesh_finish(out);
	return rc;
}

int mesh_file_load(struct mesh *out, struct hash key, const char *path)
{
	int fd = open(path, O_RDONLY | O_CLOEXEC);
	int rc;

	*out = (struct mesh){ 0 };
	if (fd < 0)
		return -errno;
	rc = mesh_file_read(out, key, fd);
	close(fd);
	return rc;
}
