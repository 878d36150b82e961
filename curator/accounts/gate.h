/* Who may come in: accounts, those who are signed in, and limits for trying. Follows changes of
 * accounts.json. Any thread. */
#ifndef GOPURA_CURATOR_ACCOUNTS_GATE_H
#define GOPURA_CURATOR_ACCOUNTS_GATE_H

#include "base/diagnostics.h"
#include <stdbool.h>

#include "curator/accounts/sign_ins.h"

struct gate;

/* What a request's cookie means. */
struct gate_visitor {
	struct caller caller;
	char token[SIGN_IN_SECRET_BYTES]; /* "": not signed in */
};

/* folder is copied. *out is owned by the caller; NULL on failure. -ENOENT: there is no account.
 * Errors of reading; all with a diagnostic. */
must_check int gate_create(struct gate **out, const char *folder, struct diagnostics *diagnostics);
void gate_destroy(struct gate *gate); /* NULL is fine */

/* Signs in with a password, which takes a few tenths of a second. key gets the cookie, *out the
 * rest. -EACCES: name or password is wrong. -EAGAIN: not before *wait_ms. */
must_check int gate_sign_in(struct gate *gate, const char *name, const char *password,
			    const char *address, char key[SIGN_IN_SECRET_BYTES],
			    struct gate_visitor *out, int64_t *wait_ms);
/* Signs in without a password, whom a museum's own sign-on has named. -EACCES: there is no such
 * account. */
must_check int gate_admit(struct gate *gate, const char *name, char key[SIGN_IN_SECRET_BYTES],
			  struct gate_visitor *out);
void gate_sign_out(struct gate *gate, const char *key);

enum gate_use {
	GATE_LOOK,    /* nobody did anything */
	GATE_MESSAGE, /* it is used, so it does not end yet */
	GATE_REQUEST, /* and there may be too many: -EAGAIN */
};
/* Finds out whose cookie it is; key "" is nobody's, and so is one that has ended, or whose account
 * was removed or has another password since. */
must_check int gate_identify(struct gate *gate, const char *key, enum gate_use use,
			     struct gate_visitor *out);
/* Returns the role of an account; ROLE_NONE: there is none. */
enum role gate_role(struct gate *gate, const char *name);

#endif
