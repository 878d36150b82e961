/* One curator's browser: a thread that draws for it and carries out what it asks. The newest camera
 * wins, and no picture is drawn before the one before the last has arrived, so a slow browser gets
 * fewer pictures and nothing queues. docs/curator.md has the messages. */
#ifndef GOPURA_CURATOR_SESSION_SESSION_H
#define GOPURA_CURATOR_SESSION_SESSION_H

#include "base/bytes.h"
#include "curator/accounts/role.h"
#include "curator/session/site.h"

enum { SESSION_MESSAGE_BYTES_MAX = 32 << 20 }; /* of what is sent to a browser */

struct session;

struct session_options {
	struct site *site; /* borrowed */
	struct caller caller;
	/* Called by the session's thread when session_next has something; may be called while
	 * session_destroy waits. */
	void (*wake)(void *user);
	void *user;
};

/* Starts the thread, which says hello. *out is owned by the caller; NULL on failure. -ENOMEM, or
 * the errno of pthread_create. */
must_check int session_create(struct session **out, const struct session_options *options);
/* Ends the thread after what it is doing. NULL is fine. */
void session_destroy(struct session *session);

/* Takes a message of the browser. Nothing fails: a bad one is answered with an error. */
void session_receive(struct session *session, const char *text, size_t bytes);
/* Appends the next message for the browser to *out. Returns false if there is none. */
bool session_next(struct session *session, struct buffer *out, bool *binary);
/* Whether the browser must be let go, because it takes its messages slowly or not at all, or
 * because there was no memory for one that it waits for. */
bool session_is_lost(struct session *session);

#endif
