/* A browser's WebSocket: carries a session's messages over a connection of libwebsockets. On the
 * server's thread. */
#ifndef GOPURA_CURATOR_SERVER_PICTURE_SOCKET_H
#define GOPURA_CURATOR_SERVER_PICTURE_SOCKET_H

#include "curator/accounts/gate.h"
#include "curator/session/session.h"

struct lws;

/* Zeroed: not open. */
struct picture_socket {
	struct gate *gate;    /* borrowed */
	struct caller caller; /* who opened it */
	char key[SIGN_IN_SECRET_BYTES];
	struct session *session; /* owned */
	struct buffer input;     /* a message whose end has not arrived */
	struct buffer output;
};

/* Notes who asks for it; it is not open yet. */
void picture_socket_set_caller(struct picture_socket *socket, struct gate *gate,
			       const struct caller *caller, const char *key);
/* Each returns 0, or -1 if the connection must be closed: also when whoever opened it has signed
 * out, or has another role since. */
must_check int picture_socket_open(struct picture_socket *socket,
				   const struct session_options *options);
must_check int picture_socket_receive(struct picture_socket *socket, struct lws *wsi,
				      const void *piece, size_t bytes);
must_check int picture_socket_write(struct picture_socket *socket, struct lws *wsi);
/* Ends the session. Zeroed is fine. */
void picture_socket_close(struct picture_socket *socket);

#endif
