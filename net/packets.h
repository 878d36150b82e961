/* The socket between kiosk and fetcher: whole messages (format/message.h), a descriptor beside
 * some, never blocking; what the socket does not take now waits in a queue. Both ends use it. */
#ifndef GOPURA_NET_PACKETS_H
#define GOPURA_NET_PACKETS_H

#include "format/message.h"

struct packet;

struct packets {
	int fd;                       /* owned; -1: none */
	struct packet *first, **last; /* queue to be sent */
	size_t queued_bytes;          /* those of descriptors included */
	struct buffer in, out;        /* scratch */
};

/* fd is taken, and made non-blocking. */
void packets_init(struct packets *packets, int fd);
/* A zeroed or finished one is fine. The other end is told at once; the close itself is left to
 * net/closer.h, for what lies in the socket unread may be anything: until then an epoll set has it
 * still, so take it out there first. */
void packets_finish(struct packets *packets);

/* passed (-1: none) is taken, even on failure. -EPIPE and kin: the other end is gone. -EFBIG: the
 * message keeps not to its limits. */
must_check int packets_send(struct packets *packets, const struct message *message, int passed);
/* Sends what waits, as far as the socket takes it. */
must_check int packets_flush(struct packets *packets);
bool packets_wait(const struct packets *packets); /* something waits to be sent */

/* The next message; its bytes are borrowed until the next call. *passed is the descriptor that came
 * along (owned by the caller) or -1; it is a memfd sealed against every change.
 *   -EAGAIN none now   -EPIPE the other end closed
 *   -EBADMSG not a message, or descriptors amiss: it stays the next one, so hang up */
must_check int packets_receive(struct packets *packets, struct message *out, int *passed);

/* A sealed memfd with these bytes, owned by the caller; negative errno. */
must_check int packets_seal(struct bytes bytes);
/* Maps what a message passed: checks that it is sealed against every change and has that size.
 * *out must be unmapped. -EBADMSG. */
must_check int packets_map_sealed(struct bytes *out, int fd, uint32_t size);

#endif
