/* The client workflow of The Update Framework (TUF 1.0.34, section 5): from a root that is trusted
 * to a target that may be, whatever the server, a mirror or an attacker between does.
 *
 * What may be attacked and what stands against it: arbitrary installation (signatures), endless
 * data (a ceiling for each file), rollback (versions of timestamp, snapshot and each targets file),
 * fast-forward (what an old key set ends with it), freeze (expiry), mix and match (the snapshot's
 * versions, the timestamp's hashes), wrong installation (the target's path and hashes).
 *
 * Nothing here reads clocks, files or the network; the caller gives these. */
#ifndef GOPURA_TUF_WORKFLOW_H
#define GOPURA_TUF_WORKFLOW_H

#include "tuf/tuf_metadata.h"

struct tuf_io {
	void *context;
	/* Fetches a file of the server's metadata folder by its name, which is quoted for a URL and
	 * may hold no slash, into out, which is empty and has a ceiling. Returns 0, -ENOENT: the
	 * server has it not, -EFBIG: beyond the ceiling, or another negative errno. */
	int (*fetch)(void *context, const char *name, struct buffer *out);
	/* The same for what store kept of a role; name is "root.json", and quoted too. */
	int (*load)(void *context, const char *name, struct buffer *out);
	/* Keeps a file in place of the role's last one, whole or not at all. 0 or a negative errno.
	 */
	int (*store)(void *context, const char *name, struct bytes file);
};

struct tuf_client {
	struct tuf_io io;
	int64_t now_s; /* what expiry is judged by */
	struct tuf_file root, timestamp, snapshot, targets;
	char why[256]; /* after a failure, for people: the file, and what is wrong with it */
};

/* Loads the root that was stored and brings all four files up to date; each that was accepted is
 * stored at once. Returns 0; -EBADMSG: a file is damaged, or not what another says of it;
 * -EKEYREJECTED: too few signatures; -ESTALE: older than what was accepted before; -ETIME: expired;
 * -ENOENT: not on the server; -ENOMEM; or what io returned. The client is for tuf_client_finish,
 * also on failure. */
must_check int tuf_client_refresh(struct tuf_client *client, const struct tuf_io *io,
				  int64_t now_s);
/* Frees everything. Zeroed is fine. */
void tuf_client_finish(struct tuf_client *client);

#endif
