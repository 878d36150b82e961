/* A captured fetcher at the other end of the kiosk's socket: whatever it sends, in whatever order,
 * the client takes no wrong object, never waits, stays small, and works with a good fetcher
 * afterwards. The sequences are random, from a seed that is printed: SEED=N plays one again. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "net/client.h"
#include "net/closer.h"
#include "net/packets.h"
#include "tests/check.h"
#include "tests/net/lingering.h"

enum {
	OBJECTS = 24, /* that are wanted, dropped and sent */
	ROUNDS = 3000,
	LINGERING_MAX = 8,                /* in one sequence; each takes memory of the kernel */
	DISPATCH_MS_MAX = LINGER_S * 500, /* far below what a wait for a close would take */
	CONNECT_MS = 5000,
	MEMORY_KIB_MAX = 400 << 10, /* more than at the begin; a sanitizer keeps 256 MiB */
};

/* ---- pauses before a reconnection are left out */

int timerfd_create(int clock, int flags)
{
	(void)clock;
	(void)flags;
	return eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
}

int timerfd_settime(int fd, int flags, const struct itimerspec *when, struct itimerspec *before)
{
	uint64_t one = 1;

	(void)flags;
	(void)before;
	if (when->it_value.tv_sec < 20)
		CHECK(write(fd, &one, sizeof(one)) == sizeof(one));
	return 0;
}

/* ---- the stage */

struct stage {
	char folder[64], path[96];
	int listener, socket; /* socket: the fetcher's end; -1: none */
	struct net_client *client;
	uint8_t objects[OBJECTS][300];
	struct hash hashes[OBJECTS];
	bool wanted[OBJECTS];
	uint64_t taken, metas;
	int peers[LINGERING_MAX]; /* of sockets that linger */
	size_t peer_count;
	uint64_t random_state;
};

static uint32_t random_below(struct stage *stage, uint32_t limit)
{
	stage->random_state = stage->random_state * 6364136223846793005ull + 1442695040888963407ull;
	return (uint32_t)(stage->random_state >> 33) % limit;
}

static struct bytes bytes_of(const struct stage *stage, uint32_t i)
{
	return (struct bytes){ stage->objects[i], sizeof(stage->objects[i]) };
}

static void on_object(void *data, struct hash hash, struct bytes bytes)
{
	struct stage *stage = data;

	CHECK(hash_equal(hash_of(bytes), hash));
	for (uint32_t i = 0; i < OBJECTS; i++) {
		if (!hash_equal(stage->hashes[i], hash))
			continue;
		CHECK(stage->wanted[i]); /* once for each want */
		stage->wanted[i] = false;
		stage->taken++;
		return;
	}
	fail_msg("an object that was never wanted");
}

static void on_missing(void *data, struct hash hash, enum missing_reason reason)
{
	(void)data;
	(void)hash;
	CHECK(reason <= MISSING_DAMAGED);
}

static void on_meta(void *data, enum meta_role role, uint32_t version, struct bytes bytes,
		    enum meta_source source)
{
	struct stage *stage = data;

	CHECK(role <= META_TIMESTAMP && source <= META_FROM_STICK && bytes.size > 0);
	(void)version;
	stage->metas++;
}

static void on_synced(void *data, bool done)
{
	(void)data;
	(void)done;
}

static void on_status(void *data, const struct message_status *status)
{
	(void)data;
	CHECK(status->online <= 1);
}

static void listen_at(struct stage *stage)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };

	stage->listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	snprintf(address.sun_path, sizeof(address.sun_path), "%s", stage->path);
	CHECK(bind(stage->listener, (struct sockaddr *)&address, sizeof(address)) == 0);
	CHECK(listen(stage->listener, 4) == 0);
}

static int set_up(void **state)
{
	struct stage *stage = calloc(1, sizeof(*stage));
	struct net_client_options options = {
		.events = { on_object, on_missing, on_meta, on_synced, on_status },
		.data = stage,
		.root_version = 1,
	};

	*state = stage;
	stage->socket = -1;
	snprintf(stage->folder, sizeof(stage->folder), "/tmp/gopura-hostile-XXXXXX");
	CHECK(mkdtemp(stage->folder));
	snprintf(stage->path, sizeof(stage->path), "%s/socket", stage->folder);
	listen_at(stage);
	for (uint32_t i = 0; i < OBJECTS; i++) {
		memset(stage->objects[i], (int)i + 1, sizeof(stage->objects[i]));
		stage->hashes[i] = hash_of(bytes_of(stage, i));
	}
	options.socket_path = stage->path;
	CHECK(net_client_create(&stage->client, &options) == 0);
	return 0;
}

static void end_lingering(struct stage *stage)
{
	while (stage->peer_count > 0)
		close(stage->peers[--stage->peer_count]);
}

static int tear_down(void **state)
{
	struct stage *stage = *state;

	net_client_destroy(stage->client);
	if (stage->socket >= 0)
		close(stage->socket);
	end_lingering(stage);
	close(stage->listener);
	unlink(stage->path);
	rmdir(stage->folder);
	free(stage);
	return 0;
}

/* ---- both ends */

static void dispatch(struct stage *stage)
{
	struct pollfd ready = { .fd = net_client_fd(stage->client), .events = POLLIN };

	for (int i = 0; i < 20 && poll(&ready, 1, 0) > 0; i++) {
		const int64_t began_ms = clock_now_ms();

		CHECK(net_client_dispatch(stage->client) == 0);
		CHECK(clock_now_ms() - began_ms < DISPATCH_MS_MAX);
	}
}

/* Is the kiosk connected? What it says is read, but for once in a while. */
static bool connected(struct stage *stage)
{
	static char heard[MESSAGE_BYTES_MAX];
	int fd = accept4(stage->listener, NULL, NULL, SOCK_CLOEXEC);
	ssize_t got = 1;

	if (fd >= 0) {
		if (stage->socket >= 0)
			close(stage->socket);
		stage->socket = fd;
	}
	while (stage->socket >= 0 && got > 0)
		got = recv(stage->socket, heard, sizeof(heard), MSG_DONTWAIT);
	if (stage->socket >= 0 && (got == 0 || errno != EAGAIN)) {
		close(stage->socket);
		stage->socket = -1;
	}
	return stage->socket >= 0;
}

/* In time: what is being closed gives way by and by. */
static bool connects(struct stage *stage)
{
	const int64_t until_ms = clock_now_ms() + CONNECT_MS;

	while (!connected(stage) && clock_now_ms() < until_ms) {
		struct pollfd ready = { .fd = stage->listener, .events = POLLIN };

		dispatch(stage);
		if (poll(&ready, 1, 10) < 0)
			return false;
	}
	return stage->socket >= 0;
}

/* false: the socket is full, or the kiosk hung up, which the next round will see. */
static bool send_packet(struct stage *stage, struct bytes packet, int fd)
{
	if (fd >= 0)
		return try_send_with(stage->socket, packet.data, packet.size, &fd, 1);
	return send(stage->socket, packet.data, packet.size, MSG_NOSIGNAL | MSG_DONTWAIT) > 0;
}

static bool send_message(struct stage *stage, const struct message *message, int fd)
{
	struct buffer wire;
	bool sent;

	buffer_init(&wire, MESSAGE_BYTES_MAX);
	message_encode(&wire, message);
	CHECK(wire.error == 0);
	sent = send_packet(stage, buffer_bytes(&wire), fd);
	buffer_finish(&wire);
	return sent;
}

/* ---- what the kiosk does meanwhile */

static void want_something(struct stage *stage)
{
	const uint32_t i = random_below(stage, OBJECTS);
	const struct message_want want = { .hash = stage->hashes[i],
					   .size = sizeof(stage->objects[i]),
					   .priority = random_below(stage, 4) };

	stage->wanted[i] = true;
	CHECK(net_client_want(stage->client, &want) == 0);
}

static void live(struct stage *stage)
{
	const uint32_t i = random_below(stage, OBJECTS);
	struct hash root = { { 1, (uint8_t)i } };

	switch (random_below(stage, 12)) {
	case 0:
		stage->wanted[i] = false;
		net_client_drop(stage->client, stage->hashes[i]);
		break;
	case 1:
		net_client_keep(stage->client, stage->hashes[i]);
		break;
	case 2:
		net_client_sync(stage->client);
		break;
	case 3:
		if (random_below(stage, 20) > 0)
			break;
		memset(stage->wanted, 0, sizeof(stage->wanted));
		net_client_use_release(stage->client, root, 100);
		net_client_use_release(stage->client, stage->hashes[0], 100);
		break;
	case 4:
		net_client_trust(stage->client, i);
		break;
	default:
		want_something(stage);
	}
}

/* ---- what the fetcher sends */

static int some_descriptor(struct stage *stage, struct bytes bytes)
{
	int pipes[2], fd;

	switch (random_below(stage, 7)) {
	case 0:
		CHECK(pipe2(pipes, O_CLOEXEC) == 0);
		close(pipes[random_below(stage, 2)]);
		return fcntl(pipes[0], F_GETFD) >= 0 ? pipes[0] : pipes[1];
	case 1:
		fd = memfd_create("open", MFD_CLOEXEC | MFD_ALLOW_SEALING);
		CHECK(ftruncate(fd, (off_t)bytes.size) == 0);
		return fd;
	case 2:
		return open("/dev/zero", O_RDONLY | O_CLOEXEC);
	case 3:
		return socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
	case 4:
		if (stage->peer_count == LINGERING_MAX)
			end_lingering(stage);
		return lingering_socket(&stage->peers[stage->peer_count++]);
	default:
		return packets_seal(bytes);
	}
}

static void send_object(struct stage *stage)
{
	const uint32_t i = random_below(stage, OBJECTS), kind = random_below(stage, 10);
	struct message message = { .kind = MESSAGE_OBJECT,
				   .object = { stage->hashes[i], bytes_of(stage, i),
					       sizeof(stage->objects[i]) } };
	int fd = -1;

	if (kind == 0)
		message.object.bytes = bytes_of(stage, (i + 1) % OBJECTS); /* wrong */
	if (kind == 1)
		message.object.hash.bytes[3] ^= 1; /* nobody's */
	if (kind == 2)
		message.object.size = 1 + random_below(stage, 16 << 20);
	if (kind >= 7) {
		message.object.bytes = (struct bytes){ NULL, 0 };
		fd = some_descriptor(stage, bytes_of(stage, i));
	}
	send_message(stage, &message, fd);
}

static void send_metadata(struct stage *stage)
{
	static uint8_t rubbish[MESSAGE_META_BYTES_MAX];
	const struct message message = { .kind = MESSAGE_META,
					 .meta = { (enum meta_role)random_below(stage, 3),
						   random_below(stage, UINT32_MAX),
						   { rubbish,
						     1 + random_below(stage, sizeof(rubbish)) },
						   (enum meta_source)random_below(stage, 2) } };

	send_message(stage, &message, -1);
}

static void send_flood(struct stage *stage)
{
	const struct message messages[] = {
		{ .kind = MESSAGE_SYNCED, .synced = true },
		{ .kind = MESSAGE_STATUS, .status.received_bytes = UINT64_MAX },
		{ .kind = MESSAGE_MISSING, .missing = { stage->hashes[0], MISSING_NOT_FOUND } },
		{ .kind = MESSAGE_META, .meta = { META_ROOT, 2, bytes_of(stage, 0), 0 } },
		{ .kind = MESSAGE_FILE,
		  .file = { .name = "9.root.json", .bytes = bytes_of(stage, 0) } },
	};
	const struct message *message = &messages[random_below(stage, ARRAY_COUNT(messages))];

	for (int i = 0; i < 300 && send_message(stage, message, -1); i++)
		;
}

/* Something that is almost a message, or nothing like it. */
static void send_rubbish(struct stage *stage)
{
	uint8_t packet[400];
	struct buffer wire;
	size_t size = 1 + random_below(stage, sizeof(packet));
	struct message message = { .kind = MESSAGE_OBJECT,
				   .object = { stage->hashes[0], bytes_of(stage, 0), 300 } };

	for (size_t i = 0; i < size; i++)
		packet[i] = (uint8_t)random_below(stage, 256);
	if (random_below(stage, 2)) {
		buffer_init(&wire, MESSAGE_BYTES_MAX);
		message_encode(&wire, &message);
		size = size < wire.size ? size : wire.size;
		memcpy(packet, wire.data, size);
		packet[random_below(stage, (uint32_t)size)] ^=
			(uint8_t)(1 << random_below(stage, 8));
		buffer_finish(&wire);
	}
	send_packet(stage, (struct bytes){ packet, size },
		    random_below(stage, 4) ? -1 : some_descriptor(stage, bytes_of(stage, 1)));
}

static void send_many_descriptors(struct stage *stage)
{
	const size_t count = 2 + random_below(stage, 252);
	int fds[253];

	for (size_t i = 0; i < count; i++)
		fds[i] = packets_seal(bytes_of(stage, 0));
	try_send_with(stage->socket, "\x40 many", 6, fds, count);
}

static void attack(struct stage *stage)
{
	switch (random_below(stage, 40)) {
	case 0:
		send_flood(stage);
		break;
	case 1:
		send_rubbish(stage);
		break;
	case 2:
		send_many_descriptors(stage);
		break;
	case 3:
		send_packet(stage, (struct bytes){ (const uint8_t *)"", 0 }, -1);
		break;
	case 4:
		close(stage->socket);
		stage->socket = -1;
		break;
	case 5:
	case 6:
		send_metadata(stage);
		break;
	default:
		send_object(stage);
	}
}

/* ---- the tests */

static long memory_kib(void)
{
	FILE *file = fopen("/proc/self/statm", "r");
	long pages = 0;

	CHECK(file && fscanf(file, "%*d %ld", &pages) == 1);
	fclose(file);
	return pages * (sysconf(_SC_PAGESIZE) / 1024);
}

static int open_descriptors(void)
{
	int count = 0;

	for (int fd = 0; fd < 4096; fd++)
		count += fcntl(fd, F_GETFD) >= 0;
	return count;
}

/* This connection is over, as when the fetcher ends. */
static void hang_up(struct stage *stage)
{
	if (stage->socket >= 0)
		close(stage->socket);
	stage->socket = -1;
}

/* A good fetcher comes: what is wanted is taken, each once. */
static void works_again(struct stage *stage)
{
	hang_up(stage);
	CHECK(connects(stage));
	stage->taken = 0;
	for (uint32_t i = 0; i < OBJECTS; i++) {
		const struct message_want want = { .hash = stage->hashes[i],
						   .size = sizeof(stage->objects[i]) };
		const struct message message = { .kind = MESSAGE_OBJECT,
						 .object = { stage->hashes[i], bytes_of(stage, i),
							     sizeof(stage->objects[i]) } };

		stage->wanted[i] = true;
		CHECK(net_client_want(stage->client, &want) == 0);
		send_message(stage, &message, -1);
		dispatch(stage);
	}
	CHECK(stage->taken == OBJECTS && connected(stage));
}

/* Descriptors are closed by threads, which come to it when they come. */
static void gives_every_descriptor_back(struct stage *stage, int before)
{
	const int64_t until_ms = clock_now_ms() + 10000;

	end_lingering(stage);
	while (open_descriptors() > before + 4 && clock_now_ms() < until_ms)
		usleep(10000);
	CHECK(open_descriptors() <= before + 4);
}

static void survives_whatever_a_fetcher_sends(void **state)
{
	struct stage *stage = *state;
	const char *seed = getenv("SEED");
	const int before = open_descriptors();
	const long before_kib = memory_kib();
	uint32_t connections = 0;

	stage->random_state = seed ? strtoull(seed, NULL, 10) : 20260701;
	printf("SEED=%llu\n", (unsigned long long)stage->random_state);
	for (int round = 0; round < ROUNDS; round++) {
		if (!connected(stage)) {
			end_lingering(stage); /* so that there is an end of waiting */
			CHECK(connects(stage));
			connections++;
		}
		live(stage);
		attack(stage);
		if (random_below(stage, 3) == 0)
			dispatch(stage);
	}
	CHECK(connections > 20 && stage->taken > 50 && stage->metas > 50); /* all that took place */
	end_lingering(stage);
	works_again(stage);
	gives_every_descriptor_back(stage, before);
	CHECK(memory_kib() < before_kib + MEMORY_KIB_MAX);
}

/* Each connection leaves a close that hangs: after a few there is no further one, and the kiosk
 * goes on; when they give way there is. */
static void gives_no_connection_while_closes_hang(void **state)
{
	struct stage *stage = *state;
	const struct message object = { .kind = MESSAGE_OBJECT,
					.object = { stage->hashes[0], { NULL, 0 }, 9 } };
	const int before = open_descriptors();
	int peers[CLOSER_THREADS_MAX + 1], count = 0;

	while (count < CLOSER_THREADS_MAX + 1 && connects(stage)) {
		CHECK(send_message(stage, &object, lingering_socket(&peers[count++])));
		dispatch(stage);
		hang_up(stage);
	}
	CHECK(count <= CLOSER_THREADS_MAX && closer_is_full());
	CHECK(open_descriptors() < before + 5 * CLOSER_THREADS_MAX);
	while (count > 0)
		close(peers[--count]);
	works_again(stage);
	gives_every_descriptor_back(stage, before);
}

#define STAGED(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		STAGED(survives_whatever_a_fetcher_sends),
		STAGED(gives_no_connection_while_closes_hang),
	};

	log_set_level(LOG_LEVEL_ERROR); /* each refusal is a warning */
	return cmocka_run_group_tests(tests, NULL, NULL);
}
