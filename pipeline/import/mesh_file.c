/* Writes and reads mesh files. The reader checks sizes, hash and indices before it trusts
 * anything. */
#include "pipeline/import/mesh_file.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <sodium.h>

#include "base/parallel.h"
#include "base/spill.h"

enum {
	BYTE_ORDER_PROBE = 0x01020304,
	HAS_COLOURS = 1,
	HAS_UVS = 2,
	HAS_MATERIALS = 4,
	HAS_FACES = 8,
	COUNTS = 5,
	CHUNK_BYTES = 1 << 20, /* hashed by one thread */
	ALIGNMENT = 8,         /* of each array in the file */
	HEAD_BYTES_MAX = 1 << 20,
	CHECKED_TRIANGLES = 1 << 16, /* by one thread at a time */
	COPIED_BYTES = 16 << 20,     /* read at a time */
};

static const char magic[8] = { 'g', 'o', 'p', 'm', 'e', 's', 'h', 4 };

static size_t padded(size_t bytes)
{
	return (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
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

/* ---- the hash: of the hashes of the chunks, so that several threads can compute it */

struct hashes {
	uint32_t count;
	uint8_t (*chunks)[HASH_BYTES]; /* owned */
};

static int hashes_init(struct hashes *hashes, uint64_t bytes)
{
	*hashes = (struct hashes){ .count = (uint32_t)((bytes + CHUNK_BYTES - 1) / CHUNK_BYTES) };
	hashes->chunks = calloc((size_t)hashes->count + 1, sizeof(*hashes->chunks));
	return hashes->chunks ? 0 : -ENOMEM;
}

static void hashes_end(struct hashes *hashes, uint8_t digest[HASH_BYTES])
{
	crypto_generichash(digest, HASH_BYTES, hashes->chunks[0],
			   hashes->count * sizeof(*hashes->chunks), NULL, 0);
	free(hashes->chunks);
}

/* ---- writing */

/* Bytes that follow one another in the file. */
struct span {
	uint8_t *data; /* NULL: zeros */
	uint64_t at;   /* from the start of the mesh */
	uint64_t bytes;
};

struct writing {
	int fd;
	off_t from; /* where the mesh starts in the file */
	struct span *spans;
	uint32_t span_count;
	uint64_t bytes;
	bool discards; /* what is written is no longer needed in memory */
	struct hashes hashes;
};

static void add_span(struct writing *writing, void *data, uint64_t bytes)
{
	if (bytes > 0)
		writing->spans[writing->span_count++] =
			(struct span){ data, writing->bytes, bytes };
	writing->bytes += bytes;
}

static void add_array(struct writing *writing, void *data, size_t bytes)
{
	add_span(writing, data, bytes);
	add_span(writing, NULL, padded(bytes) - bytes);
}

static int write_at(int fd, const uint8_t *bytes, size_t size, off_t at)
{
	while (size > 0) {
		ssize_t done = pwrite(fd, bytes, size, at);

		if (done < 0 && errno != EINTR)
			return -errno;
		if (done <= 0)
			continue;
		bytes += done;
		at += done;
		size -= (size_t)done;
	}
	return 0;
}

/* Returns the span that the byte lies in. */
static uint32_t span_at(const struct writing *writing, uint64_t at)
{
	uint32_t low = 0, high = writing->span_count - 1;

	while (low < high) {
		uint32_t middle = (low + high + 1) / 2;

		if (writing->spans[middle].at <= at)
			low = middle;
		else
			high = middle - 1;
	}
	return low;
}

static int write_chunk(void *user, uint32_t chunk, uint32_t worker)
{
	static const uint8_t zeros[ALIGNMENT];
	const struct writing *writing = user;
	const uint64_t first = (uint64_t)chunk * CHUNK_BYTES, left = writing->bytes - first;
	const uint64_t end = first + (left < CHUNK_BYTES ? left : CHUNK_BYTES);
	crypto_generichash_state hash;
	uint64_t at = first;
	int rc = 0;

	(void)worker;
	spill_breathe();
	crypto_generichash_init(&hash, NULL, 0, HASH_BYTES);
	for (uint32_t i = span_at(writing, first); rc == 0 && at < end; i++) {
		const struct span *span = &writing->spans[i];
		const uint64_t span_end = span->at + span->bytes;
		const size_t size = (size_t)((span_end < end ? span_end : end) - at);
		uint8_t *from = span->data ? span->data + (at - span->at) : NULL;
		const uint8_t *data = from ? from : zeros;

		crypto_generichash_update(&hash, data, size);
		rc = write_at(writing->fd, data, size, writing->from + (off_t)at);
		if (from && writing->discards)
			spill_discard(from, size);
		at += size;
	}
	crypto_generichash_final(&hash, writing->hashes.chunks[chunk], HASH_BYTES);
	return rc;
}

static uint32_t flags_of(const struct mesh *mesh)
{
	return (mesh->colours ? HAS_COLOURS : 0u) | (mesh->uvs ? HAS_UVS : 0u) |
	       (mesh->materials ? HAS_MATERIALS : 0u) | (mesh->faces ? HAS_FACES : 0u);
}

/* Everything before the arrays. */
static void encode_head(struct buffer *head, const struct mesh *mesh, struct hash key)
{
	const uint32_t numbers[] = { mesh->vertex_count, mesh->triangle_count, mesh->texture_count,
				     flags_of(mesh), mesh->scan_count };
	const uint32_t probe = BYTE_ORDER_PROBE;

	buffer_put(head, magic, sizeof(magic));
	buffer_put(head, &probe, sizeof(probe));
	buffer_put(head, key.bytes, HASH_BYTES);
	buffer_put(head, numbers, sizeof(numbers));
	for (uint32_t i = 0; i < mesh->scan_count; i++)
		buffer_put(head,
			   (uint32_t[]){ mesh->scans[i].triangle_count, mesh->scans[i].face_count },
			   8);
	for (uint32_t i = 0; i < mesh->texture_count; i++)
		buffer_put(head, (uint32_t[]){ mesh->textures[i].width, mesh->textures[i].height },
			   8);
}

static uint64_t head_bytes(const struct mesh *mesh)
{
	return sizeof(magic) + sizeof(uint32_t) + HASH_BYTES + COUNTS * sizeof(uint32_t) +
	       8 * ((uint64_t)mesh->scan_count + mesh->texture_count);
}

/* The offset is moved behind the mesh. Where the kernel does not tell how many cores there are, as
 * in the sandbox, which has no threads, the caller alone writes. */
static int write_spans(struct writing *writing)
{
	uint8_t digest[HASH_BYTES];
	int rc = hashes_init(&writing->hashes, writing->bytes);

	if (rc < 0)
		return rc;
	rc = parallel_run(parallel_cores(), writing->hashes.count, write_chunk, writing);
	hashes_end(&writing->hashes, digest);
	if (rc == 0)
		rc = write_at(writing->fd, digest, sizeof(digest),
			      writing->from + (off_t)writing->bytes);
	if (rc == 0 && lseek(writing->fd, writing->from + (off_t)(writing->bytes + sizeof(digest)),
			     SEEK_SET) < 0)
		rc = -errno;
	return rc;
}

static int write_mesh(int fd, const struct mesh *mesh, struct hash key, bool discards)
{
	struct writing writing = { .fd = fd, .from = lseek(fd, 0, SEEK_CUR), .discards = discards };
	struct section sections[SECTIONS];
	struct mesh shape = *mesh;
	struct buffer head;
	int rc;

	if (writing.from < 0)
		return -errno;
	writing.spans =
		malloc((1 + 2 * (SECTIONS + (size_t)mesh->texture_count)) * sizeof(*writing.spans));
	buffer_init(&head, HEAD_BYTES_MAX);
	encode_head(&head, mesh, key);
	rc = head.error ? head.error : writing.spans ? 0 : -ENOMEM;
	if (rc == 0) {
		assert(head.size == head_bytes(mesh));
		add_span(&writing, head.data, head.size);
		lay_out(&shape, flags_of(mesh), sections);
		for (int i = 0; i < SECTIONS; i++)
			add_array(&writing, *sections[i].data, sections[i].bytes);
		for (uint32_t i = 0; i < mesh->texture_count; i++)
			add_array(&writing, mesh->textures[i].rgb,
				  texture_bytes(&mesh->textures[i]));
		rc = write_spans(&writing);
	}
	buffer_finish(&head);
	free(writing.spans);
	return rc;
}

int mesh_file_write(int fd, const struct mesh *mesh, struct hash key)
{
	return write_mesh(fd, mesh, key, false);
}

/* Replaces *array by its place in the file if it is large, and moves *offset behind it. */
static int map_large(int fd, uint64_t *offset, void **array, size_t bytes)
{
	if (bytes >= SPILL_MIN_BYTES) {
		void *mapped = spill_map(fd, *offset, bytes);

		if (!mapped)
			return -errno;
		spill_free(*array);
		*array = mapped;
	}
	*offset += padded(bytes);
	return 0;
}

/* Replaces the large arrays, which were discarded, by their places in the file, which starts with
 * the mesh. */
static int map_written(int fd, struct mesh *mesh)
{
	struct section sections[SECTIONS];
	uint64_t offset = head_bytes(mesh);
	int rc = 0;

	lay_out(mesh, flags_of(mesh), sections);
	for (int i = 0; i < SECTIONS && rc == 0; i++)
		rc = map_large(fd, &offset, sections[i].data, sections[i].bytes);
	for (uint32_t i = 0; i < mesh->texture_count && rc == 0; i++)
		rc = map_large(fd, &offset, (void **)&mesh->textures[i].rgb,
			       texture_bytes(&mesh->textures[i]));
	return rc;
}

int mesh_file_save(const struct mesh *mesh, struct hash key, const char *path)
{
	char temporary[BYTES_PATH_MAX];
	int fd = bytes_begin_file(temporary, path);

	if (fd < 0)
		return fd;
	return bytes_end_file(fd, temporary, path, write_mesh(fd, mesh, key, false));
}

int mesh_file_move(struct mesh *mesh, struct hash key, const char *path)
{
	char temporary[BYTES_PATH_MAX];
	int fd = bytes_begin_file(temporary, path), rc;

	if (fd < 0)
		return fd;
	rc = write_mesh(fd, mesh, key, true);
	if (rc == 0)
		rc = map_written(fd, mesh);
	return bytes_end_file(fd, temporary, path, rc);
}

/* ---- reading: allocates only what the file is long enough for */

/* A file that is read; the first error is kept. */
struct stream {
	int fd;
	int error;
	bool maps;              /* large arrays are the file, and read only; else copies */
	uint64_t from, at, end; /* offsets: of the mesh, of the next byte, of the file's end */
};

static int stream_init(struct stream *stream, int fd, bool maps)
{
	struct stat status;
	off_t at = lseek(fd, 0, SEEK_CUR);

	if (at < 0 || fstat(fd, &status) < 0)
		return -errno;
	*stream =
		(struct stream){ .fd = fd, .maps = maps, .from = (uint64_t)at, .at = (uint64_t)at };
	stream->end = status.st_size < at ? stream->at : (uint64_t)status.st_size;
	return 0;
}

static void get(struct stream *stream, void *data, size_t size)
{
	if (!stream->error && size > stream->end - stream->at)
		stream->error = -EBADMSG;
	if (!stream->error)
		stream->error = bytes_read_at(stream->fd, data, size, stream->at);
	if (!stream->error)
		stream->at += size;
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

/* Returns NULL with errno on failure. */
static void *copy_array(int fd, uint64_t offset, size_t bytes)
{
	uint8_t *copy = spill_alloc(bytes);
	int rc = copy ? 0 : -errno;

	for (size_t at = 0, size; rc == 0 && at < bytes; at += size) {
		size = bytes - at < COPIED_BYTES ? bytes - at : COPIED_BYTES;
		rc = bytes_read_at(fd, copy + at, size, offset + at);
		spill_breathe();
	}
	if (rc == 0)
		return copy;
	spill_free(copy);
	errno = -rc;
	return NULL;
}

/* Takes bytes of the file at *offset as *out, and moves *offset behind them. */
static int read_array(const struct stream *stream, uint64_t *offset, void **out, size_t bytes)
{
	*out = (stream->maps ? spill_map : copy_array)(stream->fd, *offset, bytes);
	*offset += padded(bytes);
	return *out ? 0 : -errno;
}

static int read_arrays(struct stream *stream, struct mesh *mesh, uint32_t flags, int64_t left)
{
	uint64_t offset = stream->at;
	struct section sections[SECTIONS];
	int rc = 0;

	lay_out(mesh, flags, sections);
	for (int i = 0; i < SECTIONS; i++)
		left -= (int64_t)padded(sections[i].bytes);
	if (left != HASH_BYTES)
		return -EBADMSG;
	for (int i = 0; i < SECTIONS && rc == 0; i++)
		if (sections[i].bytes > 0 || i == 0 || i == 3)
			rc = read_array(stream, &offset, sections[i].data, sections[i].bytes);
	for (uint32_t i = 0; i < mesh->texture_count && rc == 0; i++)
		rc = read_array(stream, &offset, (void **)&mesh->textures[i].rgb,
				texture_bytes(&mesh->textures[i]));
	stream->at = offset;
	return rc;
}

struct checking {
	const struct stream *stream;
	uint64_t bytes; /* from the start of the mesh */
	struct hashes hashes;
	uint8_t **buffers; /* of each worker, of CHUNK_BYTES; owned */
};

static int check_chunk(void *user, uint32_t chunk, uint32_t worker)
{
	const struct checking *checking = user;
	const uint64_t at = (uint64_t)chunk * CHUNK_BYTES, left = checking->bytes - at;
	const size_t size = left < CHUNK_BYTES ? (size_t)left : CHUNK_BYTES;
	int rc;

	if (!checking->buffers[worker])
		checking->buffers[worker] = malloc(CHUNK_BYTES);
	if (!checking->buffers[worker])
		return -ENOMEM;
	rc = bytes_read_at(checking->stream->fd, checking->buffers[worker], size,
			   checking->stream->from + at);
	if (rc == 0)
		crypto_generichash(checking->hashes.chunks[chunk], HASH_BYTES,
				   checking->buffers[worker], size, NULL, 0);
	return rc;
}

/* Compares the hash of everything before the stream's place with the one that is stored there. */
static int check_hash(struct stream *stream)
{
	const uint32_t jobs = parallel_cores();
	struct checking checking = { .stream = stream, .bytes = stream->at - stream->from };
	uint8_t digest[HASH_BYTES], stored[HASH_BYTES] = { 0 };
	int rc = hashes_init(&checking.hashes, checking.bytes);

	if (rc < 0)
		return rc;
	checking.buffers = calloc(jobs, sizeof(*checking.buffers));
	rc = checking.buffers ? parallel_run(jobs, checking.hashes.count, check_chunk, &checking)
			      : -ENOMEM;
	for (uint32_t i = 0; checking.buffers && i < jobs; i++)
		free(checking.buffers[i]);
	free(checking.buffers);
	hashes_end(&checking.hashes, digest);
	get(stream, stored, sizeof(stored));
	if (rc == 0)
		rc = stream->error;
	return rc == 0 && memcmp(digest, stored, sizeof(digest)) != 0 ? -EBADMSG : rc;
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

static int check_triangles(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	const struct mesh *mesh = user;
	bool sound = true;

	(void)worker;
	spill_breathe();
	for (uint32_t i = first; i < after; i++)
		for (int k = 0; k < 3; k++)
			sound &= mesh->triangles[i][k] < mesh->vertex_count;
	for (uint32_t i = first; mesh->materials && i < after; i++)
		sound &= mesh->materials[i] < mesh->texture_count;
	return sound ? 0 : -EBADMSG;
}

/* The hash detects accidental damage. These checks also catch a file with a correct hash but bad
 * indices. */
static bool is_sound(struct mesh *mesh)
{
	return parallel_ranges(parallel_cores(), mesh->triangle_count, CHECKED_TRIANGLES,
			       check_triangles, mesh) == 0 &&
	       scans_are_sound(mesh);
}

static int read_body(struct stream *stream, struct mesh *mesh, struct hash key)
{
	int64_t left = (int64_t)(stream->end - stream->at);
	uint32_t probe = 0, counts[COUNTS] = { 0 };
	uint8_t start[sizeof(magic)] = { 0 };
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
	if (rc == 0)
		rc = check_hash(stream);
	return rc == 0 && !is_sound(mesh) ? -EBADMSG : rc;
}

static int read_mesh(struct mesh *out, struct hash key, int fd, bool maps)
{
	struct stream stream;
	int rc = stream_init(&stream, fd, maps);

	*out = (struct mesh){ 0 };
	if (rc == 0)
		rc = read_body(&stream, out, key);
	if (rc < 0)
		mesh_finish(out);
	return rc;
}

int mesh_file_read(struct mesh *out, struct hash key, int fd)
{
	return read_mesh(out, key, fd, false);
}

int mesh_file_load(struct mesh *out, struct hash key, const char *path)
{
	int fd = open(path, O_RDONLY | O_CLOEXEC);
	int rc;

	*out = (struct mesh){ 0 };
	if (fd < 0)
		return -errno;
	rc = read_mesh(out, key, fd, true);
	close(fd);
	return rc;
}
