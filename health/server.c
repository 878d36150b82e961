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
	ANSWER_BYTES_MOST = 9 << 20, /* the counts of 400 days; others have some kilobytes */
	PAUSE_MS = 100,              /* when the system has no descriptors left */
};

enum stage { STAGE_FREE, STAGE_HEARS, STAGE_ANSWERS, STAGE_LEAVES };

struct client {
	enum stage stage;
	int fd;
	int64_t until_ms;
	uint8_t head[REQUEST_BYTES_MOST];
	size_t head_bytes;
	struct buffer answer;
	size_t sent_bytes;
};

struct server {
	const struct server_options *options;
	struct client clients[SERVER_CLIENTS_MOST];
	size_t busy;
	int64_t idle_since_ms;
	int64_t accept_at_ms; /* not before */
};

static void part(struct server *server, struct client *client)
{
	close(client->fd);
	buffer_finish(&client->answer);
	client->stage = STAGE_FREE;
	server->busy--;
	server->idle_since_ms = clock_now_ms();
}

static void meet(struct server *server, int fd)
{
	struct client *client = server->clients;

	while (client->stage != STAGE_FREE) /* one is: more are not let in */
		client++;
	*client = (struct client){ .stage = STAGE_HEARS, .fd = fd };
	client->until_ms = clock_now_ms() + server->options->patience_ms;
	buffer_init(&client->answer, ANSWER_BYTES_MOST);
	server->busy++;
}

static void accept_from(struct server *server, int listener)
{
	int fd;

	while (server->busy < SERVER_CLIENTS_MOST) {
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

/* ---- a client, as far as it goes without waiting */

/* What else it says is read and dropped until it hangs up: closed over unread bytes, the kernel
 * would throw the answer away. */
static void see_off(struct server *server, struct client *client)
{
	uint8_t dropped[4096];
	ssize_t size = read(client->fd, dropped, sizeof(dropped));

	if (size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR))
		part(server, client);
}

static void send_answer(struct server *server, struct client *client)
{
	const struct buffer *answer = &client->answer;
	ssize_t size = send(client->fd, answer->data + client->sent_bytes,
			    answer->size - client->sent_bytes, MSG_NOSIGNAL);

	if (size < 0 && errno != EAGAIN && errno != EINTR) {
		part(server, client);
		return;
	}
	client->sent_bytes += size > 0 ? (size_t)size : 0;
	if (client->sent_bytes < answer->size)
		return;
	shutdown(client->fd, SHUT_WR);
	client->stage = STAGE_LEAVES;
}

static void hear(struct server *server, struct client *client)
{
	const struct server_options *options = server->options;
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
	options->answer(options->data, status, &request, &client->answer);
	if (client->answer.error) {
		log_warn("health", "an answer did not fit: %s", strerror(-client->answer.error));
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
	for (size_t i = 0; i < SERVER_CLIENTS_MOST; i++)
		if (server->clients[i].stage != STAGE_FREE && server->clients[i].until_ms < due_ms)
			due_ms = server->clients[i].until_ms;
	if (due_ms == INT64_MAX)
		return -1;
	return due_ms <= now_ms ? 0 : due_ms - now_ms > 60000 ? 60000 : (int)(due_ms - now_ms);
}

static int turn(struct server *server)
{
	const size_t count = server->options->listener_count;
	struct pollfd ready[SERVER_LISTENERS_MOST + SERVER_CLIENTS_MOST];
	const bool full =
		server->busy == SERVER_CLIENTS_MOST || clock_now_ms() < server->accept_at_ms;

	for (size_t i = 0; i < count; i++)
		ready[i] = (struct pollfd){ .fd = full ? -1 : server->options->listeners[i],
					    .events = POLLIN };
	for (size_t i = 0; i < SERVER_CLIENTS_MOST; i++) {
		const struct client *client = &server->clients[i];

		ready[count + i] = (struct pollfd){
			.fd = client->stage == STAGE_FREE ? -1 : client->fd,
			.events = client->stage == STAGE_ANSWERS ? POLLOUT : POLLIN,
		};
	}
	if (poll(ready, count + SERVER_CLIENTS_MOST, wait_ms(server)) < 0)
		return errno == EINTR ? 0 : -errno;
	for (size_t i = 0; i < SERVER_CLIENTS_MOST; i++) {
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

	if (options->listener_count == 0 || options->listener_count > SERVER_LISTENERS_MOST)
		return -EINVAL;
	for (size_t i = 0; i < options->listener_count; i++)
		if (fcntl(options->listeners[i], F_SETFL, O_NONBLOCK) < 0)
			return -errno;
	do
		rc = turn(&server);
	while (rc == 0 && (server.busy > 0 || options->idle_ms == 0 ||
			   clock_now_ms() < server.idle_since_ms + options->idle_ms));
	for (size_t i = 0; i < SERVER_CLIENTS_MOST; i++)
		if (server.clients[i].stage != STAGE_FREE)
			part(&server, &server.clients[i]);
	return rc;
}
