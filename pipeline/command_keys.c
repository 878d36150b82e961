/* gopura-content keys: creates the signing keys of a content folder, or shows where they are. */
#include "pipeline/commands.h"

#include <getopt.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>

#include "pipeline/keys/keys_place.h"
#include "pipeline/keys/keys_team.h"
#include "pipeline/keys/keys_tuf.h"

static const char help[] =
	"gopura-content keys: make the signing keys of a content folder, or show where they are\n"
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
	"Keep a copy of root.key in a safe place, off this machine; publishing needs only the other\n"
	"two. Whoever has release.key can publish to every terminal.\n"
	"\n"
	"Examples:\n"
	"  gopura-content keys temple\n"
	"  gopura-content keys temple --keys /media/safe/temple\n"
	"  gopura-content keys --keys museum --museum\n"
	"  gopura-content keys angkor --team angkor --from handed-over\n";

struct settings {
	const char *content_folder, *given; /* may be NULL, but one of them */
	const char *role, *from;            /* of a team; NULL: of none */
	bool tuf, museum;
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
	return settings.role ? run_team(&settings) : run(&settings);
}
