/* Decides which release may be shown next, by the rules of The Update Framework as far as three
 * small files need them. Pure: files, floors and the time go in, a decision comes out.
 *
 *   threshold, signatures   by the keys of the trust root in use (format/metadata.h)
 *   rollback                a sequence below the floor is refused
 *   mix and match           release.json must be the one that timestamp.json names by its hash
 *   freeze                  an expired file is refused if the clock is known to be set; so is every
 *                           file under an expired root
 *   key rotation            root N+1 must be signed by the keys of N and by its own
 *   fast-forward            a root that withdraws keys clears the floors that those keys may have
 *                           set; otherwise a stolen key's sequence of 2^53 would block every later
 *                           release: trust_root
 *   time                    time_floor_s rises only to what a signed timestamp.json says, because
 *                           the terminal's clock may be set by anyone on the network; and only
 *                           while that clock agrees, because the publisher's may be wrong too */
#ifndef GOPURA_APP_RELEASE_TRUST_H
#define GOPURA_APP_RELEASE_TRUST_H

#include "format/metadata.h"

enum { TRUST_CLOCKS_DIFFER_S = 86400 }; /* by as much at most, of terminal and publisher */

struct trust {
	struct trust_root root;
	bool trusted;            /* root has been set */
	uint64_t sequence_floor; /* sequence of the stored release */
	int64_t time_floor_s;    /* when the latest timestamp.json of trust_raise_time_floor was
				    issued, seconds since 1970: it cannot be earlier now */
	struct timestamp timestamp;
	bool have_timestamp;
};

/* now_s: what the clock says, seconds since 1970; 0: it is not known to be set, so nothing counts
 * as expired. */
struct trust_time {
	int64_t now_s;
};

/* Each of these functions returns 0, or refuses the file: -EBADMSG and -EKEYREJECTED (see
 * format/metadata.h), -ESTALE (older than what was seen before), -EKEYEXPIRED, -ENOKEY (no trust
 * root yet), or -ENOMEM. *why then says so for people; it is static. Files are borrowed for the
 * call. trust_pin sets the first trust root. */
must_check int trust_pin(struct trust *trust, struct bytes file, const char **why);
/* Replaces the trust root by the next one, and clears floors that the withdrawn keys may have set.
 * remembered: the release.json in use; empty if none is known. What is cleared:
 *
 *   the time floor       if a timestamp key is removed, or more signatures are required
 *   the sequence floor   if no old release.json or no old timestamp.json is valid any more, so that
 *                        there is nothing to roll back to; or if keys of both roles are withdrawn
 *                        and `remembered` is no longer valid, since a thief may have signed it. It
 *                        stays if a key is only added, or if one role replaces a key and keeps
 *                        others. */
must_check int trust_root(struct trust *trust, struct bytes file, struct bytes remembered,
			  const char **why);
/* Checks timestamp.json and keeps it; the time floor rises: trust_raise_time_floor. */
must_check int trust_timestamp(struct trust *trust, struct bytes file, struct trust_time time,
			       const char **why);
/* Checks release.json against the last timestamp.json. Returns 1 if *out is a newer release, to be
 * loaded and shown; 0 if it is the stored one. */
must_check int trust_release(struct trust *trust, struct bytes file, struct trust_time time,
			     struct release *out, const char **why);
/* The same for a release.json that is a signed target of The Update Framework. */
must_check int trust_target(const struct trust *trust, struct bytes file, struct trust_time time,
			    struct release *out, const char **why);
/* Returns by which time expiry is judged: the later of clock and time floor, or 0. */
int64_t trust_now_s(const struct trust *trust, struct trust_time time);
/* Raises the time floor to when an accepted timestamp was issued (0: it does not say), and returns
 * whether it rose. It does not while the clock is not set, or if that is further ahead of the clock
 * than clocks differ. Call it in each round: the clock may be set by then. */
bool trust_raise_time_floor(struct trust *trust, int64_t issued_s, struct trust_time time);
/* Raises the sequence floor, because a release with this sequence was stored. */
void trust_accept(struct trust *trust, uint64_t sequence);

#endif
