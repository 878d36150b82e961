/* The socket between kiosk and fetcher, used by both ends. It carries whole messages
 * (format/message.h), some with a descriptor. It never blocks: what the socket does not accept now
 * waits in a queue. */
#ifndef GOPURA_NET_PACKETS_H
#define GOPURA_NET_PACKETS_H

#include "format/message.h"

struct packet;

struct packets {
	int fd;                       /* owned; -1: none */
	struct packet *first, **last; /* send queue */
	size_t queued_bytes;          /* includes the bytes of queued descriptors */
	struct buffer in, out;        /* scratch memory */
};

/* fd is taken and made non-blocking. */
void packets_init(struct packets *packets, int fd);
/* A zeroed or finished struct is fine. The other end is told at once. net/closer.h does the close
 * itself, because unread descriptors in the socket may make it block. Remove the socket from any
 * epoll set first: the set keeps it until the close is done. */
void packets_finish(struct packets *packets);

/* Sends or queues a message. The descriptor `passed` (-1: none) is taken, even on failure. -EPIPE,
 * -ECONNRESET: the other end is gone. -EFBIG: the message exceeds its limits. -ENOMEM. */
must_check int packets_send(struct packets *packets, const struct message *message, int passed);
/* Sends queued messages until the socket accepts no more. Returns 0, also if some remain queued. */
must_check int packets_flush(struct packets *packets);
/* Returns true if messages wait in the send queue. */
bool packets_wait(const struct packets *packets);

/* Receives the next message; its bytes are borrowed until the next call. *passed is a descriptor
 * that came with it (a sealed memfd, owned by the caller), or -1.
 *   -EAGAIN: no message now. -EPIPE: the other end closed the connection.
 *   -EBADMSG: invalid message or descriptor. It stays in the queue, so disconnect. */
must_check int packets_receive(struct packets *packets, struct message *out, int *passed);

/* Creates a sealed memfd with a copy of these bytes. Returns the descriptor, owned by the caller,
 * or a negative errno. */
must_check int packets_seal(struct bytes bytes);
/* Maps a received descriptor after checking that it is sealed and has exactly this size. The caller
 * must munmap *out; fd is borrowed. -EBADMSG: the check failed. */
must_check int packets_map_sealed(struct bytes *out, int fd, uint32_t size);

#endif
