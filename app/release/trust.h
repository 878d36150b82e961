/* Which release may be shown next: the rules of The Update Framework, as far as three small files
 * need them. Pure: files, floors and the time go in, a decision comes out.
 *
 *   threshold, signatures   by the keys of the trust root in use (format/metadata.h)
 *   rollback                a sequence below the floor is refused
 *   mix and match           release.json must be the one that timestamp.json names by its hash
 *   freeze                  an expired file is refused, where the clock is known to be set; so is
 *                           every file under an expired root
 *   key rotation            root N+1 must be signed by the keys of N and by its own
 *   fast-forward            a root that withdraws trust from keys clears what those keys may have
 *                           set, else a thief's sequence of 2^53 would hold for ever: trust_root
 *   time                    floor_s rises only to what a signed timestamp.json says; the terminal's
 *                           clock may be set by anyone on the network */
#ifndef GOPURA_APP_RELEASE_TRUST_H
#define GOPURA_APP_RELEASE_TRUST_H

#include "format/metadata.h"

struct trust {
	struct trust_root root;
	bool trusted;            /* root is set */
	uint64_t sequence_floor; /* of the release that is remembered, or of one refused since */
	int64_t time_floor_s;    /* it is at least this late: the latest timestamp.json was signed
				    then */
	struct timestamp timestamp;
	bool have_timestamp;
};

/* now_s: seconds since 1970; 0: the clock is not known to be set, so nothing is called expired. */
struct trust_time {
	int64_t now_s;
};

/* Each returns 0, or refuses: -EBADMSG, -EKEYREJECTED (see format/metadata.h), -ESTALE (older than
 * what was seen), -EKEYEXPIRED, -ENOKEY (no trust root yet). *why says it for people; static. */
must_check int trust_pin(struct trust *trust, struct bytes file, const char **why);
/* remembered: the release.json in use; empty: none is known. What the new root makes void:
 *
 *   the time floor       where a timestamp key is removed, or more signatures are asked for
 *   the sequence floor   where no old release.json or no old timestamp.json is good any more, so
 *                        that there is nothing to roll back to; and where trust is withdrawn from
 *                        keys of both roles and `remembered` is not good any more, since then it
 *                        may have been a thief's. A key that is merely added, or one role's that
 *                        gives way to another beside keys that stay, leaves the sequence floor. */
must_check int trust_root(struct trust *trust, struct bytes file, struct bytes remembered,
			  const char **why);
must_check int trust_timestamp(struct trust *trust, struct bytes file, struct trust_time time,
			       const char **why);
/* 1: *out is a newer release, to be brought and shown; 0: it is the one that is known. */
must_check int trust_release(struct trust *trust, struct bytes file, struct trust_time time,
			     struct release *out, const char **why);
/* The release is remembered now: nothing older any more. */
void trust_accept(struct trust *trust, uint64_t sequence);

#endif
