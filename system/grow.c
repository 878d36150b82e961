/* Enlarges the data partition at boot: first the partition table and the kernel's view of the
 * partition, later the mounted ext4 file system, which may be on an encrypted device on top. */
#include "system/grow.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/blkpg.h>
#include <linux/fs.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/statfs.h>
#include <unistd.h>

#include "base/log.h"
#include "system/disk_table.h"

/* From the kernel's fs/ext4/ext4.h; no user-space header defines it. */
#define EXT4_RESIZE _IOW('f', 16, uint64_t)

enum { MIB = 1 << 20 };

/* Tells the kernel the new size. It rereads a partition table only if nothing on the disk is
 * mounted. */
static int tell_kernel(int fd, const struct disk_part *part)
{
	struct blkpg_partition partition = {
		.start = (long long)part->start_bytes,
		.length = (long long)part->size_bytes,
		.pno = (int)part->number,
	};
	struct blkpg_ioctl_arg argument = {
		.op = BLKPG_RESIZE_PARTITION,
		.datalen = sizeof(partition),
		.data = &partition,
	};

	return ioctl(fd, BLKPG, &argument) < 0 ? -errno : 0;
}

/* Renews the GUIDs. A failure is only logged: the terminal also starts with those of the image. */
static void renew_table(int fd, uint64_t disk_bytes, const char *disk)
{
	bool renewed;
	int rc = disk_table_renew(fd, disk_bytes, "gopura-esp", &renewed);

	if (rc < 0)
		log_warn("setup", "%s: the disk could not get its own identity: %s", disk,
			 strerror(-rc));
	else if (renewed)
		log_info("setup", "%s: the disk has its own identity now", disk);
}

static int grow_table(const char *disk, const char *name, struct disk_part *part)
{
	uint64_t disk_bytes;
	int sector, rc, fd = open(disk, O_RDWR | O_CLOEXEC);

	if (fd < 0)
		return -errno;
	if (ioctl(fd, BLKGETSIZE64, &disk_bytes) < 0 || ioctl(fd, BLKSSZGET, &sector) < 0)
		rc = -errno;
	else if (sector != 512)
		rc = -ENOTSUP;
	else
		rc = disk_table_grow(fd, disk_bytes, name, part);
	if (rc == 0 && part->grown)
		rc = tell_kernel(fd, part);
	if (rc == 0)
		renew_table(fd, disk_bytes, disk);
	close(fd);
	return rc;
}

int grow_partition(const char *disk, const char *name)
{
	struct disk_part part = { 0 };
	const int rc = grow_table(disk, name, &part);

	if (rc < 0)
		log_warn("setup", "%s: partition %s could not be enlarged: %s", disk, name,
			 strerror(-rc));
	else if (part.grown)
		log_info("setup", "%s: partition %s was enlarged to %llu MiB", disk, name,
			 (unsigned long long)(part.size_bytes / MIB));
	return rc;
}

static int size_of(const char *device, uint64_t *bytes)
{
	int rc, fd = open(device, O_RDONLY | O_CLOEXEC);

	if (fd < 0)
		return -errno;
	rc = ioctl(fd, BLKGETSIZE64, bytes) < 0 ? -errno : 0;
	close(fd);
	return rc;
}

static int resize_mounted(const char *folder, uint64_t bytes)
{
	struct statfs facts;
	uint64_t blocks;
	int rc = 0, fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);

	if (fd < 0)
		return -errno;
	if (fstatfs(fd, &facts) < 0) {
		rc = -errno;
	} else {
		blocks = bytes / (uint64_t)facts.f_bsize;
		rc = ioctl(fd, EXT4_RESIZE, &blocks) < 0 ? -errno : 0;
	}
	close(fd);
	return rc;
}

int grow_files(const char *device, const char *folder)
{
	uint64_t bytes = 0;
	int rc = size_of(device, &bytes);

	if (rc == 0)
		rc = resize_mounted(folder, bytes);
	if (rc < 0)
		log_warn("setup", "%s: the file system on %s could not be enlarged: %s", folder,
			 device, strerror(-rc));
	return rc;
}
