/* Closes descriptors on threads of their own, for those whose close may wait: a TCP socket that
 * somebody passed with SO_LINGER set waits for its peer as long as that option says, and so does
 * the socket that it still lies in. The caller never waits. Any thread. */
#ifndef GOPURA_NET_CLOSER_H
#define GOPURA_NET_CLOSER_H

#include <stdbool.h>

enum { CLOSER_THREADS_MAX = 16 };

/* fd is taken. Below 0: nothing happens. */
void closer_close(int fd);
/* So many descriptors are being closed and hang that whoever caused it should not get another
 * connection: each one may add a thread and a descriptor. */
bool closer_is_full(void);

#endif
