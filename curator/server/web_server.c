/* Connects libwebsockets' callbacks with exchanges and sessions. All callbacks run on the server's
 * thread; the threads of sessions and workers only interrupt its wait. */
#include "curator/server/web_server.h"

#include <ctype.h>
#include <errno.h>
#include <libwebsockets.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/log.h"
#include "curator/pages/history_routes.h"
#include "curator/pages/information_routes.h"
#include "curator/pages/page_routes.h"
#include "curator/pages/picture_routes.h"
#include "curator/pages/preview_routes.h"
#include "curator/pages/spoken_routes.h"
#include "curator/pages/tour_routes.h"
#include "curator/publish/publish_routes.h"
#include "curator/server/exchange.h"
#include "curator/server/picture_socket.h"
#include "curator/server/sign_in_routes.h"
#include "curator/session/part_routes.h"

enum {
	RECEIVE_BYTES = 64 << 10,
	HEADERS_BYTES = 8192,
	WORKER_THREADS = 2,
	LOOK_AGAIN_S = 20, /* for sockets of those whose session has ended */
};

struct web_server {
	struct site *site; /* borrowed */
	struct lws_context *context;
	struct lws_vhost *vhost;
	const struct lws_protocols *protocol;
	lws_sorted_usec_list_t timer;
	struct origin_names names;
	struct access access;
	struct sign_in_place sign_in;
	struct preview *preview; /* owned */
	struct api_routes tables[10];
	struct publish_place publish;
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

/* A page of another site has neither the token nor the origin. */
static int admit_socket(struct lws *wsi, struct client *client)
{
	struct web_server *server = server_of(wsi);
	struct api_job *job = api_job_create(); /* its request is too large for a stack */
	struct request_head head;
	const char *token;
	int rc = -1;

	if (job && client &&
	    request_head_read(&head, &job->request, wsi, "/socket", &server->access.head) == 0 &&
	    access_identify(&server->access, &head, &job->request, &job->response) == 0 &&
	    access_judge(ROLE_READER, &head, &job->request, &job->response) == 0) {
		token = api_query(&job->request, "token");
		if (token && sign_in_secret_is(job->request.token, token)) {
			picture_socket_set_caller(&client->socket, server->access.gate,
						  &job->request.caller, job->request.cookie);
			rc = 0;
		}
	}
	api_job_destroy(job);
	return rc;
}

/* A page shows the reason, as the server cannot answer it otherwise. */
static int refuse_socket(struct lws *wsi, const char *reason)
{
	char text[124]; /* of a close frame */

	snprintf(text, sizeof(text), "%s", reason);
	lws_close_reason(wsi, LWS_CLOSE_STATUS_POLICY_VIOLATION, (unsigned char *)text,
			 strlen(text));
	return -1;
}

static int open_socket(struct lws *wsi, struct client *client)
{
	struct web_server *server = server_of(wsi);
	const struct session_options options = { server->site, client->socket.caller, wake,
						 server };

	if (server->session_count == WEB_SERVER_SESSIONS_MAX) {
		log_warn("curator", "refused a browser: %d are connected", WEB_SERVER_SESSIONS_MAX);
		return refuse_socket(wsi, "As many browsers as the program takes show the model: "
					  "close one of them.");
	}
	if (picture_socket_open(&client->socket, &options) < 0)
		return refuse_socket(wsi, "The program has no memory for another browser.");
	server->session_count++;
	log_info("curator", "a browser of %s has connected; %u are", client->socket.caller.name,
		 server->session_count);
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
		return admit_socket(wsi, client);
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

/* ---- the server */

static void look_again(lws_sorted_usec_list_t *timer)
{
	struct web_server *server = lws_container_of(timer, struct web_server, timer);

	lws_callback_on_writable_all_protocol_vhost(server->vhost, server->protocol);
	lws_sul_schedule(server->context, 0, timer, look_again, LOOK_AGAIN_S * LWS_US_PER_SEC);
}

/* The names under which it is asked. */
static int set_names(struct web_server *server, const struct web_server_options *options)
{
	const int port = web_server_port(server);
	bool good = true;

	if (port > 0) {
		good = origin_add(&server->names, "127.0.0.1", port, false) &&
		       origin_add(&server->names, "localhost", port, false);
		if (good && strcmp(options->listen, "127.0.0.1") != 0)
			good = origin_add(&server->names, options->listen, port, false);
	}
	for (unsigned n = 0; good && n < options->host_count; n++)
		good = origin_add(&server->names, options->hosts[n], 0, true);
	return good ? 0 : -EINVAL;
}

static bool is_unix(const struct web_server_options *options)
{
	return strncmp(options->listen, "unix:", 5) == 0;
}

/* Cookies belong to a host without its port, so two servers on one machine need two names. */
static void set_access(struct web_server *server, const struct web_server_options *options)
{
	struct request_head_options *head = &server->access.head;

	server->access.gate = options->gate;
	server->access.names = &server->names;
	snprintf(head->cookie, sizeof(head->cookie), "gopura-curator-%d", web_server_port(server));
	if (options->sign_on)
		snprintf(head->sign_on, sizeof(head->sign_on), "%s:", options->sign_on);
	for (char *at = head->sign_on; *at; at++)
		*at = (char)tolower((unsigned char)*at);
	head->is_proxied = options->host_count > 0;
	server->sign_in = (struct sign_in_place){ .gate = options->gate,
						  .cookie = head->cookie,
						  .temple = server->site->content.name,
						  .is_sign_on = options->sign_on != NULL,
						  .wake = wake,
						  .user = server };
	server->tables[0] = sign_in_routes(&server->sign_in);
	server->tables[1] = part_routes(server->site);
	server->tables[2] = publish_routes(&server->publish);
	server->tables[3] = information_routes(server->site);
	server->tables[4] = page_routes(server->site);
	server->tables[5] = history_routes(server->site);
	server->tables[6] = picture_routes(server->site);
	server->tables[7] = preview_routes(server->preview);
	server->tables[8] = tour_routes(server->site);
	server->tables[9] = spoken_routes(server->site);
}

/* Those that libwebsockets knows cannot be asked for by name. */
static bool is_usable_header(const char *name)
{
	const size_t bytes = strlen(name);

	for (int n = 0; n < WSI_TOKEN_COUNT; n++) {
		const unsigned char *known = lws_token_to_string((enum lws_token_indexes)n);

		if (known && strcasecmp((const char *)known, name) == 0)
			return false;
	}
	return bytes > 1 && strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789-") == bytes - 1;
}

static int listen_at(struct web_server *server, const struct lws_context_creation_info *info,
		     const struct web_server_options *options)
{
	int rc;

	server->vhost = lws_create_vhost(server->context, info);
	if (!server->vhost)
		return -EADDRINUSE;
	server->protocol = lws_vhost_name_to_protocol(server->vhost, protocols[0].name);
	rc = set_names(server, options);
	if (rc < 0)
		return rc;
	set_access(server, options);
	return options->sign_on && !is_usable_header(server->access.head.sign_on) ? -EINVAL : 0;
}

int web_server_create(struct web_server **out, const struct web_server_options *options)
{
	struct web_server *server = calloc(1, sizeof(*server));
	const struct lws_context_creation_info info = {
		.iface = is_unix(options) ? options->listen + 5 : options->listen,
		.port = is_unix(options) ? 0 : options->port,
		.protocols = protocols,
		.server_string = "gopura-curator",
		.max_http_header_data2 = HEADERS_BYTES,
		.timeout_secs = 10,
		.keepalive_timeout = 30,
		.gid = (gid_t)-1,
		.uid = (uid_t)-1,
		.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS |
			   LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND |
			   (is_unix(options) ? LWS_SERVER_OPTION_UNIX_SOCK : 0),
		.user = server,
	};
	int rc;

	*out = NULL;
	if (!server)
		return -ENOMEM;
	lws_set_log_level(LLL_ERR | LLL_WARN, say);
	server->site = options->site;
	publish_place_init(&server->publish, server->site->content.folder, options->release);
	rc = preview_create(&server->preview, options->site);
	if (rc == 0)
		server->context = lws_create_context(&info);
	if (rc == 0)
		rc = server->context ? listen_at(server, &info, options) : -ENOMEM;
	if (rc == 0)
		rc = workers_create(&server->workers, WORKER_THREADS, wake, server);
	if (rc < 0) {
		web_server_destroy(server);
		return rc;
	}
	server->env = (struct exchange_env){ .access = &server->access,
					     .tables = server->tables,
					     .table_count = ARRAY_COUNT(server->tables),
					     .workers = server->workers };
	lws_sul_schedule(server->context, 0, &server->timer, look_again,
			 LOOK_AGAIN_S * LWS_US_PER_SEC);
	*out = server;
	return 0;
}

/* The workers end first, because they wake the context; connections that end with that then find
 * their jobs done. */
void web_server_destroy(struct web_server *server)
{
	if (!server)
		return;
	lws_sul_cancel(&server->timer);
	server->vhost = NULL;
	workers_end(server->workers);
	if (server->context)
		lws_context_destroy(server->context);
	workers_destroy(server->workers);
	publish_place_finish(&server->publish);
	preview_destroy(server->preview);
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
