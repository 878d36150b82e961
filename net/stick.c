#include "net/stick.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "format/locator.h"

enum {
	LOOK_MS = 3000,
	ROOTS_MOST = 64, /* told in one look; the kiosk's word on them begins the next */
	LOCATOR_BYTES_MOST = 64 << 20,
	NAME_BYTES = 64,
};

struct stick_release {
	struct hash root; /* zero: none */
	struct locator locator;
	bool readable; /* else there is none, or it is damaged */
};

struct stick {
	struct stick_options options;
	char folder[PATH_MAX]; /* of the release: the options' or release/ in it */
	int64_t look_ms;
	uint32_t root_version; /* that the kiosk has */
	struct buffer stamp;   /* timestamp.json as it was told; empty: no stick */
	struct buffer file;    /* read last */
	struct stick_release releases[MESSAGE_RELEASES_MOST];
	size_t next_release; /* to be overwritten */
	struct hash pack;    /* that is open */
	int pack_fd;         /* -1: none */
};

int stick_create(struct stick **out, const struct stick_options *options)
{
	struct stick *stick = calloc(1, sizeof(*stick));

	*out = stick;
	if (!stick)
		return -ENOMEM;
	stick->options = *options;
	stick->options.folder = strdup(options->folder);
	stick->pack_fd = -1;
	buffer_init(&stick->stamp, MESSAGE_META_BYTES_MOST);
	buffer_init(&stick->file, LOCATOR_BYTES_MOST);
	if (stick->options.folder)
		return 0;
	stick_destroy(stick);
	*out = NULL;
	return -ENOMEM;
}

/* What was read of the stick that was there. */
static void close_files(struct stick *stick)
{
	for (size_t i = 0; i < MESSAGE_RELEASES_MOST; i++) {
		locator_finish(&stick->releases[i].locator);
		stick->releases[i] = (struct stick_release){ 0 };
	}
	if (stick->pack_fd >= 0)
		close(stick->pack_fd);
	stick->pack_fd = -1;
}

void stick_destroy(struct stick *stick)
{
	if (!stick)
		return;
	close_files(stick);
	buffer_finish(&stick->stamp);
	buffer_finish(&stick->file);
	free((char *)stick->options.folder);
	free(stick);
}

void stick_forget(struct stick *stick)
{
	if (!stick)
		return;
	buffer_clear(&stick->stamp);
	stick->look_ms = 0;
}

void stick_trust(struct stick *stick, uint32_t root_version)
{
	if (stick)
		stick->root_version = root_version;
}

/* ---- files */

/* Not through a link, and not what would block: a stick may hold anything. */
static int open_plain(const struct stick *stick, const char *name, struct stat *info)
{
	char path[PATH_MAX + NAME_BYTES + 1];
	int fd;

	snprintf(path, sizeof(path), "%s/%s", stick->folder, name);
	fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
	if (fd < 0)
		return -errno;
	if (fstat(fd, info) == 0 && S_ISREG(info->st_mode))
		return fd;
	close(fd);
	return -ENOENT;
}

/* Into stick->file. */
static int read_file(struct stick *stick, const char *name, size_t most)
{
	struct stat info;
	int fd = open_plain(stick, name, &info), rc;
	uint8_t *to;

	if (fd < 0)
		return fd;
	buffer_clear(&stick->file);
	rc = info.st_size <= 0 || (uint64_t)info.st_size > most ? -EFBIG : 0;
	to = rc == 0 ? buffer_extend(&stick->file, (size_t)info.st_size) : NULL;
	if (rc == 0)
		rc = to ? bytes_read_at(fd, to, (size_t)info.st_size, 0) : stick->file.error;
	if (rc == 0)
		stick->file.size = (size_t)info.st_size;
	close(fd);
	return rc;
}

static int read_stamp(struct stick *stick)
{
	static const char *const below[] = { "", "/release" };
	int rc = -ENOENT;

	for (size_t i = 0; rc < 0 && i < ARRAY_COUNT(below); i++) {
		snprintf(stick->folder, sizeof(stick->folder), "%s%s", stick->options.folder,
			 below[i]);
		rc = read_file(stick, "timestamp.json", MESSAGE_META_BYTES_MOST);
	}
	return rc;
}

/* ---- metadata */

static void say(struct stick *stick, enum meta_role role, uint32_t version)
{
	stick->options.meta(stick->options.data, role, version, buffer_bytes(&stick->file));
}

static void say_all(struct stick *stick)
{
	char name[NAME_BYTES];

	for (uint32_t i = 1; i <= ROOTS_MOST; i++) {
		const uint32_t version = stick->root_version + i;

		snprintf(name, sizeof(name), "root/%u.json", version);
		if (read_file(stick, name, MESSAGE_META_BYTES_MOST) < 0)
			break;
		say(stick, META_ROOT, version);
	}
	stick->options.meta(stick->options.data, META_TIMESTAMP, 0, buffer_bytes(&stick->stamp));
	if (read_file(stick, "release.json", MESSAGE_META_BYTES_MOST) == 0)
		say(stick, META_RELEASE, 0);
}

bool stick_work(struct stick *stick)
{
	bool same;

	if (!stick || clock_now_ms() < stick->look_ms)
		return false;
	stick->look_ms = clock_now_ms() + LOOK_MS;
	if (read_stamp(stick) < 0) {
		if (stick->stamp.size > 0)
			log_info("net", "the stick is gone");
		close_files(stick); /* or it could not be unmounted */
		buffer_clear(&stick->stamp);
		return false;
	}
	same = stick->stamp.size == stick->file.size &&
	       memcmp(stick->stamp.data, stick->file.data, stick->file.size) == 0;
	if (same)
		return false;
	log_info("net", "a stick with a release is here: %s", stick->folder);
	close_files(stick);
	buffer_clear(&stick->stamp);
	buffer_put(&stick->stamp, stick->file.data, stick->file.size);
	say_all(stick);
	return true;
}

int64_t stick_due_ms(const struct stick *stick)
{
	return stick ? stick->look_ms : INT64_MAX;
}

/* ---- objects */

static const struct stick_release *release_of(struct stick *stick, struct hash root)
{
	char name[NAME_BYTES] = "locator/";
	struct stick_release *release;

	for (size_t i = 0; i < MESSAGE_RELEASES_MOST; i++)
		if (hash_equal(stick->releases[i].root, root))
			return &stick->releases[i];
	release = &stick->releases[stick->next_release++ % MESSAGE_RELEASES_MOST];
	locator_finish(&release->locator);
	*release = (struct stick_release){ .root = root };
	hash_to_hex(root, name + strlen(name));
	release->readable = read_file(stick, name, LOCATOR_BYTES_MOST) == 0 &&
			    locator_decode(&release->locator, buffer_bytes(&stick->file)) == 0;
	buffer_finish(&stick->file); /* it may have been large */
	buffer_init(&stick->file, LOCATOR_BYTES_MOST);
	return release;
}

static int open_pack(struct stick *stick, struct hash pack)
{
	char name[NAME_BYTES] = "packs/";
	struct stat info;

	if (stick->pack_fd >= 0 && hash_equal(stick->pack, pack))
		return 0;
	if (stick->pack_fd >= 0)
		close(stick->pack_fd);
	hash_to_hex(pack, name + strlen(name));
	stick->pack = pack;
	stick->pack_fd = open_plain(stick, name, &info);
	return stick->pack_fd < 0 ? -ENOENT : 0;
}

int stick_get(struct stick *stick, struct hash root, const struct message_want *want,
	      struct buffer *out)
{
	const struct stick_release *release;
	const struct locator_block *block;
	uint8_t *to;

	if (!stick || stick->stamp.size == 0)
		return -ENOENT;
	release = release_of(stick, root);
	block = release->readable ? locator_find(&release->locator, want->page) : NULL;
	if (!block || (uint64_t)want->offset + want->size > block->size ||
	    (hash_is_zero(want->page) && !hash_equal(want->hash, root)) ||
	    open_pack(stick, release->locator.packs[block->pack]) < 0)
		return -ENOENT;
	buffer_clear(out);
	to = buffer_extend(out, want->size);
	if (!to || bytes_read_at(stick->pack_fd, to, want->size,
				 (uint64_t)block->offset + want->offset) < 0)
		return -ENOENT;
	out->size = want->size;
	return 0;
}
