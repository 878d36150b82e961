/* Who signs metadata of The Update Framework (docs/tuf.md, Keys that are elsewhere): signing.ini in
 * the keys' folder names files for each role.
 *
 *   [keys]
 *   targets = token.sh               a program: gets the bytes on its standard input and writes the
 *   snapshot = release.key           signature's bytes to its standard output
 *   timestamp = timestamp.key, two.pem     keys of gopura, or private keys in PEM
 *
 * Without the file, or for what it does not name, targets and snapshot are release.key's and the
 * timestamp is timestamp.key's. "none": nobody here signs it. */
#ifndef GOPURA_PIPELINE_KEYS_SIGNING_H
#define GOPURA_PIPELINE_KEYS_SIGNING_H

#include <limits.h>

#include "tuf/tuf_metadata.h"

enum { SIGNING_LIST_BYTES = 512 };

struct signing {
	char folder[PATH_MAX]; /* of the keys */
	/* Names of files, separated by commas or spaces; indexed by enum tuf_type, root unused. */
	char signers[TUF_TYPES][SIGNING_LIST_BYTES];
};

/* Reads signing.ini of a keys' folder; there need not be one. Errors are logged. */
must_check int signing_read(struct signing *out, const char *folder);

/* Has all of a type's signers sign a message, which is that file's canonical content, and adds
 * their signatures to an array as tuf_add_signature does; keys and role say who may sign. name: the
 * file, for people. Returns 0; -EPERM: others may read or change a signer's file; -EKEYREJECTED: a
 * signature is by none of the role's keys; -EIO: a program failed; or what reading gives. Errors
 * are logged. */
must_check int signing_sign(const struct signing *signing, enum tuf_type type, const char *name,
			    const struct cJSON *keys, const struct cJSON *role,
			    struct bytes message, struct cJSON *signatures);

#endif
