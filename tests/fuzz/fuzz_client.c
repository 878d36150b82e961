/* A fetcher that was taken over, as the kiosk's end of the socket meets it: the bytes are a
 * sequence of packets, with or without descriptors, among what the kiosk asks for. Objects that get
 * through have the hash of one that is wanted; the kiosk's end lives on. */
#include <errno.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "net/client.h"
#include "net/packets.h"
#include "tests/fuzz/scratch.h"

enum { EVENTS_MAX = 40 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const struct bytes objects[] = {
	{ (const uint8_t *)"sandstone", 9 },
	{ (const uint8_t *)"laterite", 8 },
};

static struct net_client *client;
static bool wanted[ARRAY_COUNT(objects)];

/* ---- what the kiosk hears */

static void on_object(void *data, struct hash hash, struct bytes bytes)
{
	(void)data;
	for (size_t i = 0; i < ARRAY_COUNT(objects); i++)
		if (hash_equal(hash, hash_of(objects[i]))) {
			if (!wanted[i] || bytes.size != objects[i].size)
				abort();
			wanted[i] = false;
			return;
		}
	abort(); /* nobody wanted it */
}

static void on_missing(void *data, struct hash hash, enum missing_reason reason)
{
	(void)data, (void)hash;
	if (reason < MISSING_OFFLINE || reason > MISSING_DAMAGED)
		abort();
}

static void on_meta(void *data, enum meta_role role, uint32_t version, struct bytes bytes,
		    enum meta_source source)
{
	(void)data, (void)version;
	if (role < META_ROOT || role > META_TIMESTAMP || bytes.size > MESSAGE_META_BYTES_MAX ||
	    source < META_FROM_SERVER || source > META_FROM_STICK)
		abort();
}

static void on_synced(void *data, bool done)
{
	(void)data, (void)done;
}

static void on_status(void *data, const struct message_status *status)
{
	(void)data, (void)status;
}

/* ---- what the fetcher sends */

static int memory_with(struct bytes bytes)
{
	int fd = memfd_create("object", MFD_CLOEXEC | MFD_ALLOW_SEALING);

	if (fd < 0 || write(fd, bytes.data, bytes.size) != (ssize_t)bytes.size)
		abort();
	return fd;
}

/* A descriptor of a kind; -1: none. */
static int descriptor(uint8_t kind, struct bytes bytes)
{
	int fd, pair[2];

	switch (kind % 6) {
	case 1:
		fd = packets_seal(bytes);
		return fd;
	case 2:
		return memory_with(bytes);
	case 3:
		return open("/dev/null", O_RDONLY | O_CLOEXEC);
	case 4:
		if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) < 0)
			abort();
		close(pair[1]);
		return pair[0];
	case 5: /* sealed against growing alone */
		fd = memory_with(bytes);
		if (fcntl(fd, F_ADD_SEALS, F_SEAL_GROW) < 0)
			abort();
		return fd;
	default:
		return -1;
	}
}

/* count descriptors, each a copy of fd. */
static void send_packet(int socket, struct bytes packet, int fd, size_t count)
{
	union {
		char bytes[CMSG_SPACE(3 * sizeof(int))];
		struct cmsghdr aligned;
	} control = { { 0 } };
	struct iovec part = { (void *)packet.data, packet.size };
	struct msghdr header = { .msg_iov = &part, .msg_iovlen = 1 };

	if (fd >= 0) {
		struct cmsghdr *rights;

		header.msg_control = control.bytes;
		header.msg_controllen = CMSG_SPACE(count * sizeof(int));
		rights = CMSG_FIRSTHDR(&header);
		rights->cmsg_level = SOL_SOCKET;
		rights->cmsg_type = SCM_RIGHTS;
		rights->cmsg_len = CMSG_LEN(count * sizeof(int));
		for (size_t i = 0; i < count; i++)
			memcpy(CMSG_DATA(rights) + i * sizeof(int), &fd, sizeof(int));
	}
	(void)!sendmsg(socket, &header, MSG_NOSIGNAL | MSG_DONTWAIT);
	if (fd >= 0)
		close(fd);
}

/* A message as it should be, of an object that may be wanted. */
static void send_object(int socket, uint8_t which, uint8_t kind)
{
	const struct bytes object = objects[which % ARRAY_COUNT(objects)];
	const int fd = descriptor(kind, object);
	struct message message = { .kind = MESSAGE_OBJECT,
				   .object = { hash_of(object), object, (uint32_t)object.size } };
	struct buffer packet;

	if (fd >= 0)
		message.object.bytes = (struct bytes){ NULL, 0 };
	buffer_init(&packet, MESSAGE_BYTES_MAX);
	message_encode(&packet, &message);
	send_packet(socket, buffer_bytes(&packet), fd, 1);
	buffer_finish(&packet);
}

/* ---- what the kiosk says */

static void ask(uint8_t what)
{
	const size_t n = what / 8 % ARRAY_COUNT(objects);
	struct message_want want = { .hash = hash_of(objects[n]),
				     .page = { { 1 } },
				     .size = (uint32_t)objects[n].size,
				     .priority = what };

	switch (what % 8) {
	case 0: /* drops what is wanted, but where it is in use already */
		net_client_use_release(client, (struct hash){ { what } }, 100);
		break;
	case 1:
		net_client_add_release(client, (struct hash){ { what } }, 100);
		break;
	case 2:
		net_client_drop(client, want.hash);
		wanted[n] = false;
		break;
	case 3:
		net_client_sync(client);
		break;
	case 4:
		net_client_keep(client, want.hash);
		break;
	default:
		if (net_client_want(client, &want) < 0)
			abort(); /* memory does not fail here */
		wanted[n] = true;
	}
}

static void event(int fetcher, struct reader *in)
{
	const uint8_t what = reader_u8(in), kind = reader_u8(in);
	size_t size = what % 4 < 2 ? reader_u8(in) : 0;
	struct bytes packet;

	size = size < reader_left(in) ? size : reader_left(in);
	packet = reader_bytes(in, size);
	switch (what % 4) {
	case 0:
		send_packet(fetcher, packet, -1, 0);
		break;
	case 1:
		send_packet(fetcher, packet, descriptor(kind, packet), 1 + kind / 8 % 3);
		break;
	case 2:
		send_object(fetcher, what / 4, kind);
		break;
	case 3:
		ask(kind);
		break;
	}
	if (net_client_dispatch(client) < 0)
		abort();
}

static int listen_here(void)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	static int listener = -1;

	if (listener >= 0)
		return listener;
	scratch_begin();
	snprintf(address.sun_path, sizeof(address.sun_path), "%.100s", scratch_path("socket"));
	listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (bind(listener, (struct sockaddr *)&address, sizeof(address)) < 0 ||
	    listen(listener, 4) < 0)
		abort();
	return listener;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct net_client_options options = {
		.events = { on_object, on_missing, on_meta, on_synced, on_status },
	};
	const int listener = listen_here();
	struct reader in;
	int fetcher;

	options.socket_path = scratch_path("socket");
	memset(wanted, 0, sizeof(wanted));
	if (net_client_create(&client, &options) < 0)
		abort();
	fetcher = accept4(listener, NULL, NULL, SOCK_CLOEXEC);
	if (fetcher < 0) { /* it may wait until what came before is closed */
		net_client_destroy(client);
		return 0;
	}
	for (uint8_t n = 0; n < ARRAY_COUNT(objects); n++)
		ask((uint8_t)(7 + 8 * n));
	reader_init(&in, (struct bytes){ data, size });
	for (int i = 0; i < EVENTS_MAX && reader_left(&in) > 0; i++)
		event(fetcher, &in);
	close(fetcher);
	net_client_destroy(client);
	return 0;
}
