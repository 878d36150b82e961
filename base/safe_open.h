/* Opens files for reading so that a file made by somebody else cannot harm the reader: a FIFO or a
 * device could make the reader wait or read for ever, and a link could lead to any file of the
 * machine. */
#ifndef GOPURA_BASE_SAFE_OPEN_H
#define GOPURA_BASE_SAFE_OPEN_H

#include "base/compiler.h"

/* Both return a descriptor of a regular file, owned by the caller, or a negative errno. Neither
 * waits for the other end of a FIFO. open_problem explains the errno. */

/* Opens a path that we or the operator chose; links are followed. -EISDIR: a folder. -ENOTSUP: a
 * FIFO, a device or a socket. */
must_check int open_regular(const char *path);
/* Opens a name from a foreign file or medium, below a folder that we trust ("": the current one).
 * The name may contain folders ("root/1.json"). Errors as open_regular, and:
 *   -EXDEV  the name leads out of the folder: "..", an absolute path, another file system
 *   -ELOOP  a component of the name is a link */
must_check int open_beneath(const char *folder, const char *name);

/* Returns what a negative errno of these functions means and how to correct it, such as "it is a
 * folder; put a file there". Static, or strerror's. */
const char *open_problem(int rc);

#endif
