/* The program gopura-curator, with which a museum's curator marks parts on the model in a web
 * browser: parses the options, opens the content folder and serves until a signal. */
#include <errno.h>
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/crash.h"
#include "base/log.h"
#include "curator/accounts/gate.h"
#include "curator/publisher_command.h"
#include "curator/server/web_server.h"
#include "curator/session/site.h"
#include "curator/user_command.h"
#include "ui/translate.h"

static const char help[] =
	"gopura-curator: mark parts on the model in a web browser (docs/curator.md)\n"
	"\n"
	"usage: gopura-curator DIR [OPTIONS]\n"
	"       gopura-curator user add|password|role|remove|list DIR [NAME] [OPTIONS]\n"
	"       gopura-curator publisher DIR --out RELEASE [OPTIONS]\n"
	"\n"
	"DIR is a content folder whose hierarchy has been made ('gopura-content hierarchy DIR'; a build\n"
	"makes it too). Marked parts are saved in DIR/parts.json and DIR/regions, and the next build\n"
	"takes them up. Open the address that the program prints, and sign in with an account that\n"
	"'gopura-curator user add DIR NAME' has made.\n"
	"\n"
	"  --port N            default: 8780; 0: a free one\n"
	"  --listen ADDRESS    default: 127.0.0.1, this machine alone; or unix:PATH, for a proxy. Put\n"
	"                      nginx with TLS in front before others reach it\n"
	"  --host NAME         the name under which a proxy serves it; up to four times\n"
	"  --release RELEASE   the release folder, which is only read: the page then shows what would\n"
	"                      change, and 'gopura-curator publisher' publishes\n"
	"  --sign-on HEADER    the museum's own sign-on: a proxy on this machine names in this header\n"
	"                      who has signed on; roles are those of the accounts\n"
	"  --help, --version\n"
	"\n"
	"Exit status: 0 ended by a signal, 1 failed (the reason is printed), 2 wrong command line.\n"
	"\n"
	"Examples:\n"
	"  gopura-curator user add temple ana --role publisher\n"
	"  gopura-curator temple\n"
	"  gopura-curator temple --listen unix:/run/gopura-curator/socket --host curator.museum.example\n";

enum {
	OPTION_PORT = 256,
	OPTION_LISTEN,
	OPTION_HOST,
	OPTION_RELEASE,
	OPTION_SIGN_ON,
	OPTION_HELP,
	OPTION_VERSION,
	PORT_DEFAULT = 8780
};

struct settings {
	const char *folder; /* borrowed from argv, as all below */
	struct web_server_options server;
};

static struct web_server *running; /* for the signals */

static void on_signal(int number)
{
	(void)number;
	web_server_stop(running);
}

static void wrong(const char *what, const char *value)
{
	fprintf(stderr, "gopura-curator: %s%s\n", what, value);
	exit(2);
}

static int parse_port(const char *text)
{
	char *end;
	const long port = strtol(text, &end, 10);

	if (!*text || *end || port < 0 || port > 65535)
		wrong("--port must be 0 to 65535, not ", text);
	return (int)port;
}

static void add_host(struct web_server_options *server, const char *name)
{
	if (server->host_count == WEB_SERVER_HOSTS_MAX)
		wrong("--host may be given four times", "");
	server->hosts[server->host_count++] = name;
}

/* Believing a header of anybody else than a proxy on this machine would let anybody in. */
static void check(const struct settings *settings)
{
	const struct web_server_options *server = &settings->server;

	if (server->sign_on && strncmp(server->listen, "127.", 4) != 0 &&
	    strncmp(server->listen, "unix:", 5) != 0)
		wrong("--sign-on needs a proxy on this machine, so --listen must be 127.0.0.1 or "
		      "unix:PATH, not ",
		      server->listen);
	if (strncmp(server->listen, "unix:", 5) == 0 && server->host_count == 0)
		wrong("--listen unix:PATH needs the --host under which a proxy serves it", "");
}

static void parse(struct settings *settings, int argc, char **argv)
{
	static const struct option options[] = {
		{ "port", required_argument, NULL, OPTION_PORT },
		{ "listen", required_argument, NULL, OPTION_LISTEN },
		{ "host", required_argument, NULL, OPTION_HOST },
		{ "release", required_argument, NULL, OPTION_RELEASE },
		{ "sign-on", required_argument, NULL, OPTION_SIGN_ON },
		{ "help", no_argument, NULL, OPTION_HELP },
		{ "version", no_argument, NULL, OPTION_VERSION },
		{ 0 },
	};
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) != -1)
		switch (option) {
		case OPTION_PORT:
			settings->server.port = parse_port(optarg);
			break;
		case OPTION_LISTEN:
			settings->server.listen = optarg;
			break;
		case OPTION_HOST:
			add_host(&settings->server, optarg);
			break;
		case OPTION_RELEASE:
			settings->server.release = optarg;
			break;
		case OPTION_SIGN_ON:
			settings->server.sign_on = optarg;
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
	if (optind + 1 != argc)
		wrong("name one content folder; see gopura-curator --help", "");
	settings->folder = argv[optind];
	check(settings);
}

static void print_address(const struct site *site, const struct web_server_options *options)
{
	const char *name = site->content.name;

	if (options->host_count > 0)
		printf("%s: a proxy serves it as %s; listens at %s", name, options->hosts[0],
		       options->listen);
	else
		printf("%s: open http://%s:%d/ in a browser%s", name, options->listen,
		       web_server_port(running),
		       strncmp(options->listen, "127.", 4) == 0 ? " on this machine" : "");
	if (options->host_count > 0 && web_server_port(running) > 0)
		printf(":%d", web_server_port(running));
	puts("; Ctrl-C ends");
	if (fflush(stdout) == EOF) /* nobody would know the port */
		fprintf(stderr, "gopura-curator: the address could not be printed: %s; port %d\n",
			strerror(errno), web_server_port(running));
}

/* Plain HTTP on a network shows passwords and cookies to whoever listens there. */
static void warn_of_network(const struct web_server_options *options)
{
	if (strncmp(options->listen, "127.", 4) != 0 && strncmp(options->listen, "unix:", 5) != 0)
		fprintf(stderr,
			"gopura-curator: %s speaks plain HTTP, also of passwords: put nginx with "
			"TLS in front of it (docs/curator.md)\n",
			options->listen);
}

static int serve(const struct web_server_options *options)
{
	const struct sigaction action = { .sa_handler = on_signal };
	int rc = web_server_create(&running, options);

	if (rc < 0) {
		fprintf(stderr, "gopura-curator: %s, port %d: %s\n", options->listen, options->port,
			rc == -EINVAL ? "a --host or the header of --sign-on is not one"
				      : strerror(-rc));
		return rc;
	}
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
	print_address(options->site, options);
	warn_of_network(options);
	web_server_run(running);
	signal(SIGINT, SIG_IGN);
	signal(SIGTERM, SIG_IGN);
	web_server_destroy(running);
	return 0;
}

/* The terminal's own texts, for previews: beside the program while it is developed. */
static void open_texts(void)
{
	static const char folder[] = "locale";
	char path[4096];
	const ssize_t bytes = readlink("/proc/self/exe", path, sizeof(path) - sizeof(folder));
	char *slash;
	int rc;

	path[bytes > 0 ? bytes : 0] = '\0';
	slash = strrchr(path, '/');
	if (slash)
		memcpy(slash + 1, folder, sizeof(folder));
	rc = translate_open(slash && access(path, R_OK | X_OK) == 0 ? path : "/usr/share/locale");
	if (rc < 0)
		log_warn("curator", "the terminal's own texts are in English only in previews");
}

int main(int argc, char **argv)
{
	static struct site site;
	struct settings settings = { .server = { .listen = "127.0.0.1", .port = PORT_DEFAULT } };
	struct diagnostics diagnostics = { 0 };
	struct gate *gate = NULL;
	int rc;

	crash_tell("curator");
	if (argc > 1 && strcmp(argv[1], "user") == 0)
		return user_command(argc - 1, argv + 1);
	if (argc > 1 && strcmp(argv[1], "publisher") == 0)
		return publisher_command(argc - 1, argv + 1);
	parse(&settings, argc, argv);
	open_texts();
	rc = site_open(&site, settings.folder, &diagnostics);
	if (rc == 0)
		rc = gate_create(&gate, settings.folder, &diagnostics);
	settings.server.site = &site;
	settings.server.gate = gate;
	if (rc < 0)
		fprintf(stderr, "gopura-curator: %s\n", diagnostics_cause(&diagnostics, rc));
	else
		rc = serve(&settings.server);
	gate_destroy(gate);
	site_close(&site);
	return rc == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
