/* Puts pieces together to messages, and sends those of the session. */
#include "curator/server/picture_socket.h"

#include <libwebsockets.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "curator/session/request.h"

void picture_socket_set_caller(struct picture_socket *socket, struct gate *gate,
			       const struct caller *caller, const char *key)
{
	socket->gate = gate;
	socket->caller = *caller;
	snprintf(socket->key, sizeof(socket->key), "%s", key);
}

static bool is_still_in(const struct picture_socket *socket, enum gate_use use)
{
	struct gate_visitor visitor;

	return gate_identify(socket->gate, socket->key, use, &visitor) == 0 &&
	       visitor.caller.role == socket->caller.role &&
	       strcmp(visitor.caller.name, socket->caller.name) == 0;
}

int picture_socket_open(struct picture_socket *socket, const struct session_options *options)
{
	int rc;

	buffer_init(&socket->input, REQUEST_BYTES_MAX);
	buffer_init(&socket->output, LWS_PRE + SESSION_MESSAGE_BYTES_MAX);
	rc = session_create(&socket->session, options);
	if (rc < 0)
		log_error("curator", "a session cannot begin: %s", strerror(-rc));
	return rc < 0 ? -1 : 0;
}

/* Messages arrive in pieces. One that is too long ends the connection. */
int picture_socket_receive(struct picture_socket *socket, struct lws *wsi, const void *piece,
			   size_t bytes)
{
	if (!socket->session) /* refused; the connection is about to close */
		return 0;
	if (lws_frame_is_binary(wsi))
		return -1;
	buffer_put(&socket->input, piece, bytes);
	if (socket->input.error)
		return -1;
	if (!lws_is_final_fragment(wsi) || lws_remaining_packet_payload(wsi) > 0)
		return 0;
	if (!is_still_in(socket, GATE_MESSAGE))
		return -1;
	session_receive(socket->session, (const char *)socket->input.data, socket->input.size);
	buffer_clear(&socket->input);
	return 0;
}

int picture_socket_write(struct picture_socket *socket, struct lws *wsi)
{
	bool binary;
	size_t size;

	if (!socket->session)
		return 0;
	if (session_is_lost(socket->session) || !is_still_in(socket, GATE_LOOK))
		return -1;
	buffer_clear(&socket->output);
	buffer_extend(&socket->output, LWS_PRE);
	if (!session_next(socket->session, &socket->output, &binary))
		return 0;
	size = socket->output.size - LWS_PRE;
	if (socket->output.error ||
	    lws_write(wsi, socket->output.data + LWS_PRE, size,
		      binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT) < (int)size)
		return -1;
	lws_callback_on_writable(wsi); /* there may be more */
	return 0;
}

void picture_socket_close(struct picture_socket *socket)
{
	session_destroy(socket->session);
	buffer_finish(&socket->input);
	buffer_finish(&socket->output);
	*socket = (struct picture_socket){ 0 };
}
