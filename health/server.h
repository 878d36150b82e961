/* An HTTP server for a few clients on one thread, by libmicrohttpd: one request for each
 * connection. What clients can use is limited: SERVER_CLIENTS_MAX connections,
 * SERVER_CLIENTS_PER_ADDRESS_MAX of them from one address, and for each connection a head of a few
 * KiB, the answer, and patience_ms of time. A file is sent from its descriptor and never held in
 * memory; its receiver has more time, by the file's size, and SERVER_FILES_MAX files are served at
 * once. */
#ifndef GOPURA_HEALTH_SERVER_H
#define GOPURA_HEALTH_SERVER_H

#include "base/bytes.h"

enum {
	SERVER_CLIENTS_MAX = 16,
	SERVER_CLIENTS_PER_ADDRESS_MAX = 8, /* further ones are closed at once */
	SERVER_FILES_MAX = 4, /* so that slow receivers of files leave room for other requests */
	SERVER_FILE_MS_MAX = 600000, /* limit of the time added for a file */
};

struct reply {
	int status;       /* of HTTP */
	const char *type; /* content type; static */
	/* Content, with a ceiling set by whoever fills it in. If there is none, and no file, the
	 * server sends the status in words. */
	struct buffer body;
	/* Sent instead of body: file_bytes from the beginning. -1: none. Taken by the server. If it
	 * is truncated meanwhile, the connection ends before the announced length. */
	int file;
	uint64_t file_bytes;
};

struct server_options {
	int listener;        /* taken; a listening stream socket */
	int64_t patience_ms; /* time limit of a connection, after which it is closed */
	int64_t idle_ms;     /* the server ends after so long without a connection; 0: never */
	/* The receiver of a file gets one more second for each so many bytes; slower ones are
	 * disconnected. */
	uint64_t file_bytes_per_s;
	/* Fills in *reply, which is a 404, for a GET or HEAD request of this path. */
	void (*answer)(void *data, const char *path, struct reply *reply);
	void *data;
};

/* Runs the server. Returns 0 after it was idle for idle_ms; -EINVAL if libmicrohttpd refuses the
 * listener, or file_bytes_per_s is 0; -EIO if it cannot wait for sockets. */
must_check int server_run(const struct server_options *options);

#endif
