/* Sends and receives whole messages over a SOCK_SEQPACKET socket, with sealed memory descriptors
 * for large objects and a queue for what the socket does not accept yet. */
#include "net/packets.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/magic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include "net/closer.h"

enum { SEALS = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE | F_SEAL_SEAL };

struct packet {
	struct packet *next;
	int passed; /* owned; -1: none */
	size_t size;
	size_t weight; /* bytes it occupies in the queue, including those of the descriptor */
	uint8_t bytes[];
};

void packets_init(struct packets *packets, int fd)
{
	*packets = (struct packets){ .fd = fd };
	packets->last = &packets->first;
	buffer_init(&packets->in, MESSAGE_BYTES_MAX + 1);
	buffer_init(&packets->out, MESSAGE_BYTES_MAX);
	fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK);
}

static void packet_destroy(struct packet *packet)
{
	if (packet->passed >= 0)
		close(packet->passed);
	free(packet);
}

void packets_finish(struct packets *packets)
{
	while (packets->first) {
		struct packet *packet = packets->first;

		packets->first = packet->next;
		packet_destroy(packet);
	}
	buffer_finish(&packets->in);
	buffer_finish(&packets->out);
	if (packets->last && packets->fd >= 0) {  /* false for a zeroed struct */
		shutdown(packets->fd, SHUT_RDWR); /* tells the other end now */
		closer_close(packets->fd);
	}
	*packets = (struct packets){ .fd = -1 };
}

static int send_now(int fd, struct bytes bytes, int passed)
{
	union {
		char bytes[CMSG_SPACE(sizeof(int))];
		struct cmsghdr aligned;
	} control = { { 0 } };
	struct iovec part = { (void *)bytes.data, bytes.size };
	struct msghdr header = { .msg_iov = &part, .msg_iovlen = 1 };
	ssize_t sent;

	if (passed >= 0) {
		struct cmsghdr *rights;

		header.msg_control = control.bytes;
		header.msg_controllen = sizeof(control.bytes);
		rights = CMSG_FIRSTHDR(&header);
		rights->cmsg_level = SOL_SOCKET;
		rights->cmsg_type = SCM_RIGHTS;
		rights->cmsg_len = CMSG_LEN(sizeof(int));
		memcpy(CMSG_DATA(rights), &passed, sizeof(int));
	}
	do
		sent = sendmsg(fd, &header, MSG_NOSIGNAL | MSG_DONTWAIT);
	while (sent < 0 && errno == EINTR);
	/* ETOOMANYREFS (too many descriptors in flight) and ENOBUFS both pass when the other end
	 * reads. */
	if (sent < 0 && (errno == EWOULDBLOCK || errno == ETOOMANYREFS || errno == ENOBUFS))
		return -EAGAIN;
	return sent < 0 ? -errno : 0;
}

static int enqueue(struct packets *packets, struct bytes bytes, int passed, size_t passed_bytes)
{
	struct packet *packet = malloc(sizeof(*packet) + bytes.size);

	if (!packet)
		return -ENOMEM;
	*packet = (struct packet){ .passed = passed,
				   .size = bytes.size,
				   .weight = sizeof(*packet) + bytes.size + passed_bytes };
	memcpy(packet->bytes, bytes.data, bytes.size);
	*packets->last = packet;
	packets->last = &packet->next;
	packets->queued_bytes += packet->weight;
	return 0;
}

int packets_send(struct packets *packets, const struct message *message, int passed)
{
	int rc = packets->fd < 0 ? -EPIPE : 0;

	buffer_clear(&packets->out);
	message_encode(&packets->out, message);
	if (rc == 0)
		rc = packets->out.error;
	if (rc == 0)
		rc = packets->first ? -EAGAIN
				    : send_now(packets->fd, buffer_bytes(&packets->out), passed);
	if (rc == -EAGAIN) {
		rc = enqueue(packets, buffer_bytes(&packets->out), passed,
			     passed >= 0 ? message->object.size : 0);
		if (rc == 0)
			passed = -1; /* the queue owns it now */
	}
	if (passed >= 0)
		close(passed);
	return rc;
}

int packets_flush(struct packets *packets)
{
	while (packets->first) {
		struct packet *packet = packets->first;
		int rc = send_now(packets->fd, (struct bytes){ packet->bytes, packet->size },
				  packet->passed);

		if (rc < 0)
			return rc == -EAGAIN ? 0 : rc;
		packets->queued_bytes -= packet->weight;
		packets->first = packet->next;
		if (!packets->first)
			packets->last = &packets->first;
		packet_destroy(packet);
	}
	return 0;
}

bool packets_wait(const struct packets *packets)
{
	return packets->first != NULL;
}

/* ---- receiving
 *
 * The other end may pass any descriptor. The last close of some descriptors blocks (a TCP socket
 * with SO_LINGER). So a message is first read with MSG_PEEK: the descriptor we get is then a second
 * reference beside the one in the queue, and closing ours is never the last close. The message is
 * removed from the queue only when its descriptor is known to be sealed memory. Otherwise it stays
 * in the queue until the socket is closed, on a separate thread. */

/* Accepts only a memfd sealed against every change. The seals are checked first, because no other
 * file type's code is involved in that query; even fstat may block. */
static bool is_sealed_memory(int fd)
{
	const int seals = fcntl(fd, F_GET_SEALS);
	struct statfs system;

	return seals >= 0 && (seals & SEALS) == SEALS && fstatfs(fd, &system) == 0 &&
	       system.f_type == TMPFS_MAGIC; /* not hugetlbfs, whose pages may run out */
}

/* Returns the descriptor that was passed with the message; -1: none. */
static int passed_in(struct msghdr *header)
{
	int passed = -1;

	for (struct cmsghdr *part = CMSG_FIRSTHDR(header); part; part = CMSG_NXTHDR(header, part))
		if (part->cmsg_level == SOL_SOCKET && part->cmsg_type == SCM_RIGHTS &&
		    part->cmsg_len == CMSG_LEN(sizeof(int)))
			memcpy(&passed, CMSG_DATA(part), sizeof(int));
	return passed;
}

/* recvmsg that does not block and is repeated after EINTR. */
static ssize_t receive_now(int fd, struct msghdr *header, int flags)
{
	ssize_t got;

	do
		got = recvmsg(fd, header, flags | MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
	while (got < 0 && errno == EINTR);
	return got;
}

static int peek_packet(struct packets *packets, int *passed)
{
	union {
		char bytes[CMSG_SPACE(sizeof(int))];
		struct cmsghdr aligned;
	} control;
	struct iovec part;
	struct msghdr header = { .msg_iov = &part,
				 .msg_iovlen = 1,
				 .msg_control = control.bytes,
				 /* without the padding, which would have room for a second
				  * descriptor */
				 .msg_controllen = CMSG_LEN(sizeof(int)) };
	ssize_t got;

	if (packets->fd < 0)
		return -EPIPE;
	buffer_clear(&packets->in);
	part.iov_base = buffer_extend(&packets->in, MESSAGE_BYTES_MAX + 1);
	part.iov_len = MESSAGE_BYTES_MAX + 1;
	if (!part.iov_base)
		return packets->in.error;
	got = receive_now(packets->fd, &header, MSG_PEEK);
	if (got < 0)
		return errno == EAGAIN || errno == EWOULDBLOCK ? -EAGAIN
		       : errno == ECONNRESET                   ? -EPIPE
							       : -errno;
	packets->in.size = (size_t)got;
	*passed = passed_in(&header);
	if (got == 0) /* no message is empty, so this is the end of the connection */
		return -EPIPE;
	return header.msg_flags & (MSG_TRUNC | MSG_CTRUNC) ? -EBADMSG : 0;
}

static int judge_packet(const struct packets *packets, struct message *out, int passed)
{
	bool needs_one;
	int rc = message_decode(out, buffer_bytes(&packets->in));

	if (rc < 0)
		return rc;
	needs_one = out->kind == MESSAGE_OBJECT && out->object.bytes.size == 0;
	if (needs_one != (passed >= 0))
		return -EBADMSG;
	return passed < 0 || is_sealed_memory(passed) ? 0 : -EBADMSG;
}

int packets_receive(struct packets *packets, struct message *out, int *passed)
{
	/* One byte and not none: a recvmsg without a buffer is no recvmsg to qemu-user. */
	char byte;
	struct iovec part = { &byte, sizeof(byte) };
	struct msghdr rest = { .msg_iov = &part, .msg_iovlen = 1 };
	int rc;

	*passed = -1;
	rc = peek_packet(packets, passed);
	if (rc == 0)
		rc = judge_packet(packets, out, *passed);
	if (rc == 0 && receive_now(packets->fd, &rest, 0) < 0) /* remove it from the queue */
		rc = -errno;
	if (rc < 0) {
		closer_close(*passed);
		*passed = -1;
	}
	return rc;
}

int packets_seal(struct bytes bytes)
{
	int fd = memfd_create("object", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	size_t done = 0;

	if (fd < 0)
		return -errno;
	while (done < bytes.size) {
		ssize_t put = write(fd, bytes.data + done, bytes.size - done);

		if (put < 0 && errno == EINTR)
			continue;
		if (put <= 0)
			break;
		done += (size_t)put;
	}
	if (done < bytes.size || fcntl(fd, F_ADD_SEALS, SEALS) < 0) {
		int rc = errno ? -errno : -EIO;

		close(fd);
		return rc;
	}
	return fd;
}

int packets_map_sealed(struct bytes *out, int fd, uint32_t size)
{
	struct stat info;
	void *at;

	/* The other end could change or truncate an unsealed file while we read it. */
	if (!is_sealed_memory(fd))
		return -EBADMSG;
	if (fstat(fd, &info) < 0 || info.st_size != (off_t)size || size == 0)
		return -EBADMSG;
	at = mmap(NULL, size, PROT_READ, MAP_PRIVATE, fd, 0);
	if (at == MAP_FAILED)
		return -errno;
	*out = (struct bytes){ at, size };
	return 0;
}
