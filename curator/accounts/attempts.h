/* Limits for signing in: whoever guesses passwords must wait longer after each failure, by the
 * name that is tried, whether there is such an account or not, and by the address that tries. Time
 * is passed in. One thread. */
#ifndef GOPURA_CURATOR_ACCOUNTS_ATTEMPTS_H
#define GOPURA_CURATOR_ACCOUNTS_ATTEMPTS_H

#include <stdint.h>

enum {
	ATTEMPTS_MAX = 1024, /* names and addresses that are remembered */
	/* Failures without a wait; after that it doubles from a second up to the limit. A museum's
	 * curators may share an address; and whoever tries a curator's name from elsewhere must not
	 * lock the curator out for long. */
	ATTEMPTS_FREE_OF_NAME = 5,
	ATTEMPTS_FREE_OF_ADDRESS = 20,
	ATTEMPTS_WAIT_OF_NAME_MS = 60 * 1000,
	ATTEMPTS_WAIT_OF_ADDRESS_MS = 15 * 60 * 1000,
	ATTEMPTS_FORGOTTEN_MS = 60 * 60 * 1000, /* after the last failure */
};

struct attempt {
	uint64_t key; /* 0: free */
	uint32_t failures;
	int64_t last_ms, until_ms;
};

/* Zeroed: nobody has failed. */
struct attempts {
	struct attempt list[ATTEMPTS_MAX];
	uint8_t secret[16]; /* for keys that nobody can make collide */
};

/* Counts an attempt as failed, before it is tried, so that many at once gain nothing. Returns 0, or
 * how many milliseconds to wait; then it must not be tried, and is not counted. */
int64_t attempts_begin(struct attempts *attempts, const char *name, const char *address,
		       int64_t now_ms);
/* It was right: the name starts anew, and the address has one failure less. */
void attempts_succeed(struct attempts *attempts, const char *name, const char *address);

#endif
