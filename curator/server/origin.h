/* Whose requests are answered: those to a name of this server, from a page of its own or from a
 * program, which names no origin. So a page of another site in the same browser can do nothing, and
 * nor can a name that was made to mean this machine. */
#ifndef GOPURA_CURATOR_SERVER_ORIGIN_H
#define GOPURA_CURATOR_SERVER_ORIGIN_H

#include <stdbool.h>

enum { ORIGIN_NAMES_MAX = 8, ORIGIN_NAME_BYTES = 128 };

/* Zeroed: nobody is answered. */
struct origin_names {
	char names[ORIGIN_NAMES_MAX][ORIGIN_NAME_BYTES]; /* "HOST" or "HOST:PORT" */
	bool secure[ORIGIN_NAMES_MAX]; /* a proxy serves it by https, or by http */
	unsigned count;
};

/* Adds a name. port 0: the name has it, or needs none. secure: pages may come from https too.
 * Returns false if it is no host name or address, or there are too many. */
bool origin_add(struct origin_names *names, const char *host, int port, bool secure);
/* host and origin are headers of a request; origin "": there is none. */
bool origin_is_welcome(const struct origin_names *names, const char *host, const char *origin);

#endif
