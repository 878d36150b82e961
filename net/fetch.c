/* The event loop of gopura-fetch. It serves the kiosk's socket and runs the downloader, the
 * metadata poll, the USB stick and the metrics socket. */
#include "net/fetch.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/metrics_socket.h"
#include "base/service.h"
#include "net/asked_file.h"
#include "net/downloader.h"
#include "net/packets.h"
#include "net/poll.h"

enum {
	QUEUE_BYTES_MAX = 8 << 20, /* to the kiosk; beyond this no more objects are fetched */
	PACKETS_MAX = 512,         /* read per call */
	/* an object stays uncommitted in the cache's transaction at most this long */
	FLUSH_MS = 500,
	STATUS_MS = 1000, /* status interval while values change */
	/* status interval while they do not change: shows the kiosk that we are alive */
	ALIVE_MS = 30000,
};

enum source {
	SOURCE_LISTENER,
	SOURCE_KIOSK,
	SOURCE_HTTP,
	SOURCE_STICK,
	SOURCE_SIGNAL,
	SOURCE_METRICS,
};

struct fetch {
	const struct fetch_options *options;
	int epoll_fd, listen_fd, signal_fd;
	bool has_kiosk, kiosk_waits; /* kiosk_waits: EPOLLOUT is watched on its socket */
	int unsent;                  /* why a message could not be sent to the kiosk; 0: all were */
	bool ends;
	struct packets kiosk;
	struct http *http;
	struct cache *cache;
	struct link link;
	struct metrics_refusal refusal; /* the last refusal of something from the server */
	uint64_t refused_writes;        /* of the cache, as they were seen last */
	int64_t refused_write_s;        /* wall clock then */
	struct downloader *downloader;
	struct poll *poll;
	struct asked_file *asked;
	struct stick *stick;            /* NULL: no stick is used */
	struct metrics_socket *metrics; /* NULL: not offered */
	/* the last status sent */
	struct message_status sent_status;
	int64_t flush_ms, status_ms; /* when due (clock_now_ms) */
	int64_t sent_status_ms;      /* when the kiosk was last sent a status */
};

/* ---- the kiosk connects and disconnects */

static int watch(struct fetch *fetch, int fd, enum source source, uint32_t events, int how)
{
	struct epoll_event event = { .events = events, .data.u32 = source };

	return epoll_ctl(fetch->epoll_fd, how, fd, &event) < 0 ? -errno : 0;
}

static void disconnect_kiosk(struct fetch *fetch, const char *why)
{
	if (!fetch->has_kiosk)
		return;
	log_info("net", "the kiosk is disconnected: %s", why);
	fetch->has_kiosk = fetch->kiosk_waits = false;
	if (watch(fetch, fetch->kiosk.fd, SOURCE_KIOSK, 0, EPOLL_CTL_DEL) < 0)
		log_debug("net", "the kiosk's socket was not in epoll");
	packets_finish(&fetch->kiosk);
	downloader_clear(fetch->downloader);
	poll_stop(fetch->poll);
	asked_file_drop(fetch->asked);
	if (fetch->listen_fd < 0)
		fetch->ends = true;
}

static int use_connection(struct fetch *fetch, int fd)
{
	packets_init(&fetch->kiosk, fd);
	fetch->has_kiosk = true;
	fetch->kiosk_waits = false;
	fetch->unsent = 0;
	fetch->sent_status = (struct message_status){ 0 };
	fetch->status_ms = 0;
	return watch(fetch, fd, SOURCE_KIOSK, EPOLLIN, EPOLL_CTL_ADD);
}

/* Only one kiosk is served. A new connection replaces the old one, because a restarted kiosk
 * reconnects before its old socket is detected as closed. */
static int accept_kiosk(struct fetch *fetch)
{
	int fd = accept4(fetch->listen_fd, NULL, NULL, SOCK_CLOEXEC);

	if (fd < 0)
		return errno == EAGAIN || errno == ECONNABORTED || errno == EINTR ? 0 : -errno;
	disconnect_kiosk(fetch, "another kiosk connected");
	log_info("net", "a kiosk connected");
	return use_connection(fetch, fd);
}

static void send_to_kiosk(struct fetch *fetch, const struct message *message, int passed)
{
	int rc = packets_send(&fetch->kiosk, message, passed);

	if (rc == -EPIPE || rc == -ECONNRESET)
		return; /* the next receive detects it */
	/* work disconnects: this may run within another module's call */
	if (rc < 0)
		fetch->unsent = rc;
}

/* ---- events from the other modules */

static void on_object(void *data, struct hash hash, struct bytes bytes)
{
	struct fetch *fetch = data;
	struct message message = { .kind = MESSAGE_OBJECT,
				   .object = { hash, bytes, (uint32_t)bytes.size } };
	int passed = -1;

	if (bytes.size > MESSAGE_INLINE_MAX) {
		passed = packets_seal(bytes);
		if (passed < 0) {
			fetch->unsent = passed;
			return;
		}
		message.object.bytes = (struct bytes){ NULL, 0 };
	}
	send_to_kiosk(fetch, &message, passed);
}

static void on_missing(void *data, struct hash hash, enum missing_reason reason)
{
	struct message message = { .kind = MESSAGE_MISSING, .missing = { hash, reason } };

	send_to_kiosk(data, &message, -1);
}

static bool kiosk_has_room(const struct fetch *fetch)
{
	return fetch->has_kiosk && fetch->kiosk.queued_bytes < QUEUE_BYTES_MAX;
}

static bool has_room(void *data)
{
	return kiosk_has_room(data);
}

static void on_meta(void *data, enum meta_role role, uint32_t version, struct bytes bytes)
{
	struct message message = { .kind = MESSAGE_META,
				   .meta = { role, version, bytes, META_FROM_SERVER } };

	send_to_kiosk(data, &message, -1);
}

static void on_stick_meta(void *data, enum meta_role role, uint32_t version, struct bytes bytes)
{
	struct message message = { .kind = MESSAGE_META,
				   .meta = { role, version, bytes, META_FROM_STICK } };

	send_to_kiosk(data, &message, -1);
}

static void on_file(void *data, const struct message_file *file)
{
	send_to_kiosk(data, &(struct message){ .kind = MESSAGE_FILE, .file = *file }, -1);
}

static void on_stick_object(void *data, struct hash hash, int rc, struct bytes bytes)
{
	struct fetch *fetch = data;

	downloader_stick_answered(fetch->downloader, hash, rc, bytes);
}

static bool is_wanted_of_stick(void *data, struct hash hash)
{
	const struct fetch *fetch = data;

	return downloader_wants_of_stick(fetch->downloader, hash);
}

/* ---- requests from the kiosk */

static int handle_message(struct fetch *fetch, const struct message *message)
{
	switch (message->kind) {
	case MESSAGE_RELEASE:
		return downloader_use_release(fetch->downloader, message->release.root,
					      message->release.also);
	case MESSAGE_WANT:
		return downloader_want(fetch->downloader, &message->want);
	case MESSAGE_DROP:
		downloader_drop(fetch->downloader, message->drop);
		return 0;
	case MESSAGE_KEEP:
		downloader_keep(fetch->downloader, message->keep);
		return 0;
	case MESSAGE_ASK_META:
		poll_start(fetch->poll, message->period_s);
		stick_forget(fetch->stick); /* so that the stick's metadata is sent again */
		return 0;
	case MESSAGE_TRUST:
		stick_trust(fetch->stick, message->root_version);
		poll_trust(fetch->poll, message->root_version);
		return 0;
	case MESSAGE_ASK_FILE:
		if (message->file.source == META_FROM_STICK)
			stick_ask_file(fetch->stick, &message->file);
		else
			asked_file_want(fetch->asked, &message->file);
		return 0;
	case MESSAGE_SYNC:
		send_to_kiosk(fetch,
			      &(struct message){ .kind = MESSAGE_SYNCED,
						 .synced = cache_sync(fetch->cache) == 0 },
			      -1);
		return 0;
	default:
		return -EBADMSG; /* only the fetcher may send this kind of message */
	}
}

static void receive_messages(struct fetch *fetch)
{
	int rc = packets_flush(&fetch->kiosk);

	for (int i = 0; rc == 0 && i < PACKETS_MAX; i++) {
		struct message message;
		int passed;

		rc = packets_receive(&fetch->kiosk, &message, &passed);
		if (rc == 0)
			rc = handle_message(fetch, &message);
	}
	if (rc == -EBADMSG)
		disconnect_kiosk(fetch, "kiosk bug: it sent an invalid message");
	else if (rc < 0 && rc != -EAGAIN)
		disconnect_kiosk(fetch, strerror(-rc));
}

static void send_status(struct fetch *fetch)
{
	struct message message = { .kind = MESSAGE_STATUS };
	struct message_status *status = &message.status;

	if (!fetch->has_kiosk || clock_now_ms() < fetch->status_ms)
		return;
	status->online = fetch->link.online;
	status->wanted = downloader_wanted(fetch->downloader);
	status->received_bytes = http_received_bytes(fetch->http);
	status->cache_bytes = cache_file_bytes(fetch->cache);
	status->cache_budget_bytes = cache_budget_bytes(fetch->cache);
	status->offline_since_s = link_offline_since_s(&fetch->link);
	if (memcmp(status, &fetch->sent_status, sizeof(*status)) == 0 &&
	    clock_now_ms() < fetch->sent_status_ms + ALIVE_MS) {
		/* or earlier, when something happens */
		fetch->status_ms = fetch->sent_status_ms + ALIVE_MS;
		return;
	}
	fetch->status_ms = clock_now_ms() + STATUS_MS;
	fetch->sent_status_ms = clock_now_ms();
	fetch->sent_status = *status;
	send_to_kiosk(fetch, &message, -1);
}

/* ---- metrics for monitoring; docs/health.md lists them */

static void write_refusal(const struct metrics_refusal *refusal, struct buffer *out)
{
	metrics_counter(out, "gopura_fetch_refusals_total", "Failed downloads and connections.",
			(double)refusal->count);
	if (refusal->count == 0)
		return;
	metrics_gauge(out, "gopura_fetch_refused_at_seconds", "Time of the last one.",
		      (double)refusal->at_s);
	metrics_info(
		out, "gopura_fetch_refusal_info", "What failed last, and why.",
		(const struct figure_label[]){ { "what", refusal->what }, { "why", refusal->why } },
		2);
}

static void write_metrics(void *data, struct buffer *out)
{
	struct fetch *fetch = data;
	struct link *link = &fetch->link;
	struct downloader_counters objects;

	downloader_counters(fetch->downloader, &objects);
	metrics_gauge(out, "gopura_fetch_online", "Whether the last request was answered.",
		      link->online);
	metrics_gauge(out, "gopura_fetch_offline_since_seconds",
		      "Time since when the server is offline; 0 while online.",
		      (double)link_offline_since_s(link));
	metrics_gauge(out, "gopura_fetch_kiosk_connected", "Whether a kiosk is connected.",
		      fetch->has_kiosk);
	metrics_gauge(out, "gopura_fetch_wanted", "Objects that the kiosk waits for.",
		      downloader_wanted(fetch->downloader));
	metrics_counter(out, "gopura_fetch_received_bytes_total",
			"Bytes from the network, including TLS and headers.",
			(double)http_received_bytes(fetch->http));
	metrics_counter(out, "gopura_fetch_requests_total",
			"Requests that ended, successful or not.",
			(double)(link->answers + link->errors));
	metrics_counter(out, "gopura_fetch_errors_total", "Requests without an answer.",
			(double)link->errors);
	metrics_counter(out, "gopura_fetch_damaged_total", "Objects with wrong bytes, rejected.",
			(double)objects.damaged);
	metrics_counter(out, "gopura_fetch_from_cache_total", "Objects read from the cache.",
			(double)objects.from_cache);
	metrics_counter(out, "gopura_fetch_from_server_total",
			"Objects downloaded from the server.", (double)objects.from_server);
	metrics_counter(out, "gopura_fetch_from_stick_total", "Objects read from a stick.",
			(double)objects.from_stick);
	metrics_gauge(out, "gopura_fetch_cache_bytes", "Size of the cache on disk.",
		      (double)cache_file_bytes(fetch->cache));
	metrics_gauge(out, "gopura_fetch_cache_budget_bytes", "Maximum size of the cache.",
		      (double)cache_budget_bytes(fetch->cache));
	metrics_counter(out, "gopura_fetch_cache_refused_total", "Failed writes to the cache.",
			(double)fetch->refused_writes);
	if (fetch->refused_writes > 0)
		metrics_gauge(out, "gopura_fetch_cache_refused_at_seconds",
			      "Time of the last failed write to the cache.",
			      (double)fetch->refused_write_s);
	write_refusal(&fetch->refusal, out);
}

/* ---- the loop */

static void flush_cache(struct fetch *fetch)
{
	if (!cache_needs_flush(fetch->cache)) {
		fetch->flush_ms = INT64_MAX;
		return;
	}
	if (fetch->flush_ms == INT64_MAX)
		fetch->flush_ms = clock_now_ms() + FLUSH_MS;
	if (clock_now_ms() < fetch->flush_ms)
		return;
	fetch->flush_ms = INT64_MAX;
	if (cache_flush(fetch->cache) < 0)
		log_debug("net", "the last objects were not cached");
}

static void note_refused_writes(struct fetch *fetch)
{
	const uint64_t refused = cache_refused_writes(fetch->cache);

	if (refused != fetch->refused_writes)
		fetch->refused_write_s = clock_wall_s();
	fetch->refused_writes = refused;
}

static void work(struct fetch *fetch)
{
	bool waits;

	if (fetch->has_kiosk) {
		if (stick_work(fetch->stick, kiosk_has_room(fetch)))
			downloader_look_up_again(fetch->downloader);
		/* Before the objects: while the link has failed, one request at a time is made. */
		poll_work(fetch->poll);
		asked_file_work(fetch->asked);
		downloader_work(fetch->downloader);
		send_status(fetch);
	}
	/* The kiosk waits for what was lost. It connects again and repeats what it wants. */
	if (fetch->has_kiosk && fetch->unsent < 0) {
		log_error("net", "a message to the kiosk could not be sent: %s",
			  strerror(-fetch->unsent));
		disconnect_kiosk(fetch, "so that it asks again");
	}
	flush_cache(fetch);
	note_refused_writes(fetch);
	waits = fetch->has_kiosk && packets_wait(&fetch->kiosk);
	if (waits != fetch->kiosk_waits &&
	    watch(fetch, fetch->kiosk.fd, SOURCE_KIOSK, EPOLLIN | (waits ? EPOLLOUT : 0u),
		  EPOLL_CTL_MOD) == 0)
		fetch->kiosk_waits = waits;
}

static int timeout_ms(const struct fetch *fetch)
{
	int64_t now_ms = clock_now_ms(), due_ms = fetch->flush_ms;

	if (fetch->has_kiosk) {
		int64_t downloader_ms = downloader_due_ms(fetch->downloader),
			poll_ms = poll_due_ms(fetch->poll);
		int64_t asked_ms = asked_file_due_ms(fetch->asked);
		int64_t stick_ms = stick_due_ms(fetch->stick, kiosk_has_room(fetch));

		due_ms = downloader_ms < due_ms ? downloader_ms : due_ms;
		due_ms = poll_ms < due_ms ? poll_ms : due_ms;
		due_ms = asked_ms < due_ms ? asked_ms : due_ms;
		due_ms = stick_ms < due_ms ? stick_ms : due_ms;
		due_ms = fetch->status_ms < due_ms ? fetch->status_ms : due_ms;
	}
	due_ms = service_due_ms() < due_ms ? service_due_ms() : due_ms;
	if (due_ms == INT64_MAX)
		return -1;
	if (due_ms <= now_ms)
		return 0;
	return due_ms - now_ms > 60000 ? 60000 : (int)(due_ms - now_ms);
}

static int dispatch(struct fetch *fetch, enum source source)
{
	switch (source) {
	case SOURCE_LISTENER:
		return accept_kiosk(fetch);
	case SOURCE_KIOSK:
		if (fetch->has_kiosk)
			receive_messages(fetch);
		return 0;
	case SOURCE_HTTP:
		return http_dispatch(fetch->http);
	case SOURCE_STICK:
		stick_clear_event(fetch->stick);
		return 0;
	case SOURCE_SIGNAL:
		fetch->ends = true;
		return 0;
	case SOURCE_METRICS:
		metrics_socket_dispatch(fetch->metrics);
		return 0;
	}
	return 0;
}

static int loop(struct fetch *fetch)
{
	while (!fetch->ends) {
		struct epoll_event events[8];
		int count, rc;

		work(fetch);
		if (fetch->ends)
			break;
		if (service_due_ms() <= clock_now_ms())
			service_alive();
		count = epoll_wait(fetch->epoll_fd, events, 8, timeout_ms(fetch));
		if (count < 0 && errno != EINTR)
			return -errno;
		for (int i = 0; i < count; i++) {
			rc = dispatch(fetch, (enum source)events[i].data.u32);
			if (rc < 0)
				return rc;
		}
		if (count > 0 && fetch->status_ms > clock_now_ms() + STATUS_MS)
			fetch->status_ms = clock_now_ms() + STATUS_MS;
	}
	return 0;
}

/* ---- start and stop */

static int listen_on(struct fetch *fetch, const char *path)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	int fd;

	if (strlen(path) >= sizeof(address.sun_path))
		return -ENAMETOOLONG;
	memcpy(address.sun_path, path, strlen(path) + 1);
	fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (fd < 0)
		return -errno;
	fetch->listen_fd = fd;
	unlink(path); /* left by an earlier fetcher */
	if (bind(fd, (struct sockaddr *)&address, sizeof(address)) < 0 || chmod(path, 0660) < 0 ||
	    listen(fd, 4) < 0)
		return -errno;
	return watch(fetch, fd, SOURCE_LISTENER, EPOLLIN, EPOLL_CTL_ADD);
}

static int watch_signals(struct fetch *fetch)
{
	signal(SIGPIPE, SIG_IGN);
	fetch->signal_fd = service_stop_fd();
	if (fetch->signal_fd < 0)
		return fetch->signal_fd;
	return watch(fetch, fetch->signal_fd, SOURCE_SIGNAL, EPOLLIN, EPOLL_CTL_ADD);
}

static int create_modules(struct fetch *fetch)
{
	const struct fetch_options *options = fetch->options;
	struct http_options http = { .url = options->release_url,
				     .ca_file = options->ca_file,
				     .redirect_hosts = options->redirect_hosts,
				     .stall_s = options->stall_s };
	struct cache_options cache = { .path = options->cache_path,
				       .budget_bytes = options->cache_budget_bytes };
	struct downloader_options downloader = { .link = &fetch->link,
						 .rate_limit = options->rate_limit,
						 .wait_ms = options->wait_ms,
						 .events = { on_object, on_missing, has_room },
						 .data = fetch };
	struct poll_options poll = {
		.link = &fetch->link, .period_s = options->poll_s, .meta = on_meta, .data = fetch
	};
	struct asked_file_options asked = { .link = &fetch->link,
					    .answered = on_file,
					    .data = fetch };
	struct stick_options stick = { .folder = options->stick_path,
				       .meta = on_stick_meta,
				       .object = on_stick_object,
				       .file = on_file,
				       .is_wanted = is_wanted_of_stick,
				       .data = fetch };
	int rc = http_create(&fetch->http, &http);

	if (rc == 0 && options->stick_path)
		rc = stick_create(&fetch->stick, &stick);
	downloader.stick = fetch->stick;
	if (rc == 0)
		rc = cache_create(&fetch->cache, &cache);
	downloader.http = poll.http = asked.http = fetch->http;
	downloader.cache = fetch->cache;
	link_init(&fetch->link);
	fetch->link.refusal = &fetch->refusal;
	if (rc == 0)
		rc = downloader_create(&fetch->downloader, &downloader);
	if (rc == 0)
		rc = poll_create(&fetch->poll, &poll);
	if (rc == 0)
		rc = asked_file_create(&fetch->asked, &asked);
	if (rc == 0)
		rc = watch(fetch, http_fd(fetch->http), SOURCE_HTTP, EPOLLIN, EPOLL_CTL_ADD);
	if (rc == 0 && fetch->stick)
		rc = watch(fetch, stick_fd(fetch->stick), SOURCE_STICK, EPOLLIN, EPOLL_CTL_ADD);
	return rc;
}

static int offer_metrics(struct fetch *fetch)
{
	const struct metrics_socket_options options = { .path = fetch->options->metrics_path,
							.prefix = "gopura_fetch",
							.write = write_metrics,
							.data = fetch };
	int rc = 0;

	if (options.path)
		rc = metrics_socket_create(&fetch->metrics, &options);
	if (rc == 0 && fetch->metrics)
		rc = watch(fetch, metrics_socket_fd(fetch->metrics), SOURCE_METRICS, EPOLLIN,
			   EPOLL_CTL_ADD);
	return rc;
}

static int start(struct fetch *fetch)
{
	int rc;

	fetch->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
	if (fetch->epoll_fd < 0)
		return -errno;
	srandom((unsigned)clock_now_us() ^ (unsigned)getpid());
	rc = watch_signals(fetch);
	if (rc == 0)
		rc = create_modules(fetch);
	if (rc == 0)
		rc = offer_metrics(fetch);
	if (rc < 0)
		return rc;
	if (fetch->options->socket_path)
		return listen_on(fetch, fetch->options->socket_path);
	return use_connection(fetch, fetch->options->fd);
}

static void stop(struct fetch *fetch)
{
	metrics_socket_destroy(fetch->metrics);
	poll_destroy(fetch->poll);
	asked_file_destroy(fetch->asked);
	downloader_destroy(fetch->downloader);
	packets_finish(&fetch->kiosk);
	stick_destroy(fetch->stick);
	cache_destroy(fetch->cache);
	http_destroy(fetch->http);
	if (fetch->listen_fd >= 0) {
		close(fetch->listen_fd);
		unlink(fetch->options->socket_path);
	}
	if (fetch->signal_fd >= 0)
		close(fetch->signal_fd);
	if (fetch->epoll_fd >= 0)
		close(fetch->epoll_fd);
}

int fetch_run(const struct fetch_options *options)
{
	struct fetch fetch = { .options = options,
			       .epoll_fd = -1,
			       .listen_fd = -1,
			       .signal_fd = -1,
			       .flush_ms = INT64_MAX };
	int rc = start(&fetch);

	/* otherwise the kiosk is the service and waits for us */
	if (rc == 0 && options->socket_path)
		service_ready();
	if (rc == 0)
		rc = loop(&fetch);
	if (options->socket_path)
		service_stopping();
	stop(&fetch);
	return rc;
}
