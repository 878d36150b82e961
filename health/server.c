/* A small HTTP server: one poll loop over listeners and clients, with a limit on time and memory
 * for each client. */
#include "health/server.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"

enum {
	/* Kernel memory for sending to each client; without a limit it would grow to megabytes. */
	SEND_BUFFER_BYTES = 64 * 1024,
	FILE_PIECE_BYTES = 32 * 1024,
	PAUSE_MS = 100, /* wait before accepting again if the system has no descriptors left */
};

enum stage { STAGE_FREE, STAGE_HEARS, STAGE_ANSWERS, STAGE_LEAVES };

struct client {
	enum stage stage;
	int fd;
	int64_t until_ms;
	uint8_t head[REQUEST_BYTES_MAX];
	size_t head_bytes;
	struct reply reply;
	size_t sent_bytes; /* bytes sent of reply.text */
	uint64_t file_at;  /* bytes sent of reply.file */
};

struct server {
	const struct server_options *options;
	struct client clients[SERVER_CLIENTS_MAX];
	size_t busy, files; /* open connections; those of them that receive a file */
	int64_t idle_since_ms;
	int64_t accept_at_ms; /* do not accept connections before this time */
};

static void drop_reply(struct server *server, struct client *client)
{
	buffer_finish(&client->reply.text);
	if (client->reply.file < 0)
		return;
	close(client->reply.file);
	client->reply.file = -1;
	server->files--;
}

static void part(struct server *server, struct client *client)
{
	close(client->fd);
	drop_reply(server, client);
	client->stage = STAGE_FREE;
	server->busy--;
	server->idle_since_ms = clock_now_ms();
}

static void meet(struct server *server, int fd)
{
	const int send_buffer_bytes = SEND_BUFFER_BYTES;
	struct client *client = server->clients;

	while (client->stage != STAGE_FREE) /* one is free, because no more are accepted */
		client++;
	*client = (struct client){ .stage = STAGE_HEARS, .fd = fd, .reply = { .file = -1 } };
	client->until_ms = clock_now_ms() + server->options->patience_ms;
	if (setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &send_buffer_bytes, sizeof(int)) < 0)
		log_warn("health", "a send buffer keeps its size: %s", strerror(errno));
	server->busy++;
}

static void accept_from(struct server *server, int listener)
{
	int fd;

	while (server->busy < SERVER_CLIENTS_MAX) {
		fd = accept4(listener, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
		if (fd >= 0) {
			meet(server, fd);
			continue;
		}
		if (errno != EAGAIN && errno != ECONNABORTED && errno != EINTR) {
			log_warn("health", "no connection is taken: %s", strerror(errno));
			server->accept_at_ms = clock_now_ms() + PAUSE_MS;
		}
		return;
	}
}

/* ---- one client, as far as possible without waiting */

/* Reads and drops what the client still sends, until it closes the connection: if we closed it with
 * unread bytes, the kernel would discard the answer. */
static void see_off(struct server *server, struct client *client)
{
	uint8_t dropped[4096];
	ssize_t size = read(client->fd, dropped, sizeof(dropped));

	if (size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR))
		part(server, client);
}

/* Sends a part; *sent is how much. Returns 0, also if the client cannot take more now, or a
 * negative errno. */
static int send_piece(int fd, const void *data, size_t size, size_t *sent)
{
	const ssize_t rc = send(fd, data, size, MSG_NOSIGNAL);

	*sent = rc > 0 ? (size_t)rc : 0;
	return rc < 0 && errno != EAGAIN && errno != EINTR ? -errno : 0;
}

/* Sends a piece of the file. It does not use sendfile, which raises SIGPIPE if the client is gone.
 * What the client did not take is read again. */
static int send_file_piece(struct client *client)
{
	const uint64_t left = client->reply.file_bytes - client->file_at;
	uint8_t piece[FILE_PIECE_BYTES];
	const size_t wanted = left < sizeof(piece) ? (size_t)left : sizeof(piece);
	const ssize_t size = pread(client->reply.file, piece, wanted, (off_t)client->file_at);
	size_t sent;
	int rc;

	if (size < 0 && errno == EINTR)
		return 0;
	if (size <= 0)
		return size < 0 ? -errno : -ENODATA; /* the file was truncated */
	rc = send_piece(client->fd, piece, (size_t)size, &sent);
	client->file_at += sent;
	return rc;
}

static int send_text_piece(struct client *client)
{
	const struct buffer *text = &client->reply.text;
	size_t sent;
	const int rc = send_piece(client->fd, text->data + client->sent_bytes,
				  text->size - client->sent_bytes, &sent);

	client->sent_bytes += sent;
	return rc;
}

static bool is_sent(const struct client *client)
{
	return client->sent_bytes == client->reply.text.size &&
	       (client->reply.file < 0 || client->file_at == client->reply.file_bytes);
}

static void send_answer(struct server *server, struct client *client)
{
	int rc = 0;

	if (client->sent_bytes < client->reply.text.size)
		rc = send_text_piece(client);
	else if (!is_sent(client))
		rc = send_file_piece(client);
	if (rc < 0) {
		part(server, client);
		return;
	}
	if (!is_sent(client))
		return;
	if (client->reply.file >= 0) /* the time so far was for the file */
		client->until_ms = clock_now_ms() + server->options->patience_ms;
	drop_reply(server, client);
	shutdown(client->fd, SHUT_WR);
	client->stage = STAGE_LEAVES;
}

/* Returns the time that the receiver of a file of that size gets in addition to patience_ms. */
static int64_t file_ms(const struct server_options *options, uint64_t bytes)
{
	const uint64_t seconds = bytes / options->file_bytes_per_s;

	return seconds < SERVER_FILE_MS_MAX / 1000 ? (int64_t)seconds * 1000 : SERVER_FILE_MS_MAX;
}

static void make_reply(struct server *server, struct client *client, int status,
		       const struct request *request)
{
	const struct server_options *options = server->options;
	struct reply *reply = &client->reply;

	buffer_init(&reply->text, SERVER_TEXT_BYTES_MAX);
	options->answer(options->data, status, request, reply);
	if (reply->file >= 0 && server->files == SERVER_FILES_MAX) {
		close(reply->file);
		reply->file = -1;
		buffer_clear(&reply->text);
		options->answer(options->data, 503, request, reply);
	}
	if (reply->file < 0)
		return;
	server->files++;
	client->until_ms += file_ms(options, reply->file_bytes);
}

static void hear(struct server *server, struct client *client)
{
	ssize_t size = read(client->fd, client->head + client->head_bytes,
			    sizeof(client->head) - client->head_bytes);
	struct request request = { 0 };
	int status;

	if (size < 0 && (errno == EAGAIN || errno == EINTR))
		return;
	if (size <= 0) {
		part(server, client);
		return;
	}
	client->head_bytes += (size_t)size;
	status = request_parse(&request, (struct bytes){ client->head, client->head_bytes });
	if (status == 0)
		return;
	make_reply(server, client, status, &request);
	if (client->reply.text.error) {
		log_warn("health", "an answer did not fit: %s",
			 strerror(-client->reply.text.error));
		part(server, client);
		return;
	}
	client->stage = STAGE_ANSWERS;
	send_answer(server, client);
}

static void serve(struct server *server, struct client *client)
{
	switch (client->stage) {
	case STAGE_FREE:
		break;
	case STAGE_HEARS:
		hear(server, client);
		break;
	case STAGE_ANSWERS:
		send_answer(server, client);
		break;
	case STAGE_LEAVES:
		see_off(server, client);
		break;
	}
}

/* ---- the loop */

static int wait_ms(const struct server *server)
{
	const int64_t now_ms = clock_now_ms();
	int64_t due_ms = INT64_MAX;

	if (server->busy == 0 && server->options->idle_ms > 0)
		due_ms = server->idle_since_ms + server->options->idle_ms;
	if (server->accept_at_ms > now_ms && server->accept_at_ms < due_ms)
		due_ms = server->accept_at_ms;
	for (size_t i = 0; i < SERVER_CLIENTS_MAX; i++)
		if (server->clients[i].stage != STAGE_FREE && server->clients[i].until_ms < due_ms)
			due_ms = server->clients[i].until_ms;
	if (due_ms == INT64_MAX)
		return -1;
	return due_ms <= now_ms ? 0 : due_ms - now_ms > 60000 ? 60000 : (int)(due_ms - now_ms);
}

static int turn(struct server *server)
{
	const size_t count = server->options->listener_count;
	struct pollfd ready[SERVER_LISTENERS_MAX + SERVER_CLIENTS_MAX];
	const bool full =
		server->busy == SERVER_CLIENTS_MAX || clock_now_ms() < server->accept_at_ms;

	for (size_t i = 0; i < count; i++)
		ready[i] = (struct pollfd){ .fd = full ? -1 : server->options->listeners[i],
					    .events = POLLIN };
	for (size_t i = 0; i < SERVER_CLIENTS_MAX; i++) {
		const struct client *client = &server->clients[i];

		ready[count + i] = (struct pollfd){
			.fd = client->stage == STAGE_FREE ? -1 : client->fd,
			.events = client->stage == STAGE_ANSWERS ? POLLOUT : POLLIN,
		};
	}
	if (poll(ready, count + SERVER_CLIENTS_MAX, wait_ms(server)) < 0)
		return errno == EINTR ? 0 : -errno;
	for (size_t i = 0; i < SERVER_CLIENTS_MAX; i++) {
		struct client *client = &server->clients[i];

		if (client->stage != STAGE_FREE && ready[count + i].revents)
			serve(server, client);
		if (client->stage != STAGE_FREE && clock_now_ms() >= client->until_ms)
			part(server, client);
	}
	for (size_t i = 0; i < count; i++)
		if (ready[i].revents)
			accept_from(server, ready[i].fd);
	return 0;
}

int server_run(const struct server_options *options)
{
	struct server server = { .options = options, .idle_since_ms = clock_now_ms() };
	int rc = 0;

	if (options->listener_count == 0 || options->listener_count > SERVER_LISTENERS_MAX ||
	    options->file_bytes_per_s == 0)
		return -EINVAL;
	for (size_t i = 0; i < options->listener_count; i++)
		if (fcntl(options->listeners[i], F_SETFL, O_NONBLOCK) < 0)
			return -errno;
	do
		rc = turn(&server);
	while (rc == 0 && (server.busy > 0 || options->idle_ms == 0 ||
			   clock_now_ms() < server.idle_since_ms + options->idle_ms));
	for (size_t i = 0; i < SERVER_CLIENTS_MAX; i++)
		if (server.clients[i].stage != STAGE_FREE)
			part(&server, &server.clients[i]);
	return rc;
}
