/* Walls around the calling process, for code that reads what others made: after them it computes on
 * what it holds and can ask the kernel for almost nothing else. No wall can be taken down again,
 * and a child inherits them. For a process with one thread. */
#ifndef GOPURA_PIPELINE_IMPORT_LOCKDOWN_H
#define GOPURA_PIPELINE_IMPORT_LOCKDOWN_H

#include "base/compiler.h"

/* Landlock: no file can be opened, made, changed or removed by its name any more. Open descriptors
 * stay usable. -EOPNOTSUPP: this kernel has no Landlock, or it is switched off. */
must_check int lockdown_files(void);

/* seccomp: every system call but a short list (memory, reading and writing open descriptors,
 * clocks, the end of the process) fails with EPERM. No memory can be made executable.
 * -EOPNOTSUPP: this kernel has no seccomp, or this processor has no list here. */
must_check int lockdown_calls(void);

#endif
