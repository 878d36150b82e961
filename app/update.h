/* Which release may be shown next: the rules of The Update Framework, as far as three small files
 * need them. Pure: files, floors and the time go in, a decision comes out.
 *
 *   threshold, signatures   by the keys of the trust root in use (format/metadata.h)
 *   rollback                a sequence below the floor is refused
 *   mix and match           release.json must be the one that timestamp.json names by its hash
 *   freeze                  an expired file is refused, where the clock is known to be set; so is
 *                           every file under an expired root
 *   key rotation            root N+1 must be signed by the keys of N and by its own */
#ifndef GOPURA_APP_UPDATE_H
#define GOPURA_APP_UPDATE_H

#include "format/metadata.h"

struct update {
	struct trust_root trust;
	bool trusted;            /* trust is set */
	uint64_t sequence_floor; /* of the release that is remembered, or of one refused since */
	struct timestamp timestamp;
	bool have_timestamp;
};

/* now_s: seconds since 1970; 0: the clock is not known to be set, so nothing is called expired. */
struct update_time {
	int64_t now_s;
};

/* Each returns 0, or refuses: -EBADMSG, -EKEYREJECTED (see format/metadata.h), -ESTALE (older than
 * what was seen), -EKEYEXPIRED, -ENOKEY (no trust root yet). *why says it for people; static. */
must_check int update_pin(struct update *update, struct bytes file, const char **why);
must_check int update_root(struct update *update, struct bytes file, const char **why);
must_check int update_timestamp(struct update *update, struct bytes file, struct update_time time,
				const char **why);
/* 1: *out is a newer release, to be brought and shown; 0: it is the one that is known. */
must_check int update_release(struct update *update, struct bytes file, struct update_time time,
			      struct release *out, const char **why);
/* The release is remembered now: nothing older any more. */
void update_accept(struct update *update, uint64_t sequence);

#endif
