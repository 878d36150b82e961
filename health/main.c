/* The program gopura-health, which reports over HTTP whether the terminal works, and if not, what
 * to do: parses the options, opens the socket and runs the server. */
#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/crash.h"
#include "base/log.h"
#include "health/server.h"
#include "health/web_page.h"

enum {
	FRESH_MS = 1000,    /* a snapshot answers all requests for so long */
	PROGRAMS_MS = 2000, /* without a GPU, one frame of the kiosk may take as long */
	PATIENCE_MS = 10000,
	IDLE_S = 30,
	LISTEN_BACKLOG = 16,
	FILE_BYTES_PER_S = 256 << 10, /* even a poor wireless network is faster */
};

static const char help[] =
	"gopura-health: serves the terminal's health page over HTTP (docs/health.md)\n"
	"\n"
	"usage: gopura-health [OPTIONS]\n"
	"\n"
	"Pages: / for people, /metrics for Prometheus, /health (status 200 or 503) for scripts, and\n"
	"/visits.csv with the visit counts (docs/visitors.md). systemd passes the listening socket\n"
	"(gopura-health.socket) and starts the program on a request; without systemd, use --listen.\n"
	"\n"
	"  --listen ADDR:PORT  listen on this address and do not exit when idle ([::1]:9100 for IPv6)\n"
	"  --kiosk PATH        metrics socket of gopura-kiosk (default: /run/gopura-kiosk/metrics)\n"
	"  --fetch PATH        metrics socket of gopura-fetch (default: /run/gopura-fetch/metrics)\n"
	"  --faults FILE       faults of gopura.conf, one a line (default: /run/gopura/faults)\n"
	"  --visits FILE       visit counts (default: /run/gopura-kiosk/visits.csv)\n"
	"  --data DIR          folder on the partition whose free space is reported (default: /var/lib)\n"
	"  --idle-s SECONDS    with systemd's socket: exit after this time without a request\n"
	"                      (default: 30)\n"
	"  --help, --version\n"
	"\n"
	"Example:\n"
	"  gopura-health --listen 127.0.0.1:9100\n";

enum {
	OPTION_LISTEN = 256,
	OPTION_KIOSK,
	OPTION_FETCH,
	OPTION_FAULTS,
	OPTION_VISITS,
	OPTION_DATA,
	OPTION_IDLE,
	OPTION_VERSION,
	OPTION_HELP,
};

static const struct option long_options[] = {
	{ "listen", required_argument, NULL, OPTION_LISTEN },
	{ "kiosk", required_argument, NULL, OPTION_KIOSK },
	{ "fetch", required_argument, NULL, OPTION_FETCH },
	{ "faults", required_argument, NULL, OPTION_FAULTS },
	{ "visits", required_argument, NULL, OPTION_VISITS },
	{ "data", required_argument, NULL, OPTION_DATA },
	{ "idle-s", required_argument, NULL, OPTION_IDLE },
	{ "version", no_argument, NULL, OPTION_VERSION },
	{ "help", no_argument, NULL, OPTION_HELP },
	{ 0 },
};

struct health {
	const char *listen; /* NULL: systemd passes the socket */
	unsigned long idle_s;
	const char *visits; /* path of the file that the kiosk writes with --visits */
	struct gather_options gather;
	struct snapshot snapshot;
	struct verdict verdict;
};

/* ---- the command line */

static void bad(const char *option, const char *text, const char *expects)
{
	fprintf(stderr, "gopura-health: --%s: '%s' is not %s; see gopura-health --help\n", option,
		text, expects);
	exit(2);
}

static void take_option(struct health *health, int option)
{
	char *end;

	switch (option) {
	case OPTION_LISTEN:
		health->listen = optarg;
		break;
	case OPTION_KIOSK:
		health->gather.sockets[PROGRAM_KIOSK] = optarg;
		break;
	case OPTION_FETCH:
		health->gather.sockets[PROGRAM_FETCH] = optarg;
		break;
	case OPTION_FAULTS:
		health->gather.machine.faults = optarg;
		break;
	case OPTION_VISITS:
		health->visits = optarg;
		break;
	case OPTION_DATA:
		health->gather.machine.data = optarg;
		break;
	case OPTION_IDLE:
		health->idle_s = strtoul(optarg, &end, 10);
		if (*end || health->idle_s < 1 || health->idle_s > 86400)
			bad("idle-s", optarg, "a number from 1 to 86400");
		break;
	case OPTION_VERSION:
		puts("gopura-health " GOPURA_VERSION);
		exit(0);
	case OPTION_HELP:
		fputs(help, stdout);
		exit(0);
	default: /* getopt printed the reason */
		fputs("gopura-health: see gopura-health --help\n", stderr);
		exit(2);
	}
}

static void parse(struct health *health, int argc, char **argv)
{
	int option;

	while ((option = getopt_long(argc, argv, "", long_options, NULL)) != -1)
		take_option(health, option);
	if (optind == argc)
		return;
	fprintf(stderr, "gopura-health: '%s' is not an option; see gopura-health --help\n",
		argv[optind]);
	exit(2);
}

/* ---- sockets */

static int bind_to(const struct addrinfo *address)
{
	const int yes = 1;
	int rc, fd = socket(address->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);

	if (fd < 0)
		return -errno;
	if (setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes)) == 0 &&
	    bind(fd, address->ai_addr, address->ai_addrlen) == 0 && listen(fd, LISTEN_BACKLOG) == 0)
		return fd;
	rc = -errno;
	close(fd);
	return rc;
}

/* Returns a listening descriptor or a negative errno; ends the program if text is no address. */
static int listen_on(const char *text)
{
	const struct addrinfo wish = { .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE,
				       .ai_socktype = SOCK_STREAM };
	const char *colon = strrchr(text, ':');
	struct addrinfo *found;
	char host[64] = "";
	size_t size = colon ? (size_t)(colon - text) : 0;
	int fd;

	if (size > 2 && text[0] == '[' && text[size - 1] == ']') {
		text++;
		size -= 2;
	}
	if (size == 0 || size >= sizeof(host))
		bad("listen", text, "an address and a port, such as 127.0.0.1:9100");
	memcpy(host, text, size);
	if (getaddrinfo(host, colon + 1, &wish, &found) != 0)
		bad("listen", text, "an address and a port, such as 127.0.0.1:9100");
	fd = bind_to(found);
	freeaddrinfo(found);
	return fd;
}

/* Returns the socket passed by systemd or a negative errno. */
static int passed_socket(void)
{
	const int count = sd_listen_fds(1);

	if (count != 1)
		return count < 0 ? count : -EINVAL;
	return sd_is_socket(SD_LISTEN_FDS_START, AF_UNSPEC, SOCK_STREAM, 1) > 0
		       ? SD_LISTEN_FDS_START
		       : -ENOTSOCK;
}

/* ---- answers */

/* Opens the file of visits as the kiosk wrote it; before its first start there is none. Only a
 * regular file is accepted: the folder is the kiosk's, and a FIFO there could block us. */
static int open_visits(const char *path, uint64_t *bytes)
{
	const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
	struct stat info;

	if (fd < 0)
		return -errno;
	if (fstat(fd, &info) < 0 || !S_ISREG(info.st_mode)) {
		close(fd);
		return -EINVAL;
	}
	*bytes = (uint64_t)info.st_size;
	return fd;
}

static void answer_visits(const struct health *health, struct reply *reply)
{
	const int fd = open_visits(health->visits, &reply->file_bytes);

	if (fd < 0)
		return; /* 404 */
	reply->file = fd;
	reply->status = 200;
	reply->type = "text/csv";
}

/* See server_options.answer. */
static void answer(void *data, const char *path, struct reply *reply)
{
	const enum web_page page = web_page_of_path(path);
	struct health *health = data;

	if (page == WEB_PAGE_NONE)
		return;
	if (page == WEB_PAGE_VISITS) {
		answer_visits(health, reply);
		return;
	}
	if (health->snapshot.taken_ms == 0 ||
	    clock_now_ms() >= health->snapshot.taken_ms + FRESH_MS) {
		snapshot_take(&health->snapshot, &health->gather);
		verdict_judge(&health->verdict, &health->snapshot);
	}
	buffer_init(&reply->body, WEB_PAGE_BYTES_MAX);
	reply->status = web_page_write(&reply->body, &reply->type, page, &health->snapshot,
				       &health->verdict);
}

static int run(struct health *health)
{
	struct server_options server = {
		.listener = health->listen ? listen_on(health->listen) : passed_socket(),
		.patience_ms = PATIENCE_MS,
		.file_bytes_per_s = FILE_BYTES_PER_S,
		.idle_ms = health->listen ? 0 : (int64_t)health->idle_s * 1000,
		.answer = answer,
		.data = health,
	};
	int rc = server.listener;

	if (rc < 0)
		fprintf(stderr, "gopura-health: %s: %s\n",
			health->listen ? health->listen
				       : "systemd passed no socket (use --listen ADDR:PORT)",
			strerror(-rc));
	else
		rc = server_run(&server);
	return rc;
}

int main(int argc, char **argv)
{
	static struct health health = {
		.idle_s = IDLE_S,
		.gather = { .sockets = { "/run/gopura-kiosk/metrics", "/run/gopura-fetch/metrics" },
			    .patience_ms = PROGRAMS_MS,
			    .machine = { .root = "",
					 .faults = "/run/gopura/faults",
					 .data = "/var/lib" } },
		.visits = "/run/gopura-kiosk/visits.csv",
	};
	int rc;

	crash_tell("health");
	parse(&health, argc, argv);
	snapshot_init(&health.snapshot);
	rc = run(&health);
	snapshot_finish(&health.snapshot);
	return rc == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
