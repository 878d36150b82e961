/* Offers a program's figures over a Unix stream socket: whoever connects gets them as text
 * (base/metrics.h) and is let go at once. Nobody is waited for: what the kernel does not take in
 * one call is not said, so a slow reader costs nothing, and no connection outlives a call.
 *
 * Anyone on the machine may read them: they say nothing that the health page does not. One thread.
 */
#ifndef GOPURA_BASE_METRICS_SOCKET_H
#define GOPURA_BASE_METRICS_SOCKET_H

#include "base/metrics.h"

struct metrics_socket;

struct metrics_socket_options {
	const char *path;   /* copied; PATH.starts beside it counts how often this was created */
	const char *prefix; /* of the figures' names, such as "gopura_kiosk"; a literal */
	void (*write)(void *data, struct buffer *out); /* the program's own figures */
	void *data;
};

/* *out is owned by the caller; NULL on failure, which is logged. -ENAMETOOLONG, and as bind. */
must_check int metrics_socket_create(struct metrics_socket **out,
				     const struct metrics_socket_options *options);
void metrics_socket_destroy(struct metrics_socket *socket); /* NULL is fine */

/* Readable when somebody wants the figures; -1 of NULL. */
int metrics_socket_fd(const struct metrics_socket *socket);
/* Answers one of them. Calls write, then appends what every program tells: uptime, starts, memory,
 * bytes written. */
void metrics_socket_dispatch(struct metrics_socket *socket);

#endif
