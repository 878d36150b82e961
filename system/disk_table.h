/* A disk's partition table (GPT): the last partition grows when the image lies on a larger disk.
 *
 * The power may fail at any instruction, and a terminal with a half-written table does not start.
 * So nothing is overwritten in place: the entries with the larger partition are written to a second
 * place behind the first, and the backup table to the new end of the disk. When both are on the
 * disk, the primary header, a single sector, is overwritten and refers to the new place. Before
 * that write the old table is valid, and after it the new one. */
#ifndef GOPURA_SYSTEM_DISK_TABLE_H
#define GOPURA_SYSTEM_DISK_TABLE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

struct disk_part {
	uint32_t number; /* as the kernel counts, from 1 */
	uint64_t start_bytes, size_bytes;
	bool grown; /* true if this call enlarged it */
};

/* Finds the partition by its ASCII name and extends it to the end of the disk, rounded down to 1
 * MiB. fd is borrowed. disk_bytes is the size of the disk; its sectors must have 512 bytes.
 * - -ENOENT: there is no such partition.
 * - -EBADMSG: the table is damaged or missing.
 * - -ENOTSUP: another partition lies behind it, or the table's layout is not the one we write.
 * - Others: as pread, pwrite, fsync. */
must_check int disk_table_grow(int fd, uint64_t disk_bytes, const char *name,
			       struct disk_part *out);

/* Gives the disk and its partitions random GUIDs if the disk still has the GUID of the image.
 * Everybody knows that GUID, and the boot loader chooses the partition to boot by GUID. The
 * partition named `keep` keeps its GUID, because the firmware remembers the boot loader by it.
 * *renewed: the table was written, in the same safe way. Errors as above; -ENOTSUP also if there is
 * no room for a second table. */
must_check int disk_table_renew(int fd, uint64_t disk_bytes, const char *keep, bool *renewed);

#endif
