/* A disk's table of partitions (GPT), in which the last partition takes what a larger disk has
 * more.
 *
 * The power may go at any instruction, and a table that is half written is a terminal that does not
 * start. So nothing is changed where it stands: the entries with the larger partition are written
 * to a second place behind the first, and the copy of the table to the disk's new end. When both
 * are safe the header, one sector, is written over, and names the new place. Before that sector the
 * old table holds, after it the new one. */
#ifndef GOPURA_SYSTEM_DISK_TABLE_H
#define GOPURA_SYSTEM_DISK_TABLE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

struct disk_part {
	uint32_t number; /* as the kernel counts, from 1 */
	uint64_t start_bytes, size_bytes;
	bool grown; /* by this call */
};

/* Finds the partition by its name, which is ASCII, and lets it end with the disk, to a MiB.
 * disk_bytes is the disk's size. The disk's sectors have 512 bytes. -ENOENT: there is no such
 * partition   -EBADMSG: the table is damaged, or none -ENOTSUP: another partition lies behind it,
 * or a table is not as ours are   others: as pread, pwrite, fsync */
must_check int disk_table_grow(int fd, uint64_t disk_bytes, const char *name,
			       struct disk_part *out);

/* Gives the disk and its partitions random identities (GUIDs) where the disk still has that of the
 * image, which everybody knows: the loader names the partition to start from by its identity. The
 * partition `keep` keeps its own, for firmware remembers the loader by it. *renewed: the table was
 * written, in the same safe way. Results as above; -ENOTSUP: there is no room for a second table.
 */
must_check int disk_table_renew(int fd, uint64_t disk_bytes, const char *keep, bool *renewed);

#endif
