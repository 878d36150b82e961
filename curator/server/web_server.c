/* Connects libwebsockets' callbacks with exchanges and sessions. All callbacks run on the server's
 * thread; the threads of sessions and workers only interrupt its wait. */
#include "curator/server/web_server.h"

#include <errno.h>
#include <libwebsockets.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "curator/server/exchange.h"
#include "curator/server/picture_socket.h"
#include "curator/session/part_routes.h"

enum { RECEIVE_BYTES = 64 << 10, HEADERS_BYTES = 8192, WORKER_THREADS = 2 };

struct web_server {
	struct site *site; /* borrowed */
	struct lws_context *context;
	struct lws_vhost *vhost;
	const struct lws_protocols *protocol;
	struct origin_names names;
	struct api_routes tables[1];
	struct workers *workers; /* owned */
	struct exchange_env env;
	uint32_t session_count;
	volatile sig_atomic_t stopped;
};

/* Of a connection. */
struct client {
	struct exchange exchange;
	struct picture_socket socket;
};

static struct web_server *server_of(struct lws *wsi)
{
	return lws_context_user(lws_get_context(wsi));
}

static void wake(void *user)
{
	const struct web_server *server = user;

	lws_cancel_service(server->context);
}

/* ---- sockets */

static bool is_welcome(struct lws *wsi)
{
	char host[ORIGIN_NAME_BYTES] = "", origin[ORIGIN_NAME_BYTES + 8] = "";

	if (lws_hdr_copy(wsi, host, sizeof(host), WSI_TOKEN_HOST) <= 0)
		return false;
	if (lws_hdr_total_length(wsi, WSI_TOKEN_ORIGIN) > 0 &&
	    lws_hdr_copy(wsi, origin, sizeof(origin), WSI_TOKEN_ORIGIN) <= 0)
		return false; /* too long */
	return origin_is_welcome(&server_of(wsi)->names, host, origin);
}

static int open_socket(struct lws *wsi, struct client *client)
{
	struct web_server *server = server_of(wsi);
	const struct session_options options = { server->site, wake, server };

	if (server->session_count == WEB_SERVER_SESSIONS_MAX) {
		log_warn("curator", "refused a browser: %d are connected", WEB_SERVER_SESSIONS_MAX);
		return -1;
	}
	if (picture_socket_open(&client->socket, &options) < 0)
		return -1;
	server->session_count++;
	log_info("curator", "a browser has connected; %u are", server->session_count);
	return 0;
}

static void close_socket(struct lws *wsi, struct client *client)
{
	const bool was_open = client->socket.session != NULL;

	picture_socket_close(&client->socket);
	if (!was_open)
		return;
	server_of(wsi)->session_count--;
	log_info("curator", "a browser has left; %u are", server_of(wsi)->session_count);
}

/* ---- libwebsockets */

static int callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
		    size_t size)
{
	struct client *client = user;

	switch (reason) {
	case LWS_CALLBACK_HTTP:
		return exchange_begin(&client->exchange, &server_of(wsi)->env, wsi, in);
	case LWS_CALLBACK_HTTP_BODY:
		return exchange_take_body(&client->exchange, in, size);
	case LWS_CALLBACK_HTTP_BODY_COMPLETION:
		return exchange_end_body(&client->exchange);
	case LWS_CALLBACK_HTTP_WRITEABLE:
		return exchange_write(&client->exchange);
	case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
		return is_welcome(wsi) ? 0 : -1;
	case LWS_CALLBACK_ESTABLISHED:
		return open_socket(wsi, client);
	case LWS_CALLBACK_RECEIVE:
		return picture_socket_receive(&client->socket, wsi, in, size);
	case LWS_CALLBACK_SERVER_WRITEABLE:
		return picture_socket_write(&client->socket, wsi);
	case LWS_CALLBACK_EVENT_WAIT_CANCELLED: {
		const struct web_server *server = server_of(wsi);

		if (server->vhost) {
			lws_callback_on_writable_all_protocol_vhost(server->vhost,
								    server->protocol);
			exchange_wake(&server->env);
		}
		return 0;
	}
	case LWS_CALLBACK_CLOSED:
		close_socket(wsi, client);
		return 0;
	case LWS_CALLBACK_CLOSED_HTTP:
	case LWS_CALLBACK_HTTP_DROP_PROTOCOL:
		if (client)
			exchange_finish(&client->exchange);
		return 0;
	default:
		return lws_callback_http_dummy(wsi, reason, user, in, size);
	}
}

static const struct lws_protocols protocols[] = {
	{ .name = "gopura-curator",
	  .callback = callback,
	  .per_session_data_size = sizeof(struct client),
	  .rx_buffer_size = RECEIVE_BYTES },
	{ 0 },
};

static void say(int level, const char *line)
{
	if (level & LLL_ERR)
		log_error("curator", "libwebsockets: %.*s", (int)strcspn(line, "\n"), line);
	else
		log_warn("curator", "libwebsockets: %.*s", (int)strcspn(line, "\n"), line);
}

/* Listens, and names the address. */
static int listen_at(struct web_server *server, const struct lws_context_creation_info *info)
{
	static const char *const names[] = { "127.0.0.1", "localhost" };

	server->vhost = lws_create_vhost(server->context, info);
	if (!server->vhost)
		return -EADDRINUSE;
	server->protocol = lws_vhost_name_to_protocol(server->vhost, protocols[0].name);
	for (unsigned n = 0; n < ARRAY_COUNT(names); n++)
		if (!origin_add(&server->names, names[n], web_server_port(server), false))
			return -EINVAL;
	return 0;
}

int web_server_create(struct web_server **out, struct site *site, int port)
{
	struct web_server *server = calloc(1, sizeof(*server));
	const struct lws_context_creation_info info = {
		.iface = "127.0.0.1",
		.port = port,
		.protocols = protocols,
		.server_string = "gopura-curator",
		.max_http_header_data2 = HEADERS_BYTES,
		.timeout_secs = 10,
		.keepalive_timeout = 30,
		.gid = (gid_t)-1,
		.uid = (uid_t)-1,
		.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS |
			   LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND,
		.user = server,
	};
	int rc;

	*out = NULL;
	if (!server)
		return -ENOMEM;
	lws_set_log_level(LLL_ERR | LLL_WARN, say);
	server->site = site;
	server->tables[0] = part_routes(site);
	server->context = lws_create_context(&info);
	rc = server->context ? listen_at(server, &info) : -ENOMEM;
	if (rc == 0)
		rc = workers_create(&server->workers, WORKER_THREADS, wake, server);
	if (rc < 0) {
		web_server_destroy(server);
		return rc;
	}
	server->env = (struct exchange_env){ .names = &server->names,
					     .tables = server->tables,
					     .table_count = ARRAY_COUNT(server->tables),
					     .workers = server->workers };
	*out = server;
	return 0;
}

/* The workers end first, because they wake the context; connections that end with that then find
 * their jobs done. */
void web_server_destroy(struct web_server *server)
{
	if (!server)
		return;
	server->vhost = NULL;
	workers_end(server->workers);
	if (server->context)
		lws_context_destroy(server->context);
	workers_destroy(server->workers);
	free(server);
}

int web_server_port(const struct web_server *server)
{
	return lws_get_vhost_listen_port(server->vhost);
}

void web_server_run(struct web_server *server)
{
	while (!server->stopped && lws_service(server->context, 0) >= 0)
		;
}

void web_server_stop(struct web_server *server)
{
	server->stopped = 1;
	lws_cancel_service(server->context);
}
