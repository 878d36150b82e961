/* A kiosk that was taken over, as the fetcher meets it: the bytes are a sequence of packets, each
 * behind its length, and then the kiosk is gone. The fetcher, whole and with a folder as its
 * server, ends well. */
#include <signal.h>
#include <sys/socket.h>

#include "net/fetch.h"
#include "tests/fuzz/scratch.h"

enum { PACKETS_MAX = 100 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void begin(void)
{
	static const char timestamp[] = "{\"payload\":\"e30=\",\"signatures\":[]}";

	if (scratch[0])
		return;
	scratch_begin();
	if (mkdir(scratch_path("release"), 0700) < 0 || mkdir(scratch_path("stick"), 0700) < 0)
		abort();
	scratch_write("release/timestamp.json", (const uint8_t *)timestamp, sizeof(timestamp) - 1);
}

static void send_packets(int fd, struct bytes all)
{
	struct reader in;

	reader_init(&in, all);
	for (int i = 0; i < PACKETS_MAX && reader_left(&in) > 0; i++) {
		size_t size = reader_u8(&in);
		struct bytes packet;

		size = size < reader_left(&in) ? size : reader_left(&in);
		packet = reader_bytes(&in, size);
		if (size > 0 &&
		    send(fd, packet.data, size, MSG_NOSIGNAL | MSG_DONTWAIT) != (ssize_t)size)
			break;
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	char release[128], stick[128], cache[128];
	struct fetch_options options = { .release_url = release,
					 .stick_path = stick,
					 .cache_path = cache,
					 .cache_budget_bytes = 4 << 20,
					 .poll_s = 60 };
	sigset_t none;
	int pair[2];

	begin();
	snprintf(release, sizeof(release), "%s", scratch_path("release"));
	snprintf(stick, sizeof(stick), "%s", scratch_path("stick"));
	snprintf(cache, sizeof(cache), "%s", scratch_path("cache.db"));
	if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) < 0)
		abort();
	send_packets(pair[1], (struct bytes){ data, size });
	close(pair[1]);
	options.fd = pair[0];
	if (fetch_run(&options) < 0)
		abort();
	sigemptyset(&none); /* the fetcher blocks them; whoever runs the target ends it with them */
	sigprocmask(SIG_SETMASK, &none, NULL);
	return 0;
}
