/* The client against a fetcher played by the test, at the other end of a socket path. */
#include "net/client.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "net/packets.h"
#include "tests/check.h"
#include "tests/net/lingering.h"

/* Time goes on by itself, and by what a test adds; timers ring when a test says so (ring). */
static int64_t later_ms;

int64_t clock_now_us(void)
{
	struct timespec now;

	clock_gettime(CLOCK_MONOTONIC, &now);
	return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000 + later_ms * 1000;
}

int64_t clock_now_ms(void)
{
	return clock_now_us() / 1000;
}

int64_t clock_thread_us(void)
{
	return 0;
}

int64_t clock_wall_s(void)
{
	return 0;
}

static int timer_fd = -1;

int timerfd_create(int clock, int flags)
{
	(void)clock;
	timer_fd = eventfd(0, EFD_CLOEXEC | (flags & TFD_NONBLOCK ? EFD_NONBLOCK : 0));
	return timer_fd;
}

/* A short timer (a pause before reconnecting) rings at once, a long one when ring() is called. */
int timerfd_settime(int fd, int flags, const struct itimerspec *when, struct itimerspec *before)
{
	uint64_t one = 1;

	(void)flags;
	(void)before;
	if (when->it_value.tv_sec < 20)
		CHECK(write(fd, &one, sizeof(one)) == sizeof(one));
	return 0;
}

struct stage {
	char folder[64], path[96];
	int listener;
	struct packets fetcher;
	struct net_client *client;
	int objects, missing, metas, statuses, synced;
	struct hash last;
	enum missing_reason reason;
	uint32_t root_version; /* that on_meta finds good; 0: none is */
	uint64_t received_bytes;
};

static const uint8_t material[] = "sandstone", brick[] = "laterite";

static struct bytes of(const uint8_t *text)
{
	return (struct bytes){ text, strlen((const char *)text) };
}

static void on_object(void *data, struct hash hash, struct bytes bytes)
{
	struct stage *stage = data;

	CHECK(hash_equal(hash_of(bytes), hash));
	stage->objects++;
	stage->last = hash;
}

static void on_missing(void *data, struct hash hash, enum missing_reason reason)
{
	struct stage *stage = data;

	stage->missing++;
	stage->last = hash;
	stage->reason = reason;
}

static void on_meta(void *data, enum meta_role role, uint32_t version, struct bytes bytes,
		    enum meta_source source)
{
	struct stage *stage = data;

	CHECK(role == META_ROOT && version == 4 && bytes.size == 9);
	CHECK(source == META_FROM_STICK);
	stage->metas++;
	if (stage->root_version) /* it was good */
		net_client_trust(stage->client, stage->root_version);
}

static void on_synced(void *data, bool done)
{
	((struct stage *)data)->synced += done ? 1 : 100;
}

static void on_status(void *data, const struct message_status *status)
{
	struct stage *stage = data;

	stage->statuses++;
	stage->received_bytes = status->received_bytes;
}

static void accept_client(struct stage *stage)
{
	struct pollfd ready = { .fd = stage->listener, .events = POLLIN };

	/* It may take a while: threads that close what was before come to it when they come. */
	for (int i = 0; i < 2000 && poll(&ready, 1, 10) == 0; i++) {
		struct pollfd client = { .fd = net_client_fd(stage->client), .events = POLLIN };

		if (poll(&client, 1, 0) > 0)
			CHECK(net_client_dispatch(stage->client) == 0);
	}
	CHECK(poll(&ready, 1, 0) == 1);
	packets_finish(&stage->fetcher);
	packets_init(&stage->fetcher, accept(stage->listener, NULL, NULL));
	CHECK(stage->fetcher.fd >= 0);
}

static void listen_at(struct stage *stage)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };

	stage->listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
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
		.root_version = 3,
	};

	*state = stage;
	snprintf(stage->folder, sizeof(stage->folder), "/tmp/gopura-client-XXXXXX");
	CHECK(mkdtemp(stage->folder));
	snprintf(stage->path, sizeof(stage->path), "%s/socket", stage->folder);
	listen_at(stage);
	options.socket_path = stage->path;
	CHECK(net_client_create(&stage->client, &options) == 0);
	accept_client(stage);
	return 0;
}

static int tear_down(void **state)
{
	struct stage *stage = *state;

	net_client_destroy(stage->client);
	packets_finish(&stage->fetcher);
	close(stage->listener);
	unlink(stage->path);
	rmdir(stage->folder);
	free(stage);
	return 0;
}

static void dispatch(struct stage *stage)
{
	struct pollfd ready = { .fd = net_client_fd(stage->client), .events = POLLIN };

	for (int i = 0; i < 50 && poll(&ready, 1, 0) > 0; i++)
		CHECK(net_client_dispatch(stage->client) == 0);
}

static void ring(struct stage *stage)
{
	uint64_t one = 1;

	CHECK(write(timer_fd, &one, sizeof(one)) == sizeof(one));
	dispatch(stage);
}

static bool is_of_the_begin(const struct message *message)
{
	return message->kind == MESSAGE_ASK_META || message->kind == MESSAGE_TRUST;
}

/* The next message that the fetcher gets; those of a connection's begin left out. */
static struct message received(struct stage *stage)
{
	struct message message;
	int passed, rc;

	do
		rc = packets_receive(&stage->fetcher, &message, &passed);
	while (rc == 0 && is_of_the_begin(&message));
	CHECK(rc == 0);
	return message;
}

static bool hears_nothing(struct stage *stage)
{
	struct message message;
	int passed, rc;

	do
		rc = packets_receive(&stage->fetcher, &message, &passed);
	while (rc == 0 && is_of_the_begin(&message));
	return rc == -EAGAIN;
}

static void tell(struct stage *stage, struct message message, int passed)
{
	CHECK(packets_send(&stage->fetcher, &message, passed) == 0);
	dispatch(stage);
}

static struct message_want want_of(const uint8_t *text, uint32_t priority)
{
	return (struct message_want){ .hash = hash_of(of(text)), .size = 9, .priority = priority };
}

static struct message object_of(const uint8_t *text)
{
	return (struct message){ .kind = MESSAGE_OBJECT,
				 .object = { hash_of(of(text)), of(text),
					     (uint32_t)of(text).size } };
}

static void delivers_what_is_wanted_once(void **state)
{
	struct stage *stage = *state;
	struct message_want want = want_of(material, 7);

	CHECK(net_client_want(stage->client, &want) == 0);
	CHECK(received(stage).want.priority == 7);
	CHECK(net_client_want(stage->client, &want) == 0); /* the same again: nothing new */
	CHECK(hears_nothing(stage));
	want.priority = 9;
	CHECK(net_client_want(stage->client, &want) == 0);
	CHECK(received(stage).want.priority == 9);
	tell(stage, object_of(material), -1);
	CHECK(stage->objects == 1 && hash_equal(stage->last, want.hash));
	tell(stage, object_of(material), -1); /* nobody waits for it any more */
	CHECK(stage->objects == 1);
}

static void passes_on_what_is_missing_and_meta_and_status(void **state)
{
	struct stage *stage = *state;
	struct message_want want = want_of(material, 7);
	struct message missing = { .kind = MESSAGE_MISSING,
				   .missing = { want.hash, MISSING_NOT_FOUND } };
	struct message meta = { .kind = MESSAGE_META,
				.meta = { META_ROOT, 4, of(material), META_FROM_STICK } };
	struct message status = { .kind = MESSAGE_STATUS, .status.received_bytes = 500 };

	tell(stage, missing, -1);
	CHECK(stage->missing == 0); /* it was not wanted */
	CHECK(net_client_want(stage->client, &want) == 0);
	tell(stage, missing, -1);
	CHECK(stage->missing == 1 && stage->reason == MISSING_NOT_FOUND);
	tell(stage, object_of(material), -1); /* it came after all */
	CHECK(stage->objects == 1);
	tell(stage, meta, -1);
	CHECK(stage->metas == 1);
	tell(stage, status, -1);
	CHECK(stage->statuses == 1 && stage->received_bytes == 500);
}

/* All state is sent again; returns having seen the new connection. */
static void reconnects(struct stage *stage)
{
	packets_finish(&stage->fetcher);
	dispatch(stage);
	accept_client(stage);
	dispatch(stage);
}

/* The version in the next MESSAGE_TRUST, with whatever comes before it skipped. */
static uint32_t received_trust(struct stage *stage)
{
	struct message message;
	int passed;

	do
		CHECK(packets_receive(&stage->fetcher, &message, &passed) == 0);
	while (message.kind != MESSAGE_TRUST);
	return message.root_version;
}

static void tells_after_every_root_which_one_it_has(void **state)
{
	struct stage *stage = *state;
	struct message meta = { .kind = MESSAGE_META,
				.meta = { META_ROOT, 4, of(material), META_FROM_STICK } };

	CHECK(received_trust(stage) == 3); /* on connecting */
	tell(stage, meta, -1);
	CHECK(received_trust(stage) == 3); /* refused */
	stage->root_version = 4;
	tell(stage, meta, -1);
	CHECK(received_trust(stage) == 4);
	reconnects(stage);
	CHECK(received_trust(stage) == 4);
}

static void asks_for_what_came_to_be_safe(void **state)
{
	struct stage *stage = *state;

	net_client_sync(stage->client);
	CHECK(received(stage).kind == MESSAGE_SYNC && stage->synced == 0);
	tell(stage, (struct message){ .kind = MESSAGE_SYNCED, .synced = true }, -1);
	CHECK(stage->synced == 1);
	tell(stage, (struct message){ .kind = MESSAGE_SYNCED }, -1);
	CHECK(stage->synced == 101);
}

static void drops_and_forgets(void **state)
{
	struct stage *stage = *state;
	struct message_want want = want_of(material, 7);

	net_client_drop(stage->client, want.hash); /* was not wanted: not a word */
	CHECK(hears_nothing(stage));
	CHECK(net_client_want(stage->client, &want) == 0);
	net_client_drop(stage->client, want.hash);
	CHECK(received(stage).kind == MESSAGE_WANT);
	CHECK(received(stage).kind == MESSAGE_DROP);
	tell(stage, object_of(material), -1); /* was under way */
	CHECK(stage->objects == 0);
}

static void takes_large_objects_sealed(void **state)
{
	struct stage *stage = *state;
	struct message_want want = want_of(material, 7);
	struct message message = object_of(material);

	CHECK(net_client_want(stage->client, &want) == 0);
	message.object.bytes = (struct bytes){ NULL, 0 };
	tell(stage, message, packets_seal(of(material)));
	CHECK(stage->objects == 1);
}

static void says_everything_again_after_the_fetcher_died(void **state)
{
	struct stage *stage = *state;
	struct message_want want = want_of(material, 7);
	struct hash root = { { 1 } }, next = { { 2 } }, keep = { { 3 } };
	struct message status = { .kind = MESSAGE_STATUS, .status.received_bytes = 500 };
	struct message message;

	net_client_use_release(stage->client, root, 100);
	net_client_add_release(stage->client, next, 200);
	CHECK(net_client_want(stage->client, &want) == 0);
	net_client_keep(stage->client, keep);
	tell(stage, status, -1);
	reconnects(stage);
	message = received(stage);
	CHECK(message.kind == MESSAGE_RELEASE && hash_equal(message.release.root, root));
	CHECK(!message.release.also && message.release.root_bytes == 100);
	message = received(stage);
	CHECK(message.kind == MESSAGE_RELEASE && hash_equal(message.release.root, next));
	CHECK(message.release.also);
	message = received(stage);
	CHECK(message.kind == MESSAGE_KEEP && hash_equal(message.keep, keep));
	message = received(stage);
	CHECK(message.kind == MESSAGE_WANT && hash_equal(message.want.hash, want.hash));
	status.status.received_bytes = 70; /* the new one counts from zero */
	tell(stage, status, -1);
	CHECK(stage->received_bytes == 570);
	tell(stage, object_of(material), -1);
	CHECK(stage->objects == 1);
}

static void begins_anew_with_another_release(void **state)
{
	struct stage *stage = *state;
	struct message_want want = want_of(material, 7);
	struct hash root = { { 1 } }, next = { { 2 } };

	net_client_use_release(stage->client, root, 100);
	CHECK(net_client_want(stage->client, &want) == 0);
	net_client_use_release(stage->client, root, 100); /* in use already */
	CHECK(received(stage).kind == MESSAGE_RELEASE);
	CHECK(received(stage).kind == MESSAGE_WANT);
	CHECK(hears_nothing(stage));
	net_client_use_release(stage->client, next, 100);
	CHECK(received(stage).kind == MESSAGE_RELEASE);
	tell(stage, object_of(material), -1);
	CHECK(stage->objects == 0); /* wants of the old one are dropped */
	reconnects(stage);
	CHECK(hash_equal(received(stage).release.root, next));
	CHECK(hears_nothing(stage));
}

static void leaves_a_fetcher_that_lies(void **state)
{
	struct stage *stage = *state;
	struct message_want want = want_of(material, 7);
	struct message lie = object_of(brick);

	CHECK(net_client_want(stage->client, &want) == 0);
	CHECK(received(stage).kind == MESSAGE_WANT);
	lie.object.hash = want.hash; /* these are not its bytes */
	tell(stage, lie, -1);
	CHECK(stage->objects == 0);
	accept_client(stage); /* it hung up and came again */
	CHECK(received(stage).kind == MESSAGE_WANT);
	CHECK(send(stage->fetcher.fd, "no message", 10, 0) == 10);
	dispatch(stage);
	accept_client(stage);
	CHECK(received(stage).kind == MESSAGE_WANT);
}

/* The kiosk has hung up, and comes again. */
static void comes_again(struct stage *stage)
{
	dispatch(stage);
	accept_client(stage);
	dispatch(stage);
}

/* A captured fetcher passes what takes long to close, wanted or not. */
static void is_not_held_up_by_a_socket_that_lingers(void **state)
{
	struct stage *stage = *state;
	struct message_want want = want_of(material, 7);
	const struct message objects[] = { object_of(material), object_of(brick) };

	CHECK(net_client_want(stage->client, &want) == 0);
	for (size_t i = 0; i < ARRAY_COUNT(objects); i++) {
		struct message message = objects[i];
		int64_t began_ms;
		struct buffer wire;
		int peer, fd = lingering_socket(&peer);

		message.object.bytes = (struct bytes){ NULL, 0 };
		buffer_init(&wire, MESSAGE_BYTES_MAX);
		message_encode(&wire, &message);
		send_with(stage->fetcher.fd, wire.data, wire.size, &fd, 1);
		buffer_finish(&wire);
		began_ms = clock_now_ms();
		comes_again(stage);
		CHECK(clock_now_ms() - began_ms < LINGER_S * 1000 / 2);
		close(peer);
	}
	tell(stage, object_of(material), -1);
	CHECK(stage->objects == 1);
}

static void leaves_a_fetcher_that_sends_what_nobody_wants(void **state)
{
	struct stage *stage = *state;
	struct message_want want = want_of(material, 7);
	struct message message = object_of(brick);

	CHECK(net_client_want(stage->client, &want) == 0);
	CHECK(received(stage).kind == MESSAGE_WANT);
	/* Never hashed, so nobody sees that it is a lie. */
	message.object.bytes = of(material);
	message.object.size = (uint32_t)of(material).size;
	for (int i = 0; i < 16; i++)
		tell(stage, message, -1);
	tell(stage, object_of(material), -1); /* some may be an error */
	CHECK(stage->objects == 1);
	tell(stage, message, -1);
	comes_again(stage);
	CHECK(net_client_want(stage->client, &want) == 0);
	tell(stage, object_of(material), -1);
	CHECK(stage->objects == 2);
}

/* Each want that was taken back or repeated may have been on its way. */
static void takes_what_was_on_its_way_for_no_crime(void **state)
{
	struct stage *stage = *state;
	struct message_want want = want_of(material, 7);

	for (int i = 0; i < 500; i++) {
		CHECK(net_client_want(stage->client, &want) == 0);
		net_client_drop(stage->client, want.hash);
		CHECK(net_client_want(stage->client, &want) == 0);
		want.priority++;
		CHECK(net_client_want(stage->client, &want) == 0);
		for (int sent = 0; sent < 3; sent++)
			tell(stage, object_of(material), -1);
	}
	CHECK(stage->objects == 500);
	CHECK(received(stage).kind == MESSAGE_WANT); /* on the first connection still */
}

static void keeps_its_queue_to_a_fetcher_that_does_not_read_short(void **state)
{
	struct stage *stage = *state;
	struct message_want want = want_of(material, 7);

	for (int i = 0; i < 2000000; i++) { /* some 300 MB, all in all */
		want.priority++;
		CHECK(net_client_want(stage->client, &want) == 0);
	}
	ring(stage);
	comes_again(stage);
	CHECK(received(stage).want.priority == want.priority);
}

static void does_not_block_on_a_fetcher_that_hangs(void **state)
{
	struct stage *stage = *state;
	uint32_t count = 0;

	for (uint32_t n = 0; n < 20000; n++) {
		struct message_want want = { .size = 1, .priority = n };

		memcpy(want.hash.bytes, &n, sizeof(n));
		want.hash.bytes[15] = 1;
		CHECK(net_client_want(stage->client, &want) == 0);
	}
	while (count < 20000) {
		struct message message;
		int passed, rc = packets_receive(&stage->fetcher, &message, &passed);

		if (rc == -EAGAIN) {
			dispatch(stage);
			continue;
		}
		CHECK(rc == 0);
		count += message.kind == MESSAGE_WANT;
	}
}

/* Ninety seconds without a word: time is moved, not spent. */
static void leaves_a_fetcher_that_says_nothing(void **state)
{
	struct stage *stage = *state;
	struct message_want want = want_of(material, 7);
	struct message status = { .kind = MESSAGE_STATUS, .status.received_bytes = 1 };
	struct message message;
	int passed;

	CHECK(net_client_want(stage->client, &want) == 0);
	later_ms += 60000;
	tell(stage, status, -1); /* a sign of life */
	later_ms += 60000;
	ring(stage);
	CHECK(packets_receive(&stage->fetcher, &message, &passed) != -EPIPE);
	later_ms += 40000;
	ring(stage);
	accept_client(stage);
	CHECK(received(stage).kind == MESSAGE_WANT);
}

static void says_what_is_wrong_with_its_options(void **state)
{
	struct net_client_options options = { .program = "/bin/true" };
	struct net_client *client;

	(void)state;
	CHECK(net_client_create(&client, &options) == -EINVAL && client == NULL);
	net_client_destroy(NULL);
}

/* A program that ends at once, or is not there: tried again with pauses, never a failure. */
static void survives_a_fetcher_that_cannot_start(void **state)
{
	static const char *const programs[] = { "/bin/true", "/nonexistent/fetch" };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(programs); i++) {
		struct net_client_options options = { .program = programs[i],
						      .release_url = "/nowhere",
						      .cache_path = "/nowhere" };
		struct message_want want = want_of(material, 7);
		struct net_client *client;

		CHECK(net_client_create(&client, &options) == 0);
		CHECK(net_client_want(client, &want) == 0);
		for (int n = 0; n < 12; n++) {
			struct pollfd ready = { .fd = net_client_fd(client), .events = POLLIN };

			if (poll(&ready, 1, 100) > 0)
				CHECK(net_client_dispatch(client) == 0);
		}
		net_client_destroy(client);
	}
}

#define STAGED(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		STAGED(delivers_what_is_wanted_once),
		STAGED(passes_on_what_is_missing_and_meta_and_status),
		STAGED(tells_after_every_root_which_one_it_has),
		STAGED(asks_for_what_came_to_be_safe),
		STAGED(drops_and_forgets),
		STAGED(takes_large_objects_sealed),
		STAGED(says_everything_again_after_the_fetcher_died),
		STAGED(begins_anew_with_another_release),
		STAGED(leaves_a_fetcher_that_lies),
		STAGED(leaves_a_fetcher_that_says_nothing),
		STAGED(is_not_held_up_by_a_socket_that_lingers),
		STAGED(leaves_a_fetcher_that_sends_what_nobody_wants),
		STAGED(takes_what_was_on_its_way_for_no_crime),
		STAGED(keeps_its_queue_to_a_fetcher_that_does_not_read_short),
		STAGED(does_not_block_on_a_fetcher_that_hangs),
		cmocka_unit_test(says_what_is_wrong_with_its_options),
		cmocka_unit_test(survives_a_fetcher_that_cannot_start),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
