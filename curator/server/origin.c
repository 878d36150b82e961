/* Compares the headers Host and Origin with the names of this server. */
#include "curator/server/origin.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

bool origin_add(struct origin_names *names, const char *host, int port, bool secure)
{
	static const char good[] =
		"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-.:[]";
	const size_t bytes = strlen(host);
	char *name = names->names[names->count];

	if (names->count == ORIGIN_NAMES_MAX || bytes == 0 || strspn(host, good) != bytes ||
	    bytes > ORIGIN_NAME_BYTES - sizeof(":65535"))
		return false;
	if (port > 0)
		snprintf(name, ORIGIN_NAME_BYTES, "%s:%u", host, (unsigned)(uint16_t)port);
	else
		memcpy(name, host, bytes + 1);
	names->secure[names->count++] = secure;
	return true;
}

static bool is_page_of(const char *origin, const char *scheme, const char *name)
{
	const size_t bytes = strlen(scheme);

	return strncmp(origin, scheme, bytes) == 0 && strcasecmp(origin + bytes, name) == 0;
}

bool origin_is_welcome(const struct origin_names *names, const char *host, const char *origin)
{
	for (unsigned n = 0; n < names->count; n++) {
		const char *name = names->names[n];

		if (strcasecmp(host, name) == 0)
			return !*origin || is_page_of(origin, "http://", name) ||
			       (names->secure[n] && is_page_of(origin, "https://", name));
	}
	return false;
}
