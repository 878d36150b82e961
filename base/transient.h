/* Failures that say nothing of what was asked for: the next try may work. */
#ifndef GOPURA_BASE_TRANSIENT_H
#define GOPURA_BASE_TRANSIENT_H

#include <errno.h>
#include <stdbool.h>

/* rc is 0 or a negative errno. */
static inline bool is_transient(int rc)
{
	return rc == -ENOMEM || rc == -EIO || rc == -EINTR || rc == -EAGAIN || rc == -EMFILE ||
	       rc == -ENFILE || rc == -ENOSPC;
}

#endif
