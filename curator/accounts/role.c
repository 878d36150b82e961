/* The names of roles. */
#include "curator/accounts/role.h"

#include <errno.h>
#include <string.h>

static const char *const names[] = { "nobody", "reader", "editor", "publisher" };

const char *role_name(enum role role)
{
	return names[role];
}

int role_parse(enum role *out, const char *name)
{
	for (unsigned n = ROLE_READER; n < ROLE_COUNT; n++)
		if (strcmp(name, names[n]) == 0) {
			*out = (enum role)n;
			return 0;
		}
	return -EINVAL;
}
