/* Builds, opens and reads the master: a file of patch group objects and its index. */
#include "pipeline/hierarchy/master.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/array.h"
#include "base/clock.h"
#include "base/log.h"
#include "pipeline/hierarchy/block_build.h"

/* Raise BUILD_VERSION whenever the same scan would give other bytes. */
enum { BUILD_VERSION = 14, INDEX_VERSION = 2, INDEX_BYTES_MAX = 256 << 20 };

static const uint8_t magic[4] = { 'G', 'P', 'm', 'i' };

struct hash master_stamp(struct hash scans_key, const struct master_options *options)
{
	struct buffer text;
	struct hash stamp;

	buffer_init(&text, 4096);
	buffer_put_u32(&text, BUILD_VERSION);
	buffer_put(&text, scans_key.bytes, sizeof(scans_key.bytes));
	buffer_put_u32(&text, options->multires.kind);
	buffer_put_u32(&text, options->multires.patch_triangles);
	buffer_put_u32(&text, options->multires.group_patches);
	buffer_put_u32(&text, options->multires.top_triangles);
	buffer_put_u32(&text, options->multires.block_triangles);
	buffer_put_f64(&text, options->multires.step_max_m);
	buffer_put_u8(&text, options->material_colours ? (uint8_t)(1 + options->substance) : 0);
	if (options->multires.simplifier != MULTIRES_QUADRIC)
		buffer_put_u32(&text, options->multires.simplifier);
	stamp = hash_of(buffer_bytes(&text));
	buffer_finish(&text);
	return stamp;
}

static int path_in(char out[PATH_MAX], const char *folder, const char *name)
{
	return snprintf(out, PATH_MAX, "%s/%s", folder, name) < PATH_MAX ? 0 : -ENAMETOOLONG;
}

/* kind: "groups", the file of objects, or "blocks", the folder of a build in progress. */
static int stamped_path(char out[PATH_MAX], const char *folder, const char *kind, struct hash stamp)
{
	char hex[HASH_HEX_BYTES], name[HASH_HEX_BYTES + 16];

	hash_to_hex(stamp, hex);
	snprintf(name, sizeof(name), "%s-%s", kind, hex);
	return path_in(out, folder, name);
}

/* ---- building */

struct written {
	uint32_t size;
	float loss_m4;
};

struct writer {
	const char *path; /* borrowed */
	char temporary[BYTES_PATH_MAX];
	int fd;                  /* of the temporary file, once it has an object; negative before */
	struct written *objects; /* owned; in the order in which they are made */
	uint32_t count, room;
};

static int write_object(void *user, struct bytes object, float loss_m4)
{
	struct writer *writer = user;
	size_t done = 0;
	int rc = ARRAY_RESERVE(writer->objects, writer->room, writer->count + 1, UINT32_MAX);

	/* Objects come at the end of long work. A file from its beginning would look as if a killed
	 * build had left it: `build` removes those. */
	if (rc == 0 && writer->fd < 0) {
		writer->fd = bytes_begin_file(writer->temporary, writer->path);
		rc = writer->fd < 0 ? writer->fd : 0;
	}
	if (rc < 0)
		return rc;
	writer->objects[writer->count++] = (struct written){ (uint32_t)object.size, loss_m4 };
	while (done < object.size) {
		ssize_t put = write(writer->fd, object.data + done, object.size - done);

		if (put < 0 && errno != EINTR)
			return -errno;
		if (put > 0)
			done += (size_t)put;
	}
	return 0;
}

static int put_index(struct buffer *out, const struct master *head,
		     const struct hierarchy *hierarchy, const struct writer *writer)
{
	struct buffer payload;
	struct hash hash;
	int rc;

	buffer_put(out, magic, sizeof(magic));
	buffer_put_u32(out, INDEX_VERSION);
	buffer_put(out, head->stamp.bytes, sizeof(head->stamp.bytes));
	for (int i = 0; i < 3; i++)
		buffer_put_f64(out, head->lattice.origin_m[i]);
	buffer_put_f64(out, head->lattice.step_m);
	for (int i = 0; i < 3; i++)
		buffer_put_f32(out, head->box_min_m[i]);
	for (int i = 0; i < 3; i++)
		buffer_put_f32(out, head->box_max_m[i]);
	buffer_put_u64(out, head->source_triangles);
	buffer_init(&payload, INDEX_BYTES_MAX);
	rc = hierarchy_encode(&payload, hierarchy);
	buffer_put_u32(out, (uint32_t)payload.size);
	buffer_put(out, payload.data, payload.size);
	buffer_finish(&payload);
	/* In the order in which they lie in the file: the finest are made first. */
	for (uint32_t i = 0; i < writer->count; i++) {
		buffer_put_u32(out, writer->objects[i].size);
		buffer_put_f32(out, writer->objects[i].loss_m4);
	}
	hash = hash_of(buffer_bytes(out));
	buffer_put(out, hash.bytes, sizeof(hash.bytes));
	return rc < 0 ? rc : out->error;
}

static int write_index(const char *folder, const struct master *head,
		       const struct hierarchy *hierarchy, const struct writer *writer)
{
	char path[PATH_MAX];
	struct buffer index;
	int rc = path_in(path, folder, "index");

	buffer_init(&index, INDEX_BYTES_MAX);
	if (rc == 0)
		rc = put_index(&index, head, hierarchy, writer);
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&index), path);
	buffer_finish(&index);
	return rc;
}

/* Removes what earlier builds left whose names begin with kind, complete or not, but the index and
 * what keep names. */
static void remove_others(const char *folder, const char *kind, const char *keep)
{
	DIR *entries = opendir(folder);
	struct dirent *entry;
	char path[PATH_MAX];

	while (entries && (entry = readdir(entries))) {
		if (entry->d_name[0] == '.' || strcmp(entry->d_name, "index") == 0 ||
		    strncmp(entry->d_name, kind, strlen(kind)) != 0 ||
		    path_in(path, folder, entry->d_name) < 0 || strcmp(path, keep) == 0)
			continue;
		bytes_remove_folder(path);
	}
	if (entries)
		closedir(entries);
}

static void take_report(struct master_report *report, struct master *head,
			const struct block_build *build)
{
	report->counts = build->counts;
	report->stats = build->stats;
	head->lattice = build->lattice;
	memcpy(head->box_min_m, build->box_min_m, sizeof(head->box_min_m));
	memcpy(head->box_max_m, build->box_max_m, sizeof(head->box_max_m));
}

/* Builds into a temporary file and renames it to groups, then writes the index. */
static int build_files(const char *folder, const char *groups, const char *blocks,
		       const struct mesh *mesh, struct hash stamp,
		       const struct master_options *options, struct master_report *report)
{
	struct writer writer = { .path = groups, .fd = -1 };
	const struct multires_sink sink = { write_object, &writer };
	struct master head = { .stamp = stamp, .source_triangles = mesh->triangle_count };
	struct block_build build;
	int rc;

	rc = block_build(&build, blocks, mesh, &options->multires, options->material_colours,
			 options->substance, &sink);
	if (rc == 0 && fsync(writer.fd) < 0)
		rc = -errno;
	if (writer.fd >= 0)
		rc = bytes_end_file(writer.fd, writer.temporary, groups, rc);
	if (rc == 0) {
		take_report(report, &head, &build);
		rc = write_index(folder, &head, &build.hierarchy, &writer);
	}
	block_build_finish(&build);
	free(writer.objects);
	return rc;
}

/* The same; if a file that an interrupted build left is damaged, once more from the beginning. */
static int build_whole_files(const char *folder, const char *groups, const char *blocks,
			     const struct mesh *mesh, struct hash stamp,
			     const struct master_options *options, struct master_report *report)
{
	int rc = build_files(folder, groups, blocks, mesh, stamp, options, report);

	/* What no build can use is not for the next one, which may be that of a better program. */
	if (rc == -EPROTO)
		bytes_remove_folder(blocks);
	if (rc != -EBADMSG)
		return rc;
	log_warn("pipeline", "%s: a file of an interrupted build is damaged; it begins anew",
		 blocks);
	bytes_remove_folder(blocks);
	if (mkdir(blocks, 0777) < 0 && errno != EEXIST)
		return -errno;
	return build_files(folder, groups, blocks, mesh, stamp, options, report);
}

static bool is_complete(const char *folder, struct hash stamp)
{
	struct master *master;
	int rc = master_open(&master, folder, &stamp);

	master_destroy(master);
	return rc == 0;
}

int master_build(const char *folder, const struct mesh *mesh, struct hash stamp,
		 const struct master_options *options, struct master_report *report)
{
	int64_t start_ms = clock_now_ms();
	char groups[PATH_MAX], blocks[PATH_MAX];
	int rc = stamped_path(groups, folder, "groups", stamp);

	*report = (struct master_report){ 0 };
	if (rc == 0)
		rc = stamped_path(blocks, folder, "blocks", stamp);
	if (rc < 0)
		return rc;
	if ((mkdir(folder, 0777) < 0 && errno != EEXIST) ||
	    (mkdir(blocks, 0777) < 0 && errno != EEXIST))
		return -errno;
	/* Blocks of other scans or options may fill the disk. What they were for is not asked for
	 * any more; a complete master stays until this one is. */
	remove_others(folder, "blocks-", blocks);
	rc = build_whole_files(folder, groups, blocks, mesh, stamp, options, report);
	/* Files that vanish were removed by the machine that completed this master. */
	if ((rc == -ENOENT || rc == -ESTALE) && is_complete(folder, stamp))
		rc = 0;
	/* What a killed build has done stays for the next one. Of several, the last to end removes
	 * what it wrote while another was removing. */
	if (rc == 0)
		remove_others(folder, "", groups);
	report->duration_ms = clock_now_ms() - start_ms;
	return rc;
}

void master_drop_leftovers(const char *folder, struct hash stamp)
{
	char groups[PATH_MAX];

	if (stamped_path(groups, folder, "groups", stamp) == 0)
		remove_others(folder, "", groups);
}

/* ---- opening */

static int get_head(struct master *master, struct reader *reader, const struct hash *stamp)
{
	struct bytes start = reader_bytes(reader, sizeof(magic)), name;

	if (reader->failed || memcmp(start.data, magic, sizeof(magic)) != 0)
		return -EBADMSG;
	if (reader_u32(reader) != INDEX_VERSION)
		return -ESTALE;
	name = reader_bytes(reader, HASH_BYTES);
	if (reader->failed)
		return -EBADMSG;
	memcpy(master->stamp.bytes, name.data, HASH_BYTES);
	if (stamp && !hash_equal(*stamp, master->stamp))
		return -ESTALE;
	for (int i = 0; i < 3; i++)
		master->lattice.origin_m[i] = reader_f64(reader);
	master->lattice.step_m = reader_f64(reader);
	for (int i = 0; i < 3; i++)
		master->box_min_m[i] = reader_f32(reader);
	for (int i = 0; i < 3; i++)
		master->box_max_m[i] = reader_f32(reader);
	lattice_fit(&master->lattice, master->box_min_m, master->box_max_m);
	master->source_triangles = reader_u64(reader);
	return reader->failed ? -EBADMSG : 0;
}

static int get_index(struct master *master, struct bytes index, const struct hash *stamp)
{
	struct reader reader;
	struct hash hash;
	uint32_t count;
	int rc;

	if (index.size < HASH_BYTES)
		return -EBADMSG;
	index.size -= HASH_BYTES;
	hash = hash_of(index);
	if (memcmp(hash.bytes, index.data + index.size, HASH_BYTES) != 0)
		return -EBADMSG;
	reader_init(&reader, index);
	rc = get_head(master, &reader, stamp);
	if (rc == 0)
		rc = hierarchy_decode(&master->hierarchy,
				      reader_bytes(&reader, reader_u32(&reader)));
	if (rc < 0)
		return rc;
	count = master->hierarchy.group_count;
	master->places = calloc(count, sizeof(*master->places));
	master->sizes = calloc(count, sizeof(*master->sizes));
	master->losses_m4 = calloc(count, sizeof(*master->losses_m4));
	if (!master->places || !master->sizes || !master->losses_m4)
		return -ENOMEM;
	/* Group 0 was made last and is last in the file. */
	for (uint32_t g = count; g-- > 0;) {
		master->sizes[g] = reader_u32(&reader);
		master->losses_m4[g] = reader_f32(&reader);
		master->places[g] =
			g + 1 < count ? master->places[g + 1] + master->sizes[g + 1] : 0;
	}
	return reader.failed || reader_left(&reader) > 0 ? -EBADMSG : 0;
}

static int open_groups(struct master *master, const char *path)
{
	struct stat file;

	master->fd = open(path, O_RDONLY | O_CLOEXEC);
	if (master->fd < 0 || fstat(master->fd, &file) < 0)
		return -errno;
	/* Group 0 is the last in the file. */
	return (uint64_t)file.st_size == master->places[0] + master->sizes[0] ? 0 : -EBADMSG;
}

int master_open(struct master **out, const char *folder, const struct hash *stamp)
{
	struct master *master = calloc(1, sizeof(*master));
	char path[PATH_MAX];
	struct buffer index;
	int rc = master ? path_in(path, folder, "index") : -ENOMEM;

	*out = NULL;
	if (!master)
		return rc;
	master->fd = -1;
	buffer_init(&index, INDEX_BYTES_MAX);
	if (rc == 0)
		rc = buffer_read_file(&index, path);
	if (rc == 0)
		rc = get_index(master, buffer_bytes(&index), stamp);
	buffer_finish(&index);
	if (rc == 0)
		rc = stamped_path(path, folder, "groups", master->stamp);
	if (rc == 0)
		rc = open_groups(master, path);
	if (rc < 0) {
		master_destroy(master);
		return rc;
	}
	*out = master;
	return 0;
}

void master_destroy(struct master *master)
{
	if (!master)
		return;
	if (master->fd >= 0)
		close(master->fd);
	free(master->places);
	free(master->sizes);
	free(master->losses_m4);
	hierarchy_finish(&master->hierarchy);
	free(master);
}

int master_read_group(const struct master *master, uint32_t group, struct buffer *out)
{
	uint64_t at, size;
	uint8_t *to;

	if (group >= master->hierarchy.group_count)
		return -EINVAL;
	at = master->places[group];
	size = master->sizes[group];
	to = buffer_extend(out, size);
	if (!to)
		return out->error;
	return bytes_read_at(master->fd, to, size, at);
}
