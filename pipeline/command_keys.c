/* gopura-content keys: creates the signing keys of a content folder, or shows where they are. */
#include "pipeline/commands.h"

#include <getopt.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>

#include "pipeline/keys/keys_place.h"
#include "pipeline/keys/keys_tuf.h"

static const char help[] =
	"gopura-content keys: make the signing keys of a content folder, or show where they are\n"
	"\n"
	"usage: gopura-content keys DIR [OPTIONS]\n"
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
	"Keep a copy of root.key in a safe place, off this machine; publishing needs only the other\n"
	"two. Whoever has release.key can publish to every terminal.\n"
	"\n"
	"Examples:\n"
	"  gopura-content keys temple\n"
	"  gopura-content keys temple --keys /media/safe/temple\n";

static void print_key(const char *what, const uint8_t key[KEY_BYTES])
{
	char hex[HASH_HEX_BYTES];

	hash_to_hex(hash_of((struct bytes){ key, KEY_BYTES }), hex);
	printf("  %-10s %s\n", what, hex);
}

static int run(const char *content_folder, const char *given, bool tuf)
{
	struct publisher_keys keys;
	char folder[PATH_MAX];
	bool made;
	int rc = 0;

	if (keys_open(&keys, folder, content_folder, given, &made) < 0)
		return EXIT_FAILURE;
	printf("%s %s\n", made ? "made keys in" : "keys in", folder);
	print_key("root", keys.trust.roles[META_ROOT].keys[0]);
	print_key("release", keys.release.public_key);
	print_key("timestamp", keys.timestamp.public_key);
	printf("give terminals %s/root/1.json\n", folder);
	if (tuf && (rc = keys_make_tuf_root(folder, &keys)) == 0)
		printf("give other clients of The Update Framework %s/tuf/1.root.json\n", folder);
	keys_finish(&keys);
	return rc < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

int command_keys(int argc, char **argv)
{
	static const struct option options[] = {
		{ "keys", required_argument, NULL, 'K' },
		{ "tuf", no_argument, NULL, 't' },
		{ "help", no_argument, NULL, 'h' },
		{ NULL, 0, NULL, 0 },
	};
	const char *given = NULL;
	bool tuf = false;
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) >= 0) {
		switch (option) {
		case 'K':
			given = optarg;
			break;
		case 't':
			tuf = true;
			break;
		case 'h':
			fputs(help, stdout);
			return EXIT_SUCCESS;
		default:
			return 2;
		}
	}
	if (optind + 1 != argc)
		return command_wrong(argv[0], "name one content folder", "");
	return run(argv[optind], given, tuf);
}
