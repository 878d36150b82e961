#include "system/disk_table.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/check.h"

/* A table is made here by hand, and read by hand, after UEFI 2.10, 5.3. */
enum {
	SECTOR = 512,
	MIB = 1 << 20,
	IMAGE_MIB = 16,
	CARD_MIB = 40,
	ENTRIES = 128 * 128,
	WRITES_MAX = 8,
};

struct write {
	uint64_t at;
	size_t size;
	bool sync;
};

/* What the module did to the disk, in order. */
static struct write writes[WRITES_MAX];
static unsigned write_count, fail_at;

ssize_t __real_pwrite(int fd, const void *data, size_t size, off_t at);
int __real_fsync(int fd);
ssize_t __wrap_pwrite(int fd, const void *data, size_t size, off_t at);
int __wrap_fsync(int fd);

static bool note(struct write write)
{
	CHECK(write_count < WRITES_MAX);
	writes[write_count++] = write;
	return write_count == fail_at;
}

ssize_t __wrap_pwrite(int fd, const void *data, size_t size, off_t at)
{
	if (note((struct write){ .at = (uint64_t)at, .size = size })) {
		errno = EIO;
		return -1;
	}
	return __real_pwrite(fd, data, size, at);
}

int __wrap_fsync(int fd)
{
	if (note((struct write){ .sync = true })) {
		errno = EIO;
		return -1;
	}
	return __real_fsync(fd);
}

static void put(uint8_t *at, unsigned size, uint64_t value)
{
	for (unsigned i = 0; i < size; i++)
		at[i] = (uint8_t)(value >> 8 * i);
}

static uint64_t get(const uint8_t *at, unsigned size)
{
	uint64_t value = 0;

	for (unsigned i = 0; i < size; i++)
		value |= (uint64_t)at[i] << 8 * i;
	return value;
}

static uint32_t crc(const uint8_t *data, size_t size)
{
	uint32_t value = 0xffffffff;

	for (size_t i = 0; i < size * 8; i++) {
		bool bit = (data[i / 8] >> i % 8 & 1) ^ (value & 1);
		value = value >> 1 ^ (bit ? 0xedb88320 : 0);
	}
	return ~value;
}

static uint8_t header[SECTOR], entries[ENTRIES];

static void entry(unsigned number, const char *name, uint64_t first_mib, uint64_t behind_mib)
{
	uint8_t *at = entries + (number - 1) * 128;

	at[0] = 0xaf;
	memset(at + 16, (int)(0x10 + number), 16);
	put(at + 32, 8, first_mib * 2048);
	put(at + 40, 8, behind_mib * 2048 - 1);
	for (unsigned i = 0; name[i]; i++)
		put(at + 56 + 2 * i, 2, (uint8_t)name[i]);
}

/* As image/assemble.sh has it: 6F707572-6100-4000-8000-0000000000FF. */
static const uint8_t image_identity[16] = { 0x72, 0x75, 0x70, 0x6f, 0x00, 0x61, 0x00, 0x40,
					    0x80, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xff };

static void write_header(int fd, uint64_t own, uint64_t other, uint64_t entries_at)
{
	memset(header, 0, sizeof(header));
	memcpy(header, "EFI PART\0\0\1", 12);
	put(header + 12, 4, 92);
	put(header + 24, 8, own);
	put(header + 32, 8, other);
	put(header + 40, 8, 2048);
	put(header + 48, 8, IMAGE_MIB * 2048 - 34);
	memcpy(header + 56, image_identity, 16);
	put(header + 72, 8, entries_at);
	put(header + 80, 4, 128);
	put(header + 84, 4, 128);
	put(header + 88, 4, crc(entries, ENTRIES));
	put(header + 16, 4, crc(header, 92));
	CHECK(__real_pwrite(fd, header, SECTOR, (off_t)own * SECTOR) == SECTOR);
	CHECK(__real_pwrite(fd, entries, ENTRIES, (off_t)entries_at * SECTOR) == ENTRIES);
}

/* An image of two partitions on a card that is larger. */
static int card(void)
{
	char path[] = "/tmp/gopura-table-XXXXXX";
	int fd = mkstemp(path);

	CHECK(fd >= 0 && unlink(path) == 0 && ftruncate(fd, CARD_MIB * (off_t)MIB) == 0);
	memset(entries, 0, sizeof(entries));
	entry(1, "gopura-esp", 1, 4);
	entry(2, "gopura-data", 4, IMAGE_MIB - 1);
	write_header(fd, 1, IMAGE_MIB * 2048 - 1, 2);
	write_header(fd, IMAGE_MIB * 2048 - 1, 1, IMAGE_MIB * 2048 - 33);
	write_count = fail_at = 0;
	return fd;
}

/* The data partition's size by the header in a sector, as firmware and kernel read it; 0: not
 * valid. */
static uint64_t data_mib(int fd, uint64_t sector)
{
	uint8_t head[SECTOR], list[ENTRIES], sum[4];
	const uint8_t *data = list + 128;

	CHECK(pread(fd, head, SECTOR, (off_t)sector * SECTOR) == SECTOR);
	memcpy(sum, head + 16, 4);
	memset(head + 16, 0, 4);
	if (memcmp(head, "EFI PART", 8) != 0 || crc(head, 92) != get(sum, 4) ||
	    get(head + 24, 8) != sector)
		return 0;
	CHECK(pread(fd, list, ENTRIES, (off_t)get(head + 72, 8) * SECTOR) == ENTRIES);
	if (crc(list, ENTRIES) != get(head + 88, 4))
		return 0;
	CHECK(get(list + 32, 8) == 2048 && get(list + 40, 8) == 4 * 2048 - 1);
	CHECK(get(data + 32, 8) == 4 * 2048);
	CHECK(get(data + 40, 8) <= get(head + 48, 8));
	return (get(data + 40, 8) + 1 - get(data + 32, 8)) / 2048;
}

static int grow(int fd, uint64_t mib, struct disk_part *part)
{
	return disk_table_grow(fd, mib * MIB, "gopura-data", part);
}

static void takes_what_a_larger_card_has(void **state)
{
	struct disk_part part;
	int fd = card();

	(void)state;
	CHECK(grow(fd, CARD_MIB, &part) == 0);
	CHECK(part.grown && part.number == 2);
	CHECK(part.start_bytes == 4 * MIB && part.size_bytes == (CARD_MIB - 5) * (uint64_t)MIB);
	CHECK(data_mib(fd, 1) == CARD_MIB - 5);
	CHECK(data_mib(fd, CARD_MIB * 2048 - 1) == CARD_MIB - 5);
	close(fd);
}

static void leaves_a_table_that_fills_its_card(void **state)
{
	struct disk_part part;
	int fd = card();

	(void)state;
	CHECK(grow(fd, IMAGE_MIB, &part) == 0);
	CHECK(!part.grown && part.size_bytes == (IMAGE_MIB - 5) * (uint64_t)MIB &&
	      write_count == 0);
	CHECK(grow(fd, CARD_MIB, &part) == 0 && part.grown);
	write_count = 0;
	CHECK(grow(fd, CARD_MIB, &part) == 0 && !part.grown && write_count == 0);
	close(fd);
}

static void grows_again_on_a_larger_card_yet(void **state)
{
	struct disk_part part;
	int fd = card();

	(void)state;
	CHECK(grow(fd, CARD_MIB, &part) == 0);
	write_count = 0;
	CHECK(ftruncate(fd, 2 * CARD_MIB * (off_t)MIB) == 0);
	CHECK(grow(fd, 2 * CARD_MIB, &part) == 0 && part.grown);
	CHECK(data_mib(fd, 1) == 2 * CARD_MIB - 5);
	close(fd);
}

/* Whatever of the unsynced writes is lost: until the first sync no sector of the table that holds
 * is touched, after it a single one is. */
static void the_table_that_holds_is_changed_by_one_sector(void **state)
{
	const uint64_t table_bytes = 34 * SECTOR;
	struct disk_part part;
	int fd = card();
	unsigned i;

	(void)state;
	CHECK(grow(fd, CARD_MIB, &part) == 0);
	for (i = 0; i < write_count && !writes[i].sync; i++)
		CHECK(writes[i].at >= table_bytes && (writes[i].at + writes[i].size <= 4 * MIB ||
						      writes[i].at >= IMAGE_MIB * MIB));
	CHECK(i + 3 == write_count);
	CHECK(!writes[i + 1].sync && writes[i + 1].at == SECTOR && writes[i + 1].size == SECTOR);
	CHECK(writes[i + 2].sync);
	close(fd);
}

static void after_a_failed_write_the_table_is_the_old_or_the_new_one(void **state)
{
	struct disk_part part;

	(void)state;
	for (unsigned failing = 1; failing <= 6; failing++) {
		int fd = card();
		uint64_t mib;

		fail_at = failing;
		CHECK(grow(fd, CARD_MIB, &part) == -EIO);
		mib = data_mib(fd, 1);
		CHECK(mib == IMAGE_MIB - 5 || (failing == 6 && mib == CARD_MIB - 5));
		fail_at = write_count = 0;
		CHECK(grow(fd, CARD_MIB, &part) == 0);
		CHECK(data_mib(fd, 1) == CARD_MIB - 5);
		close(fd);
	}
}

static void refuses_a_damaged_table(void **state)
{
	static const off_t places[] = { SECTOR, SECTOR + 20, SECTOR + 90, 2 * SECTOR + 170 };
	struct disk_part part;

	(void)state;
	for (unsigned i = 0; i < sizeof(places) / sizeof(*places); i++) {
		int fd = card();

		CHECK(__real_pwrite(fd, "\xa5", 1, places[i]) == 1);
		CHECK(grow(fd, CARD_MIB, &part) == -EBADMSG && write_count == 0);
		close(fd);
	}
}

static void refuses_a_partition_that_is_not_there_or_not_last(void **state)
{
	struct disk_part part;
	int fd = card();

	(void)state;
	CHECK(disk_table_grow(fd, CARD_MIB * (uint64_t)MIB, "gopura-dat", &part) == -ENOENT);
	CHECK(disk_table_grow(fd, CARD_MIB * (uint64_t)MIB, "gopura-esp", &part) == -ENOTSUP);
	CHECK(write_count == 0);
	close(fd);
}

static void leaves_a_card_that_is_smaller_than_its_table(void **state)
{
	struct disk_part part;
	int fd = card();

	(void)state;
	CHECK(grow(fd, 8, &part) == 0 && !part.grown && write_count == 0);
	close(fd);
}

/* The identity of the disk (0) or of a partition, by the header in sector 1. */
static void identity_of(int fd, unsigned number, uint8_t out[16])
{
	uint8_t head[SECTOR];
	off_t at = SECTOR + 56;

	CHECK(pread(fd, head, SECTOR, SECTOR) == SECTOR);
	if (number > 0)
		at = (off_t)get(head + 72, 8) * SECTOR + (number - 1) * 128 + 16;
	CHECK(pread(fd, out, 16, at) == 16);
}

static void a_disk_gets_an_identity_of_its_own_once(void **state)
{
	uint8_t before[3][16], after[3][16], again[3][16];
	bool renewed;
	int fd = card();

	(void)state;
	for (unsigned i = 0; i < 3; i++)
		identity_of(fd, i, before[i]);
	CHECK(disk_table_renew(fd, CARD_MIB * (uint64_t)MIB, "gopura-esp", &renewed) == 0);
	CHECK(renewed && data_mib(fd, 1) == IMAGE_MIB - 5);
	CHECK(data_mib(fd, CARD_MIB * 2048 - 1) == IMAGE_MIB - 5);
	for (unsigned i = 0; i < 3; i++)
		identity_of(fd, i, after[i]);
	CHECK(memcmp(before[0], after[0], 16) != 0); /* the disk */
	CHECK(memcmp(before[1], after[1], 16) == 0); /* the loader's, which firmware remembers */
	CHECK(memcmp(before[2], after[2], 16) != 0);
	CHECK(memcmp(after[0], after[2], 16) != 0);
	write_count = 0;
	CHECK(disk_table_renew(fd, CARD_MIB * (uint64_t)MIB, "gopura-esp", &renewed) == 0);
	CHECK(!renewed && write_count == 0);
	for (unsigned i = 0; i < 3; i++) {
		identity_of(fd, i, again[i]);
		CHECK(memcmp(after[i], again[i], 16) == 0);
	}
	close(fd);
}

static void an_identity_is_left_where_a_second_table_has_no_room(void **state)
{
	bool renewed;
	int fd = card();

	(void)state;
	CHECK(disk_table_renew(fd, 8 * (uint64_t)MIB, "gopura-esp", &renewed) == -ENOTSUP);
	CHECK(!renewed && write_count == 0);
	close(fd);
}

static void after_a_failed_write_the_identity_is_the_old_or_a_new_one(void **state)
{
	(void)state;
	for (unsigned failing = 1; failing <= 6; failing++) {
		int fd = card();
		bool renewed;

		fail_at = failing;
		CHECK(disk_table_renew(fd, CARD_MIB * (uint64_t)MIB, "gopura-esp", &renewed) ==
		      -EIO);
		CHECK(!renewed && data_mib(fd, 1) == IMAGE_MIB - 5);
		close(fd);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(takes_what_a_larger_card_has),
		cmocka_unit_test(leaves_a_table_that_fills_its_card),
		cmocka_unit_test(grows_again_on_a_larger_card_yet),
		cmocka_unit_test(the_table_that_holds_is_changed_by_one_sector),
		cmocka_unit_test(after_a_failed_write_the_table_is_the_old_or_the_new_one),
		cmocka_unit_test(refuses_a_damaged_table),
		cmocka_unit_test(refuses_a_partition_that_is_not_there_or_not_last),
		cmocka_unit_test(leaves_a_card_that_is_smaller_than_its_table),
		cmocka_unit_test(a_disk_gets_an_identity_of_its_own_once),
		cmocka_unit_test(an_identity_is_left_where_a_second_table_has_no_room),
		cmocka_unit_test(after_a_failed_write_the_identity_is_the_old_or_a_new_one),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
