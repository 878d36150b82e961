/* gopura-content keys: creates the signing keys of a content folder, exchanges them, or shows where
 * they are. */
#include "pipeline/commands.h"

#include <getopt.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "pipeline/keys/keys_exchange.h"
#include "pipeline/keys/keys_place.h"
#include "pipeline/keys/keys_team.h"
#include "pipeline/keys/keys_tuf.h"

static const char help[] =
	"gopura-content keys: make or exchange the signing keys of a content folder, or show where they are\n"
	"\n"
	"usage: gopura-content keys DIR [OPTIONS]\n"
	"       gopura-content keys --keys FOLDER [OPTIONS]     keys of no content folder, as a museum's\n"
	"\n"
	"  --keys FOLDER   folder of the keys (default: $XDG_CONFIG_HOME/gopura/keys/NAME, where NAME is\n"
	"                  DIR's name, and XDG_CONFIG_HOME is ~/.config if it is not set)\n"
	"\n"
	"Makes root.key, release.key and timestamp.key (ed25519, readable by you alone) and root/1.json,\n"
	"which lists their public keys and which every terminal needs. Existing keys are never\n"
	"replaced. `build` and `publish` make missing keys too. Keys that an earlier version made in\n"
	"DIR/keys are moved out of it.\n"
	"\n"
	"  --tuf           also sign releases as The Update Framework does, from the next publish on: makes\n"
	"                  tuf/1.root.json beside the keys, for which root.key must be there\n"
	"\n"
	"Several temples on one server, each signed by its own team (docs/tuf.md):\n"
	"\n"
	"  --museum        as --tuf, and makes snapshot.key, which the museum may hand over to its teams with\n"
	"                  timestamp.key and the folder tuf\n"
	"  --team ROLE     makes ROLE.key and ROLE.pub, and signing.ini, instead of the keys above; the museum\n"
	"                  needs ROLE.pub\n"
	"  --from FOLDER   with --team: what the museum handed over\n"
	"\n"
	"A key was stolen, or is old (docs/tuf.md):\n"
	"\n"
	"  --exchange KEY  make a new KEY.key and sign the next root, which names it in place of the old one:\n"
	"                  root, release, snapshot or timestamp. Several times: several keys. root.key must\n"
	"                  be there. The old key becomes KEY.key.old; it signs nothing any more. Then publish,\n"
	"                  so that terminals learn of it\n"
	"\n"
	"Keep a copy of root.key in a safe place, off this machine; publishing needs only the other\n"
	"two. Whoever has release.key can publish to every terminal.\n"
	"\n"
	"Examples:\n"
	"  gopura-content keys temple\n"
	"  gopura-content keys temple --keys /media/safe/temple\n"
	"  gopura-content keys --keys museum --museum\n"
	"  gopura-content keys angkor --team angkor --from handed-over\n"
	"  gopura-content keys temple --exchange release --exchange timestamp\n";

struct settings {
	const char *content_folder, *given; /* may be NULL, but one of them */
	const char *role, *from;            /* of a team; NULL: of none */
	bool tuf, museum;
	unsigned exchanged; /* 1 << enum exchange_key of each */
};

static void print_key(const char *what, const uint8_t key[KEY_BYTES])
{
	char hex[HASH_HEX_BYTES];

	hash_to_hex(hash_of((struct bytes){ key, KEY_BYTES }), hex);
	printf("  %-10s %s\n", what, hex);
}

static int run_team(const struct settings *settings)
{
	const char *role = settings->role;
	char folder[PATH_MAX];
	int rc = keys_open(NULL, folder, settings->content_folder, settings->given, NULL);

	if (rc == 0)
		rc = keys_make_team(folder, role, settings->from);
	if (rc < 0)
		return EXIT_FAILURE;
	printf("keys of %s in %s\n"
	       "give the museum %s/%s.pub, which is no secret\n"
	       "put into temple.ini:\n"
	       "  [release]\n"
	       "  metadata = tuf\n"
	       "  target = %s/release.json\n"
	       "  role = %s\n",
	       role, folder, folder, role, role, role);
	return EXIT_SUCCESS;
}

/* ---- exchanging */

static unsigned key_named(const char *name)
{
	for (int key = 0; key < EXCHANGE_KEYS; key++)
		if (strcmp(name, exchange_key_names[key]) == 0)
			return 1u << key;
	return strcmp(name, "targets") == 0 ? 1u << EXCHANGE_RELEASE : 0;
}

/* "root.key, release.key" */
static void print_names(unsigned keys, const char *end)
{
	const char *before = "";

	for (int key = 0; key < EXCHANGE_KEYS; key++) {
		if (!(keys & 1u << key))
			continue;
		printf("%s%s.key%s", before, exchange_key_names[key], end);
		before = ", ";
	}
}

static void print_roots(const struct keys_exchanged *exchanged)
{
	const time_t time_s = (time_t)exchanged->expires_s;
	char date[32] = "";
	struct tm tm;

	if (exchanged->root > 0)
		printf("root/%u.json", exchanged->root);
	if (exchanged->tuf_root > 0)
		printf("%stuf/%u.root.json", exchanged->root > 0 ? " and " : "",
		       exchanged->tuf_root);
	if (gmtime_r(&time_s, &tm))
		strftime(date, sizeof(date), "%Y-%m-%d", &tm);
	printf(" %s the new keys%s%s\n",
	       exchanged->root > 0 && exchanged->tuf_root > 0 ? "name" : "names",
	       exchanged->went_on ? "" : ", valid until ", exchanged->went_on ? "" : date);
}

/* What has to be done now that the folder of keys is in order. */
static void print_next(const struct settings *settings, const struct keys_exchanged *exchanged,
		       const char *folder)
{
	const unsigned root = 1u << EXCHANGE_ROOT;

	if (exchanged->is_shared)
		printf("next: gopura-content delegate RELEASE --keys %s --renew, so that terminals "
		       "learn of it\n"
		       "then hand over to the teams again: %s/tuf, and snapshot.key and "
		       "timestamp.key if they sign these files themselves\n",
		       folder, folder);
	else
		printf("next: gopura-content publish %s%s%s, so that terminals learn of it\n",
		       settings->content_folder ? settings->content_folder : "DIR",
		       settings->given ? " --keys " : "", settings->given ? folder : "");
	printf("put root.key back into its safe place%s\n",
	       settings->exchanged & root ? ", the new one, with a copy" : "");
	if (exchanged->kept & root)
		printf("destroy root.key.old and every copy of it: terminals that have not seen "
		       "the new root still follow it\n");
}

static int run_exchange(const struct settings *settings)
{
	struct keys_exchanged exchanged;
	char folder[PATH_MAX];
	int rc = keys_open(NULL, folder, settings->content_folder, settings->given, NULL);

	if (rc == 0)
		rc = keys_exchange(&exchanged, folder, settings->exchanged);
	if (rc < 0)
		return EXIT_FAILURE;
	printf("%s ", exchanged.went_on ? "finished the interrupted exchange of" : "exchanged");
	print_names(settings->exchanged, "");
	printf(" in %s\n", folder);
	print_roots(&exchanged);
	if (exchanged.kept) {
		printf("the old keys, which sign nothing any more: ");
		print_names(exchanged.kept, ".old");
		printf("\n");
	}
	print_next(settings, &exchanged, folder);
	return EXIT_SUCCESS;
}

/* ---- */

static int run(const struct settings *settings)
{
	struct publisher_keys keys;
	char folder[PATH_MAX];
	bool made;
	int rc = 0;

	if (keys_open(&keys, folder, settings->content_folder, settings->given, &made) < 0)
		return EXIT_FAILURE;
	printf("%s %s\n", made ? "made keys in" : "keys in", folder);
	print_key("root", keys.trust.roles[META_ROOT].keys[0]);
	print_key("release", keys.release.public_key);
	print_key("timestamp", keys.timestamp.public_key);
	if (!settings->museum)
		printf("give terminals %s/root/1.json\n", folder);
	if (settings->museum)
		rc = keys_make_museum_root(folder, &keys);
	else if (settings->tuf)
		rc = keys_make_tuf_root(folder, &keys);
	if (rc == 0 && settings->museum)
		printf("give terminals %s/tuf/1.root.json\n"
		       "hand over to teams that publish here: %s/tuf, and snapshot.key and "
		       "timestamp.key if they sign these files themselves\n",
		       folder, folder);
	else if (rc == 0 && settings->tuf)
		printf("give other clients of The Update Framework %s/tuf/1.root.json\n", folder);
	keys_finish(&keys);
	return rc < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* Returns what is wrong with the command line, or NULL. */
static const char *fault_of(const struct settings *settings)
{
	if (!settings->content_folder && !settings->given)
		return "name one content folder, or a folder of keys with --keys";
	if (!settings->role != !settings->from)
		return "--team goes with --from, the folder that the museum handed over";
	if (settings->role && (settings->tuf || settings->museum))
		return "give only one of --team, --tuf and --museum";
	if (settings->exchanged && (settings->role || settings->tuf || settings->museum))
		return "--exchange goes with no other option than --keys";
	if (settings->role && !content_role_is_valid(settings->role))
		return content_role_rule;
	return NULL;
}

int command_keys(int argc, char **argv)
{
	static const struct option options[] = {
		{ "keys", required_argument, NULL, 'K' },
		{ "tuf", no_argument, NULL, 't' },
		{ "museum", no_argument, NULL, 'm' },
		{ "team", required_argument, NULL, 'T' },
		{ "from", required_argument, NULL, 'f' },
		{ "exchange", required_argument, NULL, 'x' },
		{ "help", no_argument, NULL, 'h' },
		{ NULL, 0, NULL, 0 },
	};
	struct settings settings = { .given = NULL };
	const char *fault;
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) >= 0) {
		switch (option) {
		case 'K':
			settings.given = optarg;
			break;
		case 't':
			settings.tuf = true;
			break;
		case 'm':
			settings.museum = true;
			break;
		case 'T':
			settings.role = optarg;
			break;
		case 'f':
			settings.from = optarg;
			break;
		case 'x':
			if (!key_named(optarg))
				return command_wrong(
					argv[0],
					"--exchange takes root, release, snapshot or timestamp; "
					"a team's key is exchanged by `gopura-content delegate`; "
					"not ",
					optarg);
			settings.exchanged |= key_named(optarg);
			break;
		case 'h':
			fputs(help, stdout);
			return EXIT_SUCCESS;
		default:
			return 2;
		}
	}
	if (argc - optind > 1)
		return command_wrong(argv[0], "name one content folder", "");
	settings.content_folder = argv[optind];
	fault = fault_of(&settings);
	if (fault)
		return command_wrong(argv[0], fault, "");
	if (settings.exchanged)
		return run_exchange(&settings);
	return settings.role ? run_team(&settings) : run(&settings);
}
