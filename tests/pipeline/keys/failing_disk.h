/* A disk that is full, or otherwise fails, from the n-th call on: mkdir, write, fsync, and what
 * else asks fails_now. The linker redirects the calls of one test program here. */
#ifndef GOPURA_TESTS_PIPELINE_KEYS_FAILING_DISK_H
#define GOPURA_TESTS_PIPELINE_KEYS_FAILING_DISK_H

#include <errno.h>
#include <stdbool.h>
#include <sys/stat.h>
#include <unistd.h>

static int calls_left = -1; /* -1: nothing fails */

static bool fails_now(void)
{
	if (calls_left > 0)
		calls_left--;
	if (calls_left == 0)
		errno = ENOSPC;
	return calls_left == 0;
}

int __real_mkdir(const char *path, mode_t mode);
int __wrap_mkdir(const char *path, mode_t mode);
ssize_t __real_write(int fd, const void *data, size_t size);
ssize_t __wrap_write(int fd, const void *data, size_t size);
int __real_fsync(int fd);
int __wrap_fsync(int fd);
int __real_rename(const char *from, const char *to);
int __wrap_rename(const char *from, const char *to);

int __wrap_mkdir(const char *path, mode_t mode)
{
	return fails_now() ? -1 : __real_mkdir(path, mode);
}

/* The last write that works is cut short, as on a disk that is just full. */
ssize_t __wrap_write(int fd, const void *data, size_t size)
{
	if (fails_now())
		return -1;
	return __real_write(fd, data, calls_left == 1 && size > 10 ? 10 : size);
}

int __wrap_fsync(int fd)
{
	return fails_now() ? -1 : __real_fsync(fd);
}

#endif
