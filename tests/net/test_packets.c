#include "net/packets.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "tests/check.h"
#include "tests/net/lingering.h"

struct ends {
	struct packets near, far;
};

static void open_ends(struct ends *ends)
{
	int pair[2];

	CHECK(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) == 0);
	packets_init(&ends->near, pair[0]);
	packets_init(&ends->far, pair[1]);
}

static void close_ends(struct ends *ends)
{
	packets_finish(&ends->near);
	packets_finish(&ends->far);
}

static const struct hash name = { { 1, 2, 3 } };

static struct message drop(uint8_t n)
{
	return (struct message){ .kind = MESSAGE_DROP, .drop = { { n, 1 } } };
}

static void delivers_in_order_however_much_waits(void **state)
{
	struct message message, back;
	struct ends ends;
	int passed, received = 0;

	(void)state;
	open_ends(&ends);
	for (int i = 0; i < 5000; i++) {
		message = drop((uint8_t)i);
		CHECK(packets_send(&ends.near, &message, -1) == 0);
	}
	CHECK(packets_wait(&ends.near)); /* more than a socket holds */
	while (received < 5000) {
		int rc = packets_receive(&ends.far, &back, &passed);

		if (rc == -EAGAIN) {
			CHECK(packets_flush(&ends.near) == 0);
			continue;
		}
		CHECK(rc == 0 && passed == -1);
		CHECK(back.kind == MESSAGE_DROP && back.drop.bytes[0] == (uint8_t)received);
		received++;
	}
	CHECK(!packets_wait(&ends.near) && ends.near.queued_bytes == 0);
	close_ends(&ends);
}

static void passes_a_sealed_object(void **state)
{
	struct message message = { .kind = MESSAGE_OBJECT,
				   .object = { name, { NULL, 0 }, 300000 } };
	uint8_t *large = malloc(300000);
	struct message back;
	struct bytes mapped;
	struct ends ends;
	int passed;

	(void)state;
	memset(large, 42, 300000);
	open_ends(&ends);
	CHECK(packets_send(&ends.near, &message, packets_seal((struct bytes){ large, 300000 })) ==
	      0);
	CHECK(packets_receive(&ends.far, &back, &passed) == 0);
	CHECK(passed >= 0 && back.object.size == 300000);
	CHECK(packets_map_sealed(&mapped, passed, 299999) == -EBADMSG);
	CHECK(packets_map_sealed(&mapped, passed, 300000) == 0);
	CHECK(memcmp(mapped.data, large, 300000) == 0);
	CHECK(write(passed, "x", 1) < 0); /* nobody can change it any more */
	munmap((void *)mapped.data, mapped.size);
	close(passed);
	close_ends(&ends);
	free(large);
}

static void maps_nothing_that_is_not_sealed(void **state)
{
	struct bytes mapped;
	int fd = memfd_create("open", MFD_ALLOW_SEALING | MFD_CLOEXEC);
	int pipes[2];

	(void)state;
	CHECK(write(fd, "hello", 5) == 5);
	CHECK(packets_map_sealed(&mapped, fd, 5) == -EBADMSG);
	CHECK(fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK) == 0);
	CHECK(packets_map_sealed(&mapped, fd, 5) == -EBADMSG);
	close(fd);
	CHECK(pipe(pipes) == 0);
	CHECK(packets_map_sealed(&mapped, pipes[0], 5) == -EBADMSG);
	close(pipes[0]);
	close(pipes[1]);
}

/* The packet with these descriptors is refused, and stays so. */
static void refused(const struct message *message, const int *fds, size_t count)
{
	struct message back;
	struct buffer wire;
	struct ends ends;
	int passed;

	open_ends(&ends);
	buffer_init(&wire, MESSAGE_BYTES_MAX);
	message_encode(&wire, message);
	send_with(ends.near.fd, wire.data, wire.size, fds, count);
	buffer_finish(&wire);
	for (int i = 0; i < 3; i++)
		CHECK(packets_receive(&ends.far, &back, &passed) == -EBADMSG && passed == -1);
	close_ends(&ends);
}

static int sealed(void)
{
	return packets_seal((struct bytes){ (const uint8_t *)"123456789", 9 });
}

static void refuses_descriptors_that_are_no_sealed_memory(void **state)
{
	const struct message object = { .kind = MESSAGE_OBJECT,
					.object = { name, { NULL, 0 }, 9 } };
	char path[] = "/tmp/gopura-packets-XXXXXX";
	int pipes[2], fds[6];

	(void)state;
	CHECK(pipe(pipes) == 0);
	fds[0] = pipes[0];
	fds[1] = pipes[1];
	fds[2] = memfd_create("open", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	fds[3] = mkstemp(path); /* a file, on tmpfs perhaps, where it has seals of a kind */
	fds[4] = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	fds[5] = open("/dev/null", O_RDONLY | O_CLOEXEC);
	unlink(path);
	CHECK(fcntl(fds[2], F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW) == 0);
	for (size_t i = 0; i < ARRAY_COUNT(fds); i++)
		refused(&object, &fds[i], 1);
}

static void refuses_descriptors_that_do_not_belong(void **state)
{
	const struct message object = { .kind = MESSAGE_OBJECT,
					.object = { name, { NULL, 0 }, 9 } };
	struct message message = drop(1), back;
	struct ends ends;
	int passed, fds[253];

	(void)state;
	fds[0] = sealed();
	refused(&message, fds, 1);
	fds[0] = sealed();
	fds[1] = sealed();
	refused(&object, fds, 2); /* one too many */
	for (size_t i = 0; i < ARRAY_COUNT(fds); i++)
		fds[i] = sealed();
	refused(&object, fds, ARRAY_COUNT(fds));
	open_ends(&ends);
	CHECK(packets_send(&ends.near, &object, -1) == 0);
	CHECK(packets_receive(&ends.far, &back, &passed) == -EBADMSG); /* none came along */
	close_ends(&ends);
	open_ends(&ends);
	CHECK(send(ends.near.fd, "\xff rubbish", 9, 0) == 9);
	CHECK(packets_receive(&ends.far, &back, &passed) == -EBADMSG);
	close_ends(&ends);
}

/* One, two, and more than any message has. */
static void never_waits_for_the_close_of_what_was_passed(void **state)
{
	static const size_t counts[] = { 1, 2, 20 };
	const struct message object = { .kind = MESSAGE_OBJECT,
					.object = { name, { NULL, 0 }, 9 } };
	const int64_t began_ms = clock_now_ms();
	struct message back;
	struct buffer wire;
	struct ends ends;
	int passed, fds[20], peers[21];

	(void)state;
	buffer_init(&wire, MESSAGE_BYTES_MAX);
	message_encode(&wire, &object);
	for (size_t i = 0; i < ARRAY_COUNT(counts); i++) {
		for (size_t k = 0; k < counts[i]; k++)
			fds[k] = lingering_socket(&peers[k]);
		open_ends(&ends);
		send_with(ends.near.fd, wire.data, wire.size, fds, counts[i]);
		fds[0] = lingering_socket(&peers[counts[i]]); /* in a packet that nobody reads */
		send_with(ends.near.fd, wire.data, wire.size, fds, 1);
		packets_finish(&ends.near);
		CHECK(packets_receive(&ends.far, &back, &passed) == -EBADMSG);
		packets_finish(&ends.far);
		CHECK(clock_now_ms() - began_ms < LINGER_S * 1000 / 2);
		for (size_t k = 0; k <= counts[i]; k++)
			close(peers[k]);
	}
	buffer_finish(&wire);
}

static void refuses_a_packet_past_the_ceiling(void **state)
{
	uint8_t *large = calloc(1, MESSAGE_BYTES_MAX + 500);
	struct message back;
	struct ends ends;
	int passed;

	(void)state;
	open_ends(&ends);
	large[0] = MESSAGE_META;
	CHECK(send(ends.near.fd, large, MESSAGE_BYTES_MAX + 500, 0) == MESSAGE_BYTES_MAX + 500);
	CHECK(packets_receive(&ends.far, &back, &passed) == -EBADMSG);
	close_ends(&ends);
	free(large);
}

static void tells_that_the_other_end_closed(void **state)
{
	struct message message = drop(1), back;
	struct ends ends;
	int passed;

	(void)state;
	open_ends(&ends);
	CHECK(packets_receive(&ends.far, &back, &passed) == -EAGAIN);
	packets_finish(&ends.near);
	CHECK(packets_receive(&ends.far, &back, &passed) == -EPIPE);
	CHECK(packets_send(&ends.far, &message, -1) == -EPIPE);
	CHECK(packets_send(&ends.near, &message, -1) == -EPIPE);
	close_ends(&ends); /* twice is fine */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(delivers_in_order_however_much_waits),
		cmocka_unit_test(passes_a_sealed_object),
		cmocka_unit_test(maps_nothing_that_is_not_sealed),
		cmocka_unit_test(refuses_descriptors_that_are_no_sealed_memory),
		cmocka_unit_test(never_waits_for_the_close_of_what_was_passed),
		cmocka_unit_test(refuses_descriptors_that_do_not_belong),
		cmocka_unit_test(refuses_a_packet_past_the_ceiling),
		cmocka_unit_test(tells_that_the_other_end_closed),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
