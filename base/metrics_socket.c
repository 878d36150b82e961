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

enum { WAIT_MOST = 8 /* connections that may wait for an answer */ };

struct figures_socket {
	struct figures_socket_options options;
	struct sockaddr_un address;
	int fd;
	bool bound; /* the name is ours to remove */
	uint64_t starts;
	int64_t started_ms;
	struct buffer text;
};

/* Beside the socket, in a folder that a reboot empties (/run): a program that crashes again and
 * again is seen, and no card wears. */
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
		log_warn("base", "%s: %s: starts are not counted", name, strerror(errno));
		return 1;
	}
	fprintf(file, "%llu\n", starts + 1);
	fclose(file);
	return starts + 1;
}

static int listen_on(struct figures_socket *figures)
{
	const char *path = figures->address.sun_path;

	figures->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (figures->fd < 0)
		return -errno;
	unlink(path); /* of the program before us */
	if (bind(figures->fd, (struct sockaddr *)&figures->address, sizeof(figures->address)) < 0)
		return -errno;
	figures->bound = true;
	if (chmod(path, 0666) < 0 || listen(figures->fd, WAIT_MOST) < 0)
		return -errno;
	return 0;
}

int figures_socket_create(struct figures_socket **out, const struct figures_socket_options *options)
{
	struct figures_socket *figures = calloc(1, sizeof(*figures));
	int rc;

	*out = NULL;
	if (!figures)
		return -ENOMEM;
	figures->options = *options;
	figures->options.path = NULL; /* borrowed */
	figures->fd = -1;
	figures->started_ms = clock_now_ms();
	figures->address.sun_family = AF_UNIX;
	buffer_init(&figures->text, FIGURES_BYTES_MOST);
	if (strlen(options->path) < sizeof(figures->address.sun_path)) {
		memcpy(figures->address.sun_path, options->path, strlen(options->path) + 1);
		rc = listen_on(figures);
	} else {
		rc = -ENAMETOOLONG;
	}
	if (rc < 0) {
		log_error("base", "%s: %s (choose another with --figures)", options->path,
			  strerror(-rc));
		figures_socket_destroy(figures);
		return rc;
	}
	figures->starts = count_start(options->path);
	*out = figures;
	return 0;
}

void figures_socket_destroy(struct figures_socket *figures)
{
	if (!figures)
		return;
	if (figures->fd >= 0)
		close(figures->fd);
	if (figures->bound)
		unlink(figures->address.sun_path);
	buffer_finish(&figures->text);
	free(figures);
}

int figures_socket_fd(const struct figures_socket *figures)
{
	return figures ? figures->fd : -1;
}

/* ---- what every program tells */

/* One number of a file of /proc, behind a word; false: the kernel does not say. */
static bool proc_number(const char *path, const char *scan, unsigned long long *out)
{
	char text[1024];
	FILE *file = fopen(path, "re");
	size_t size = file ? fread(text, 1, sizeof(text) - 1, file) : 0;
	const char *at = text;

	if (file)
		fclose(file);
	text[size] = '\0';
	for (; at && *at; at = strchr(at, '\n'), at += at ? 1 : 0)
		if (sscanf(at, scan, out) == 1)
			return true;
	return false;
}

struct common {
	const char *name, *help;
	bool counts;
	double value;
};

static void put_common(struct figures_socket *figures, const struct common *figure)
{
	char name[FIGURES_NAME_MOST];

	snprintf(name, sizeof(name), "%s_%s", figures->options.prefix, figure->name);
	if (figure->counts)
		figures_counter(&figures->text, name, figure->help, figure->value);
	else
		figures_gauge(&figures->text, name, figure->help, figure->value);
}

static void write_common(struct figures_socket *figures)
{
	const double uptime_s = (double)(clock_now_ms() - figures->started_ms) / 1000;
	unsigned long long pages, bytes;

	put_common(figures, &(struct common){ "uptime_seconds", "Since the program began.", false,
					      uptime_s });
	put_common(figures, &(struct common){ "starts_total",
					      "How often the program began since the machine did.",
					      true, (double)figures->starts });
	if (proc_number("/proc/self/statm", "%*u %llu", &pages))
		put_common(figures, &(struct common){
					    "resident_bytes", "Memory that the program holds.",
					    false, (double)pages * (double)sysconf(_SC_PAGESIZE) });
	if (proc_number("/proc/self/io", "write_bytes: %llu", &bytes))
		put_common(figures, &(struct common){ "written_bytes_total",
						      "What the program had written to disks.",
						      true, (double)bytes });
}

void figures_socket_dispatch(struct figures_socket *figures)
{
	const int fd = accept4(figures->fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);

	if (fd < 0)
		return; /* it went away meanwhile */
	buffer_clear(&figures->text);
	figures->options.write(figures->options.data, &figures->text);
	write_common(figures);
	if (figures->text.error)
		log_warn("base", "kiosk bug: figures of more than %d bytes", FIGURES_BYTES_MOST);
	else if (send(fd, figures->text.data, figures->text.size, MSG_NOSIGNAL) < 0)
		log_debug("base", "figures did not go out: %s", strerror(errno));
	close(fd);
}
