/* The next root after an exchange of keys, in each of the two forms: signed by root.key of the root
 * before, and by the new root.key where that is exchanged too. Valid for KEYS_ROOT_LIFE_S. */
#ifndef GOPURA_PIPELINE_KEYS_EXCHANGE_ROOTS_H
#define GOPURA_PIPELINE_KEYS_EXCHANGE_ROOTS_H

#include "pipeline/keys/exchange_folder.h"
#include "pipeline/keys/keys.h"

/* Sets of keys have 1 << enum exchange_key of each. */
struct exchange {
	const char *folder; /* of the keys */
	unsigned wanted;    /* the keys to be exchanged */
	unsigned present;   /* those that old has; root.key, wanted or not */
	int64_t expires_s;  /* of the new root */
	struct signing_key old[EXCHANGE_KEYS], next[EXCHANGE_KEYS];
};

struct exchange_root {
	uint32_t version;   /* of the newest root; 0: the folder has none in this form */
	struct buffer file; /* the root after it; empty: the newest names the new keys already */
};

/* *out is initialised by the caller with a ceiling, and finished by it.
 *
 * -ENOENT: root.key is not in the folder. -EKEYREJECTED: root.key alone may not sign, or it cannot
 * be told which key is to go. -EBADMSG: the newest root is damaged. Errors are logged. */
must_check int exchange_earlier_root(struct exchange_root *out, const struct exchange *exchange);
must_check int exchange_tuf_root(struct exchange_root *out, const struct exchange *exchange);

#endif
