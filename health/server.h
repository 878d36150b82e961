/* An HTTP/1.1 server for a few clients on one thread: one request for each connection. What clients
 * can use is limited: SERVER_CLIENTS_MAX connections, and for each REQUEST_BYTES_MAX bytes of
 * request, SERVER_TEXT_BYTES_MAX bytes of answer in memory, and patience_ms of time. A file is sent
 * in pieces and never held in memory as a whole; its receiver has more time, by the file's size,
 * and SERVER_FILES_MAX files are served at once. */
#ifndef GOPURA_HEALTH_SERVER_H
#define GOPURA_HEALTH_SERVER_H

#include "health/request.h"

enum {
	SERVER_CLIENTS_MAX = 16,
	SERVER_LISTENERS_MAX = 4,
	SERVER_FILES_MAX = 4, /* so that slow receivers of files leave room for other requests */
	SERVER_TEXT_BYTES_MAX = 132 * 1024,
	SERVER_FILE_MS_MAX = 600000, /* limit of the time added for a file */
};

/* A whole HTTP answer: text, then file_bytes bytes from the beginning of file. If the file is
 * truncated meanwhile, the connection ends before the announced length. */
struct reply {
	struct buffer text;
	int file; /* -1: none; taken by the server, which closes it */
	uint64_t file_bytes;
};

struct server_options {
	const int *listeners; /* borrowed; listening stream sockets, which are made non-blocking */
	size_t listener_count;
	int64_t patience_ms; /* time limit of a connection, after which it is closed */
	int64_t idle_ms;     /* the server ends after so long without a connection; 0: never */
	/* The receiver of a file gets one more second for each so many bytes; slower ones are cut
	 * off. */
	uint64_t file_bytes_per_s;
	/* Fills in reply, which is empty. status 200: answer the request; 503: too many files are
	 * being sent; otherwise what request_parse found wrong. */
	void (*answer)(void *data, int status, const struct request *request, struct reply *reply);
	void *data;
};

/* Runs the server. Returns 0 after it was idle for idle_ms; -EINVAL if there are no listeners or
 * more than SERVER_LISTENERS_MAX, or file_bytes_per_s is 0; or another negative errno if it cannot
 * wait for sockets. */
must_check int server_run(const struct server_options *options);

#endif
