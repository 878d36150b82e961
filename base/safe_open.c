/* Opens regular files safely: with openat2 where the kernel has it, otherwise one path component at
 * a time without following links. */
#include "base/safe_open.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/openat2.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { READ_FLAGS = O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY };

/* Returns fd if it is a regular file; otherwise closes it and returns the reason as a negative
 * errno. A negative errno as fd is passed on. */
static int only_regular(int fd)
{
	struct stat info;
	int rc = fd;

	if (fd < 0)
		return fd == -ENXIO ? -ENOTSUP : fd; /* open() fails with ENXIO on a socket */
	if (fstat(fd, &info) < 0)
		rc = -errno;
	else if (S_ISDIR(info.st_mode))
		rc = -EISDIR;
	else if (!S_ISREG(info.st_mode))
		rc = -ENOTSUP;
	if (rc < 0)
		close(fd);
	return rc;
}

int open_regular(const char *path)
{
	const int fd = open(path, READ_FLAGS);

	return only_regular(fd < 0 ? -errno : fd);
}

/* Returns the length of the first component of name; 0 at its end. */
static size_t component_length(const char *name)
{
	return strcspn(name, "/");
}

/* Returns whether name is relative, such as "a/b.c", without empty components, "." and "..". */
static bool stays_beneath(const char *name)
{
	for (;;) {
		const size_t length = component_length(name);

		if (length == 0 || (length == 1 && name[0] == '.') ||
		    (length == 2 && name[0] == '.' && name[1] == '.'))
			return false;
		if (name[length] == '\0')
			return true;
		name += length + 1;
	}
}

/* ---- for kernels or sandboxes without openat2: one component at a time */

/* Returns fd if it is a folder of the file system `device`; otherwise closes it and returns a
 * negative errno. */
static int only_folder(int fd, dev_t device)
{
	struct stat info;
	int rc = fd;

	if (fd < 0)
		return fd;
	if (fstat(fd, &info) < 0)
		rc = -errno;
	else if (S_ISLNK(info.st_mode))
		rc = -ELOOP;
	else if (!S_ISDIR(info.st_mode))
		rc = -ENOTDIR;
	else if (info.st_dev != device)
		rc = -EXDEV;
	if (rc < 0)
		close(fd);
	return rc;
}

/* Opens a component of a path, without following a link. parent is taken. Returns a negative errno
 * on failure. */
static int open_component(int parent, const char *component, int flags)
{
	int fd = openat(parent, component, flags | O_NOFOLLOW);

	if (fd < 0)
		fd = -errno;
	close(parent);
	return fd;
}

static int open_by_steps(int folder, const char *name)
{
	struct stat top, found;
	char component[NAME_MAX + 1];
	int fd = fstat(folder, &top) < 0 ? -errno : fcntl(folder, F_DUPFD_CLOEXEC, 0);

	while (fd >= 0) {
		const size_t length = component_length(name);
		const bool is_last = name[length] == '\0';

		if (length > NAME_MAX) {
			close(fd);
			return -ENAMETOOLONG;
		}
		memcpy(component, name, length);
		component[length] = '\0';
		fd = open_component(fd, component, is_last ? READ_FLAGS : O_PATH | O_CLOEXEC);
		if (is_last)
			break;
		fd = only_folder(fd, top.st_dev);
		name += length + 1;
	}
	if (fd >= 0 && (fstat(fd, &found) < 0 || found.st_dev != top.st_dev)) {
		close(fd);
		return -EXDEV;
	}
	return fd;
}

/* ---- below a folder */

static int open_at(int folder, const char *name)
{
	struct open_how how = {
		.flags = (uint64_t)READ_FLAGS,
		.resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS | RESOLVE_NO_XDEV |
			   RESOLVE_NO_MAGICLINKS,
	};
	const long fd = syscall(SYS_openat2, folder, name, &how, sizeof(how));

	if (fd >= 0)
		return (int)fd;
	/* A filter of system calls may refuse it with EPERM. */
	if (errno == ENOSYS || errno == EPERM)
		return open_by_steps(folder, name);
	return -errno;
}

int open_beneath(const char *folder, const char *name)
{
	int top, fd;

	if (!stays_beneath(name))
		return -EXDEV;
	top = open(*folder ? folder : ".", O_PATH | O_DIRECTORY | O_CLOEXEC);
	if (top < 0)
		return -errno;
	fd = open_at(top, name);
	close(top);
	return only_regular(fd);
}

const char *open_problem(int rc)
{
	switch (-rc) {
	case EISDIR:
		return "it is a folder; put a file there";
	case ENOTSUP:
		return "it is not a regular file but a pipe, a device or a socket; put a file there";
	case ELOOP:
		return "it is a link, and links are not followed; copy the file itself";
	case EXDEV:
		return "it is outside its folder; copy it there";
	case EFBIG:
		return "it is too large, so it is some other file";
	default:
		return strerror(-rc);
	}
}
