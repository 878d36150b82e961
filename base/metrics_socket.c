/* Listens on a Unix socket, and answers each connection with the program's metrics and those that
 * all programs have in common. */
#include "base/metrics_socket.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/proc_number.h"

enum { WAIT_MAX = 8 /* most connections that may wait for an answer */ };

struct metrics_socket {
	struct metrics_socket_options options;
	struct sockaddr_un address;
	int fd;
	bool bound; /* the socket file is ours, to be removed at the end */
	uint64_t starts;
	int64_t started_ms;
	struct buffer text;
};

/* Counts this start in PATH.starts and returns the number of starts. The file is in a folder that a
 * reboot empties (/run): repeated crashes are seen, and no flash memory wears. */
static uint64_t count_start(const char *path)
{
	char name[sizeof(((struct sockaddr_un *)0)->sun_path) + 8];
	unsigned long long starts = 0;
	FILE *file;

	snprintf(name, sizeof(name), "%s.starts", path);
	file = fopen(name, "re");
	if (file && fscanf(file, "%llu", &starts) != 1)
		starts = 0;
	if (file)
		fclose(file);
	file = fopen(name, "we");
	if (!file) {
		log_warn("base", "%s: %s; the starts are not counted", name, strerror(errno));
		return 1;
	}
	fprintf(file, "%llu\n", starts + 1);
	fclose(file);
	return starts + 1;
}

static int listen_on(struct metrics_socket *metrics)
{
	const char *path = metrics->address.sun_path;

	metrics->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (metrics->fd < 0)
		return -errno;
	unlink(path); /* left by an earlier process */
	if (bind(metrics->fd, (struct sockaddr *)&metrics->address, sizeof(metrics->address)) < 0)
		return -errno;
	metrics->bound = true;
	if (chmod(path, 0666) < 0 || listen(metrics->fd, WAIT_MAX) < 0)
		return -errno;
	return 0;
}

int metrics_socket_create(struct metrics_socket **out, const struct metrics_socket_options *options)
{
	struct metrics_socket *metrics = calloc(1, sizeof(*metrics));
	int rc;

	*out = NULL;
	if (!metrics)
		return -ENOMEM;
	metrics->options = *options;
	metrics->options.path = NULL; /* borrowed */
	metrics->fd = -1;
	metrics->started_ms = clock_now_ms();
	metrics->address.sun_family = AF_UNIX;
	buffer_init(&metrics->text, METRICS_BYTES_MAX);
	if (strlen(options->path) < sizeof(metrics->address.sun_path)) {
		memcpy(metrics->address.sun_path, options->path, strlen(options->path) + 1);
		rc = listen_on(metrics);
	} else {
		rc = -ENAMETOOLONG;
	}
	if (rc < 0) {
		log_error("base", "%s: %s (choose another with --metrics)", options->path,
			  strerror(-rc));
		metrics_socket_destroy(metrics);
		return rc;
	}
	metrics->starts = count_start(options->path);
	*out = metrics;
	return 0;
}

void metrics_socket_destroy(struct metrics_socket *metrics)
{
	if (!metrics)
		return;
	if (metrics->fd >= 0)
		close(metrics->fd);
	if (metrics->bound)
		unlink(metrics->address.sun_path);
	buffer_finish(&metrics->text);
	free(metrics);
}

int metrics_socket_fd(const struct metrics_socket *metrics)
{
	return metrics ? metrics->fd : -1;
}

/* ---- metrics that all programs have */

struct common {
	const char *name, *help;
	bool counts;
	double value;
};

static void put_common(struct metrics_socket *metrics, const struct common *figure)
{
	char name[METRICS_NAME_MAX];

	snprintf(name, sizeof(name), "%s_%s", metrics->options.prefix, figure->name);
	if (figure->counts)
		metrics_counter(&metrics->text, name, figure->help, figure->value);
	else
		metrics_gauge(&metrics->text, name, figure->help, figure->value);
}

static void write_common(struct metrics_socket *metrics)
{
	const double uptime_s = (double)(clock_now_ms() - metrics->started_ms) / 1000;
	unsigned long long pages, bytes;

	put_common(metrics, &(struct common){ "uptime_seconds", "Since the program began.", false,
					      uptime_s });
	put_common(metrics, &(struct common){ "starts_total",
					      "How often the program began since the machine did.",
					      true, (double)metrics->starts });
	if (proc_number("/proc/self/statm", "%*u %llu", &pages))
		put_common(metrics, &(struct common){
					    "resident_bytes", "Memory that the program holds.",
					    false, (double)pages * (double)sysconf(_SC_PAGESIZE) });
	if (proc_number("/proc/self/io", "write_bytes: %llu", &bytes))
		put_common(metrics, &(struct common){ "written_bytes_total",
						      "What the program had written to disks.",
						      true, (double)bytes });
}

void metrics_socket_dispatch(struct metrics_socket *metrics)
{
	const int fd = accept4(metrics->fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);

	if (fd < 0)
		return; /* the client has closed the connection meanwhile */
	buffer_clear(&metrics->text);
	metrics->options.write(metrics->options.data, &metrics->text);
	write_common(metrics);
	if (metrics->text.error)
		log_warn("base", "kiosk bug: the metrics have more than %d bytes",
			 METRICS_BYTES_MAX);
	else if (send(fd, metrics->text.data, metrics->text.size, MSG_NOSIGNAL) < 0)
		log_debug("base", "the metrics could not be sent: %s", strerror(errno));
	close(fd);
}
