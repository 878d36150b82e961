/* Exchanges signing keys of a keys' folder, because they are old or were stolen: docs/tuf.md, A key
 * was stolen, or is old.
 *
 * 1. The new keys are made in FOLDER/exchange.part, which is then renamed to FOLDER/exchange.
 * 2. The next root that names them is written: root/N.json and tuf/N.root.json, whichever are
 * there.
 * 3. Each old key becomes NAME.key.old, and the new one NAME.key.
 * 4. FOLDER/exchange is renamed back, and removed.
 *
 * As long as FOLDER/exchange is there nothing is signed (exchange_check), and the same call goes on
 * where the interrupted one stopped. */
#ifndef GOPURA_PIPELINE_KEYS_KEYS_EXCHANGE_H
#define GOPURA_PIPELINE_KEYS_KEYS_EXCHANGE_H

#include <stdbool.h>
#include <stdint.h>

#include "pipeline/keys/exchange_folder.h"

struct keys_exchanged {
	uint32_t root, tuf_root; /* versions of the roots that name the new keys; 0: no such form */
	int64_t expires_s;       /* of roots that were made by this call */
	unsigned kept;  /* keys of which NAME.key.old has the one before, 1 << key of each */
	bool went_on;   /* with an interrupted exchange */
	bool is_shared; /* the museum's teams sign snapshots by a snapshot.key of their own */
};

/* keys: 1 << enum exchange_key of each, at least one. root.key must be in the folder; the others
 * may be lost if it is clear which key of the root is meant. Nothing is changed on -ENOENT: there
 * is no root or no root.key; -EKEYREJECTED: root.key alone may not sign the next root, or the root
 * names other keys; -EBUSY: an exchange of other keys was not finished; -EPERM, -EBADMSG: a key is
 * read by others or damaged. Errors are logged. */
must_check int keys_exchange(struct keys_exchanged *out, const char *folder, unsigned keys);

#endif
