/* Lets the data partition use the whole disk: partition table, kernel and file system. */
#ifndef GOPURA_SYSTEM_GROW_H
#define GOPURA_SYSTEM_GROW_H

#include "base/compiler.h"

/* Enlarges the last partition of `disk`, found by its name, and the ext4 file system on it, which
 * is mounted at `folder`, as far as the disk allows. Does nothing if both are large enough. It may
 * be interrupted at any instruction and called again. Logs what was done, or why not. Returns 0 or
 * a negative errno. */
must_check int grow(const char *disk, const char *name, const char *folder);

#endif
