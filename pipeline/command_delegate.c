/* gopura-content delegate: says which team may publish which of several temples in one folder. */
#include "pipeline/commands.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/release/delegation.h"

static const char help[] =
	"gopura-content delegate: let the teams of several temples publish on one server, each by keys\n"
	"of its own (docs/tuf.md)\n"
	"\n"
	"usage: gopura-content delegate RELEASE --keys FOLDER                  list the roles\n"
	"       gopura-content delegate RELEASE ROLE --keys FOLDER --key FILE...\n"
	"                                                                     add a role, exchange its keys\n"
	"       gopura-content delegate RELEASE ROLE --keys FOLDER --remove\n"
	"       gopura-content delegate RELEASE --keys FOLDER --renew\n"
	"\n"
	"  --keys FOLDER    the museum's keys, made by `gopura-content keys --keys FOLDER --museum`\n"
	"  --key FILE       a public key of the team, which may sign ROLE/release.json from now on, in place\n"
	"                   of the keys that the role had: PEM (BEGIN PUBLIC KEY), as openssl and\n"
	"                   `gopura-content keys --team` write it. Several times: several keys\n"
	"  --threshold N    how many of these keys have to sign (default: 1)\n"
	"  --remove         take the role away\n"
	"  --invalidate     go on even if the role's present release is not valid any more then; terminals keep\n"
	"                   what they show until its team publishes again\n"
	"  --renew          sign the list of roles anew, as it is, before it expires\n"
	"  --expires DAYS   days after which terminals refuse the list of roles (default: 1825)\n"
	"  --trust-clock    as of publish: sign even if this machine's clock seems wrong\n"
	"  --write-unsigned FOLDER\n"
	"                   do not publish: write the metadata into FOLDER, to be signed elsewhere\n"
	"  --add-signature FOLDER\n"
	"                   publish what --write-unsigned of this command or of `publish` wrote; snapshot and\n"
	"                   timestamp are signed here\n"
	"\n"
	"Signs the next targets.json, snapshot and timestamp, and writes them so that terminals find the\n"
	"old list or the new one at any moment.\n"
	"\n"
	"Examples:\n"
	"  gopura-content delegate release angkor --keys museum --key angkor.pub\n"
	"  gopura-content delegate release angkor --keys museum --key old.pub --key new.pub\n";

struct settings {
	struct delegation_options delegation;
	bool remove, renew;
	const char *staged_folder;
};

static int act(const struct settings *settings)
{
	const struct delegation_options *options = &settings->delegation;

	if (settings->staged_folder)
		return delegation_add_signatures(options, settings->staged_folder);
	if (settings->renew)
		return delegation_renew(options);
	if (settings->remove)
		return delegation_remove(options);
	return options->role ? delegation_set(options) : 0;
}

static int run(const struct settings *settings)
{
	const char *unsigned_folder = settings->delegation.unsigned_folder;
	const bool changes =
		settings->delegation.role || settings->renew || settings->staged_folder;
	int rc = act(settings);

	if (rc < 0 && changes)
		fprintf(stderr, "gopura-content delegate: nothing was changed (%s)\n",
			strerror(-rc));
	else if (unsigned_folder)
		printf("not published yet: sign each FILE.json in %s, or its FILE.json.bytes into "
		       "FILE.json.NAME.sig, and run delegate with --add-signature %s\n",
		       unsigned_folder, unsigned_folder);
	else
		rc = delegation_print(stdout, &settings->delegation);
	return rc < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* Returns what is wrong with the command line, or NULL. */
static const char *fault_of(const struct settings *settings)
{
	const struct delegation_options *options = &settings->delegation;
	const bool sets = options->key_count > 0;

	if (!options->keys_folder)
		return "name the folder of the museum's keys with --keys";
	if (sets + settings->remove + settings->renew + (settings->staged_folder != NULL) > 1)
		return "give only one of --key, --remove, --renew and --add-signature";
	if (options->role && !sets && !settings->remove)
		return "give the team's public key with --key, or --remove";
	if (!options->role && (sets || settings->remove))
		return "name the role after the release folder";
	if (options->role && !content_role_is_valid(options->role))
		return content_role_rule;
	if (options->unsigned_folder && !sets && !settings->remove && !settings->renew)
		return "--write-unsigned goes with --key, --remove or --renew";
	return NULL;
}

int command_delegate(int argc, char **argv)
{
	static const struct option options[] = {
		{ "keys", required_argument, NULL, 'K' },
		{ "key", required_argument, NULL, 'k' },
		{ "threshold", required_argument, NULL, 't' },
		{ "remove", no_argument, NULL, 'r' },
		{ "invalidate", no_argument, NULL, 'i' },
		{ "renew", no_argument, NULL, 'n' },
		{ "expires", required_argument, NULL, 'e' },
		{ "trust-clock", no_argument, NULL, 'c' },
		{ "write-unsigned", required_argument, NULL, 'w' },
		{ "add-signature", required_argument, NULL, 'a' },
		{ "help", no_argument, NULL, 'h' },
		{ NULL, 0, NULL, 0 },
	};
	struct settings settings = { .delegation = { .threshold = 1, .life_s = 1825 * 86400ll } };
	struct delegation_options *delegation = &settings.delegation;
	const char *fault;
	uint64_t number;
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) >= 0) {
		switch (option) {
		case 'K':
			delegation->keys_folder = optarg;
			break;
		case 'k':
			if (delegation->key_count == DELEGATION_KEYS_MAX)
				return command_wrong(argv[0], "a role has at most 16 keys", "");
			delegation->key_files[delegation->key_count++] = optarg;
			break;
		case 't':
			if (!command_number(optarg, 1, DELEGATION_KEYS_MAX, &number))
				return command_wrong(
					argv[0], "--threshold must be 1 to 16 keys, not ", optarg);
			delegation->threshold = (uint32_t)number;
			break;
		case 'r':
			settings.remove = true;
			break;
		case 'i':
			delegation->invalidate = true;
			break;
		case 'n':
			settings.renew = true;
			break;
		case 'e':
			if (!command_number(optarg, 1, 36500, &number))
				return command_wrong(
					argv[0], "--expires must be 1 to 36500 days, not ", optarg);
			delegation->life_s = (int64_t)number * 86400;
			break;
		case 'c':
			delegation->trust_clock = true;
			break;
		case 'w':
			delegation->unsigned_folder = optarg;
			break;
		case 'a':
			settings.staged_folder = optarg;
			break;
		case 'h':
			fputs(help, stdout);
			return 0;
		default:
			return 2;
		}
	}
	if (optind == argc || argc - optind > 2)
		return command_wrong(argv[0], "name one release folder, and at most one role", "");
	delegation->release = argv[optind];
	delegation->role = argv[optind + 1];
	fault = fault_of(&settings);
	return fault ? command_wrong(argv[0], fault, "") : run(&settings);
}
