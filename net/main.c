/* gopura-fetch: parses the command line and runs the fetcher. This process uses the network and the
 * cache, but no devices. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/crash.h"
#include "base/log.h"
#include "net/fetch.h"
#include "net/redirect.h"

static const char help[] =
	"gopura-fetch: downloads the objects of a release for the kiosk and caches them\n"
	"\n"
	"usage: gopura-fetch --release URL --cache FILE (--socket PATH | --fd N) [OPTIONS]\n"
	"\n"
	"  --release URL       where the release is: https://..., http://... or a folder\n"
	"  --stick DIR         folder in which a USB stick with a release may be mounted; it is asked\n"
	"                      before the server, and replaces it if there is no --release\n"
	"  --cache FILE        database of the cache; created if missing, replaced if damaged\n"
	"  --socket PATH       listen for the kiosk on this socket\n"
	"  --fd N              serve the kiosk on this connected socket, and exit when it closes\n"
	"  --metrics PATH      socket on which metrics are offered (docs/health.md)\n"
	"  --cache-budget MIB  largest size of the cache on disk (default: 1024; at least 4, at\n"
	"                      most 60 % of the file system)\n"
	"  --ca FILE           certificate authority of the server (default: the system's)\n"
	"  --redirect-hosts A,B\n"
	"                      other hosts that the server may redirect to, as NAME or NAME:PORT\n"
	"                      (default: none)\n"
	"  --poll-s SECONDS    interval of looking for a new release (default: 60)\n"
	"  --rate-limit KIB    mean KiB per second for a release that is not shown yet\n"
	"                      (default: no limit)\n"
	"  --wait-ms MS        what is requested at once takes about so long (default: 500)\n"
	"  --stall-s SECONDS   time without a byte after which a request has failed (default: 15)\n"
	"  --verbose           log debug messages\n"
	"  --help, --version\n"
	"\n"
	"Examples:\n"
	"  gopura-fetch --release https://museum.example/temple --cache /var/lib/gopura/cache.db \\\n"
	"               --socket /run/gopura/fetch\n"
	"  gopura-fetch --stick /run/gopura-stick --cache /tmp/cache.db --socket /tmp/fetch\n";

enum {
	OPTION_RELEASE = 256,
	OPTION_STICK,
	OPTION_CACHE,
	OPTION_SOCKET,
	OPTION_METRICS,
	OPTION_FIGURES,
	OPTION_FD,
	OPTION_CACHE_BUDGET,
	OPTION_CA,
	OPTION_REDIRECT_HOSTS,
	OPTION_POLL,
	OPTION_RATE_LIMIT,
	OPTION_WAIT,
	OPTION_STALL,
	OPTION_VERBOSE,
	OPTION_VERSION,
	OPTION_HELP,
};

static const struct option long_options[] = {
	{ "release", required_argument, NULL, OPTION_RELEASE },
	{ "stick", required_argument, NULL, OPTION_STICK },
	{ "cache", required_argument, NULL, OPTION_CACHE },
	{ "socket", required_argument, NULL, OPTION_SOCKET },
	{ "metrics", required_argument, NULL, OPTION_METRICS },
	{ "figures", required_argument, NULL, OPTION_FIGURES }, /* its name before */
	{ "fd", required_argument, NULL, OPTION_FD },
	{ "cache-budget", required_argument, NULL, OPTION_CACHE_BUDGET },
	{ "ca", required_argument, NULL, OPTION_CA },
	{ "redirect-hosts", required_argument, NULL, OPTION_REDIRECT_HOSTS },
	{ "poll-s", required_argument, NULL, OPTION_POLL },
	{ "rate-limit", required_argument, NULL, OPTION_RATE_LIMIT },
	{ "wait-ms", required_argument, NULL, OPTION_WAIT },
	{ "stall-s", required_argument, NULL, OPTION_STALL },
	{ "verbose", no_argument, NULL, OPTION_VERBOSE },
	{ "version", no_argument, NULL, OPTION_VERSION },
	{ "help", no_argument, NULL, OPTION_HELP },
	{ 0 },
};

/* Parses a whole number in least..most. Prints a message and exits if it is not one. */
static uint64_t number(const char *name, const char *text, uint64_t least, uint64_t most)
{
	char *end;
	unsigned long long value;

	errno = 0;
	value = strtoull(text, &end, 10);
	if (errno || *end || end == text || text[0] == '-' || value < least || value > most) {
		fprintf(stderr, "gopura-fetch: --%s: '%s' is not a number from %llu to %llu\n",
			name, text, (unsigned long long)least, (unsigned long long)most);
		exit(2);
	}
	return value;
}

static void take_option(struct fetch_options *options, int option)
{
	switch (option) {
	case OPTION_RELEASE:
		options->release_url = optarg;
		break;
	case OPTION_STICK:
		options->stick_path = optarg;
		break;
	case OPTION_CACHE:
		options->cache_path = optarg;
		break;
	case OPTION_SOCKET:
		options->socket_path = optarg;
		break;
	case OPTION_METRICS:
		options->metrics_path = optarg;
		break;
	case OPTION_FIGURES:
		fputs("gopura-fetch: --figures is called --metrics now\n", stderr);
		exit(2);
	case OPTION_FD:
		options->fd = (int)number("fd", optarg, 0, 65535);
		break;
	case OPTION_CACHE_BUDGET:
		options->cache_budget_bytes = number("cache-budget", optarg, 4, 1 << 24) << 20;
		break;
	case OPTION_CA:
		options->ca_file = optarg;
		break;
	case OPTION_REDIRECT_HOSTS:
		options->redirect_hosts = optarg;
		break;
	case OPTION_POLL:
		options->poll_s = (uint32_t)number("poll-s", optarg, 1, 86400);
		break;
	case OPTION_RATE_LIMIT:
		options->rate_limit = number("rate-limit", optarg, 1, 1 << 24) << 10;
		break;
	case OPTION_WAIT:
		options->wait_ms = (uint32_t)number("wait-ms", optarg, 50, 60000);
		break;
	case OPTION_STALL:
		options->stall_s = (uint32_t)number("stall-s", optarg, 1, 3600);
		break;
	case OPTION_VERBOSE:
		log_set_level(LOG_LEVEL_DEBUG);
		break;
	case OPTION_VERSION:
		puts("gopura-fetch " GOPURA_VERSION);
		exit(0);
	case OPTION_HELP:
		fputs(help, stdout);
		exit(0);
	default: /* getopt has printed the error */
		fprintf(stderr, "gopura-fetch: see gopura-fetch --help\n");
		exit(2);
	}
}

static void parse(struct fetch_options *options, int argc, char **argv)
{
	const char *wrong = NULL;
	int option;

	while ((option = getopt_long(argc, argv, "", long_options, NULL)) != -1)
		take_option(options, option);
	if (!options->release_url || !*options->release_url)
		options->release_url = options->stick_path;
	if (optind < argc) {
		fprintf(stderr, "gopura-fetch: '%s' is not an option; see gopura-fetch --help\n",
			argv[optind]);
		exit(2);
	}
	if (!options->release_url)
		wrong = "--release is missing";
	else if (!options->cache_path)
		wrong = "--cache is missing";
	else if (!options->socket_path == (options->fd < 0))
		wrong = "give either --socket or --fd";
	else if (!redirect_hosts_valid(options->redirect_hosts))
		wrong = "--redirect-hosts takes 1 to 4 names such as cdn.example or "
			"cdn.example:8443, separated by commas";
	if (!wrong)
		return;
	fprintf(stderr, "gopura-fetch: %s; see gopura-fetch --help\n", wrong);
	exit(2);
}

int main(int argc, char **argv)
{
	struct fetch_options options = { .cache_budget_bytes = 1024ull << 20,
					 .fd = -1,
					 .poll_s = 60 };
	int rc;

	crash_tell("net");
	parse(&options, argc, argv);
	rc = fetch_run(&options);
	if (rc < 0)
		fprintf(stderr, "gopura-fetch: %s\n",
			rc == -EINVAL
				? "--release is neither an https:// or http:// address nor a folder"
				: strerror(-rc));
	return rc < 0 ? 1 : 0;
}
