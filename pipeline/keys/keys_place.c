/* Chooses the folder of a content folder's signing keys, moves keys out of the content folder, and
 * opens or creates them under a lock. */
#include "pipeline/keys/keys_place.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/log.h"

enum { SAME_NAMES_MAX = 1000, ROOTS_MAX = 10000, OLD_FILE_BYTES_MAX = 1 << 20 };

static int complain(const char *path, int rc, const char *cure)
{
	log_error("pipeline", "%s: %s%s", path, strerror(-rc), cure);
	return rc;
}

static int join(char out[PATH_MAX], const char *folder, const char *name)
{
	return snprintf(out, PATH_MAX, "%s/%s", folder, name) < PATH_MAX ? 0 : -ENAMETOOLONG;
}

/* ---- the default location */

static int default_base(char out[PATH_MAX])
{
	const char *config = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
	int size;

	if (config && config[0] == '/')
		size = snprintf(out, PATH_MAX, "%s/gopura/keys", config);
	else if (home && home[0] == '/')
		size = snprintf(out, PATH_MAX, "%s/.config/gopura/keys", home);
	else
		return complain("signing keys", -ENOENT,
				"; neither XDG_CONFIG_HOME nor HOME is set: give --keys FOLDER");
	return size < PATH_MAX ? 0
			       : complain("signing keys", -ENAMETOOLONG, "; give --keys FOLDER");
}

/* Creates every folder on the path, accessible only to the owner. */
static int make_way(const char *folder)
{
	char path[PATH_MAX];

	snprintf(path, sizeof(path), "%s", folder);
	for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
		*slash = '\0';
		if (mkdir(path, 0700) < 0 && errno != EEXIST)
			return complain(path, -errno, "; give --keys FOLDER");
		*slash = '/';
	}
	return mkdir(path, 0700) < 0 && errno != EEXIST
		       ? complain(path, -errno, "; give --keys FOLDER")
		       : 0;
}

/* Reads which content folder these keys belong to. -ENOENT: it is not stated. */
static int read_owner(char owner[PATH_MAX], const char *keys)
{
	char path[PATH_MAX];
	struct buffer file;
	int rc = join(path, keys, "content");

	if (rc < 0)
		return rc;
	buffer_init(&file, PATH_MAX - 1);
	rc = buffer_read_file(&file, path);
	if (rc == 0)
		snprintf(owner, PATH_MAX, "%.*s", (int)file.size, (const char *)file.data);
	if (rc == 0 && file.size > 0 && owner[file.size - 1] == '\n')
		owner[file.size - 1] = '\0';
	buffer_finish(&file);
	return rc;
}

static int write_owner(const char *keys, const char *content)
{
	char path[PATH_MAX], text[PATH_MAX + 1];
	int size = snprintf(text, sizeof(text), "%s\n", content);
	int rc = join(path, keys, "content");

	if (rc == 0)
		rc = bytes_write_file((struct bytes){ (const uint8_t *)text, (size_t)size }, path);
	return rc < 0 ? complain(path, rc, "") : 0;
}

/* Warns about keys of the same name whose content folder no longer exists; it may be this folder,
 * moved. */
static void tell_orphan(const char *orphan, const char *content)
{
	char owner[PATH_MAX];

	if (orphan[0] && read_owner(owner, orphan) == 0)
		log_warn(
			"pipeline",
			"%s gets keys of its own. %s are those of %s, which is not there any more: "
			"if it is this folder, moved, remove the new keys and write its new place "
			"into %s/content",
			content, orphan, owner, orphan);
}

/* Sets out to the n-th folder of that name below base. */
static int numbered(char out[PATH_MAX], const char *base, const char *name, unsigned n)
{
	const int size = n == 1 ? snprintf(out, PATH_MAX, "%s/%s", base, name)
				: snprintf(out, PATH_MAX, "%s/%s-%u", base, name, n);

	return size < PATH_MAX ? 0 : complain(name, -ENAMETOOLONG, "; give --keys FOLDER");
}

/* Chooses the folder below base: the one that names this content, or one that belongs to nobody, or
 * a new one. Numbers may be left out: their keys were removed. */
static int choose(char out[PATH_MAX], const char *base, const char *content)
{
	const char *name = content[1] ? strrchr(content, '/') + 1 : "root";
	char orphan[PATH_MAX] = "", owner[PATH_MAX];
	unsigned unclaimed = 0, unused = 0, closed = 0;
	int rc, why = 0;

	for (unsigned n = 1; n <= SAME_NAMES_MAX; n++) {
		rc = numbered(out, base, name, n);

		if (rc < 0)
			return rc;
		if (access(out, F_OK) < 0) {
			unused = unused ? unused : n;
			continue;
		}
		rc = read_owner(owner, out);
		if (rc == -ENOENT) {
			unclaimed = unclaimed ? unclaimed : n;
		} else if (rc < 0) {
			closed = n;
			why = rc;
		} else if (strcmp(owner, content) == 0) {
			return 0;
		} else if (access(owner, F_OK) < 0) {
			memcpy(orphan, out, PATH_MAX);
		}
	}
	if (closed) {
		rc = numbered(out, base, name, closed);
		return rc < 0 ? rc
			      : complain(out, why,
					 "; it cannot be told whose keys these are: give --keys "
					 "FOLDER");
	}
	if (!unclaimed && !unused)
		return complain(content, -EMFILE,
				": too many keys of that name; give --keys FOLDER");
	if (!unclaimed)
		tell_orphan(orphan, content);
	return numbered(out, base, name, unclaimed ? unclaimed : unused);
}

/* ---- moving keys out of the content folder */

static int copy_file(const char *from, const char *to, mode_t mode)
{
	struct buffer file;
	int fd, rc;

	buffer_init(&file, OLD_FILE_BYTES_MAX);
	rc = buffer_read_file(&file, from);
	if (rc == 0) {
		fd = open(to, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, mode);
		rc = fd < 0 ? -errno : 0;
		errno = 0; /* a short write does not set errno */
		if (rc == 0 &&
		    (write(fd, file.data, file.size) != (ssize_t)file.size || fsync(fd) < 0))
			rc = errno ? -errno : -ENOSPC;
		if (fd >= 0 && close(fd) < 0 && rc == 0)
			rc = -errno;
	}
	if (file.data)
		explicit_bzero(file.data, file.size);
	buffer_finish(&file);
	return rc == -ENOENT ? 0 : rc;
}

static int old_file(char out[PATH_MAX], const char *folder, int index)
{
	static const char *const keys[] = { "root.key", "release.key", "timestamp.key" };
	const int key_count = (int)ARRAY_COUNT(keys);

	return index < key_count ? join(out, folder, keys[index])
	       : snprintf(out, PATH_MAX, "%s/root/%d.json", folder, index - key_count + 1) <
			       PATH_MAX
		       ? 0
		       : -ENAMETOOLONG;
}

/* Removes keys and roots, then the folders if they are empty. */
static void remove_files(const char *folder)
{
	char path[PATH_MAX];

	for (int i = 0; i < ROOTS_MAX && old_file(path, folder, i) == 0; i++)
		if (unlink(path) < 0 && i > 3)
			break;
	if (join(path, folder, "root") == 0)
		rmdir(path);
	if (rmdir(folder) < 0 && errno != ENOENT)
		log_warn("pipeline",
			 "%s: the keys were moved out, but other files are left in it; remove them",
			 folder);
}

/* Moves the keys to another file system: they are copied to a temporary folder, synced and renamed;
 * only then are the old ones removed. */
static int copy_across(const char *from, const char *to)
{
	char aside[PATH_MAX], path[PATH_MAX], copy[PATH_MAX];
	int rc = snprintf(aside, PATH_MAX, "%s.move", to) < PATH_MAX ? 0 : -ENAMETOOLONG;

	if (rc == 0 && access(aside, F_OK) == 0)
		remove_files(aside); /* left by an interrupted run */
	if (rc == 0)
		rc = join(path, aside, "root");
	if (rc == 0 && ((mkdir(aside, 0700) < 0 && errno != EEXIST) ||
			(mkdir(path, 0755) < 0 && errno != EEXIST)))
		rc = -errno;
	for (int i = 0; rc == 0 && i < ROOTS_MAX; i++) {
		rc = old_file(path, from, i);
		if (rc == 0 && access(path, F_OK) < 0) {
			if (i > 3)
				break;
			continue;
		}
		if (rc == 0)
			rc = old_file(copy, aside, i);
		if (rc == 0)
			rc = copy_file(path, copy, i < 3 ? 0600 : 0644);
	}
	if (rc == 0)
		rc = keys_sync_folder(aside);
	if (rc == 0 && rename(aside, to) < 0)
		rc = -errno;
	if (rc == 0)
		rc = keys_sync_parent(to);
	if (rc == 0)
		remove_files(from);
	else
		remove_files(aside);
	return rc;
}

static bool have_one_root(const char *a, const char *b)
{
	struct buffer first, second;
	bool same;

	buffer_init(&first, OLD_FILE_BYTES_MAX);
	buffer_init(&second, OLD_FILE_BYTES_MAX);
	same = keys_read_root(&first, a, 1) == 0 && keys_read_root(&second, b, 1) == 0 &&
	       first.size == second.size && memcmp(first.data, second.data, first.size) == 0;
	buffer_finish(&first);
	buffer_finish(&second);
	return same;
}

static bool is_one_folder(const char *a, const char *b)
{
	struct stat first, second;

	return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev &&
	       first.st_ino == second.st_ino;
}

/* Moves the keys out of DIR/keys. If that fails, folder is set to the old place, where they
 * stay. */
static void move_old(char folder[PATH_MAX], const char *content)
{
	char old[PATH_MAX];
	int rc;

	if (join(old, content, "keys") < 0 || !keys_are_in(old) || is_one_folder(old, folder))
		return;
	if (keys_are_in(folder)) {
		if (have_one_root(old, folder))
			remove_files(old); /* the move was interrupted */
		else
			log_warn(
				"pipeline",
				"%s contains keys too, but those in %s are used; remove the others",
				old, folder);
		return;
	}
	rc = rename(old, folder) < 0 ? -errno : keys_sync_parent(folder);
	if (rc == -EXDEV)
		rc = copy_across(old, folder);
	if (rc == 0) {
		chmod(folder, 0700);
		log_info(
			"pipeline",
			"moved the signing keys of %s to %s, because they must not lie in the content folder",
			content, folder);
	} else {
		log_warn("pipeline",
			 "%s: the signing keys cannot be moved to %s (%s) and are used where they "
			 "are; what lies among the content is read by many: move them with --keys "
			 "FOLDER",
			 old, folder, strerror(-rc));
		memcpy(folder, old, PATH_MAX);
	}
}

/* ---- putting it together */

/* Locks the parent folder, because two builds at once must not create keys twice. Closing the
 * descriptor releases the lock. A folder that cannot be locked is used without one. */
static int lock_beside(const char *folder)
{
	char parent[PATH_MAX];
	char *slash;
	int fd;

	snprintf(parent, sizeof(parent), "%s", folder);
	slash = strrchr(parent, '/');
	if (slash)
		slash[slash == parent] = '\0';
	fd = open(slash ? parent : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd >= 0 && flock(fd, LOCK_EX) < 0)
		log_debug("pipeline", "%s: cannot be locked: %s", parent, strerror(errno));
	return fd;
}

/* Uses the folder given with --keys. Only the folders above it are created here. */
static int take_given(char folder[PATH_MAX], const char *given)
{
	size_t size = strlen(given);
	char above[PATH_MAX];
	char *slash;

	while (size > 1 && given[size - 1] == '/')
		size--;
	if (size == 0 || size >= PATH_MAX - 16)
		return complain(given, size ? -ENAMETOOLONG : -ENOENT, "; give --keys FOLDER");
	snprintf(folder, PATH_MAX, "%.*s", (int)size, given);
	memcpy(above, folder, size + 1);
	slash = strrchr(above, '/');
	if (!slash || slash == above)
		return 0;
	*slash = '\0';
	return make_way(above);
}

static int load_or_make(struct publisher_keys *out, const char *folder, bool *made)
{
	int rc = keys_load(out, folder);

	if (rc != -ENOENT)
		return rc;
	rc = keys_make(folder);
	if (rc == 0)
		rc = keys_load(out, folder);
	if (rc == 0)
		*made = true;
	return rc;
}

static void judge_place(const char *folder, const char *content)
{
	char real[PATH_MAX];
	size_t size = strlen(content);

	if (realpath(folder, real) && strncmp(real, content, size) == 0 && real[size] == '/')
		log_warn("pipeline",
			 "%s: the signing keys are in the content folder; keep them elsewhere "
			 "(--keys FOLDER)",
			 folder);
}

/* Called while the lock is held. */
static int open_at(struct publisher_keys *out, char folder[PATH_MAX], const char *content,
		   bool is_given, bool *made)
{
	char chosen[PATH_MAX], owner[PATH_MAX];
	int rc;

	memcpy(chosen, folder, PATH_MAX);
	if (content[0])
		move_old(folder, content);
	if (!out && !is_given && mkdir(folder, 0700) < 0 && errno != EEXIST)
		return complain(folder, -errno, "");
	rc = out ? load_or_make(out, folder, made) : 0;
	if (rc == 0 && !is_given && strcmp(folder, chosen) == 0 &&
	    (read_owner(owner, folder) < 0 || strcmp(owner, content) != 0)) {
		rc = write_owner(folder, content);
		if (rc < 0)
			keys_finish(out);
	}
	if (rc == 0 && content[0])
		judge_place(folder, content);
	return rc;
}

int keys_open(struct publisher_keys *out, char folder[PATH_MAX], const char *content_folder,
	      const char *given, bool *made)
{
	char content[PATH_MAX] = "", base[PATH_MAX];
	bool is_new = false;
	int lock, rc;

	if (content_folder && !realpath(content_folder, content))
		return complain(content_folder, -errno, "");
	rc = given ? take_given(folder, given) : default_base(base);
	if (rc == 0 && !given)
		rc = make_way(base);
	if (rc < 0)
		return rc;
	if (!given)
		snprintf(folder, PATH_MAX, "%.*s/", PATH_MAX - 2, base); /* parent: base */
	lock = lock_beside(folder);
	if (!given)
		rc = choose(folder, base, content);
	if (rc == 0)
		rc = open_at(out, folder, content, given != NULL, &is_new);
	if (lock >= 0)
		close(lock);
	if (made)
		*made = is_new;
	return rc;
}
