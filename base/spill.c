/* Keeps a list of the large arrays, each a mapping of a file. */
#include "base/spill.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/bytes.h"

enum { ARRAYS_MAX = 4096 };

struct large {
	void *array;   /* what the caller has */
	uint8_t *base; /* of the mapping */
	size_t bytes;  /* of the mapping */
	int fd;        /* -1: read only */
};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static struct large large[ARRAYS_MAX];
static uint32_t large_count;
static char own_folder[BYTES_PATH_MAX];

void spill_set_folder(const char *folder)
{
	pthread_mutex_lock(&lock);
	snprintf(own_folder, sizeof(own_folder), "%s", folder);
	pthread_mutex_unlock(&lock);
}

/* Returns the descriptor of a new file without a name, or -1. */
static int open_unnamed(void)
{
	const char *folder = getenv("TMPDIR");
	char path[BYTES_PATH_MAX + 16];
	int fd;

	pthread_mutex_lock(&lock);
	if (own_folder[0])
		folder = own_folder;
	snprintf(path, sizeof(path), "%s/.spill-XXXXXX", folder && folder[0] ? folder : "/var/tmp");
	pthread_mutex_unlock(&lock);
	fd = mkostemp(path, O_CLOEXEC);
	if (fd >= 0)
		unlink(path);
	return fd;
}

/* Takes the entry into the list. Returns the caller's array, or NULL with errno; the entry's
 * mapping and descriptor are then released. */
static void *add(struct large entry)
{
	bool added = false;

	pthread_mutex_lock(&lock);
	if (large_count < ARRAYS_MAX) {
		large[large_count++] = entry;
		added = true;
	}
	pthread_mutex_unlock(&lock);
	if (added)
		return entry.array;
	munmap(entry.base, entry.bytes);
	if (entry.fd >= 0)
		close(entry.fd);
	errno = ENOMEM;
	return NULL;
}

/* Removes the entry of array from the list. False: it is not in it. */
static bool take(void *array, struct large *out)
{
	bool found = false;

	pthread_mutex_lock(&lock);
	for (uint32_t i = 0; i < large_count && !found; i++)
		if (large[i].array == array) {
			*out = large[i];
			large[i] = large[--large_count];
			found = true;
		}
	pthread_mutex_unlock(&lock);
	return found;
}

static void *alloc_large(size_t bytes)
{
	struct large entry = { .bytes = bytes, .fd = open_unnamed() };
	int rc;

	if (entry.fd < 0)
		return NULL;
	rc = posix_fallocate(entry.fd, 0, (off_t)bytes);
	if (rc == 0) {
		entry.base = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, entry.fd, 0);
		rc = entry.base == MAP_FAILED ? errno : 0;
	}
	if (rc != 0) {
		close(entry.fd);
		errno = rc;
		return NULL;
	}
	entry.array = entry.base;
	return add(entry);
}

void *spill_alloc(size_t bytes)
{
	return bytes < SPILL_MIN_BYTES ? calloc(1, bytes ? bytes : 1) : alloc_large(bytes);
}

const char *spill_folder_cure(int rc)
{
	return rc == -ENOENT || rc == -ENOTDIR || rc == -EACCES || rc == -EROFS
		       ? "no temporary file can be made in TMPDIR, or without it in /var/tmp; set "
			 "TMPDIR to a folder on a disk that may be written to"
		       : NULL;
}

static void *resize_large(struct large entry, size_t bytes)
{
	/* zeroed even if the array was larger once */
	int rc = ftruncate(entry.fd, (off_t)(bytes < entry.bytes ? bytes : entry.bytes)) < 0
			 ? errno
			 : posix_fallocate(entry.fd, 0, (off_t)bytes);
	void *moved = MAP_FAILED;

	if (rc == 0)
		moved = mremap(entry.base, entry.bytes, bytes, MREMAP_MAYMOVE);
	if (rc == 0 && moved == MAP_FAILED)
		rc = errno;
	if (rc == 0) {
		entry.base = entry.array = moved;
		entry.bytes = bytes;
	}
	moved = add(entry);
	if (rc == 0)
		return moved;
	errno = rc;
	return NULL;
}

static void *copy_to(void *to, void *array, size_t bytes)
{
	if (to && bytes)
		memcpy(to, array, bytes);
	if (to)
		spill_free(array);
	return to;
}

int spill_resize(void *array, size_t old_count, size_t count, size_t item_bytes)
{
	const size_t bytes = count * item_bytes;
	struct large entry;
	void *old, *resized;

	memcpy(&old, array, sizeof(old)); /* pointers to whatever type are kept alike */
	if (bytes >= SPILL_MIN_BYTES && old && take(old, &entry))
		resized = resize_large(entry, bytes);
	else
		resized = copy_to(spill_alloc(bytes), old,
				  (old_count < count ? old_count : count) * item_bytes);
	if (!resized)
		return -errno;
	memcpy(array, &resized, sizeof(resized));
	return 0;
}

/* ---- mapping files */

static void *read_part(int fd, uint64_t offset, size_t bytes)
{
	void *copy = malloc(bytes ? bytes : 1);
	int rc = copy ? bytes_read_at(fd, copy, bytes, offset) : -ENOMEM;

	if (rc == 0)
		return copy;
	free(copy);
	errno = -rc;
	return NULL;
}

void *spill_map(int fd, uint64_t offset, size_t bytes)
{
	const uint64_t page = (uint64_t)sysconf(_SC_PAGESIZE);
	size_t lead = (size_t)(offset % page);
	struct large entry = { .bytes = bytes + lead, .fd = -1 };

	if (bytes < SPILL_MIN_BYTES)
		return read_part(fd, offset, bytes);
	entry.base = mmap(NULL, entry.bytes, PROT_READ, MAP_SHARED, fd, (off_t)(offset - lead));
	if (entry.base == MAP_FAILED)
		return NULL;
	entry.array = entry.base + lead;
	return add(entry);
}

/* Whether the part lies in an array that is a file of its own. */
static bool is_in_file(const uint8_t *part)
{
	bool found = false;

	pthread_mutex_lock(&lock);
	for (uint32_t i = 0; i < large_count && !found; i++)
		found = large[i].fd >= 0 && part >= large[i].base &&
			part < large[i].base + large[i].bytes;
	pthread_mutex_unlock(&lock);
	return found;
}

void spill_discard(void *part, size_t bytes)
{
	const size_t page = (size_t)sysconf(_SC_PAGESIZE);
	const size_t lead = (page - (uintptr_t)part % page) % page;

	/* If the file system cannot do it, the space is freed with the array. */
	if (bytes >= lead + page && is_in_file(part))
		madvise((uint8_t *)part + lead, (bytes - lead) / page * page, MADV_REMOVE);
}

void spill_free(void *array)
{
	struct large entry;

	if (!array || !take(array, &entry)) {
		free(array);
		return;
	}
	munmap(entry.base, entry.bytes);
	if (entry.fd >= 0)
		close(entry.fd);
}

/* ---- resident pages */

/* Returns the bytes of files that are resident in this process; 0 if the kernel does not say. */
static uint64_t resident_bytes(void)
{
	char text[128] = "";
	unsigned long long whole, all, shared;
	int fd = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
	ssize_t size = fd < 0 ? -1 : read(fd, text, sizeof(text) - 1);

	if (fd >= 0)
		close(fd);
	if (size < 0 || sscanf(text, "%llu %llu %llu", &whole, &all, &shared) != 3)
		return 0;
	return shared * (uint64_t)sysconf(_SC_PAGESIZE);
}

void spill_breathe(void)
{
	if (resident_bytes() < SPILL_RESIDENT_BYTES)
		return;
	pthread_mutex_lock(&lock);
	for (uint32_t i = 0; i < large_count; i++)
		madvise(large[i].base, large[i].bytes, MADV_DONTNEED);
	pthread_mutex_unlock(&lock);
}
