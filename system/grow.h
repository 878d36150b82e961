/* The data partition takes the whole card: table, kernel and file system of it. */
#ifndef GOPURA_SYSTEM_GROW_H
#define GOPURA_SYSTEM_GROW_H

#include "base/compiler.h"

/* The partition with this name, the last on the disk, and its ext4 that is mounted at folder,
 * become as large as the disk allows. Does nothing where they are; may be cut off at any
 * instruction and called again. Says what was done or why not; negative errno. */
must_check int grow(const char *disk, const char *name, const char *folder);

#endif
