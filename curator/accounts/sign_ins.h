/* Who is signed in: a table of keys, each of which a browser has as its cookie, in memory alone. A
 * key is kept as its hash, so that no comparison tells by its time how much of a guess is right. It
 * ends after an hour or two without a request, or after half a day. Time is passed in. One thread.
 */
#ifndef GOPURA_CURATOR_ACCOUNTS_SIGN_INS_H
#define GOPURA_CURATOR_ACCOUNTS_SIGN_INS_H

#include <stdbool.h>
#include <stdint.h>

#include "curator/accounts/role.h"
#include "format/hash.h"

enum {
	SIGN_INS_MAX = 256,
	SIGN_INS_OF_ACCOUNT_MAX = 16, /* then the one used longest ago ends */
	SIGN_IN_SECRET_BYTES = 65,    /* 64 digits and the end */
	SIGN_IN_IDLE_MS = 2 * 60 * 60 * 1000,
	SIGN_IN_WHOLE_MS = 12 * 60 * 60 * 1000,
	/* Requests that one may make at once, and after that every second. */
	SIGN_IN_REQUESTS_AT_ONCE = 200,
	SIGN_IN_REQUESTS_PER_S = 20,
};

struct sign_in {
	struct hash key; /* zero: the entry is free */
	char token[SIGN_IN_SECRET_BYTES];
	char name[ACCOUNT_NAME_BYTES];
	int64_t begun_ms, used_ms, counted_ms;
	double requests; /* that may be made, at counted_ms */
};

/* Zeroed: nobody. */
struct sign_ins {
	struct sign_in list[SIGN_INS_MAX];
};

/* Begins one. key gets the cookie. The result is borrowed. If all are in use, the one used longest
 * ago ends. */
const struct sign_in *sign_ins_begin(struct sign_ins *sign_ins, const char *name, int64_t now_ms,
				     char key[SIGN_IN_SECRET_BYTES]);
/* Returns the one of a cookie, borrowed; NULL: there is none, or it has ended. */
struct sign_in *sign_ins_find(struct sign_ins *sign_ins, const char *key, int64_t now_ms);
/* Counts a request. Returns false if there were too many. */
bool sign_in_may_ask(struct sign_in *sign_in, int64_t now_ms);
/* Ends that of a cookie, if there is one. */
void sign_ins_end(struct sign_ins *sign_ins, const char *key);
/* Ends all those of an account. */
void sign_ins_end_all(struct sign_ins *sign_ins, const char *name);
/* Returns whether a text is a secret; takes the same time for each wrong one of its length. */
bool sign_in_secret_is(const char *secret, const char *text);

#endif
