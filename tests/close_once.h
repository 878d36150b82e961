/* For a test that is one file: close() in place of libc's, which ends the test at a descriptor that
 * was not open. What is closed twice closes another thread's file one day. */
#ifndef GOPURA_TESTS_CLOSE_ONCE_H
#define GOPURA_TESTS_CLOSE_ONCE_H

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <unistd.h>

int close(int fd)
{
	const int rc = (int)syscall(SYS_close, fd);

	if (rc < 0 && errno == EBADF && fd >= 0) {
		fprintf(stderr, "descriptor %d is closed and was not open\n", fd);
		abort();
	}
	return rc;
}

#endif
