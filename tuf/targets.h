/* The search for a target in what a refresh (tuf/workflow.h) found to be trusted. */
#ifndef GOPURA_TUF_TARGETS_H
#define GOPURA_TUF_TARGETS_H

#include "tuf/workflow.h"

/* The longest path of a target, in bytes. */
enum { TUF_PATH_MAX = 512 };

struct tuf_target {
	uint64_t length;
	/* Where the server has it, below its targets folder: with a hash in its name where the
	 * repository is consistent; not quoted. */
	char file[TUF_PATH_MAX + 160];
	struct cJSON *entry; /* length, hashes and custom, owned */
};

/* Finds a target in the targets and in what these delegate, first found first (section 5.6.7). At
 * most 32 delegated files are looked at. Returns 0, -ENOENT: no such target, or as above. *out is
 * zeroed on failure. */
must_check int tuf_client_find(struct tuf_client *client, const char *path, struct tuf_target *out);
/* Brings the targets file of the top up to date; a part of tuf_client_refresh, which returns what
 * this does. */
must_check int tuf_update_targets(struct tuf_client *client);

/* Returns whether a file is that target. */
bool tuf_target_is(const struct tuf_target *target, struct bytes file);
/* Frees it. Zeroed is fine. */
void tuf_target_finish(struct tuf_target *target);

#endif
