/* What an account may do, and whose request this is. Each role may do what the ones before it may.
 */
#ifndef GOPURA_CURATOR_ACCOUNTS_ROLE_H
#define GOPURA_CURATOR_ACCOUNTS_ROLE_H

#include "base/compiler.h"

enum role {
	ROLE_NONE,      /* not signed in */
	ROLE_READER,    /* looks, and marks for itself */
	ROLE_EDITOR,    /* saves */
	ROLE_PUBLISHER, /* publishes */
	ROLE_COUNT,
};

enum { ACCOUNT_NAME_BYTES = 65 }; /* with its end */

struct caller {
	char name[ACCOUNT_NAME_BYTES]; /* "": nobody is signed in */
	enum role role;
};

/* "reader", "editor", "publisher"; "nobody" for ROLE_NONE. Static. */
const char *role_name(enum role role);
/* Returns -EINVAL if it is none of the three. */
must_check int role_parse(enum role *out, const char *name);

#endif
