/* Connects libwebsockets' callbacks with sessions. All callbacks run on the server's thread; a
 * session's thread only interrupts its wait. */
#include "curator/server/web_server.h"

#include <errno.h>
#include <libwebsockets.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "curator/server/web_files.h"
#include "curator/session/request.h"
#include "curator/session/session.h"

enum { HOST_BYTES = 64, HEADER_BYTES = 2048, PIECE_BYTES = 64 << 10 };

/* What a browser gets is asked for by the page itself, and by nobody else. */
static const char policy[] =
	"default-src 'none'; script-src 'self'; style-src 'self'; img-src data:; "
	"connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

struct web_server {
	struct site *site; /* borrowed */
	struct lws_context *context;
	struct lws_vhost *vhost;
	const struct lws_protocols *protocol;
	uint32_t session_count;
	volatile sig_atomic_t stopped;
};

/* Of a connection. */
struct client {
	const struct web_file *file; /* HTTP: what it is sent */
	struct session *session;     /* WebSocket; owned */
	struct buffer input;         /* a message whose end has not arrived */
	struct buffer output;
	bool counted;
};

static struct web_server *server_of(struct lws *wsi)
{
	return lws_context_user(lws_get_context(wsi));
}

/* ---- files */

static int add_header(struct lws *wsi, const char *name, const char *value, uint8_t **at,
		      uint8_t *end)
{
	return lws_add_http_header_by_name(wsi, (const uint8_t *)name, (const uint8_t *)value,
					   (int)strlen(value), at, end);
}

static int answer_file(struct lws *wsi, struct client *client, const char *path)
{
	uint8_t header[LWS_PRE + HEADER_BYTES], *at = header + LWS_PRE,
						*end = header + sizeof(header) - 1;

	client->file = web_file_find(path);
	if (!client->file) {
		if (lws_return_http_status(wsi, HTTP_STATUS_NOT_FOUND, NULL))
			return -1;
		return lws_http_transaction_completed(wsi);
	}
	if (lws_add_http_common_headers(wsi, HTTP_STATUS_OK, client->file->type,
					client->file->bytes.size, &at, end) ||
	    add_header(wsi, "content-security-policy:", policy, &at, end) ||
	    add_header(wsi, "x-content-type-options:", "nosniff", &at, end) ||
	    add_header(wsi, "referrer-policy:", "no-referrer", &at, end) ||
	    add_header(wsi, "cache-control:", "no-cache", &at, end) ||
	    lws_finalize_write_http_header(wsi, header + LWS_PRE, &at, end))
		return -1;
	lws_callback_on_writable(wsi);
	return 0;
}

static int send_file(struct lws *wsi, struct client *client)
{
	const size_t size = client->file->bytes.size;

	buffer_init(&client->output, LWS_PRE + size);
	buffer_extend(&client->output, LWS_PRE);
	buffer_put(&client->output, client->file->bytes.data, size);
	client->file = NULL;
	if (client->output.error ||
	    lws_write(wsi, client->output.data + LWS_PRE, size, LWS_WRITE_HTTP_FINAL) < (int)size)
		return -1;
	return lws_http_transaction_completed(wsi) ? -1 : 0;
}

/* ---- who may open a socket */

/* A page of another site, or a name that was made to mean this machine, may not: only requests to
 * this address, by a page from it or by a program, which names no origin. */
static bool is_welcome(struct lws *wsi)
{
	char host[HOST_BYTES] = "", origin[HOST_BYTES] = "", expected[HOST_BYTES];
	const int port = lws_get_vhost_listen_port(lws_get_vhost(wsi));
	static const char *const names[] = { "127.0.0.1", "localhost" };

	if (lws_hdr_copy(wsi, host, sizeof(host), WSI_TOKEN_HOST) <= 0)
		return false;
	if (lws_hdr_total_length(wsi, WSI_TOKEN_ORIGIN) > 0 &&
	    lws_hdr_copy(wsi, origin, sizeof(origin), WSI_TOKEN_ORIGIN) <= 0)
		return false; /* too long */
	for (unsigned n = 0; n < ARRAY_COUNT(names); n++) {
		snprintf(expected, sizeof(expected), "http://%s:%d", names[n], port);
		if (strcmp(host, expected + strlen("http://")) == 0)
			return !*origin || strcmp(origin, expected) == 0;
	}
	return false;
}

/* ---- sessions */

static void wake(void *user)
{
	const struct web_server *server = user;

	lws_cancel_service(server->context);
}

static int open_session(struct lws *wsi, struct client *client)
{
	struct web_server *server = server_of(wsi);
	const struct session_options options = { server->site, wake, server };
	int rc;

	if (server->session_count == WEB_SERVER_SESSIONS_MAX) {
		log_warn("curator", "refused a browser: %d are connected", WEB_SERVER_SESSIONS_MAX);
		return -1;
	}
	buffer_init(&client->input, REQUEST_BYTES_MAX);
	buffer_init(&client->output, LWS_PRE + SESSION_MESSAGE_BYTES_MAX);
	rc = session_create(&client->session, &options);
	if (rc < 0) {
		log_error("curator", "a session cannot begin: %s", strerror(-rc));
		return -1;
	}
	server->session_count++;
	log_info("curator", "a browser has connected; %u are", server->session_count);
	return 0;
}

static void close_session(struct lws *wsi, struct client *client)
{
	if (!client->session)
		return;
	session_destroy(client->session);
	client->session = NULL;
	server_of(wsi)->session_count--;
	log_info("curator", "a browser has left; %u are", server_of(wsi)->session_count);
}

/* Messages arrive in pieces. One that is too long ends the connection. */
static int receive(struct lws *wsi, struct client *client, const void *piece, size_t bytes)
{
	if (lws_frame_is_binary(wsi))
		return -1;
	buffer_put(&client->input, piece, bytes);
	if (client->input.error)
		return -1;
	if (!lws_is_final_fragment(wsi) || lws_remaining_packet_payload(wsi) > 0)
		return 0;
	session_receive(client->session, (const char *)client->input.data, client->input.size);
	buffer_clear(&client->input);
	return 0;
}

static int send_message(struct lws *wsi, struct client *client)
{
	bool binary;
	size_t size;

	if (session_is_lost(client->session))
		return -1;
	buffer_clear(&client->output);
	buffer_extend(&client->output, LWS_PRE);
	if (!session_next(client->session, &client->output, &binary))
		return 0;
	size = client->output.size - LWS_PRE;
	if (client->output.error ||
	    lws_write(wsi, client->output.data + LWS_PRE, size,
		      binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT) < (int)size)
		return -1;
	lws_callback_on_writable(wsi); /* there may be more */
	return 0;
}

/* ---- libwebsockets */

static int callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
		    size_t size)
{
	struct client *client = user;

	switch (reason) {
	case LWS_CALLBACK_HTTP:
		return answer_file(wsi, client, in);
	case LWS_CALLBACK_HTTP_WRITEABLE:
		return client->file ? send_file(wsi, client) : 0;
	case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
		return is_welcome(wsi) ? 0 : -1;
	case LWS_CALLBACK_ESTABLISHED:
		return open_session(wsi, client);
	case LWS_CALLBACK_RECEIVE:
		return receive(wsi, client, in, size);
	case LWS_CALLBACK_SERVER_WRITEABLE:
		return send_message(wsi, client);
	case LWS_CALLBACK_EVENT_WAIT_CANCELLED: {
		const struct web_server *server = server_of(wsi);

		if (server->vhost)
			lws_callback_on_writable_all_protocol_vhost(server->vhost,
								    server->protocol);
		return 0;
	}
	case LWS_CALLBACK_CLOSED:
		close_session(wsi, client);
		buffer_finish(&client->input);
		buffer_finish(&client->output);
		return 0;
	case LWS_CALLBACK_CLOSED_HTTP:
		if (client)
			buffer_finish(&client->output);
		return 0;
	default:
		return lws_callback_http_dummy(wsi, reason, user, in, size);
	}
}

static const struct lws_protocols protocols[] = {
	{ .name = "gopura-curator",
	  .callback = callback,
	  .per_session_data_size = sizeof(struct client),
	  .rx_buffer_size = PIECE_BYTES },
	{ 0 },
};

static void say(int level, const char *line)
{
	if (level & LLL_ERR)
		log_error("curator", "libwebsockets: %.*s", (int)strcspn(line, "\n"), line);
	else
		log_warn("curator", "libwebsockets: %.*s", (int)strcspn(line, "\n"), line);
}

int web_server_create(struct web_server **out, struct site *site, int port)
{
	struct web_server *server = calloc(1, sizeof(*server));
	const struct lws_context_creation_info info = {
		.iface = "127.0.0.1",
		.port = port,
		.protocols = protocols,
		.server_string = "gopura-curator",
		.timeout_secs = 10,
		.keepalive_timeout = 30,
		.gid = (gid_t)-1,
		.uid = (uid_t)-1,
		.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS |
			   LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND,
		.user = server,
	};

	*out = NULL;
	if (!server)
		return -ENOMEM;
	lws_set_log_level(LLL_ERR | LLL_WARN, say);
	server->site = site;
	server->context = lws_create_context(&info);
	if (!server->context) {
		free(server);
		return -ENOMEM;
	}
	server->vhost = lws_create_vhost(server->context, &info);
	if (!server->vhost) {
		web_server_destroy(server);
		return -EADDRINUSE;
	}
	server->protocol = lws_vhost_name_to_protocol(server->vhost, protocols[0].name);
	*out = server;
	return 0;
}

void web_server_destroy(struct web_server *server)
{
	if (!server)
		return;
	server->vhost = NULL;
	lws_context_destroy(server->context);
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
