/* Drives libmicrohttpd from one loop without threads. libmicrohttpd limits a connection only while
 * it is silent; the loop limits the whole time of each, by shutting its socket down. */
#include "health/server.h"

#include <assert.h>
#include <errno.h>
#include <microhttpd.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"

enum {
	/* Kernel memory for sending to each client; without a limit it would grow to megabytes. */
	SEND_BUFFER_BYTES = 64 * 1024,
	CONNECTION_BYTES = 8 * 1024, /* memory for the heads of a request and its answer */
	FILE_PIECE_BYTES = 32 * 1024,
	WAIT_MS_MAX = 60000,
};

struct client {
	bool busy;
	int fd;           /* borrowed from libmicrohttpd */
	int64_t until_ms; /* INT64_MAX: its socket was shut down */
	bool has_file;
};

struct server {
	const struct server_options *options;
	struct MHD_Daemon *daemon;
	struct client clients[SERVER_CLIENTS_MAX];
	size_t client_count, file_count; /* connections; those of them that receive a file */
	int64_t idle_since_ms;
};

/* ---- connections */

static void begin_client(struct server *server, struct MHD_Connection *connection, void **context)
{
	const union MHD_ConnectionInfo *info =
		MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
	const int send_buffer_bytes = SEND_BUFFER_BYTES;
	struct client *client = server->clients;

	if (setsockopt(info->connect_fd, SOL_SOCKET, SO_SNDBUF, &send_buffer_bytes,
		       sizeof(send_buffer_bytes)) < 0)
		log_warn("health", "the size of a send buffer cannot be set: %s", strerror(errno));
	while (client->busy) {
		client++;
		assert(client < server->clients + SERVER_CLIENTS_MAX); /* the connection limit */
	}
	*client = (struct client){ .busy = true,
				   .fd = info->connect_fd,
				   .until_ms = clock_now_ms() + server->options->patience_ms };
	server->client_count++;
	*context = client;
}

static void end_client(struct server *server, struct client *client)
{
	server->file_count -= client->has_file;
	client->busy = false;
	server->client_count--;
	server->idle_since_ms = clock_now_ms();
}

static void on_connection(void *data, struct MHD_Connection *connection, void **context,
			  enum MHD_ConnectionNotificationCode code)
{
	if (code == MHD_CONNECTION_NOTIFY_STARTED)
		begin_client(data, connection, context);
	else
		end_client(data, *context);
}

static struct client *client_of(struct MHD_Connection *connection)
{
	return MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT)
		->socket_context;
}

/* libmicrohttpd closes a connection when it finds its socket shut down. */
static void disconnect_late_clients(struct server *server)
{
	for (size_t i = 0; i < SERVER_CLIENTS_MAX; i++) {
		struct client *client = &server->clients[i];

		if (!client->busy || clock_now_ms() < client->until_ms)
			continue;
		shutdown(client->fd, SHUT_RDWR);
		client->until_ms = INT64_MAX;
	}
}

/* ---- answers */

/* Returns the time that the receiver of a file of that size gets in addition to patience_ms. */
static int64_t file_ms(const struct server_options *options, uint64_t bytes)
{
	const uint64_t seconds = bytes / options->file_bytes_per_s;

	return seconds < SERVER_FILE_MS_MAX / 1000 ? (int64_t)seconds * 1000 : SERVER_FILE_MS_MAX;
}

/* Replaces the reply by the status in words. */
static void refuse(struct reply *reply, unsigned status)
{
	if (reply->file >= 0)
		close(reply->file);
	reply->file = -1;
	reply->status = (int)status;
	reply->type = "text/plain";
	buffer_finish(&reply->body);
	buffer_init(&reply->body, 64);
	buffer_print(&reply->body, "%u %s\n", status, MHD_get_reason_phrase_for(status));
}

/* Reads a piece of the file at *data, which starts at place. */
static ssize_t read_file(void *data, uint64_t place, char *out, size_t bytes)
{
	const ssize_t size = pread(*(int *)data, out, bytes, (off_t)place);

	return size > 0 ? size : MHD_CONTENT_READER_END_WITH_ERROR; /* 0: it was truncated */
}

static void close_file(void *data)
{
	close(*(int *)data);
	free(data);
}

/* Takes the file. libmicrohttpd's own response from a descriptor uses sendfile, which waits for
 * ever when the file was truncated. */
static struct MHD_Response *make_file_response(const struct reply *reply)
{
	struct MHD_Response *response = NULL;
	int *fd = malloc(sizeof(*fd));

	if (fd) {
		*fd = reply->file;
		response = MHD_create_response_from_callback(reply->file_bytes, FILE_PIECE_BYTES,
							     read_file, fd, close_file);
	}
	if (!response) {
		close(reply->file);
		free(fd);
	}
	return response;
}

/* Takes the contents of the reply. Returns NULL if there is no memory. */
static struct MHD_Response *make_response(struct reply *reply)
{
	struct MHD_Response *response;

	if (reply->file >= 0)
		return make_file_response(reply);
	response = MHD_create_response_from_buffer(reply->body.size, reply->body.data,
						   MHD_RESPMEM_MUST_FREE);
	if (!response)
		buffer_finish(&reply->body);
	return response;
}

static enum MHD_Result add_headers(struct MHD_Response *response, const struct reply *reply)
{
	const struct {
		const char *name, *value;
	} headers[] = {
		{ "Connection", "close" },
		{ "Cache-Control", "no-store" },
		{ "X-Content-Type-Options", "nosniff" },
		{ "Content-Security-Policy", "default-src 'none'; style-src 'unsafe-inline'" },
		{ "Allow", reply->status == MHD_HTTP_METHOD_NOT_ALLOWED ? "GET, HEAD" : NULL },
	};
	enum MHD_Result rc = MHD_YES;
	char type[80];

	snprintf(type, sizeof(type), "%s; charset=utf-8", reply->type);
	rc = MHD_add_response_header(response, "Content-Type", type);
	for (size_t i = 0; i < ARRAY_COUNT(headers) && rc == MHD_YES; i++)
		if (headers[i].value)
			rc = MHD_add_response_header(response, headers[i].name, headers[i].value);
	return rc;
}

/* Sends the reply and takes its contents. MHD_NO closes the connection. */
static enum MHD_Result send_reply(struct MHD_Connection *connection, struct reply *reply)
{
	struct MHD_Response *response = make_response(reply);
	enum MHD_Result rc = MHD_NO;

	if (!response)
		return MHD_NO;
	if (add_headers(response, reply) == MHD_YES)
		rc = MHD_queue_response(connection, (unsigned)reply->status, response);
	MHD_destroy_response(response); /* the connection holds it while it is sent */
	return rc;
}

static enum MHD_Result on_request(void *data, struct MHD_Connection *connection, const char *path,
				  const char *method, const char *version, const char *upload,
				  size_t *upload_bytes, void **request)
{
	struct server *server = data;
	const struct server_options *options = server->options;
	struct client *client = client_of(connection);
	struct reply reply = { .status = MHD_HTTP_NOT_FOUND, .file = -1 };

	(void)version, (void)upload, (void)upload_bytes, (void)request;
	if (strcmp(method, "GET") != 0 && strcmp(method, "HEAD") != 0) {
		refuse(&reply, MHD_HTTP_METHOD_NOT_ALLOWED);
		return send_reply(connection, &reply);
	}
	options->answer(options->data, path, &reply);
	if (reply.body.error) {
		log_warn("health", "an answer does not fit: %s", strerror(-reply.body.error));
		buffer_finish(&reply.body);
		return MHD_NO;
	}
	if (reply.file >= 0 && server->file_count == SERVER_FILES_MAX)
		refuse(&reply, MHD_HTTP_SERVICE_UNAVAILABLE);
	else if (reply.file < 0 && reply.body.size == 0)
		refuse(&reply, (unsigned)reply.status);
	if (reply.file >= 0) {
		client->has_file = true;
		server->file_count++;
		client->until_ms += file_ms(options, reply.file_bytes);
	}
	return send_reply(connection, &reply);
}

/* ---- the loop */

static int32_t wait_ms(const struct server *server)
{
	const int64_t now_ms = clock_now_ms();
	int64_t due_ms = now_ms + WAIT_MS_MAX;

	if (server->client_count == 0 && server->options->idle_ms > 0 &&
	    server->idle_since_ms + server->options->idle_ms < due_ms)
		due_ms = server->idle_since_ms + server->options->idle_ms;
	for (size_t i = 0; i < SERVER_CLIENTS_MAX; i++)
		if (server->clients[i].busy && server->clients[i].until_ms < due_ms)
			due_ms = server->clients[i].until_ms;
	return due_ms > now_ms ? (int32_t)(due_ms - now_ms) : 0;
}

static bool is_over(const struct server *server)
{
	return server->client_count == 0 && server->options->idle_ms > 0 &&
	       clock_now_ms() >= server->idle_since_ms + server->options->idle_ms;
}

int server_run(const struct server_options *options)
{
	struct server server = { .options = options, .idle_since_ms = clock_now_ms() };
	int rc = 0;

	if (options->file_bytes_per_s == 0)
		return -EINVAL;
	signal(SIGPIPE, SIG_IGN); /* a client may close while a file is being sent */
	server.daemon = MHD_start_daemon(
		MHD_USE_EPOLL, 0, NULL, NULL, on_request, &server, MHD_OPTION_LISTEN_SOCKET,
		options->listener, MHD_OPTION_NOTIFY_CONNECTION, on_connection, &server,
		MHD_OPTION_CONNECTION_LIMIT, (unsigned)SERVER_CLIENTS_MAX,
		MHD_OPTION_PER_IP_CONNECTION_LIMIT, (unsigned)SERVER_CLIENTS_PER_ADDRESS_MAX,
		MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)CONNECTION_BYTES,
		MHD_OPTION_SIGPIPE_HANDLED_BY_APP, 1, MHD_OPTION_END);
	if (!server.daemon)
		return -EINVAL;
	while (rc == 0 && !is_over(&server)) {
		if (MHD_run_wait(server.daemon, wait_ms(&server)) != MHD_YES)
			rc = -EIO;
		disconnect_late_clients(&server);
	}
	MHD_stop_daemon(server.daemon);
	return rc;
}
