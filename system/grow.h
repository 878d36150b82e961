/* Lets the data partition use the whole disk: partition table and kernel, then its file system. */
#ifndef GOPURA_SYSTEM_GROW_H
#define GOPURA_SYSTEM_GROW_H

#include "base/compiler.h"

/* Enlarges the last partition of `disk`, found by its name, as far as the disk allows, before what
 * is on it is opened. Does nothing if it is large enough. It may be interrupted at any instruction
 * and called again. Logs what was done, or why not. Returns 0 or a negative errno. */
must_check int grow_partition(const char *disk, const char *name);

/* Enlarges the ext4 file system on `device`, which is mounted at `folder`, to the size of the
 * device; otherwise the same. */
must_check int grow_files(const char *device, const char *folder);

#endif
