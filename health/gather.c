/* Collects a snapshot: connects to the metrics sockets of kiosk and fetcher, reads both answers
 * with one deadline, and adds the machine's values. */
#include "health/gather.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/clock.h"

static const char *const prefixes[PROGRAM_COUNT] = { "gopura_kiosk_", "gopura_fetch_" };

void snapshot_init(struct snapshot *snapshot)
{
	memset(snapshot, 0, sizeof(*snapshot));
	for (int i = 0; i < PROGRAM_COUNT; i++)
		buffer_init(&snapshot->answers[i].text, METRICS_BYTES_MAX);
}

void snapshot_finish(struct snapshot *snapshot)
{
	for (int i = 0; i < PROGRAM_COUNT; i++)
		buffer_finish(&snapshot->answers[i].text);
}

/* Connects to a program. Returns a descriptor or a negative errno. If the queue of connections is
 * full, the program counts as hung. */
static int begin(const char *path)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	int fd, rc;

	if (strlen(path) >= sizeof(address.sun_path))
		return -ENAMETOOLONG;
	memcpy(address.sun_path, path, strlen(path) + 1);
	fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (fd < 0)
		return -errno;
	if (connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0)
		return fd;
	rc = errno == EAGAIN ? -ETIMEDOUT : -errno;
	close(fd);
	return rc;
}

/* Reads what has arrived. Returns 1 if more may come, 0 at the end, or a negative errno. */
static int hear(struct buffer *text, int fd)
{
	uint8_t piece[4096];
	ssize_t size;

	while ((size = read(fd, piece, sizeof(piece))) > 0)
		buffer_put(text, piece, (size_t)size);
	if (text->error)
		return -EBADMSG;
	if (size < 0)
		return errno == EAGAIN || errno == EINTR ? 1 : -errno;
	return 0;
}

static void end(struct answer *answer, struct pollfd *waiting, int rc, const char *prefix)
{
	close(waiting->fd);
	waiting->fd = -1;
	if (rc == 0 && !metrics_valid(buffer_bytes(&answer->text), prefix))
		rc = -EBADMSG;
	answer->rc = rc;
	if (rc < 0)
		buffer_clear(&answer->text);
}

static void ask_programs(struct snapshot *snapshot, const struct gather_options *options)
{
	const int64_t until_ms = clock_now_ms() + options->patience_ms;
	struct pollfd waiting[PROGRAM_COUNT];
	int left = 0;

	for (int i = 0; i < PROGRAM_COUNT; i++) {
		const int fd = begin(options->sockets[i]);

		waiting[i] = (struct pollfd){ .fd = fd, .events = POLLIN };
		snapshot->answers[i].rc = fd < 0 ? fd : -ETIMEDOUT;
		buffer_clear(&snapshot->answers[i].text);
		left += fd >= 0;
	}
	while (left > 0) {
		const int64_t wait_ms = until_ms - clock_now_ms();

		if (wait_ms <= 0 || poll(waiting, PROGRAM_COUNT, (int)wait_ms) < 0)
			break;
		for (int i = 0; i < PROGRAM_COUNT; i++) {
			int rc;

			if (waiting[i].fd < 0 || !waiting[i].revents)
				continue;
			rc = hear(&snapshot->answers[i].text, waiting[i].fd);
			if (rc <= 0) {
				end(&snapshot->answers[i], &waiting[i], rc, prefixes[i]);
				left--;
			}
		}
	}
	for (int i = 0; i < PROGRAM_COUNT; i++)
		if (waiting[i].fd >= 0)
			end(&snapshot->answers[i], &waiting[i], -ETIMEDOUT, prefixes[i]);
}

void snapshot_take(struct snapshot *snapshot, const struct gather_options *options)
{
	ask_programs(snapshot, options);
	machine_read(&snapshot->machine, &options->machine);
	snapshot->taken_ms = clock_now_ms();
	snapshot->taken_wall_s = clock_wall_s();
}
