/* Looks which files the folder has. */
#include "pipeline/keys/exchange_folder.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/log.h"

const char *const exchange_key_names[EXCHANGE_KEYS] = {
	[EXCHANGE_ROOT] = "root",
	[EXCHANGE_RELEASE] = "release",
	[EXCHANGE_SNAPSHOT] = "snapshot",
	[EXCHANGE_TIMESTAMP] = "timestamp",
};

unsigned exchange_going_on(const char *folder)
{
	char path[PATH_MAX];
	unsigned keys = 0;

	for (int key = 0; key < EXCHANGE_KEYS; key++)
		if (snprintf(path, sizeof(path), "%s/exchange/%s.key", folder,
			     exchange_key_names[key]) < (int)sizeof(path) &&
		    access(path, F_OK) == 0)
			keys |= 1u << key;
	return keys;
}

int exchange_check(const char *folder)
{
	const unsigned keys = exchange_going_on(folder);
	char options[128] = "";
	size_t size = 0;

	for (int key = 0; key < EXCHANGE_KEYS; key++)
		if (keys & 1u << key)
			size += (size_t)snprintf(options + size, sizeof(options) - size,
						 " --exchange %s", exchange_key_names[key]);
	if (keys == 0)
		return 0;
	log_error("pipeline",
		  "%s: an exchange of keys was not finished: run `gopura-content keys` for this "
		  "folder with%s, which goes on with it",
		  folder, options);
	return -EBUSY;
}
