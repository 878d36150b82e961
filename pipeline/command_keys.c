#include "pipeline/commands.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/keys.h"

static const char help[] =
	"gopura-content keys: make the signing keys of a content folder\n"
	"\n"
	"usage: gopura-content keys DIR\n"
	"\n"
	"Makes DIR/keys/root.key, release.key and timestamp.key (ed25519, readable by you alone) and\n"
	"DIR/keys/root/1.json, which names them and which every terminal is given. Keys that are there\n"
	"are never replaced. `build` and `publish` make them too when there are none.\n"
	"\n"
	"Keep a copy of root.key in a safe place, off this machine; publishing needs only the other\n"
	"two. Who has release.key can publish to every terminal.\n"
	"\n"
	"example: gopura-content keys temple\n";

static void print_key(const char *what, const uint8_t key[KEY_BYTES])
{
	char hex[HASH_HEX_BYTES];

	hash_to_hex(hash_of((struct bytes){ key, KEY_BYTES }), hex);
	printf("  %-10s %s\n", what, hex);
}

int command_keys(int argc, char **argv)
{
	struct publisher_keys keys;
	char folder[PATH_MAX];
	int rc;

	if (argc == 2 && strcmp(argv[1], "--help") == 0) {
		fputs(help, stdout);
		return 0;
	}
	if (argc != 2 || argv[1][0] == '-') {
		fputs("gopura-content keys: name one content folder; see gopura-content keys --help\n",
		      stderr);
		return 2;
	}
	if (snprintf(folder, sizeof(folder), "%s/keys", argv[1]) >= (int)sizeof(folder))
		return 1;
	rc = keys_load(&keys, folder);
	if (rc == -ENOENT) {
		if (keys_make(folder) < 0 || keys_load(&keys, folder) < 0)
			return 1;
		printf("made keys in %s\n", folder);
	} else if (rc < 0) {
		return 1;
	} else {
		printf("keys in %s\n", folder);
	}
	print_key("root", keys.trust.roles[META_ROOT].keys[0]);
	print_key("release", keys.release.public_key);
	print_key("timestamp", keys.timestamp.public_key);
	printf("give terminals %s/root/1.json\n", folder);
	keys_finish(&keys);
	return 0;
}
