/* Offers a program's metrics over a Unix stream socket: each client gets them as text
 * (base/metrics.h), and the connection is closed at once. Sending never waits: what the kernel does
 * not take in one call is not sent, so a slow client costs nothing, and no connection outlives a
 * call.
 *
 * Any user of the machine may read the metrics: they say nothing that the health page does not. One
 * thread. */
#ifndef GOPURA_BASE_METRICS_SOCKET_H
#define GOPURA_BASE_METRICS_SOCKET_H

#include "base/metrics.h"

struct metrics_socket;

struct metrics_socket_options {
	const char *path;   /* copied; PATH.starts beside it counts the starts */
	const char *prefix; /* first part of the names, such as "gopura_kiosk"; a literal */
	void (*write)(void *data, struct buffer *out); /* appends the program's own metrics */
	void *data;
};

/* Creates the socket. *out is owned by the caller; NULL on failure. Returns 0 or a negative errno
 * (logged): -ENAMETOOLONG, and as bind; or -ENOMEM. */
must_check int metrics_socket_create(struct metrics_socket **out,
				     const struct metrics_socket_options *options);
/* Removes the socket file and frees; NULL is fine. */
void metrics_socket_destroy(struct metrics_socket *socket);

/* Returns the listening descriptor, borrowed, readable when a client waits; -1 if socket is NULL.
 */
int metrics_socket_fd(const struct metrics_socket *socket);
/* Answers one client. Calls write, then appends the metrics that all programs have: uptime, starts,
 * memory, bytes written. */
void metrics_socket_dispatch(struct metrics_socket *socket);

#endif
