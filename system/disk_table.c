/* Reads and writes a GPT: enlarges the last partition and replaces the GUIDs of the image. The
 * entries alternate between two places, so that a power cut never leaves a half-written table. */
#include "system/disk_table.h"

#include <errno.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

#include "base/bytes.h"

enum {
	SECTOR = 512,
	ALIGN = 2048, /* in sectors: 1 MiB, the usual partition alignment */
	/* Offsets in the header, UEFI 2.10, section 5.3.2 */
	HEADER_BYTES = 92,
	HEADER_CRC = 16,
	HEADER_OWN = 24,
	HEADER_OTHER = 32,
	HEADER_FIRST_USABLE = 40,
	HEADER_LAST_USABLE = 48,
	HEADER_IDENTITY = 56,
	HEADER_ENTRIES = 72,
	HEADER_ENTRY_COUNT = 80,
	HEADER_ENTRY_BYTES = 84,
	HEADER_ENTRIES_CRC = 88,
	/* The partition entries, and the offsets in one entry */
	ENTRY_COUNT = 128,
	ENTRY_BYTES = 128,
	ENTRY_IDENTITY = 16,
	ENTRY_FIRST = 32,
	ENTRY_LAST = 40,
	ENTRY_NAME = 56,
	NAME_MAX = 36, /* UTF-16 code units */
	ENTRIES_BYTES = ENTRY_COUNT * ENTRY_BYTES,
	ENTRIES_SECTORS = ENTRIES_BYTES / SECTOR,
	PRIMARY = 1, /* sector of the primary header */
	/* first sector of each of the two places for the entries */
	PLACE_ONE = 2,
	PLACE_TWO = PLACE_ONE + ENTRIES_SECTORS,
	IDENTITY_BYTES = 16, /* a GUID in mixed-endian form */
};

/* The disk GUID that image/assemble.sh writes: 6F707572-6100-4000-8000-0000000000FF. */
static const uint8_t image_identity[IDENTITY_BYTES] = { 0x72, 0x75, 0x70, 0x6f, 0x00, 0x61,
							0x00, 0x40, 0x80, 0x00, 0x00, 0x00,
							0x00, 0x00, 0x00, 0xff };

struct table {
	uint8_t header[SECTOR];
	uint8_t entries[ENTRIES_BYTES];
};

static uint64_t get(const uint8_t *at, unsigned size)
{
	uint64_t value = 0;

	for (unsigned i = size; i-- > 0;)
		value = value << 8 | at[i];
	return value;
}

static void put(uint8_t *at, unsigned size, uint64_t value)
{
	for (unsigned i = 0; i < size; i++, value >>= 8)
		at[i] = (uint8_t)value;
}

/* CRC-32 as UEFI requires (IEEE 802.3, reflected). */
static uint32_t crc32_of(const uint8_t *data, size_t size)
{
	uint32_t crc = 0xffffffff;

	for (size_t i = 0; i < size; i++) {
		crc ^= data[i];
		for (int bit = 0; bit < 8; bit++)
			crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
	}
	return ~crc;
}

static uint32_t header_crc(const uint8_t header[SECTOR])
{
	uint8_t copy[HEADER_BYTES];

	memcpy(copy, header, sizeof(copy));
	put(copy + HEADER_CRC, 4, 0);
	return crc32_of(copy, sizeof(copy));
}

static int write_at(int fd, const uint8_t *data, size_t size, uint64_t sector)
{
	ssize_t done = pwrite(fd, data, size, (off_t)(sector * SECTOR));

	if (done < 0)
		return -errno;
	return (size_t)done == size ? 0 : -EIO;
}

static int sync_disk(int fd)
{
	return fsync(fd) < 0 ? -errno : 0;
}

static int read_table(struct table *table, int fd)
{
	uint64_t entries_at;
	int rc = bytes_read_at(fd, table->header, SECTOR, PRIMARY * SECTOR);

	if (rc < 0)
		return rc;
	if (memcmp(table->header, "EFI PART", 8) != 0 ||
	    get(table->header + HEADER_CRC, 4) != header_crc(table->header))
		return -EBADMSG;
	entries_at = get(table->header + HEADER_ENTRIES, 8);
	if (get(table->header + 12, 4) != HEADER_BYTES ||
	    get(table->header + HEADER_ENTRY_COUNT, 4) != ENTRY_COUNT ||
	    get(table->header + HEADER_ENTRY_BYTES, 4) != ENTRY_BYTES ||
	    (entries_at != PLACE_ONE && entries_at != PLACE_TWO))
		return -ENOTSUP;
	rc = bytes_read_at(fd, table->entries, ENTRIES_BYTES, entries_at * SECTOR);
	if (rc < 0)
		return rc;
	return crc32_of(table->entries, ENTRIES_BYTES) == get(table->header + HEADER_ENTRIES_CRC, 4)
		       ? 0
		       : -EBADMSG;
}

static bool has_name(const uint8_t *entry, const char *name)
{
	for (unsigned i = 0; i < NAME_MAX; i++) {
		if (get(entry + ENTRY_NAME + 2 * i, 2) != (uint8_t)name[i])
			return false;
		if (!name[i])
			return true;
	}
	return false;
}

/* Finds the entry with this name. -ENOTSUP: another partition lies behind it, or there is no room
 * for the second place of the entries. */
static int find(struct table *table, const char *name, uint8_t **out)
{
	uint8_t *found = NULL, *last = NULL;

	for (unsigned i = 0; i < ENTRY_COUNT; i++) {
		uint8_t *entry = table->entries + i * ENTRY_BYTES;
		uint64_t first = get(entry + ENTRY_FIRST, 8);

		if (first == 0)
			continue;
		if (first < PLACE_TWO + ENTRIES_SECTORS)
			return -ENOTSUP;
		if (!last || first > get(last + ENTRY_FIRST, 8))
			last = entry;
		if (has_name(entry, name))
			found = entry;
	}
	*out = found;
	return !found ? -ENOENT : found == last ? 0 : -ENOTSUP;
}

/* Completes a header: its own sector, that of the other header, the place of the entries, and the
 * CRC. */
static void seal(uint8_t header[SECTOR], uint64_t own, uint64_t other, uint64_t entries_at)
{
	put(header + HEADER_OWN, 8, own);
	put(header + HEADER_OTHER, 8, other);
	put(header + HEADER_ENTRIES, 8, entries_at);
	put(header + HEADER_CRC, 4, header_crc(header));
}

/* Writes the entries and the backup header, syncs, and then replaces the primary header. */
static int write_table(struct table *table, int fd, uint64_t sectors)
{
	uint64_t now_at = get(table->header + HEADER_ENTRIES, 8), copy = sectors - 1;
	uint64_t next_at = now_at == PLACE_ONE ? PLACE_TWO : PLACE_ONE;
	int rc;

	put(table->header + HEADER_FIRST_USABLE, 8, PLACE_TWO + ENTRIES_SECTORS);
	put(table->header + HEADER_LAST_USABLE, 8, copy - ENTRIES_SECTORS - 1);
	put(table->header + HEADER_ENTRIES_CRC, 4, crc32_of(table->entries, ENTRIES_BYTES));
	rc = write_at(fd, table->entries, ENTRIES_BYTES, next_at);
	if (rc == 0)
		rc = write_at(fd, table->entries, ENTRIES_BYTES, copy - ENTRIES_SECTORS);
	if (rc == 0) {
		seal(table->header, copy, PRIMARY, copy - ENTRIES_SECTORS);
		rc = write_at(fd, table->header, SECTOR, copy);
	}
	if (rc == 0)
		rc = sync_disk(fd);
	if (rc == 0) {
		seal(table->header, PRIMARY, copy, next_at);
		rc = write_at(fd, table->header, SECTOR, PRIMARY);
	}
	return rc == 0 ? sync_disk(fd) : rc;
}

int disk_table_grow(int fd, uint64_t disk_bytes, const char *name, struct disk_part *out)
{
	struct table table;
	uint8_t *entry = NULL;
	uint64_t first, last, behind, sectors = disk_bytes / SECTOR;
	int rc = read_table(&table, fd);

	if (rc == 0)
		rc = find(&table, name, &entry);
	if (rc < 0)
		return rc;
	first = get(entry + ENTRY_FIRST, 8);
	last = get(entry + ENTRY_LAST, 8);
	if (last < first)
		return -EBADMSG;
	behind = sectors < ALIGN ? 0 : (sectors - 1 - ENTRIES_SECTORS) / ALIGN * ALIGN;
	out->number = (uint32_t)((entry - table.entries) / ENTRY_BYTES + 1);
	out->start_bytes = first * SECTOR;
	out->grown = behind > last + 1;
	if (out->grown) {
		last = behind - 1;
		put(entry + ENTRY_LAST, 8, last);
		rc = write_table(&table, fd, sectors);
	}
	out->size_bytes = (last + 1 - first) * SECTOR;
	return rc;
}

/* Generates a random GUID, version 4. */
static int new_identity(uint8_t out[IDENTITY_BYTES])
{
	if (getrandom(out, IDENTITY_BYTES, 0) != IDENTITY_BYTES)
		return -EIO;
	out[7] = (uint8_t)((out[7] & 0x0f) | 0x40);
	out[8] = (uint8_t)((out[8] & 0x3f) | 0x80);
	return 0;
}

/* Returns whether both places of the entries, and the backup table at the end of the disk, lie
 * outside every partition. */
static bool has_room(const struct table *table, uint64_t sectors)
{
	for (unsigned i = 0; i < ENTRY_COUNT; i++) {
		const uint8_t *entry = table->entries + i * ENTRY_BYTES;
		const uint64_t first = get(entry + ENTRY_FIRST, 8);

		if (first > 0 && (first < PLACE_TWO + ENTRIES_SECTORS ||
				  get(entry + ENTRY_LAST, 8) + 1 + ENTRIES_SECTORS >= sectors))
			return false;
	}
	return true;
}

int disk_table_renew(int fd, uint64_t disk_bytes, const char *keep, bool *renewed)
{
	struct table table;
	int rc = read_table(&table, fd);

	*renewed = false;
	if (rc < 0 || memcmp(table.header + HEADER_IDENTITY, image_identity, IDENTITY_BYTES) != 0)
		return rc;
	if (!has_room(&table, disk_bytes / SECTOR))
		return -ENOTSUP;
	rc = new_identity(table.header + HEADER_IDENTITY);
	for (unsigned i = 0; i < ENTRY_COUNT && rc == 0; i++) {
		uint8_t *entry = table.entries + i * ENTRY_BYTES;

		if (get(entry + ENTRY_FIRST, 8) > 0 && !has_name(entry, keep))
			rc = new_identity(entry + ENTRY_IDENTITY);
	}
	if (rc == 0)
		rc = write_table(&table, fd, disk_bytes / SECTOR);
	*renewed = rc == 0;
	return rc;
}
