/* Closes descriptors on separate threads, because close() may block. A TCP socket with SO_LINGER
 * set, passed to us by the other side, blocks in close() for as long as that option says; so does
 * the UNIX socket in whose queue it lies. The caller never waits. Any thread. */
#ifndef GOPURA_NET_CLOSER_H
#define GOPURA_NET_CLOSER_H

#include <stdbool.h>

enum { CLOSER_THREADS_MAX = 16 };

/* fd is taken. Does nothing if fd is negative. */
void closer_close(int fd);
/* Returns true when CLOSER_THREADS_MAX descriptors hang in close(), or wait for a thread that could
 * not be started; that is tried again first. Whoever caused this should get no new connection,
 * because each one may add another thread and descriptor. */
bool closer_is_full(void);

#endif
