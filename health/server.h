/* HTTP/1.1 for a handful of clients on one thread: a request, its answer, the end of the
 * connection. What clients can take of us is bounded: SERVER_CLIENTS_MAX connections, of each
 * REQUEST_BYTES_MAX bytes of request, SERVER_TEXT_BYTES_MAX bytes of answer in memory and
 * patience_ms of time. A file goes from the disk to the socket and takes no memory of ours; its
 * reader has more time, by the file's size, and SERVER_FILES_MAX of them are served at once. */
#ifndef GOPURA_HEALTH_SERVER_H
#define GOPURA_HEALTH_SERVER_H

#include "health/request.h"

enum {
	SERVER_CLIENTS_MAX = 16,
	SERVER_LISTENERS_MAX = 4,
	SERVER_FILES_MAX = 4, /* slow readers of files leave room for other questions */
	SERVER_TEXT_BYTES_MAX = 132 * 1024,
	SERVER_FILE_MS_MAX = 600000, /* for a file of any size */
};

/* A whole HTTP answer: text, then file_bytes bytes from the beginning of file. A file that has
 * become shorter meanwhile ends the connection before the announced length. */
struct reply {
	struct buffer text;
	int file; /* -1: none; the server closes it */
	uint64_t file_bytes;
};

struct server_options {
	const int *listeners; /* borrowed; listening stream sockets, made non-blocking */
	size_t listener_count;
	int64_t patience_ms; /* then a connection is cut, whatever it is at */
	int64_t idle_ms;     /* without a connection: the server ends; 0: never */
	/* A reader of a file gets a second more for each so many bytes; who reads slower is cut. */
	uint64_t file_bytes_per_s;
	/* Fills reply, which is empty. status 200: to request; 503: too many files are being read;
	 * else what request_parse found wrong. */
	void (*answer)(void *data, int status, const struct request *request, struct reply *reply);
	void *data;
};

/* 0 when it was idle for idle_ms. -EINVAL: more listeners than SERVER_LISTENERS_MAX, or none;
 * file_bytes_per_s is 0. */
must_check int server_run(const struct server_options *options);

#endif
