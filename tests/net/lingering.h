/* A TCP socket whose last close waits for LINGER_S: unsent data, and a peer that does not read. */
#ifndef GOPURA_TESTS_LINGERING_H
#define GOPURA_TESTS_LINGERING_H

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdbool.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/check.h"

/* The tests allow a tenth of it: whoever waits for such a close is found out on a slow machine
 * too. */
enum { LINGER_S = 30 };

/* *peer is to be closed by the caller, after what it tests. */
static inline int lingering_socket(int *peer)
{
	struct sockaddr_in address = { .sin_family = AF_INET };
	const struct linger linger = { .l_onoff = 1, .l_linger = LINGER_S };
	static const uint8_t data[65536];
	socklen_t size = sizeof(address);
	int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

	address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	CHECK(bind(listener, (struct sockaddr *)&address, size) == 0 && listen(listener, 1) == 0);
	CHECK(getsockname(listener, (struct sockaddr *)&address, &size) == 0);
	CHECK(connect(fd, (struct sockaddr *)&address, size) == 0);
	*peer = accept(listener, NULL, NULL);
	CHECK(*peer >= 0);
	close(listener);
	while (send(fd, data, sizeof(data), MSG_DONTWAIT | MSG_NOSIGNAL) > 0)
		;
	CHECK(setsockopt(fd, SOL_SOCKET, SO_LINGER, &linger, sizeof(linger)) == 0);
	return fd;
}

/* A packet with so many descriptors, which the sender then has no more. false: the socket does not
 * take it. */
static inline bool try_send_with(int socket_fd, const void *bytes, size_t size, const int *fds,
				 size_t count)
{
	union {
		char bytes[CMSG_SPACE(253 * sizeof(int))];
		struct cmsghdr aligned;
	} control = { { 0 } };
	struct iovec part = { (void *)bytes, size };
	struct msghdr header = { .msg_iov = &part,
				 .msg_iovlen = 1,
				 .msg_control = control.bytes,
				 .msg_controllen = CMSG_SPACE(count * sizeof(int)) };
	struct cmsghdr *rights = CMSG_FIRSTHDR(&header);
	const struct linger none = { 0 };
	ssize_t sent;

	rights->cmsg_level = SOL_SOCKET;
	rights->cmsg_type = SCM_RIGHTS;
	rights->cmsg_len = CMSG_LEN(count * sizeof(int));
	memcpy(CMSG_DATA(rights), fds, count * sizeof(int));
	sent = sendmsg(socket_fd, &header, MSG_NOSIGNAL | MSG_DONTWAIT);
	for (size_t i = 0; i < count; i++) {
		if (sent < 0) /* ours is the last one: it must not wait */
			setsockopt(fds[i], SOL_SOCKET, SO_LINGER, &none, sizeof(none));
		close(fds[i]);
	}
	return sent == (ssize_t)size;
}

static inline void send_with(int socket_fd, const void *bytes, size_t size, const int *fds,
			     size_t count)
{
	CHECK(try_send_with(socket_fd, bytes, size, fds, count));
}

#endif
