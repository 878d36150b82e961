/* A line that loses packets, between this machine and a command in a network namespace of its own:
 *
 *   line [--kbit N] [--rtt-ms N] [--loss PERCENT] [--swing SECONDS] [--log FILE] COMMAND [ARGUMENT
 * ...]
 *
 * COMMAND sees this machine as 10.77.0.1, and nothing else. Each way carries N kilobits a second
 * (0: all that comes), takes half of the round trip and drops so many packets by chance, the same
 * ones in each run; with --swing every second period of so many seconds carries half. A packet for
 * which there is no room at the router, who keeps 50 ms and at least 16 of them, is dropped too. So
 * TCP does what it does on such a line; a proxy (shape.py) needs no rights but loses nothing.
 *
 * --log: monotonic seconds, bytes down and up so far with their headers, a line a tenth of a second
 * while anything comes. Ends with the status of COMMAND, which gets SIGINT and SIGTERM; 77 without
 * the right to make namespaces and tunnels. */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"

enum {
	PACKET_BYTES = 2048, /* an interface has 1500 */
	QUEUE_PACKETS = 4096,
	ROUTER_US = 50000,
	ROUTER_PACKETS = 16,
	WHOLE_PACKET_BYTES = 1500,
	LOG_EVERY_US = 100000,
	SKIPPED = 77,
};

struct packet {
	int64_t due_us;
	size_t size;
	uint8_t data[PACKET_BYTES];
};

/* One way. */
struct way {
	struct packet *queue; /* a ring, in the order of due_us */
	uint32_t first, count;
	int64_t free_at_us; /* when the last packet has gone out */
	uint64_t bytes;     /* delivered */
};

struct line {
	int64_t bits_a_second, one_way_us, swing_us, began_us;
	double loss;
	uint64_t random;
	struct way down, up; /* towards the command, and from it */
	FILE *log;
	int64_t logged_us;
	uint64_t logged_bytes;
};

static pid_t child;
static volatile sig_atomic_t asked_to_end;

static void fail(const char *what)
{
	const int rc = errno;

	fprintf(stderr, "line: %s: %s\n", what, strerror(rc));
	exit(rc == EPERM || rc == EACCES || rc == ENOENT ? SKIPPED : 1);
}

/* ---- the tunnel's two ends */

static void raise_link(int socket_fd, struct ifreq *request)
{
	if (ioctl(socket_fd, SIOCGIFFLAGS, request) < 0)
		fail("cannot read an interface's state");
	request->ifr_flags |= IFF_UP;
	if (ioctl(socket_fd, SIOCSIFFLAGS, request) < 0)
		fail("cannot bring an interface up");
}

static void give_address(int socket_fd, struct ifreq *request, unsigned long what,
			 const char *address)
{
	struct sockaddr_in *in = (struct sockaddr_in *)&request->ifr_addr;

	memset(in, 0, sizeof(*in));
	in->sin_family = AF_INET;
	if (inet_pton(AF_INET, address, &in->sin_addr) != 1 || ioctl(socket_fd, what, request) < 0)
		fail("cannot give the tunnel an address");
}

/* Returns the tunnel's descriptor, of the namespace that the caller is in. */
static int open_tunnel(const char *address, const char *peer)
{
	struct ifreq request = { .ifr_flags = IFF_TUN | IFF_NO_PI };
	const int tunnel = open("/dev/net/tun", O_RDWR | O_CLOEXEC | O_NONBLOCK);
	const int socket_fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);

	if (tunnel < 0 || socket_fd < 0)
		fail("cannot open /dev/net/tun");
	snprintf(request.ifr_name, sizeof(request.ifr_name), "gopura-line");
	if (ioctl(tunnel, TUNSETIFF, &request) < 0)
		fail("cannot make the tunnel gopura-line (is another line running?)");
	give_address(socket_fd, &request, SIOCSIFADDR, address);
	give_address(socket_fd, &request, SIOCSIFDSTADDR, peer);
	raise_link(socket_fd, &request);
	close(socket_fd);
	return tunnel;
}

static void raise_loopback(void)
{
	struct ifreq request = { .ifr_name = "lo" };
	const int socket_fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);

	if (socket_fd < 0)
		fail("cannot open a socket");
	raise_link(socket_fd, &request);
	close(socket_fd);
}

union control {
	struct cmsghdr header;
	char room[CMSG_SPACE(sizeof(int))];
};

static void send_descriptor(int over, int descriptor)
{
	char byte = 0;
	union control control = { 0 };
	struct iovec text = { &byte, 1 };
	struct msghdr message = { .msg_iov = &text,
				  .msg_iovlen = 1,
				  .msg_control = &control,
				  .msg_controllen = sizeof(control) };
	struct cmsghdr *header = CMSG_FIRSTHDR(&message);

	header->cmsg_level = SOL_SOCKET;
	header->cmsg_type = SCM_RIGHTS;
	header->cmsg_len = CMSG_LEN(sizeof(int));
	memcpy(CMSG_DATA(header), &descriptor, sizeof(descriptor));
	if (sendmsg(over, &message, 0) != 1)
		fail("cannot pass the tunnel on");
}

/* Returns the descriptor; ends with the child's status if the child gave up. */
static int take_descriptor(int over)
{
	int descriptor, status = 0;
	char byte;
	union control control = { 0 };
	struct iovec text = { &byte, 1 };
	struct msghdr message = { .msg_iov = &text,
				  .msg_iovlen = 1,
				  .msg_control = &control,
				  .msg_controllen = sizeof(control) };
	const struct cmsghdr *header;

	if (recvmsg(over, &message, MSG_CMSG_CLOEXEC) != 1 || !(header = CMSG_FIRSTHDR(&message))) {
		waitpid(child, &status, 0);
		exit(WIFEXITED(status) ? WEXITSTATUS(status) : 1);
	}
	memcpy(&descriptor, CMSG_DATA(header), sizeof(descriptor));
	return descriptor;
}

static void run_command(int over, char **command)
{
	char byte;
	int tunnel;

	if (unshare(CLONE_NEWNET) < 0)
		fail("cannot make a network namespace");
	raise_loopback();
	tunnel = open_tunnel("10.77.0.2", "10.77.0.1");
	send_descriptor(over, tunnel);
	/* The other side closes its end once packets are carried. */
	while (read(over, &byte, 1) < 0 && errno == EINTR)
		;
	execvp(command[0], command);
	fail(command[0]);
}

/* ---- carrying */

static double random_share(struct line *line)
{
	line->random = line->random * 6364136223846793005u + 1442695040888963407u;
	return (double)(line->random >> 33) / (double)(1u << 31);
}

static int64_t bits_now(const struct line *line, int64_t now_us)
{
	const bool half = line->swing_us && (now_us - line->began_us) / line->swing_us % 2;

	return half ? line->bits_a_second / 2 : line->bits_a_second;
}

static int64_t sending_us(int64_t bits_a_second, size_t bytes)
{
	return bits_a_second ? (int64_t)bytes * 8 * 1000000 / bits_a_second : 0;
}

static void take_packet(struct line *line, struct way *way, const uint8_t *data, size_t size)
{
	const int64_t now_us = clock_now_us(), bits = bits_now(line, now_us);
	const int64_t queued_us = sending_us(bits, ROUTER_PACKETS * WHOLE_PACKET_BYTES);
	const int64_t room_us = queued_us > ROUTER_US ? queued_us : ROUTER_US;
	const bool lost = random_share(line) < line->loss;
	struct packet *packet;

	if (way->free_at_us < now_us)
		way->free_at_us = now_us;
	if (way->free_at_us - now_us > room_us || way->count == QUEUE_PACKETS)
		return;
	way->free_at_us += sending_us(bits, size);
	if (lost)
		return;
	packet = &way->queue[(way->first + way->count++) % QUEUE_PACKETS];
	packet->due_us = way->free_at_us + line->one_way_us;
	packet->size = size;
	memcpy(packet->data, data, size);
}

static void take_packets(struct line *line, struct way *way, int from)
{
	uint8_t data[PACKET_BYTES];
	ssize_t size;

	while ((size = read(from, data, sizeof(data))) > 0)
		if (data[0] >> 4 == 4) /* nobody is asked for IPv6 routers */
			take_packet(line, way, data, (size_t)size);
}

/* Returns when the next packet is due; INT64_MAX: none is. */
static int64_t deliver(struct way *way, int to)
{
	while (way->count && way->queue[way->first].due_us <= clock_now_us()) {
		const struct packet *packet = &way->queue[way->first];

		/* A full interface drops it, like any other. */
		if (write(to, packet->data, packet->size) > 0)
			way->bytes += packet->size;
		way->first = (way->first + 1) % QUEUE_PACKETS;
		way->count--;
	}
	return way->count ? way->queue[way->first].due_us : INT64_MAX;
}

static void write_log(struct line *line)
{
	const int64_t now_us = clock_now_us();
	const uint64_t bytes = line->down.bytes + line->up.bytes;

	if (!line->log || now_us - line->logged_us < LOG_EVERY_US || bytes == line->logged_bytes)
		return;
	fprintf(line->log, "%.3f %llu %llu\n", (double)now_us / 1e6,
		(unsigned long long)line->down.bytes, (unsigned long long)line->up.bytes);
	fflush(line->log);
	line->logged_us = now_us;
	line->logged_bytes = bytes;
}

static int carry(struct line *line, int here, int there)
{
	struct pollfd wait[2] = { { .fd = here, .events = POLLIN },
				  { .fd = there, .events = POLLIN } };
	int status;
	bool passed_on = false;

	while (waitpid(child, &status, WNOHANG) == 0) {
		const int64_t down_us = deliver(&line->down, there);
		const int64_t up_us = deliver(&line->up, here);
		int64_t left_us = (down_us < up_us ? down_us : up_us) - clock_now_us();
		struct timespec timeout;

		if (asked_to_end && !passed_on)
			kill(child, asked_to_end);
		passed_on = asked_to_end;
		left_us = left_us < 0 ? 0 : left_us > LOG_EVERY_US ? LOG_EVERY_US : left_us;
		timeout = (struct timespec){ 0, left_us * 1000 };
		if (ppoll(wait, 2, &timeout, NULL) > 0) {
			take_packets(line, &line->down, here);
			take_packets(line, &line->up, there);
		}
		write_log(line);
	}
	return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* ---- command line */

static void on_signal(int number)
{
	asked_to_end = number;
}

static double number_of(const char *name, const char *text, double most)
{
	char *end;
	const double value = strtod(text, &end);

	if (end == text || *end || !(value >= 0 && value <= most)) {
		fprintf(stderr, "line: --%s must be a number up to %.0f, not %s\n", name, most,
			text);
		exit(2);
	}
	return value;
}

static void read_options(struct line *line, int argc, char **argv)
{
	static const struct option options[] = {
		{ "kbit", required_argument, NULL, 'k' },
		{ "rtt-ms", required_argument, NULL, 'r' },
		{ "loss", required_argument, NULL, 'l' },
		{ "swing", required_argument, NULL, 's' },
		{ "log", required_argument, NULL, 'o' },
		{ NULL, 0, NULL, 0 },
	};
	int at, chosen;

	while ((chosen = getopt_long(argc, argv, "+", options, &at)) >= 0) {
		const char *name = chosen == '?' ? "" : options[at].name;

		if (chosen == 'k')
			line->bits_a_second = (int64_t)(number_of(name, optarg, 1e7) * 1000);
		else if (chosen == 'r')
			line->one_way_us = (int64_t)(number_of(name, optarg, 10000) * 500);
		else if (chosen == 'l')
			line->loss = number_of(name, optarg, 100) / 100;
		else if (chosen == 's')
			line->swing_us = (int64_t)(number_of(name, optarg, 3600) * 1e6);
		else if (chosen == 'o' && (line->log = fopen(optarg, "we")))
			continue;
		else if (chosen == 'o')
			fail(optarg);
		else
			exit(2);
	}
	if (optind == argc) {
		fprintf(stderr, "line: which command shall run at the end of the line?\n");
		exit(2);
	}
}

int main(int argc, char **argv)
{
	static struct line line = { .random = 1 };
	const struct sigaction action = { .sa_handler = on_signal };
	int ends[2], here, there, status;

	read_options(&line, argc, argv);
	line.down.queue = calloc(QUEUE_PACKETS, sizeof(struct packet));
	line.up.queue = calloc(QUEUE_PACKETS, sizeof(struct packet));
	if (!line.down.queue || !line.up.queue ||
	    socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) < 0)
		fail("cannot begin");
	here = open_tunnel("10.77.0.1", "10.77.0.2");
	child = fork();
	if (child < 0)
		fail("cannot fork");
	if (child == 0) {
		close(ends[0]);
		run_command(ends[1], argv + optind);
	}
	close(ends[1]);
	there = take_descriptor(ends[0]);
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
	line.began_us = clock_now_us();
	close(ends[0]);
	status = carry(&line, here, there);
	write_log(&line);
	free(line.down.queue);
	free(line.up.queue);
	return status;
}
