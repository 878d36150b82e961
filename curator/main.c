/* The program gopura-curator, with which a museum's curator marks parts on the model in a web
 * browser: parses the options, opens the content folder and serves until a signal. */
#include <errno.h>
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "curator/server/web_server.h"
#include "curator/session/site.h"

static const char help[] =
	"gopura-curator: mark parts on the model in a web browser (docs/curator.md)\n"
	"\n"
	"usage: gopura-curator DIR [--port N]\n"
	"\n"
	"DIR is a content folder whose hierarchy has been made ('gopura-content hierarchy DIR'; a build\n"
	"makes it too). Marked parts are saved in DIR/parts.json and DIR/regions, and the next build\n"
	"takes them up. Open the address that the program prints. It listens on this machine only\n"
	"(127.0.0.1), and whoever may use the machine may use it: there are no accounts.\n"
	"\n"
	"  --port N            default: 8780; 0: a free one\n"
	"  --help, --version\n"
	"\n"
	"Exit status: 0 ended by a signal, 1 failed (the reason is printed), 2 wrong command line.\n"
	"\n"
	"Example:\n"
	"  gopura-curator temple\n";

enum { OPTION_PORT = 256, OPTION_HELP, OPTION_VERSION, PORT_DEFAULT = 8780 };

struct settings {
	const char *folder; /* borrowed from argv */
	int port;
};

static struct web_server *running; /* for the signals */

static void on_signal(int number)
{
	(void)number;
	web_server_stop(running);
}

static void parse(struct settings *settings, int argc, char **argv)
{
	static const struct option options[] = {
		{ "port", required_argument, NULL, OPTION_PORT },
		{ "help", no_argument, NULL, OPTION_HELP },
		{ "version", no_argument, NULL, OPTION_VERSION },
		{ 0 },
	};
	int option;
	long port;
	char *end;

	while ((option = getopt_long(argc, argv, "", options, NULL)) != -1)
		switch (option) {
		case OPTION_PORT:
			port = strtol(optarg, &end, 10);
			if (!*optarg || *end || port < 0 || port > 65535) {
				fprintf(stderr,
					"gopura-curator: --port must be 0 to 65535, not %s\n",
					optarg);
				exit(2);
			}
			settings->port = (int)port;
			break;
		case OPTION_HELP:
			fputs(help, stdout);
			exit(0);
		case OPTION_VERSION:
			puts("gopura-curator " GOPURA_VERSION);
			exit(0);
		default: /* getopt printed the reason */
			fputs("gopura-curator: see gopura-curator --help\n", stderr);
			exit(2);
		}
	if (optind + 1 != argc) {
		fputs("gopura-curator: name one content folder; see gopura-curator --help\n",
		      stderr);
		exit(2);
	}
	settings->folder = argv[optind];
}

static int run(struct site *site, int port)
{
	const struct sigaction action = { .sa_handler = on_signal };
	int rc = web_server_create(&running, site, port);

	if (rc < 0) {
		fprintf(stderr, "gopura-curator: port %d: %s\n", port, strerror(-rc));
		return rc;
	}
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
	printf("%s: open http://127.0.0.1:%d/ in a browser on this machine; Ctrl-C ends\n",
	       site->content.name, web_server_port(running));
	fflush(stdout);
	web_server_run(running);
	signal(SIGINT, SIG_IGN);
	signal(SIGTERM, SIG_IGN);
	web_server_destroy(running);
	return 0;
}

int main(int argc, char **argv)
{
	static struct site site;
	struct settings settings = { .port = PORT_DEFAULT };
	struct diagnostics diagnostics = { 0 };
	int rc;

	parse(&settings, argc, argv);
	rc = site_open(&site, settings.folder, &diagnostics);
	if (rc < 0)
		fprintf(stderr, "gopura-curator: %s\n", diagnostics_cause(&diagnostics, rc));
	else
		rc = run(&site, settings.port);
	site_close(&site);
	return rc == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
