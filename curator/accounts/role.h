/* What an account may do, and whose request this is. Each role may do what the ones before it may.
 */
#ifndef GOPURA_CURATOR_ACCOUNTS_ROLE_H
#define GOPURA_CURATOR_ACCOUNTS_ROLE_H

enum role {
	ROLE_NONE,      /* not signed in */
	ROLE_READER,    /* looks, and marks for itself */
	ROLE_EDITOR,    /* saves */
	ROLE_PUBLISHER, /* publishes */
};

enum { ACCOUNT_NAME_BYTES = 65 }; /* with its end */

struct caller {
	char name[ACCOUNT_NAME_BYTES]; /* "": nobody is signed in */
	enum role role;
};

#endif
