/* Opens files for reading so that a file which somebody else made cannot harm who reads it: a FIFO
 * or a device would make the reader wait or read for ever, and a link could lead it to any file of
 * the machine. */
#ifndef GOPURA_BASE_SAFE_OPEN_H
#define GOPURA_BASE_SAFE_OPEN_H

#include "base/compiler.h"

/* Both give a descriptor of a regular file, or a negative errno. Neither waits for whoever is at
 * the other end of a FIFO. open_problem says in words what the errno means. */

/* A path that we or the operator chose: links are followed. -EISDIR: a folder. -ENOTSUP: a FIFO, a
 * device or a socket. */
must_check int open_regular(const char *path);
/* A name from a foreign file or a foreign medium, below a folder that is ours to trust ("": the
 * current one). The name may have folders in it ("root/1.json").
 *   -EXDEV  the name leads out of the folder: "..", an absolute path, another file system
 *   -ELOOP  a component of the name is a link
 * and as open_regular. */
must_check int open_beneath(const char *folder, const char *name);

/* "it is a link; copy the file itself": the fact and the cure, static. */
const char *open_problem(int rc);

#endif
