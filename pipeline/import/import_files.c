/* Opens files that a scan names. Whoever made the scan chose these names, so they are opened one
 * folder at a time from the scan's own folder: neither "..", nor a link, nor an absolute path leads
 * out of it. */
#include "pipeline/import/import_files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/transient.h"
#include "base/uri.h"
#include "pipeline/import/sandbox.h"
#include "pipeline/keys/keys.h"

bool import_has_extension(const char *name, const char *extension)
{
	size_t length = strlen(name), extension_length = strlen(extension);

	return length > extension_length &&
	       strcasecmp(name + length - extension_length, extension) == 0;
}

int import_files_open_folder(const char *scan_path)
{
	char folder[PATH_MAX];
	const char *slash = strrchr(scan_path, '/');
	int length = slash ? (int)(slash - scan_path) + 1 : 0;
	int fd;

	if (snprintf(folder, sizeof(folder), "%.*s", length, scan_path) >= (int)sizeof(folder))
		return -ENAMETOOLONG;
	fd = open(length ? folder : ".", O_PATH | O_DIRECTORY | O_CLOEXEC);
	return fd < 0 ? -errno : fd;
}

const char *import_files_why(int rc)
{
	switch (rc) {
	case -ENOENT:
		return "is not beside it";
	case -EXDEV:
		return "lies outside the scan's folder";
	case -ELOOP:
		return "is a link, or lies behind one";
	case -EINVAL:
		return "is not a regular file";
	case -EKEYREJECTED:
		return "is a signing key";
	default:
		return strerror(-rc);
	}
}

/* Returns whether the name stays below the folder: not absolute, no "..", and nothing hidden,
 * because settings and secrets lie in folders whose names begin with a dot. */
static bool stays_below(const char *name)
{
	if (name[0] == '/')
		return false;
	for (const char *c = name; *c;) {
		size_t length = strcspn(c, "/");

		if (c[0] == '.' && length > 1)
			return false;
		c += length;
		c += *c == '/';
	}
	return true;
}

/* Returns the error of the last call on name, or -ELOOP if name is a link. */
static int failed(int folder, const char *name)
{
	int rc = -errno;
	struct stat status;

	if (fstatat(folder, name, &status, AT_SYMLINK_NOFOLLOW) == 0 && S_ISLNK(status.st_mode))
		return -ELOOP;
	return rc;
}

/* Finds the one entry of the folder whose name differs in the case of letters alone. Windows and
 * macOS take it for the same, so nobody there sees that the scan names it otherwise. -ENOENT: there
 * is none, or several. */
static int find_other_case(int folder, const char *name, char other[NAME_MAX + 1])
{
	int fd = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC), count = 0;
	DIR *entries = fd < 0 ? NULL : fdopendir(fd);
	const struct dirent *entry;
	int rc;

	if (!entries) {
		rc = is_transient(-errno) ? -errno : -ENOENT;
		if (fd >= 0)
			close(fd);
		return rc;
	}
	while ((entry = readdir(entries)))
		if (strcasecmp(entry->d_name, name) == 0) {
			snprintf(other, NAME_MAX + 1, "%s", entry->d_name);
			count++;
		}
	closedir(entries);
	return count == 1 ? 0 : -ENOENT;
}

/* Opens a regular file only. A FIFO would block, and opening a device may trigger an action, so the
 * type is checked before and after opening. */
static int open_regular(int folder, const char *name)
{
	struct stat status;
	int fd, rc;

	if (fstatat(folder, name, &status, AT_SYMLINK_NOFOLLOW) < 0)
		return -errno;
	if (!S_ISREG(status.st_mode))
		return S_ISLNK(status.st_mode) ? -ELOOP : -EINVAL;
	fd = openat(folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
	if (fd < 0)
		return failed(folder, name);
	rc = fstat(fd, &status) < 0 ? -errno : S_ISREG(status.st_mode) ? 0 : -EINVAL;
	if (rc < 0) {
		close(fd);
		return rc;
	}
	if (keys_is_key_file(fd)) {
		close(fd);
		return -EKEYREJECTED;
	}
	return fd;
}

static int open_folder(int at, const char *name)
{
	int fd = openat(at, name, O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);

	return fd < 0 ? failed(at, name) : fd;
}

/* Opens the folder `name` in the folder `at`. at is closed. */
static int step_into(int at, const char *name, size_t length)
{
	char part[NAME_MAX + 1], other[NAME_MAX + 1];
	int next = -ENAMETOOLONG;

	if (length <= NAME_MAX) {
		memcpy(part, name, length);
		part[length] = '\0';
		next = open_folder(at, part);
		if (next == -ENOENT) {
			next = find_other_case(at, part, other);
			next = next < 0 ? next : open_folder(at, other);
		}
	}
	close(at);
	return next;
}

/* Opens a file below the folder. The name must satisfy stays_below. */
static int open_below(int folder, const char *name)
{
	int at = fcntl(folder, F_DUPFD_CLOEXEC, 0);
	char other[NAME_MAX + 1];
	int fd;

	if (at < 0)
		return -errno;
	for (const char *slash; at >= 0 && (slash = strchr(name, '/')); name = slash + 1) {
		size_t length = (size_t)(slash - name);

		if (length > 0 && !(length == 1 && name[0] == '.'))
			at = step_into(at, name, length);
	}
	if (at < 0)
		return at;
	fd = open_regular(at, name);
	if (fd == -ENOENT) {
		fd = find_other_case(at, name, other);
		fd = fd < 0 ? fd : open_regular(at, other);
	}
	close(at);
	return fd;
}

static int open_named(int folder_fd, const char *name)
{
	char clean[PATH_MAX];
	const char *last;
	int rc, beside;

	if (strlen(name) >= sizeof(clean))
		return -ENAMETOOLONG;
	if (name[0] == '\0')
		return -ENOENT;
	memcpy(clean, name, strlen(name) + 1);
	for (char *c = clean; *c; c++)
		if (*c == '\\')
			*c = '/';
	if (strchr(clean, ':'))
		rc = -ENOENT; /* C:/... and http://... are not files on this machine */
	else
		rc = stays_below(clean) ? open_below(folder_fd, clean) : -EXDEV;
	if (rc >= 0)
		return rc;
	last = strrchr(clean, '/');
	if (!last || !last[1] || strchr(last, ':') || !stays_below(last + 1))
		return rc;
	beside = open_below(folder_fd, last + 1);
	return beside == -ENOENT ? rc : beside;
}

int import_files_open_at(int folder_fd, const char *name)
{
	char decoded[PATH_MAX];
	int rc = open_named(folder_fd, name), other;

	if (rc >= 0 || is_transient(rc) || !strchr(name, '%') ||
	    !uri_decode(decoded, sizeof(decoded), name))
		return rc;
	other = open_named(folder_fd, decoded);
	return other == -ENOENT ? rc : other;
}

int import_files_open(struct import_files *files, const char *name)
{
	int fd;

	if (files->in_sandbox)
		return sandbox_open(name);
	fd = import_files_open_at(files->folder_fd, name);
	import_files_note(&files->failure, fd, name);
	return fd;
}

uint64_t import_files_count(struct import_files_counted *counted, int fd)
{
	struct stat status;

	if (counted->count == IMPORT_FILES_COUNTED_MAX || fstat(fd, &status) < 0)
		return 0;
	for (uint32_t i = 0; i < counted->count; i++)
		if (counted->files[i].device == status.st_dev &&
		    counted->files[i].number == status.st_ino)
			return 0;
	counted->files[counted->count].device = status.st_dev;
	counted->files[counted->count++].number = status.st_ino;
	return (uint64_t)status.st_size;
}

void import_files_note(struct import_files_failure *failure, int rc, const char *name)
{
	if (failure->rc == 0 && is_transient(rc)) {
		failure->rc = rc;
		snprintf(failure->name, sizeof(failure->name), "%s", name);
	}
}

int import_files_judge(const struct import_files_failure *failure, int rc, const char *scan_path,
		       struct diagnostics *diagnostics)
{
	if (rc < 0 || failure->rc == 0)
		return rc;
	return diagnostics_add(diagnostics, failure->rc, scan_path, 0,
			       "'%s', which it names, cannot be read: %s; try again", failure->name,
			       strerror(-failure->rc));
}
