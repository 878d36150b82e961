/* Client side of the fetcher's socket: starts gopura-fetch or connects to it, verifies each object
 * that arrives, and repeats all requests after a reconnect. */
#include "net/client.h"

#include <assert.h>
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/map.h"
#include "net/closer.h"
#include "net/packets.h"

extern char **environ;

enum {
	MESSAGES_MAX = 64, /* per dispatch: other sources share the frame loop */
	/* time limit of one dispatch */
	DISPATCH_US = 3000,
	PAUSE_MS = 100, /* before the first restart; doubles with each failure */
	PAUSE_MAX_MS = 10000,
	STEADY_MS = 10000, /* a connection that lasted longer resets the failure count */
	END_MS = 2000,     /* how long the fetcher may take to exit by itself */
	/* without any message; then it hangs (it sends a status at least every 30 s) */
	SILENT_MS = 90000,
	UNWANTED_MAX = 16, /* objects accepted on one connection that were never requested on it */
	/* send queue to the fetcher; holds every want of a large temple */
	QUEUE_BYTES_MAX = 64 << 20,
	FETCHER_FD = 3, /* descriptor number of the socket in the fetcher process */
};

enum source { SOURCE_SOCKET, SOURCE_CHILD, SOURCE_TIMER };

struct in_use {
	struct hash root;
	uint32_t root_bytes;
};

struct net_client {
	struct net_client_options options;
	int epoll_fd, timer_fd;
	struct packets packets; /* fd is -1 while not connected */
	/* EPOLLOUT is being watched */
	bool waits_to_send;
	/* Why a message could not be sent, so that the connection is given up; 0: all were.
	 * -ENOBUFS: the send queue is full because the fetcher does not read. */
	int unsent;
	/* Number of objects that may still arrive although nobody wants them. Each want that was
	 * dropped or repeated on this connection counts one, because its object may already be on
	 * its way. */
	uint64_t late_count;
	uint32_t unwanted_count; /* unrequested objects beyond late_count */
	pid_t pid;               /* of the fetcher we started; 0: none */
	int pid_fd;
	uint32_t failures; /* connections in a row that did not last */
	int64_t connected_ms, received_ms;
	/* Bytes received by earlier fetchers, and by the current one. */
	uint64_t received_before, received_now;
	struct map wants; /* from hash_key to struct message_want, owned */
	struct map keeps; /* of hash_key; the values mean nothing */
	struct in_use releases[MESSAGE_RELEASES_MAX];
	size_t release_count;
};

/* ---- helpers */

static struct message_want *find_want(const struct net_client *client, struct hash hash)
{
	return map_get_pointer(&client->wants, hash_key(hash));
}

static int watch(struct net_client *client, int fd, enum source source, uint32_t events, int how)
{
	struct epoll_event event = { .events = events, .data.u32 = source };

	return epoll_ctl(client->epoll_fd, how, fd, &event) < 0 ? -errno : 0;
}

static void set_timer(struct net_client *client, int64_t after_ms)
{
	struct itimerspec when = { .it_value = { after_ms / 1000, after_ms % 1000 * 1000000 } };

	timerfd_settime(client->timer_fd, 0, &when, NULL);
}

/* Watches for EPOLLOUT only while messages wait in the queue. */
static void watch_socket(struct net_client *client)
{
	bool waits = packets_wait(&client->packets);

	if (client->packets.fd < 0 || waits == client->waits_to_send)
		return;
	if (watch(client, client->packets.fd, SOURCE_SOCKET, EPOLLIN | (waits ? EPOLLOUT : 0u),
		  EPOLL_CTL_MOD) == 0)
		client->waits_to_send = waits;
}

/* supervise disconnects later: this may run while a message is being handled. */
static void give_up(struct net_client *client, int rc)
{
	client->unsent = rc;
	set_timer(client, 1);
}

/* Sends a message. While not connected it does nothing, because send_all_state repeats the state
 * after connecting. A broken socket is detected when receiving. */
static void send_message(struct net_client *client, const struct message *message)
{
	int rc;

	if (client->packets.fd < 0 || client->unsent < 0)
		return;
	if (client->packets.queued_bytes > QUEUE_BYTES_MAX) {
		give_up(client, -ENOBUFS);
		return;
	}
	rc = packets_send(&client->packets, message, -1);
	if (rc < 0 && rc != -EPIPE && rc != -ECONNRESET)
		give_up(client, rc);
	watch_socket(client);
}

/* ---- connecting */

static void send_releases(struct net_client *client)
{
	for (size_t i = 0; i < client->release_count; i++) {
		const struct in_use *release = &client->releases[i];
		struct message message = { .kind = MESSAGE_RELEASE,
					   .release = { release->root, release->root_bytes,
							i > 0 } };

		send_message(client, &message);
	}
}

static void send_trust(struct net_client *client)
{
	send_message(client, &(struct message){ .kind = MESSAGE_TRUST,
						.root_version = client->options.root_version });
}

static void send_all_state(struct net_client *client)
{
	struct message message = { .kind = MESSAGE_ASK_META, .period_s = client->options.poll_s };
	map_key keep;
	const struct message_want *want;
	size_t at = 0;

	send_releases(client);
	send_trust(client);
	send_message(client, &message);
	message.kind = MESSAGE_KEEP;
	while (map_next_key(&client->keeps, &at, &keep)) {
		message.keep = hash_from_key(keep);
		send_message(client, &message);
	}
	at = 0;
	message.kind = MESSAGE_WANT;
	while ((want = map_next_pointer(&client->wants, &at))) {
		message.want = *want;
		send_message(client, &message);
	}
}

/* Takes fd. */
static int adopt_socket(struct net_client *client, int fd)
{
	int rc;

	packets_init(&client->packets, fd);
	client->waits_to_send = false;
	client->unsent = 0;
	client->late_count = client->unwanted_count = 0;
	client->connected_ms = client->received_ms = clock_now_ms();
	set_timer(client, SILENT_MS);
	rc = watch(client, fd, SOURCE_SOCKET, EPOLLIN, EPOLL_CTL_ADD);
	if (rc < 0)
		packets_finish(&client->packets);
	return rc;
}

static int connect_to(struct net_client *client, const char *path)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	int fd;

	if (strlen(path) >= sizeof(address.sun_path))
		return -ENAMETOOLONG;
	memcpy(address.sun_path, path, strlen(path) + 1);
	fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (fd < 0)
		return -errno;
	if (connect(fd, (struct sockaddr *)&address, sizeof(address)) < 0) {
		int rc = -errno;

		close(fd);
		return rc;
	}
	return adopt_socket(client, fd);
}

/* Starts the fetcher. It gets our end of the socket pair as FETCHER_FD, an empty signal mask and
 * the default signal handlers. fd is borrowed. */
static int spawn_with(struct net_client *client, char *const *arguments, int fd)
{
	posix_spawn_file_actions_t actions;
	posix_spawnattr_t attributes;
	sigset_t none, all;
	int rc;

	sigemptyset(&none);
	sigfillset(&all);
	posix_spawn_file_actions_init(&actions);
	posix_spawnattr_init(&attributes);
	posix_spawn_file_actions_adddup2(&actions, fd, FETCHER_FD);
	posix_spawnattr_setsigmask(&attributes, &none);
	posix_spawnattr_setsigdefault(&attributes, &all);
	posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
	rc = posix_spawn(&client->pid, client->options.program, &actions, &attributes, arguments,
			 environ);
	posix_spawnattr_destroy(&attributes);
	posix_spawn_file_actions_destroy(&actions);
	if (rc != 0) {
		client->pid = 0;
		return -rc;
	}
	client->pid_fd = pidfd_open(client->pid, 0);
	if (client->pid_fd < 0)
		return -errno;
	return watch(client, client->pid_fd, SOURCE_CHILD, EPOLLIN, EPOLL_CTL_ADD);
}

static int start_fetcher(struct net_client *client)
{
	const struct net_client_options *options = &client->options;
	char budget[32], fd[8];
	const char *arguments[20] = {
		options->program, "--release", options->release_url, "--cache", options->cache_path,
		"--fd",           fd,          "--cache-budget",     budget
	};
	size_t count = 9;
	int pair[2], rc;

	snprintf(fd, sizeof(fd), "%d", FETCHER_FD);
	snprintf(budget, sizeof(budget), "%llu",
		 (unsigned long long)(options->cache_budget_bytes >> 20));
	if (options->stick_path) {
		arguments[count++] = "--stick";
		arguments[count++] = options->stick_path;
	}
	if (options->ca_file) {
		arguments[count++] = "--ca";
		arguments[count++] = options->ca_file;
	}
	if (options->redirect_hosts) {
		arguments[count++] = "--redirect-hosts";
		arguments[count++] = options->redirect_hosts;
	}
	if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) < 0)
		return -errno;
	rc = spawn_with(client, (char *const *)arguments, pair[1]);
	close(pair[1]);
	if (rc < 0) {
		close(pair[0]);
		return rc;
	}
	return adopt_socket(client, pair[0]);
}

static void retry_later(struct net_client *client)
{
	int64_t pause_ms = PAUSE_MS;

	if (client->connected_ms && clock_now_ms() - client->connected_ms > STEADY_MS)
		client->failures = 0;
	for (uint32_t i = 0; i < client->failures && pause_ms < PAUSE_MAX_MS; i++)
		pause_ms *= 2;
	client->failures++;
	client->connected_ms = 0;
	set_timer(client, pause_ms < PAUSE_MAX_MS ? pause_ms : PAUSE_MAX_MS);
}

static void connect_now(struct net_client *client)
{
	const char *what =
		client->options.socket_path ? client->options.socket_path : client->options.program;
	int rc;

	if (closer_is_full())
		rc = -EBUSY; /* earlier descriptors still hang in close() */
	else if (client->options.socket_path)
		rc = connect_to(client, client->options.socket_path);
	else
		rc = start_fetcher(client);
	if (rc == 0) {
		send_all_state(client);
		return;
	}
	if (client->failures == 0)
		log_error("net", "cannot connect to the fetcher at %s: %s", what, strerror(-rc));
	retry_later(client);
}

static void disconnect(struct net_client *client, const char *why)
{
	if (client->packets.fd < 0)
		return;
	log_warn("net", "the fetcher is disconnected: %s", why);
	client->received_before += client->received_now;
	client->received_now = 0;
	if (watch(client, client->packets.fd, SOURCE_SOCKET, 0, EPOLL_CTL_DEL) < 0)
		log_debug("net", "the fetcher's socket was not in epoll");
	packets_finish(&client->packets);
	if (client->pid)
		kill(client->pid, SIGTERM); /* its closed socket ends it anyway */
	retry_later(client);
}

/* Returns false while the child process still runs. */
static bool reap(struct net_client *client)
{
	if (client->pid && waitpid(client->pid, NULL, WNOHANG) == 0)
		return false;
	if (client->pid && client->pid_fd >= 0)
		close(client->pid_fd);
	client->pid = 0;
	client->pid_fd = -1;
	return true;
}

/* Disconnects a fetcher that hangs or does not read. A hanging fetcher counts as dead. */
static void supervise(struct net_client *client)
{
	int64_t silent_ms = clock_now_ms() - client->received_ms;

	if (client->unsent < 0) {
		disconnect(client, client->unsent == -ENOBUFS ? "it does not read its messages"
							      : strerror(-client->unsent));
		return;
	}
	if (silent_ms < SILENT_MS) {
		set_timer(client, SILENT_MS - silent_ms + 1);
		return;
	}
	if (client->pid)
		kill(client->pid, SIGKILL);
	disconnect(client, "it sent nothing for a long time");
}

/* Either supervises the connection, or reconnects when the pause is over. Only one process may own
 * the cache, so the old fetcher must have exited first. */
static void on_timer(struct net_client *client)
{
	uint64_t expirations;

	if (read(client->timer_fd, &expirations, sizeof(expirations)) < 0)
		return;
	if (client->packets.fd >= 0) {
		supervise(client);
		return;
	}
	if (!reap(client)) {
		kill(client->pid, SIGKILL);
		set_timer(client, PAUSE_MS);
		return;
	}
	connect_now(client);
}

/* ---- what the fetcher sends */

/* Counts an object that nobody waits for; it is neither hashed nor mapped. -EBADMSG: too many of
 * them arrived. */
static int count_unwanted(struct net_client *client)
{
	if (client->late_count > 0) {
		client->late_count--;
		return 0;
	}
	return ++client->unwanted_count > UNWANTED_MAX ? -EBADMSG : 0;
}

/* Verifies the hash and passes the object on. -EBADMSG: the bytes do not have that hash. */
static int pass_on(struct net_client *client, struct hash hash, struct bytes bytes)
{
	struct message_want *wanted = find_want(client, hash);

	if (!hash_equal(hash_of(bytes), hash))
		return -EBADMSG;
	map_remove(&client->wants, hash_key(hash));
	free(wanted);
	client->options.events.object(client->options.data, hash, bytes);
	return 0;
}

/* Takes the descriptor `passed` (-1: none). */
static int take_object(struct net_client *client, const struct message *message, int passed)
{
	struct bytes mapped;
	int rc;

	if (!find_want(client, message->object.hash)) {
		if (passed >= 0)
			close(passed);
		return count_unwanted(client);
	}
	if (passed < 0)
		return pass_on(client, message->object.hash, message->object.bytes);
	rc = packets_map_sealed(&mapped, passed, message->object.size);
	close(passed);
	if (rc < 0)
		return rc;
	rc = pass_on(client, message->object.hash, mapped);
	munmap((void *)mapped.data, mapped.size);
	return rc;
}

/* Each fetcher counts bytes from its own start. The kiosk gets the sum over all fetchers. */
static void pass_status(struct net_client *client, struct message_status status)
{
	client->received_now = status.received_bytes;
	status.received_bytes += client->received_before;
	if (client->options.events.status)
		client->options.events.status(client->options.data, &status);
}

static int handle_message(struct net_client *client, const struct message *message, int passed)
{
	const struct net_client_events *events = &client->options.events;
	void *data = client->options.data;

	switch (message->kind) {
	case MESSAGE_OBJECT:
		return take_object(client, message, passed);
	case MESSAGE_MISSING:
		if (events->missing && find_want(client, message->missing.hash))
			events->missing(data, message->missing.hash, message->missing.reason);
		return 0;
	case MESSAGE_META:
		if (events->meta)
			events->meta(data, message->meta.role, message->meta.version,
				     message->meta.bytes, message->meta.source);
		/* the fetcher waits for this answer, whether the kiosk accepted the root or not */
		if (message->meta.role == META_ROOT)
			send_trust(client);
		return 0;
	case MESSAGE_FILE:
		if (events->file)
			events->file(data, &message->file);
		return 0;
	case MESSAGE_SYNCED:
		if (events->synced)
			events->synced(data, message->synced);
		return 0;
	case MESSAGE_STATUS:
		pass_status(client, message->status);
		return 0;
	default:
		return -EBADMSG; /* only the client may send this kind of message */
	}
}

static void receive_messages(struct net_client *client)
{
	int64_t until_us = clock_now_us() + DISPATCH_US;
	int rc = packets_flush(&client->packets);

	for (int i = 0; rc == 0 && i < MESSAGES_MAX && clock_now_us() < until_us; i++) {
		struct message message;
		int passed;

		rc = packets_receive(&client->packets, &message, &passed);
		if (rc == 0) {
			client->received_ms = clock_now_ms();
			rc = handle_message(client, &message, passed);
		}
	}
	watch_socket(client);
	if (rc == -EBADMSG)
		disconnect(client, "fetcher bug: it sent an invalid message, wrong bytes, or "
				   "unwanted objects");
	else if (rc < 0 && rc != -EAGAIN)
		disconnect(client, rc == -EPIPE ? "it closed the socket" : strerror(-rc));
}

int net_client_fd(const struct net_client *client)
{
	return client->epoll_fd;
}

int net_client_dispatch(struct net_client *client)
{
	struct epoll_event events[4];
	int count = epoll_wait(client->epoll_fd, events, 4, 0);

	if (count < 0 && errno != EINTR)
		return -errno;
	for (int i = 0; i < count; i++) {
		switch ((enum source)events[i].data.u32) {
		case SOURCE_SOCKET:
			if (client->packets.fd >= 0)
				receive_messages(client);
			break;
		case SOURCE_CHILD:
			/* Messages that the fetcher sent before it exited are read first. The
			 * socket itself reports the end of the connection. */
			if (client->packets.fd < 0)
				reap(client);
			else
				receive_messages(client);
			break;
		case SOURCE_TIMER:
			on_timer(client);
			break;
		}
	}
	return 0;
}

/* ---- create, destroy */

/* Replaces *text by a copy. NULL stays NULL. */
static int copy_text(const char **text)
{
	if (!*text)
		return 0;
	*text = strdup(*text);
	return *text ? 0 : -ENOMEM;
}

static int copy_options(struct net_client *client, const struct net_client_options *options)
{
	const char **const texts[] = { &client->options.socket_path,   &client->options.program,
				       &client->options.release_url,   &client->options.cache_path,
				       &client->options.ca_file,       &client->options.stick_path,
				       &client->options.redirect_hosts };
	int rc = 0;

	client->options = *options;
	for (size_t i = 0; i < ARRAY_COUNT(texts); i++) {
		if (rc < 0)
			*texts[i] = NULL; /* not copied yet, so we must not free it */
		else
			rc = copy_text(texts[i]);
	}
	if (client->options.cache_budget_bytes < 4 << 20)
		client->options.cache_budget_bytes = 4 << 20;
	return rc;
}

int net_client_create(struct net_client **out, const struct net_client_options *options)
{
	struct net_client *client = calloc(1, sizeof(*client));
	int rc;

	*out = NULL;
	if (!client)
		return -ENOMEM;
	client->packets.fd = client->pid_fd = -1;
	rc = copy_options(client, options);
	client->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
	client->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
	if (rc == 0 && (client->epoll_fd < 0 || client->timer_fd < 0))
		rc = -errno;
	if (rc == 0 && !options->socket_path &&
	    (!options->program || !options->release_url || !options->cache_path))
		rc = -EINVAL;
	if (rc == 0)
		rc = watch(client, client->timer_fd, SOURCE_TIMER, EPOLLIN, EPOLL_CTL_ADD);
	if (rc < 0) {
		net_client_destroy(client);
		return rc;
	}
	connect_now(client);
	*out = client;
	return 0;
}

static void end_fetcher(struct net_client *client)
{
	struct pollfd child = { .fd = client->pid_fd, .events = POLLIN };

	if (!client->pid)
		return;
	kill(client->pid, SIGTERM);
	if (client->pid_fd < 0 || poll(&child, 1, END_MS) <= 0)
		kill(client->pid, SIGKILL);
	waitpid(client->pid, NULL, 0);
	if (client->pid_fd >= 0)
		close(client->pid_fd);
}

static void forget_objects(struct net_client *client)
{
	struct message_want *wanted;
	size_t at = 0;

	while ((wanted = map_next_pointer(&client->wants, &at)))
		free(wanted);
	map_finish(&client->wants);
	map_finish(&client->keeps);
}

void net_client_destroy(struct net_client *client)
{
	if (!client)
		return;
	packets_finish(&client->packets);
	end_fetcher(client);
	if (client->timer_fd >= 0)
		close(client->timer_fd);
	if (client->epoll_fd >= 0)
		close(client->epoll_fd);
	forget_objects(client);
	free((char *)client->options.socket_path);
	free((char *)client->options.program);
	free((char *)client->options.release_url);
	free((char *)client->options.cache_path);
	free((char *)client->options.ca_file);
	free((char *)client->options.stick_path);
	free((char *)client->options.redirect_hosts);
	free(client);
}

/* ---- requests of the kiosk */

static void add_release(struct net_client *client, struct hash root, uint32_t root_bytes, bool also)
{
	struct message message = { .kind = MESSAGE_RELEASE, .release = { root, root_bytes, also } };

	/* The list is full: the release in use stays first, and the oldest of the others is
	 * removed. */
	if (client->release_count == MESSAGE_RELEASES_MAX) {
		memmove(&client->releases[1], &client->releases[2],
			(MESSAGE_RELEASES_MAX - 2) * sizeof(client->releases[0]));
		client->release_count--;
	}
	client->releases[client->release_count++] = (struct in_use){ root, root_bytes };
	send_message(client, &message);
}

void net_client_use_release(struct net_client *client, struct hash root, uint32_t root_bytes)
{
	if (client->release_count == 1 && hash_equal(client->releases[0].root, root))
		return;
	client->late_count += client->wants.count;
	forget_objects(client);
	client->release_count = 0;
	add_release(client, root, root_bytes, false);
}

void net_client_add_release(struct net_client *client, struct hash root, uint32_t root_bytes)
{
	for (size_t i = 0; i < client->release_count; i++)
		if (hash_equal(client->releases[i].root, root))
			return;
	add_release(client, root, root_bytes, client->release_count > 0);
}

int net_client_want(struct net_client *client, const struct message_want *want)
{
	struct message message = { .kind = MESSAGE_WANT, .want = *want };
	struct message_want *wanted = find_want(client, want->hash);

	if (wanted && wanted->priority == want->priority)
		return 0;
	if (wanted) /* the object may be on its way already, and will then arrive twice */
		client->late_count++;
	if (!wanted) {
		wanted = calloc(1, sizeof(*wanted));
		if (!wanted)
			return -ENOMEM;
		if (map_set(&client->wants, hash_key(want->hash), (uintptr_t)wanted) < 0) {
			free(wanted);
			return -ENOMEM;
		}
	}
	*wanted = *want;
	send_message(client, &message);
	return 0;
}

void net_client_drop(struct net_client *client, struct hash hash)
{
	struct message message = { .kind = MESSAGE_DROP, .drop = hash };
	struct message_want *wanted = find_want(client, hash);

	if (!wanted)
		return;
	map_remove(&client->wants, hash_key(hash));
	free(wanted);
	client->late_count++;
	send_message(client, &message);
}

void net_client_sync(struct net_client *client)
{
	send_message(client, &(struct message){ .kind = MESSAGE_SYNC });
}

void net_client_trust(struct net_client *client, uint32_t root_version)
{
	const bool begins_tuf =
		root_version == MESSAGE_TRUST_TUF && client->options.root_version != root_version;

	client->options.root_version = root_version;
	if (begins_tuf) /* no root came that the fetcher waits to be told about */
		send_trust(client);
}

void net_client_ask_file(struct net_client *client, const struct message_file *file)
{
	assert(message_name_is_fine(file->name));
	send_message(client, &(struct message){ .kind = MESSAGE_ASK_FILE, .file = *file });
}

void net_client_keep(struct net_client *client, struct hash hash)
{
	struct message message = { .kind = MESSAGE_KEEP, .keep = hash };

	if (map_add(&client->keeps, hash_key(hash), 0) > 0)
		send_message(client, &message);
}
