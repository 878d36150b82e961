/* Reads metadata, locators and objects from a mounted stick. It uses only regular files and never
 * follows links. */
#include "net/stick_reader.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/safe_open.h"
#include "base/transient.h"

enum {
	LOCATOR_BYTES_MAX = 64 << 20,
	NAME_BYTES = MESSAGE_NAME_MAX + 16,
	LOOKS_AGAIN_MAX = 16,
};

int stick_reader_init(struct stick_reader *reader, const char *folder)
{
	*reader = (struct stick_reader){ .folder = strdup(folder), .below = "", .pack_fd = -1 };
	buffer_init(&reader->stamp, MESSAGE_META_BYTES_MAX);
	buffer_init(&reader->file, LOCATOR_BYTES_MAX);
	return reader->folder ? 0 : -ENOMEM;
}

/* Frees everything that was read from the previous stick. */
static void close_files(struct stick_reader *reader)
{
	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++) {
		locator_finish(&reader->releases[i].locator);
		reader->releases[i] = (struct stick_release){ 0 };
	}
	if (reader->pack_fd >= 0)
		close(reader->pack_fd);
	reader->pack_fd = -1;
}

void stick_reader_finish(struct stick_reader *reader)
{
	if (!reader->folder)
		return;
	close_files(reader);
	buffer_finish(&reader->stamp);
	buffer_finish(&reader->file);
	free((char *)reader->folder);
	*reader = (struct stick_reader){ .pack_fd = -1 };
}

void stick_reader_forget(struct stick_reader *reader)
{
	reader->reports_again = true;
}

/* ---- files */

/* Makes the next look report everything again after a transient failure, a few times a stick. */
static void look_again(struct stick_reader *reader, int rc)
{
	if (is_transient(rc) && reader->looks_again++ < LOOKS_AGAIN_MAX)
		stick_reader_forget(reader);
}

static int open_file(const struct stick_reader *reader, const char *name)
{
	char whole[NAME_BYTES + 16];

	snprintf(whole, sizeof(whole), "%s%s", reader->below, name);
	return open_beneath(reader->folder, whole);
}

/* Reads a file into reader->file. */
static int read_file(struct stick_reader *reader, const char *name, size_t ceiling)
{
	struct stat info;
	int fd = open_file(reader, name), rc;
	uint8_t *to;

	if (fd < 0)
		return fd;
	buffer_clear(&reader->file);
	rc = fstat(fd, &info) < 0 ? -errno : 0;
	if (rc == 0 && (info.st_size <= 0 || (uint64_t)info.st_size > ceiling))
		rc = -EFBIG;
	to = rc == 0 ? buffer_extend(&reader->file, (size_t)info.st_size) : NULL;
	if (rc == 0)
		rc = to ? bytes_read_at(fd, to, (size_t)info.st_size, 0) : reader->file.error;
	close(fd);
	return rc;
}

static int read_stamp(struct stick_reader *reader, bool tuf)
{
	static const char *const below[] = { "", "release/" };
	int rc = -ENOENT;

	for (size_t i = 0; rc < 0 && i < ARRAY_COUNT(below); i++) {
		reader->below = below[i];
		rc = read_file(reader, tuf ? "tuf/timestamp.json" : "timestamp.json",
			       MESSAGE_META_BYTES_MAX);
	}
	return rc;
}

/* ---- metadata */

/* Appends the file that was read last to the list. */
static int add_file(const struct stick_reader *reader, struct stick_file *files, size_t *count,
		    enum meta_role role, uint32_t version)
{
	struct stick_file *file = &files[*count];

	*file = (struct stick_file){ .role = role, .version = version };
	buffer_init(&file->bytes, MESSAGE_META_BYTES_MAX);
	buffer_put(&file->bytes, reader->file.data, reader->file.size);
	if (!file->bytes.error)
		++*count;
	return file->bytes.error;
}

/* Returns 0, or the last transient failure. */
static int read_all(struct stick_reader *reader, uint32_t root_version, struct stick_file *files,
		    size_t *count)
{
	const bool tuf = root_version == MESSAGE_TRUST_TUF;
	char name[NAME_BYTES];
	int rc = 0, failure = 0;

	for (uint32_t i = 1; rc == 0 && i <= STICK_ROOTS_MAX && !tuf; i++) {
		snprintf(name, sizeof(name), "root/%u.json", root_version + i);
		rc = read_file(reader, name, MESSAGE_META_BYTES_MAX);
		if (rc == 0)
			rc = add_file(reader, files, count, META_ROOT, root_version + i);
	}
	failure = is_transient(rc) ? rc : 0;
	buffer_clear(&reader->file);
	buffer_put(&reader->file, reader->stamp.data, reader->stamp.size);
	rc = reader->file.error;
	if (rc == 0)
		rc = add_file(reader, files, count, META_TIMESTAMP, 0);
	failure = is_transient(rc) ? rc : failure;
	rc = tuf ? 0 : read_file(reader, "release.json", MESSAGE_META_BYTES_MAX);
	if (rc == 0 && !tuf)
		rc = add_file(reader, files, count, META_RELEASE, 0);
	return is_transient(rc) ? rc : failure;
}

enum stick_change stick_reader_look(struct stick_reader *reader, uint32_t root_version,
				    struct stick_file files[STICK_FILES_MAX], size_t *count)
{
	const bool tuf = root_version == MESSAGE_TRUST_TUF;

	*count = 0;
	if (read_stamp(reader, tuf) < 0) {
		close_files(reader); /* open files would prevent unmounting */
		buffer_clear(&reader->stamp);
		reader->looks_again = 0;
		return STICK_REMOVED;
	}
	if (!reader->reports_again && reader->stamp.size == reader->file.size &&
	    memcmp(reader->stamp.data, reader->file.data, reader->file.size) == 0)
		return STICK_UNCHANGED;
	close_files(reader);
	buffer_clear(&reader->stamp);
	buffer_put(&reader->stamp, reader->file.data, reader->file.size);
	if (reader->stamp.error)
		return STICK_REMOVED; /* until there is memory for it */
	reader->reports_again = false;
	look_again(reader, read_all(reader, root_version, files, count));
	return STICK_INSERTED;
}

enum file_answer stick_reader_file(struct stick_reader *reader, const char *name,
				   struct buffer *out)
{
	char path[NAME_BYTES];
	int rc = -ENOENT;

	if (reader->stamp.size > 0 &&
	    snprintf(path, sizeof(path), "tuf/%s", name) < (int)sizeof(path))
		rc = read_file(reader, path, out->ceiling);
	if (rc == 0)
		buffer_put(out, reader->file.data, reader->file.size);
	if (rc == 0)
		rc = out->error;
	if (rc == 0)
		return FILE_IS_HERE;
	look_again(reader, rc);
	return rc == -EFBIG ? FILE_TOO_LARGE : FILE_NOT_THERE;
}

/* ---- objects */

/* Sets *out to what the stick has of a release; a locator that is missing or damaged is remembered.
 * Returns 0, or a transient failure. */
static int release_of(struct stick_reader *reader, struct hash root,
		      const struct stick_release **out)
{
	char name[NAME_BYTES] = "locator/";
	struct stick_release *release;
	int rc;

	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++)
		if (hash_equal(reader->releases[i].root, root)) {
			*out = &reader->releases[i];
			return 0;
		}
	*out = release = &reader->releases[reader->next_release++ % MESSAGE_RELEASES_MAX];
	locator_finish(&release->locator);
	*release = (struct stick_release){ 0 };
	hash_to_hex(root, name + strlen(name));
	rc = read_file(reader, name, LOCATOR_BYTES_MAX);
	if (rc == 0)
		rc = locator_decode(&release->locator, buffer_bytes(&reader->file));
	buffer_finish(&reader->file); /* it may have been large */
	buffer_init(&reader->file, LOCATOR_BYTES_MAX);
	if (is_transient(rc))
		return rc;
	release->root = root;
	release->readable = rc == 0;
	return 0;
}

static int open_pack(struct stick_reader *reader, struct hash pack)
{
	char name[NAME_BYTES] = "packs/";

	if (reader->pack_fd >= 0 && hash_equal(reader->pack, pack))
		return 0;
	if (reader->pack_fd >= 0)
		close(reader->pack_fd);
	hash_to_hex(pack, name + strlen(name));
	reader->pack = pack;
	reader->pack_fd = open_file(reader, name);
	return reader->pack_fd < 0 ? reader->pack_fd : 0;
}

static int get_of(struct stick_reader *reader, struct hash root, const struct message_want *want,
		  struct buffer *out)
{
	const struct stick_release *release;
	const struct locator_block *block;
	uint8_t *to;
	int rc = release_of(reader, root, &release);

	if (rc < 0)
		return rc;
	block = release->readable ? locator_find(&release->locator, want->page) : NULL;
	if (!block || (uint64_t)want->offset + want->size > block->size ||
	    (hash_is_zero(want->page) && !hash_equal(want->hash, root)))
		return -ENOENT;
	buffer_clear(out);
	to = buffer_extend(out, want->size);
	rc = to ? open_pack(reader, release->locator.packs[block->pack]) : out->error;
	if (rc == 0)
		rc = bytes_read_at(reader->pack_fd, to, want->size,
				   (uint64_t)block->offset + want->offset);
	if (rc < 0)
		return is_transient(rc) ? rc : -ENOENT;
	return hash_equal(hash_of(buffer_bytes(out)), want->hash) ? 0 : -EBADMSG;
}

int stick_reader_get(struct stick_reader *reader, const struct hash *roots, size_t count,
		     const struct message_want *want, struct buffer *out)
{
	int rc = -ENOENT;

	for (size_t i = 0; i < count && rc != 0; i++) {
		const int now =
			reader->stamp.size > 0 ? get_of(reader, roots[i], want, out) : -ENOENT;

		if (now != -ENOENT)
			rc = now;
	}
	if (rc != 0)
		buffer_clear(out);
	return rc;
}
