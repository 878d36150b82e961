/* Several temples in one release folder: who may sign which path (docs/tuf.md, Several temples on
 * one server). targets.json, which the museum signs, delegates the paths ROLE/... to a role with
 * keys of its team. */
#ifndef GOPURA_PIPELINE_RELEASE_DELEGATION_H
#define GOPURA_PIPELINE_RELEASE_DELEGATION_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "base/compiler.h"

enum { DELEGATION_KEYS_MAX = 16 /* of one role */ };

/* All borrowed. */
struct delegation_options {
	const char *release;     /* the release folder; made where there is none */
	const char *keys_folder; /* the museum's keys; who signs, its signing.ini says */
	const char *role;
	const char *key_files[DELEGATION_KEYS_MAX]; /* public keys: tuf/public_key.h */
	uint32_t key_count;
	uint32_t threshold; /* how many of them have to sign; at least 1 */
	/* Goes on where the role's present release is not valid any more afterwards. */
	bool invalidate;
	int64_t life_s;              /* of targets.json */
	bool trust_clock;            /* as struct publish_target has it */
	const char *unsigned_folder; /* as release_tuf_write has it; NULL: it is published */
};

/* The three sign the next targets.json, snapshot and timestamp, in one locked step. Nothing is
 * written on failure. -EEXIST: a key is used already; -EKEYREJECTED: the role's present release
 * would not be valid any more, or signatures are missing; -ENOENT: there is no such role or file;
 * -EINVAL. Errors are logged. */

/* Delegates ROLE/... to the keys, which replace those that the role had. */
must_check int delegation_set(const struct delegation_options *options);
must_check int delegation_remove(const struct delegation_options *options);
/* Changes nothing but versions and times of expiry. */
must_check int delegation_renew(const struct delegation_options *options);

/* Publishes what was staged in a folder, the museum's or a team's: release_tuf_add_signatures. */
must_check int delegation_add_signatures(const struct delegation_options *options,
					 const char *staged_folder);

/* Lists the roles. Errors are logged. */
must_check int delegation_print(FILE *to, const struct delegation_options *options);

#endif
