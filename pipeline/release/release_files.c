/* Reads and writes the signed metadata files of a release folder. */
#include "pipeline/release/release_files.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/transient.h"
#include "format/metadata_sign.h"

static int make_path(char path[PATH_MAX], const char *release, const char *name)
{
	return snprintf(path, PATH_MAX, "%s/%s", release, name) < PATH_MAX ? 0 : -ENAMETOOLONG;
}

/* Servers distinguish versions of a file by its size and the second of its modification (ETag,
 * Last-Modified). Two versions within one second would look equal, and a client with the first one
 * would always be told that it is current. So the new file gets a later time than the old one. */
static int make_later(int fd, time_t than_s)
{
	struct timespec times[2] = { { .tv_nsec = UTIME_OMIT } };
	struct stat now;

	if (fstat(fd, &now) < 0)
		return -errno;
	if (now.st_mtim.tv_sec > than_s)
		return 0;
	times[1].tv_sec = than_s + 1;
	return futimens(fd, times) < 0 ? -errno : 0;
}

/* A file that is complete beside its place and not yet renamed to it. */
struct pending {
	char path[PATH_MAX], temporary[BYTES_PATH_MAX];
	int fd; /* -1: there is none */
};

/* Writes what is to replace a file. *out is to be ended by replace, also on failure. */
static int prepare(struct pending *out, const char *release, const char *name, struct bytes bytes)
{
	struct stat before;
	int rc = make_path(out->path, release, name);

	out->fd = -1;
	if (rc == 0) {
		bytes_drop_leftovers(out->path); /* of a publisher that was killed */
		out->fd = bytes_begin_file(out->temporary, out->path);
		rc = out->fd < 0 ? out->fd : bytes_fill_file(out->fd, bytes);
	}
	if (rc == 0 && stat(out->path, &before) == 0)
		rc = make_later(out->fd, before.st_mtim.tv_sec);
	if (rc < 0)
		log_error("pipeline", "%s/%s: %s", release, name, strerror(-rc));
	return rc;
}

/* Replaces the file; if rc is negative, only drops what was prepared and returns rc. */
static int replace(struct pending *file, int rc)
{
	int ended = file->fd < 0 ? 0 : bytes_end_file(file->fd, file->temporary, file->path, rc);

	if (ended < 0 && rc == 0)
		log_error("pipeline", "%s: %s", file->path, strerror(-ended));
	return rc < 0 ? rc : ended;
}

int release_files_put(const char *release, const char *name, struct bytes bytes)
{
	struct pending file;
	int rc = replace(&file, prepare(&file, release, name, bytes));

	return rc < 0 ? rc : bytes_sync_folder_of(file.path);
}

/* Returns 0 if a release key of an earlier root signed the release, -EKEYREJECTED if none did, or
 * what says neither. */
static int check_earlier(struct release *out, const char *keys_folder, uint32_t newest,
			 struct bytes release_file)
{
	struct trust_root earlier;
	struct buffer file;
	int rc = -EKEYREJECTED;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	for (uint32_t version = newest; rc < 0 && !is_transient(rc) && --version > 0;) {
		rc = keys_read_root(&file, keys_folder, version);
		if (rc == 0)
			rc = trust_root_first(&earlier, buffer_bytes(&file), NULL);
		if (rc == 0)
			rc = release_decode(out, &earlier, release_file, NULL);
	}
	buffer_finish(&file);
	return rc == 0 || is_transient(rc) ? rc : -EKEYREJECTED;
}

static int read_release(struct release *out, const char *release, const char *name,
			const char *keys_folder, const struct publisher_keys *keys)
{
	const char *why = "cannot be read";
	char path[PATH_MAX];
	struct buffer file;
	int rc = make_path(path, release, name);

	*out = (struct release){ 0 };
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	if (rc == 0)
		rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = release_decode(out, &keys->trust, buffer_bytes(&file), &why);
	if (rc == -EKEYREJECTED) {
		rc = check_earlier(out, keys_folder, keys->trust.version, buffer_bytes(&file));
		why = strerror(-rc);
		if (rc == 0) {
			log_warn("pipeline",
				 "%s: signed with a release.key that was exchanged since, so only "
				 "its number counts",
				 path);
			rc = -ENOENT;
		}
	}
	buffer_finish(&file);
	if (rc == -EKEYREJECTED)
		log_error(
			"pipeline",
			"%s: not signed with the keys of this content folder; publish into another "
			"folder (--out), or bring the keys it was made with",
			path);
	else if (rc < 0 && rc != -ENOENT)
		log_error("pipeline", "%s: %s", path, why);
	return rc;
}

int release_files_current(struct release *out, const char *release, const char *keys_folder,
			  const struct publisher_keys *keys)
{
	const int rc = keys_check_release(keys, release);

	*out = (struct release){ 0 };
	return rc < 0 ? rc : read_release(out, release, "release.json", keys_folder, keys);
}

int release_files_at(struct release *out, const char *release, const char *keys_folder,
		     const struct publisher_keys *keys, uint64_t sequence)
{
	char name[64];

	snprintf(name, sizeof(name), "history/%" PRIu64 ".json", sequence);
	return read_release(out, release, name, keys_folder, keys);
}

int release_files_before(struct release *out, const char *release, const char *keys_folder,
			 const struct publisher_keys *keys, const struct release *current)
{
	for (uint64_t sequence = current->sequence; sequence-- > 1;) {
		int rc = release_files_at(out, release, keys_folder, keys, sequence);

		if (rc == 0 && !hash_equal(out->root, current->root))
			return 0;
		if (rc < 0 && rc != -ENOENT)
			return rc;
	}
	return -ENOENT;
}

int release_files_issued_s(int64_t *out, const char *release, const struct publisher_keys *keys)
{
	struct timestamp timestamp = { 0 };
	char path[PATH_MAX];
	struct buffer file;
	int rc = make_path(path, release, "timestamp.json");

	*out = 0;
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	if (rc == 0)
		rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = timestamp_decode(&timestamp, &keys->trust, buffer_bytes(&file), NULL);
	buffer_finish(&file);
	if (is_transient(rc))
		log_error("pipeline", "%s: %s", path, strerror(-rc));
	else if (rc == 0)
		*out = timestamp.issued_s;
	return is_transient(rc) ? rc : 0;
}

static int make_folders(const char *release)
{
	static const char *const names[] = { "root", "history" };

	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		char path[PATH_MAX];
		int rc = make_path(path, release, names[i]);

		if (rc == 0 && mkdir(path, 0755) < 0 && errno != EEXIST)
			rc = -errno;
		if (rc < 0) {
			log_error("pipeline", "%s/%s: %s", release, names[i], strerror(-rc));
			return rc;
		}
	}
	return 0;
}

static int copy_roots(const char *release, const char *keys_folder, uint32_t newest)
{
	struct buffer file;
	int rc = 0;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	for (uint32_t version = 1; rc == 0 && version <= newest; version++) {
		char name[32];

		snprintf(name, sizeof(name), "root/%u.json", version);
		rc = keys_read_root(&file, keys_folder, version);
		if (rc == 0)
			rc = release_files_put(release, name, buffer_bytes(&file));
	}
	buffer_finish(&file);
	return rc;
}

/* Prepares the timestamp that names a release.json of these bytes. */
static int prepare_timestamp(struct pending *out, const char *release,
			     const struct publisher_keys *keys, uint64_t sequence,
			     struct bytes release_file, int64_t life_s)
{
	const int64_t now_s = clock_wall_s();
	struct timestamp timestamp = { .sequence = sequence,
				       .expires_s = now_s + life_s,
				       .issued_s = now_s,
				       .release = hash_of(release_file) };
	struct buffer file;
	int rc;

	out->fd = -1;
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	rc = timestamp_encode(&file, &timestamp, &keys->timestamp, 1);
	if (rc == 0)
		rc = prepare(out, release, "timestamp.json", buffer_bytes(&file));
	buffer_finish(&file);
	return rc;
}

/* Reads the file that is to be replaced; nothing if there is none. */
static int read_before(struct buffer *out, const char *path)
{
	const int rc = buffer_read_file(out, path);

	if (rc == 0 || rc == -ENOENT)
		return 0;
	log_error("pipeline", "%s: %s", path, strerror(-rc));
	return rc;
}

/* Puts the file back that was replaced, or removes the new one if there was none. */
static void take_back(const char *release, const struct pending *file, struct bytes before)
{
	int rc = 0;

	if (before.size > 0)
		rc = release_files_put(release, "release.json", before);
	else if (unlink(file->path) < 0)
		rc = -errno;
	if (rc < 0)
		log_error("pipeline",
			  "%s: %s; timestamp.json names another one until the next "
			  "publication",
			  file->path, strerror(-rc));
}

/* Replaces release.json and the timestamp that names it. Both are complete before, so neither a
 * full disk nor, but for the moment between two renames, a kill leaves one without the other; nor
 * does a rename that fails. */
static int replace_both(const char *release, const struct publisher_keys *keys, uint64_t sequence,
			struct bytes release_file, int64_t timestamp_life_s)
{
	struct pending first, second = { .fd = -1 };
	struct buffer before;
	int rc = prepare(&first, release, "release.json", release_file);

	buffer_init(&before, METADATA_FILE_BYTES_MAX);
	if (rc == 0)
		rc = prepare_timestamp(&second, release, keys, sequence, release_file,
				       timestamp_life_s);
	if (rc == 0)
		rc = read_before(&before, first.path);
	rc = replace(&first, rc);
	const bool is_new = rc == 0;
	rc = replace(&second, rc);
	if (is_new && rc < 0)
		take_back(release, &first, buffer_bytes(&before));
	buffer_finish(&before);
	return rc < 0 ? rc : bytes_sync_folder_of(second.path);
}

int release_files_write(const char *release, const char *keys_folder,
			const struct publisher_keys *keys, const struct release *what,
			int64_t timestamp_life_s)
{
	struct buffer file;
	char name[64];
	int rc = make_folders(release);

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	if (rc == 0)
		rc = copy_roots(release, keys_folder, keys->trust.version);
	if (rc == 0)
		rc = release_encode(&file, what, &keys->release, 1);
	snprintf(name, sizeof(name), "history/%" PRIu64 ".json", what->sequence);
	if (rc == 0)
		rc = release_files_put(release, name, buffer_bytes(&file));
	if (rc == 0)
		rc = replace_both(release, keys, what->sequence, buffer_bytes(&file),
				  timestamp_life_s);
	buffer_finish(&file);
	return rc;
}

int release_files_renew(const char *release, const char *keys_folder,
			const struct publisher_keys *keys, int64_t timestamp_life_s)
{
	struct pending timestamp = { .fd = -1 };
	struct release current;
	char path[PATH_MAX];
	struct buffer file;
	int rc = release_files_current(&current, release, keys_folder, keys);

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	if (rc == 0)
		rc = copy_roots(release, keys_folder, keys->trust.version);
	if (rc == 0)
		rc = make_path(path, release, "release.json");
	if (rc == 0)
		rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = prepare_timestamp(&timestamp, release, keys, current.sequence,
				       buffer_bytes(&file), timestamp_life_s);
	rc = replace(&timestamp, rc);
	buffer_finish(&file);
	return rc < 0 ? rc : bytes_sync_folder_of(timestamp.path);
}
