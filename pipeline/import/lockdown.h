/* Restricts the calling process before it reads untrusted data: afterwards it can only compute with
 * what it has and can make few system calls. A restriction cannot be removed again, and child
 * processes inherit it. For a process with one thread. */
#ifndef GOPURA_PIPELINE_IMPORT_LOCKDOWN_H
#define GOPURA_PIPELINE_IMPORT_LOCKDOWN_H

#include "base/compiler.h"

/* Uses Landlock: no file can be opened, created, changed or removed by name any more. Open
 * descriptors stay usable. -EOPNOTSUPP: this kernel has no Landlock, or it is disabled. */
must_check int lockdown_files(void);

/* Uses seccomp: every system call outside a short list (memory, reading and writing open
 * descriptors, clocks, process exit) fails with EPERM. Memory cannot be made executable.
 * -EOPNOTSUPP: the kernel has no seccomp, or there is no list for this processor. */
must_check int lockdown_calls(void);

#endif
