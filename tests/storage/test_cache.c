#include "storage/cache.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "base/clock.h"
#include "tests/check.h"
#include "tests/storage/fault_vfs.h"

/* Time stands still unless a test moves it. */
static int64_t now_ms = 1000;

int64_t clock_now_ms(void)
{
	return now_ms;
}

int64_t clock_now_us(void)
{
	return now_ms * 1000;
}

int64_t clock_thread_us(void)
{
	return 0;
}

int64_t clock_wall_s(void)
{
	return 0;
}

/* The size of the disk, or how its file system fails. */
static uint64_t disk_bytes = UINT64_C(1) << 40;
static int disk_rc;

int statvfs(const char *name, struct statvfs *out)
{
	CHECK(strstr(name, "/gopura-cache-") || strstr(name, "/nonexistent/"));
	*out = (struct statvfs){ .f_frsize = 4096, .f_blocks = disk_bytes / 4096 };
	return disk_rc;
}

static char folder[64], path[96];
static uint8_t store[1 << 20];

static int enter_empty_folder(void **state)
{
	(void)state;
	now_ms = 1000;
	fault_set(FAULT_NONE, 0, 0);
	snprintf(folder, sizeof(folder), "/tmp/gopura-cache-XXXXXX");
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/cache.db", folder);
	return 0;
}

static int leave_folder(void **state)
{
	char command[128];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	return system(command);
}

static struct cache *open_cache(uint64_t budget)
{
	struct cache_options options = { .path = path, .budget_bytes = budget };
	struct cache *cache;

	CHECK(cache_create(&cache, &options) == 0);
	return cache;
}

/* Object n: its own bytes, from its number. Borrowed until the next call. */
static struct bytes object(uint32_t n, size_t size)
{
	uint64_t x = n * UINT64_C(2654435761) + 12345;

	for (size_t i = 0; i < size; i += sizeof(x)) {
		x = x * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
		memcpy(store + i, &x, size - i < sizeof(x) ? size - i : sizeof(x));
	}
	return (struct bytes){ store, size };
}

static int put(struct cache *cache, uint32_t n, size_t size, uint32_t priority)
{
	struct bytes bytes = object(n, size);

	return cache_put(cache, hash_of(bytes), bytes, priority);
}

static int get(struct cache *cache, uint32_t n, size_t size)
{
	struct bytes bytes = object(n, size);
	struct buffer back;
	int rc;

	buffer_init(&back, sizeof(store));
	rc = cache_get(cache, hash_of(bytes), 0, &back);
	if (rc == 0)
		CHECK(back.size == size && memcmp(back.data, bytes.data, size) == 0);
	buffer_finish(&back);
	return rc;
}

static bool exists(const char *suffix)
{
	char name[128];

	snprintf(name, sizeof(name), "%s%s", path, suffix);
	return access(name, F_OK) == 0;
}

static void gives_back_what_was_put_across_a_restart(void **state)
{
	struct cache *cache = open_cache(8 << 20);

	(void)state;
	CHECK(get(cache, 1, 5000) == -ENOENT);
	CHECK(put(cache, 1, 5000, 0) == 0);
	CHECK(put(cache, 1, 5000, 0) == 0); /* again is fine */
	CHECK(put(cache, 2, 100, 0) == 0);
	CHECK(get(cache, 1, 5000) == 0); /* before the transaction ended */
	CHECK(cache_needs_flush(cache));
	CHECK(cache_flush(cache) == 0 && !cache_needs_flush(cache));
	cache_destroy(cache);
	cache = open_cache(8 << 20);
	CHECK(get(cache, 1, 5000) == 0 && get(cache, 2, 100) == 0);
	cache_destroy(cache);
	cache_destroy(NULL);
	CHECK(!exists("-shm"));
}

static void holds_its_budget_under_churn(void **state)
{
	const uint64_t budget = 6 << 20;
	struct cache *cache = open_cache(budget);
	struct cache_figures figures;
	uint64_t most = 0;

	(void)state;
	for (uint32_t n = 0; n < 4000; n++) {
		size_t size = n % 97 == 0 ? 150000 : 200 + n * 7919 % 30000;

		CHECK(put(cache, n, size, n % 5 * 1000) == 0);
		if (n % 40 == 0)
			CHECK(cache_flush(cache) == 0);
		if (cache_file_bytes(cache) > most)
			most = cache_file_bytes(cache);
	}
	cache_figures(cache, &figures);
	CHECK(most <= budget);
	CHECK(figures.evicted > 3000);
	/* and it is used: no more than a third lies idle */
	CHECK(figures.object_bytes > budget / 8 * 7 / 3 * 2);
	CHECK(figures.file_bytes == cache_file_bytes(cache));
	cache_destroy(cache);
}

/* Puts objects until count were evicted. (To ask whether one is there would be a want of it.) */
static uint32_t put_until_evicted(struct cache *cache, uint64_t count, uint32_t next)
{
	struct cache_figures figures;

	do {
		CHECK(put(cache, next++, 50000, 0) == 0);
		CHECK(next < 300);
		cache_figures(cache, &figures);
	} while (figures.evicted < count);
	return next;
}

static void drops_the_least_useful_first(void **state)
{
	struct cache *cache = open_cache(CACHE_BUDGET_MIN);

	(void)state;
	CHECK(put(cache, 0, 50000, 1000000) == 0); /* an index page */
	CHECK(put(cache, 1, 50000, 0) == 0);
	CHECK(put(cache, 2, 50000, 0) == 0);
	CHECK(put(cache, 3, 50000, 64000) == 0); /* a tile worth much */
	CHECK(put(cache, 4, 50000, 0) == 0);
	now_ms += 3600 * 1000;
	CHECK(get(cache, 1, 50000) == 0); /* wanted again an hour later */
	now_ms += 1000;
	put_until_evicted(cache, 1, 100);
	CHECK(get(cache, 2, 50000) == -ENOENT);
	CHECK(get(cache, 1, 50000) == 0);
	put_until_evicted(cache, 30, 200);
	CHECK(get(cache, 4, 50000) == -ENOENT && get(cache, 1, 50000) == -ENOENT);
	CHECK(get(cache, 3, 50000) == 0);
	CHECK(get(cache, 0, 50000) == 0);
	cache_destroy(cache);
}

static void knows_what_was_wanted_before_a_restart(void **state)
{
	struct cache *cache = open_cache(CACHE_BUDGET_MIN);

	(void)state;
	now_ms += 7200 * 1000;
	CHECK(put(cache, 1, 50000, 0) == 0);
	CHECK(put(cache, 2, 50000, 0) == 0);
	cache_destroy(cache);
	now_ms = 50; /* a boot: the monotonic clock begins anew */
	cache = open_cache(CACHE_BUDGET_MIN);
	now_ms += 1000;
	CHECK(put(cache, 3, 50000, 0) == 0);
	put_until_evicted(cache, 1, 100);
	CHECK(get(cache, 1, 50000) == -ENOENT);
	CHECK(get(cache, 3, 50000) == 0);
	cache_destroy(cache);
}

static void keeps_what_it_was_told_to_keep(void **state)
{
	const struct hash first = { { 1 } }, second = { { 2 } }, third = { { 3 } };
	struct cache *cache = open_cache(CACHE_BUDGET_MIN);

	(void)state;
	CHECK(cache_use_release(cache, first) == 0);
	CHECK(put(cache, 1, 50000, 0) == 0);
	CHECK(cache_keep(cache, hash_of(object(1, 50000))) == 0);
	CHECK(cache_keep(cache, hash_of(object(2, 50000))) == 0); /* before it came */
	CHECK(put(cache, 2, 50000, 0) == 0);
	now_ms += 1000;
	for (uint32_t n = 100; n < 250; n++)
		CHECK(put(cache, n, 50000, 0) == 0);
	cache_destroy(cache);
	cache = open_cache(CACHE_BUDGET_MIN);
	CHECK(cache_use_release(cache, first) == 0); /* the same: kept still */
	for (uint32_t n = 250; n < 400; n++)
		CHECK(put(cache, n, 50000, 0) == 0);
	CHECK(get(cache, 1, 50000) == 0 && get(cache, 2, 50000) == 0);
	CHECK(cache_use_release(cache, second) == 0); /* the one before, whole still */
	now_ms += 1000;
	for (uint32_t n = 400; n < 550; n++)
		CHECK(put(cache, n, 50000, 0) == 0);
	CHECK(get(cache, 1, 50000) == 0 && get(cache, 2, 50000) == 0);
	CHECK(cache_use_release(cache, third) == 0);
	now_ms += 1000;
	for (uint32_t n = 550; n < 700; n++)
		CHECK(put(cache, n, 50000, 0) == 0);
	CHECK(get(cache, 1, 50000) == -ENOENT && get(cache, 2, 50000) == -ENOENT);
	cache_destroy(cache);
}

static void churn(struct cache *cache, uint32_t first)
{
	now_ms += 1000;
	for (uint32_t n = first; n < first + 150; n++)
		CHECK(put(cache, n, 50000, 0) == 0);
}

/* Object 1 is the first release's, 2 the second's, 3 of both. */
static void keeps_both_releases_across_a_return(void **state)
{
	const struct hash first = { { 1 } }, second = { { 2 } };
	struct cache *cache = open_cache(CACHE_BUDGET_MIN);

	(void)state;
	for (uint32_t n = 1; n <= 3; n++)
		CHECK(put(cache, n, 50000, 0) == 0);
	CHECK(cache_use_release(cache, first) == 0);
	CHECK(cache_keep(cache, hash_of(object(1, 50000))) == 0);
	CHECK(cache_keep(cache, hash_of(object(3, 50000))) == 0);
	CHECK(cache_use_release(cache, second) == 0);
	CHECK(cache_keep(cache, hash_of(object(2, 50000))) == 0);
	CHECK(cache_keep(cache, hash_of(object(3, 50000))) == 0);
	CHECK(cache_use_release(cache, first) == 0); /* it did not work */
	cache_destroy(cache);
	cache = open_cache(CACHE_BUDGET_MIN);
	churn(cache, 100);
	for (uint32_t n = 1; n <= 3; n++)
		CHECK(get(cache, n, 50000) == 0);
	CHECK(cache_use_release(cache, (struct hash){ { 9 } }) == 0);
	churn(cache, 300);
	CHECK(get(cache, 1, 50000) == 0 && get(cache, 3, 50000) == 0);
	CHECK(get(cache, 2, 50000) == -ENOENT); /* of the one that was returned from */
	cache_destroy(cache);
}

static void keeps_no_more_than_three_quarters(void **state)
{
	struct cache *cache = open_cache(CACHE_BUDGET_MIN);
	struct cache_figures figures;
	int rc = 0;

	(void)state;
	for (uint32_t n = 0; n < 100 && rc == 0; n++) {
		rc = cache_keep(cache, hash_of(object(n, 50000)));
		if (rc == 0)
			CHECK(put(cache, n, 50000, 0) == 0);
	}
	CHECK(rc == -ENOSPC);
	cache_figures(cache, &figures);
	CHECK(figures.kept_bytes <= CACHE_BUDGET_MIN / 4 * 3 + 50000);
	CHECK(put(cache, 200, 50000, 0) == 0); /* others still pass through */
	cache_destroy(cache);
}

static void gives_the_disk_back_when_the_budget_shrinks(void **state)
{
	struct cache *cache = open_cache(16 << 20);

	(void)state;
	for (uint32_t n = 0; n < 600; n++)
		CHECK(put(cache, n, 20000, 0) == 0);
	cache_destroy(cache);
	cache = open_cache(5 << 20);
	CHECK(cache_file_bytes(cache) <= 5 << 20);
	CHECK(get(cache, 599, 20000) == 0);
	for (uint32_t n = 600; n < 700; n++) {
		CHECK(put(cache, n, 20000, 0) == 0);
		CHECK(cache_file_bytes(cache) <= 5 << 20);
	}
	cache_destroy(cache);
}

static void unkeeps_nothing_where_a_write_fails_while_it_shrinks(void **state)
{
	struct cache *cache = open_cache(16 << 20);
	struct cache_figures figures;
	struct buffer file;
	long writes = 1;

	(void)state;
	for (uint32_t n = 0; n < 600; n++) {
		CHECK(put(cache, n, 20000, 0) == 0);
		if (n % 30 == 0)
			CHECK(cache_keep(cache, hash_of(object(n, 20000))) == 0);
	}
	cache_destroy(cache);
	buffer_init(&file, 16 << 20);
	CHECK(buffer_read_file(&file, path) == 0);
	for (long at = 0; at < writes; at += 1 + writes / 100) {
		CHECK(bytes_write_file(buffer_bytes(&file), path) == 0);
		fault_set(FAULT_FULL, at, 1);
		cache = open_cache(5 << 20);
		writes = fault.writes > writes ? fault.writes : writes;
		fault_set(FAULT_NONE, 0, 0);
		now_ms += 60000;
		CHECK(get(cache, 30, 20000) == 0);
		cache_figures(cache, &figures);
		CHECK(figures.kept_bytes == 20 * 20000);
		cache_destroy(cache);
	}
	CHECK(writes > 100);
	buffer_finish(&file);
}

static void refuses_what_can_never_fit(void **state)
{
	struct cache *cache = open_cache(CACHE_BUDGET_MIN);

	(void)state;
	CHECK(put(cache, 1, sizeof(store), 0) == -EFBIG);
	CHECK(put(cache, 1, 120000, 0) == 0);
	cache_destroy(cache);
}

static void keeps_the_locators_of_this_release_and_the_last(void **state)
{
	const struct hash first = { { 1 } }, second = { { 2 } };
	struct cache *cache = open_cache(8 << 20);
	struct buffer back;

	(void)state;
	buffer_init(&back, sizeof(store));
	CHECK(cache_use_release(cache, first) == 0);
	CHECK(cache_put_file(cache, first, object(1, 70000)) == 0);
	CHECK(cache_put_file(cache, second, object(2, 100)) == 0);
	cache_destroy(cache);
	cache = open_cache(8 << 20);
	CHECK(cache_get_file(cache, first, &back) == 0 && back.size == 70000);
	CHECK(cache_use_release(cache, second) == 0);
	CHECK(cache_get_file(cache, first, &back) == 0); /* to be returned to */
	CHECK(cache_get_file(cache, second, &back) == 0 && back.size == 100);
	CHECK(cache_use_release(cache, (struct hash){ { 3 } }) == 0);
	CHECK(cache_get_file(cache, first, &back) == -ENOENT);
	CHECK(cache_get_file(cache, second, &back) == 0);
	buffer_finish(&back);
	cache_destroy(cache);
}

/* ---- damage */

static void change_bytes(long at, const char *with, size_t size)
{
	FILE *file = fopen(path, "r+b");

	CHECK(file && fseek(file, at, SEEK_SET) == 0);
	CHECK(fwrite(with, 1, size, file) == size);
	fclose(file);
}

static void drops_an_object_whose_bytes_changed(void **state)
{
	struct cache *cache = open_cache(8 << 20);
	struct bytes bytes;
	struct buffer file;
	uint8_t *at;

	(void)state;
	CHECK(put(cache, 1, 40000, 0) == 0 && put(cache, 2, 40000, 0) == 0);
	cache_destroy(cache);
	buffer_init(&file, 8 << 20);
	CHECK(buffer_read_file(&file, path) == 0);
	bytes = object(1, 40000);
	at = memmem(file.data, file.size, bytes.data + 30000, 64);
	CHECK(at);
	change_bytes(at - file.data, "ha", 2);
	buffer_finish(&file);
	cache = open_cache(8 << 20);
	CHECK(get(cache, 1, 40000) == -EBADMSG);
	CHECK(get(cache, 1, 40000) == -ENOENT); /* dropped */
	CHECK(get(cache, 2, 40000) == 0);
	CHECK(put(cache, 1, 40000, 0) == 0 && get(cache, 1, 40000) == 0);
	cache_destroy(cache);
	CHECK(!exists(".broken"));
}

static void sets_what_is_no_database_aside(void **state)
{
	struct cache *cache = open_cache(8 << 20);
	struct cache_figures figures;
	struct stat info;
	char broken[128];

	(void)state;
	for (uint32_t n = 0; n < 100; n++)
		CHECK(put(cache, n, 20000, 0) == 0);
	cache_destroy(cache);
	change_bytes(0, "this was a cache once", 21);
	cache = open_cache(8 << 20);
	CHECK(exists(".broken"));
	snprintf(broken, sizeof(broken), "%s.broken", path);
	CHECK(stat(broken, &info) == 0 && info.st_size <= 1 << 20);
	CHECK(get(cache, 1, 20000) == -ENOENT);
	CHECK(put(cache, 1, 20000, 0) == 0 && get(cache, 1, 20000) == 0);
	cache_figures(cache, &figures);
	CHECK(figures.set_aside == 1);
	cache_destroy(cache);
}

/* Whatever happened to the file: no crash, never wrong bytes, and it takes objects again. */
static void survives(void)
{
	struct cache *cache = open_cache(8 << 20);

	for (uint32_t n = 0; n < 60; n++) {
		int rc = get(cache, n, 3000 + n * 500);

		CHECK(rc == 0 || rc == -ENOENT || rc == -EBADMSG || rc == -EIO);
	}
	for (uint32_t n = 0; n < 20; n++) {
		int rc = put(cache, 1000 + n, 5000, 0);

		CHECK(rc == 0 || rc == -EIO); /* -EIO: found the damage just now */
	}
	CHECK(put(cache, 2000, 5000, 0) == 0 && cache_flush(cache) == 0);
	CHECK(get(cache, 2000, 5000) == 0);
	cache_destroy(cache);
}

static void make_healthy(struct buffer *file)
{
	struct cache *cache = open_cache(8 << 20);

	for (uint32_t n = 0; n < 60; n++)
		CHECK(put(cache, n, 3000 + n * 500, 0) == 0);
	cache_destroy(cache);
	buffer_init(file, 16 << 20);
	CHECK(buffer_read_file(file, path) == 0);
}

static void survives_every_kind_of_truncated_file(void **state)
{
	struct buffer file;

	(void)state;
	make_healthy(&file);
	for (size_t n = 0; n < file.size; n += n < 8192 ? 509 : file.size / 37) {
		CHECK(bytes_write_file((struct bytes){ file.data, n }, path) == 0);
		survives();
	}
	buffer_finish(&file);
}

static void survives_flipped_bits(void **state)
{
	struct buffer file;
	uint32_t x = 7;

	(void)state;
	make_healthy(&file);
	for (int round = 0; round < 80; round++) {
		uint8_t *copy = malloc(file.size);

		memcpy(copy, file.data, file.size);
		for (int flip = 0; flip <= round % 8; flip++) {
			x = x * 1664525 + 1013904223;
			/* half of them where the structure lies */
			copy[(x >> 4) % (round % 2 ? 16384 : file.size)] ^= (uint8_t)(1u << x % 8);
		}
		CHECK(bytes_write_file((struct bytes){ copy, file.size }, path) == 0);
		free(copy);
		survives();
	}
	buffer_finish(&file);
}

/* ---- faults */

/* A short life of a cache; every call may fail, none may do worse. */
static void live(void)
{
	struct cache *cache = open_cache(CACHE_BUDGET_MIN);

	for (uint32_t n = 0; n < 150; n++) {
		int rc = put(cache, n, 1000 + n % 7 * 9000, 0);

		CHECK(rc == 0 || rc == -ENOSPC || rc == -EIO);
		rc = get(cache, n / 2, 1000 + n / 2 % 7 * 9000);
		CHECK(rc == 0 || rc == -ENOENT || rc == -EIO);
		if (n % 30 == 0) {
			rc = cache_flush(cache);
			CHECK(rc == 0 || rc == -ENOSPC || rc == -EIO);
		}
		CHECK(cache_file_bytes(cache) <= CACHE_BUDGET_MIN);
	}
	cache_destroy(cache);
}

static void empty_folder(void)
{
	char command[128];

	snprintf(command, sizeof(command), "rm -f %s*", path);
	CHECK(system(command) == 0);
}

#ifdef __SANITIZE_ADDRESS__ /* the release build fails each of the first */
enum { FAILED_STEP = 3 };
#else
enum { FAILED_STEP = 1 };
#endif

static void goes_on_after_any_write_failed(void **state)
{
	static const enum fault_kind kinds[] = { FAULT_FULL, FAULT_IO, FAULT_POWER_CUT };
	long writes;

	(void)state;
	fault_set(FAULT_NONE, 0, 0);
	live();
	writes = fault.writes;
	CHECK(writes > 300);
	for (size_t kind = 0; kind < ARRAY_COUNT(kinds); kind++) {
		for (long at = 0; at < writes; at += at < 40 ? FAILED_STEP : writes / 12) {
			empty_folder();
			fault_set(kinds[kind], at, kinds[kind] == FAULT_POWER_CUT ? 0 : 1 + at % 3);
			live();
			fault_set(FAULT_NONE, 0, 0);
			live();                    /* the next start */
			CHECK(!exists(".broken")); /* faults are no damage */
		}
	}
}

static void takes_no_failed_read_for_damage(void **state)
{
	struct cache *cache = open_cache(8 << 20);
	long reads;

	(void)state;
	CHECK(put(cache, 1, 20000, 0) == 0);
	cache_destroy(cache);
	fault_set(FAULT_NONE, 0, 0);
	cache = open_cache(8 << 20);
	CHECK(get(cache, 1, 20000) == 0);
	cache_destroy(cache);
	reads = fault.reads;
	CHECK(reads > 7);
	for (long at = 0; at < reads; at++) {
		fault_set(FAULT_READ, at, 1);
		cache = open_cache(8 << 20);
		(void)get(cache, 1, 20000);
		fault_set(FAULT_NONE, 0, 0);
		now_ms += 600000; /* it tries again */
		CHECK(get(cache, 1, 20000) == 0 && !exists(".broken"));
		cache_destroy(cache);
	}
}

static void tolerates_a_disk_that_stays_full(void **state)
{
	struct cache *cache = open_cache(8 << 20);
	struct cache_figures figures;
	int rc = 0;

	(void)state;
	CHECK(put(cache, 1, 20000, 0) == 0 && cache_flush(cache) == 0);
	fault_set(FAULT_FULL, 0, 0);
	for (uint32_t n = 2; n < 300 && rc == 0; n++)
		rc = put(cache, n, 20000, 0);
	CHECK(rc == -ENOSPC);
	CHECK(get(cache, 1, 20000) == 0); /* what is there stays usable */
	cache_figures(cache, &figures);
	CHECK(figures.refused_writes > 0);
	fault_set(FAULT_NONE, 0, 0);
	CHECK(put(cache, 500, 20000, 0) == 0 && cache_flush(cache) == 0);
	cache_destroy(cache);
}

/* Who syncs goes on to say that what was put is safe. */
static void a_sync_tells_once_of_what_the_disk_refused(void **state)
{
	struct cache *cache = open_cache(8 << 20);

	(void)state;
	CHECK(put(cache, 1, 20000, 0) == 0 && cache_sync(cache) == 0);
	fault_set(FAULT_FULL, 0, 0);
	CHECK(put(cache, 2, 20000, 0) == 0 && cache_flush(cache) == -ENOSPC);
	fault_set(FAULT_NONE, 0, 0);
	CHECK(put(cache, 3, 20000, 0) == 0 && cache_sync(cache) == -EIO);
	CHECK(cache_sync(cache) == 0);
	CHECK(get(cache, 2, 20000) == -ENOENT && get(cache, 3, 20000) == 0);
	cache_destroy(cache);
}

/* It would never be stored, however often it is put. */
static void a_sync_tells_nothing_of_what_has_no_room(void **state)
{
	struct cache *cache = open_cache(CACHE_BUDGET_MIN);
	uint32_t n = 0;
	int rc = 0;

	(void)state;
	CHECK(put(cache, n, 1 << 20, 0) == -EFBIG);
	while (rc == 0) { /* a byte more than half a page: a page for each */
		const struct bytes bytes = object(++n, 2100);

		rc = cache_keep(cache, hash_of(bytes));
		if (rc == 0)
			rc = cache_put(cache, hash_of(bytes), bytes, 0);
	}
	CHECK(rc == -ENOSPC && cache_sync(cache) == 0);
	CHECK(cache_refused_writes(cache) == 0); /* the disk is not to blame */
	cache_destroy(cache);
}

static void a_sync_tells_of_what_came_before_the_file_could_be_opened(void **state)
{
	struct cache *cache;

	(void)state;
	fault_set(FAULT_IO, 0, 0);
	cache = open_cache(8 << 20);
	CHECK(put(cache, 1, 20000, 0) == -EIO && cache_refused_writes(cache) == 1);
	fault_set(FAULT_NONE, 0, 0);
	now_ms += 60000;
	CHECK(put(cache, 2, 20000, 0) == 0 && cache_sync(cache) == -EIO);
	CHECK(cache_sync(cache) == 0);
	cache_destroy(cache);
}

/* The log is written back in the midst of a put: by then its statement is that of the cache before.
 */
static void a_log_that_does_not_fit_the_file_begins_a_new_cache(void **state)
{
	struct cache *cache = open_cache(8 << 20);

	(void)state;
	for (uint32_t n = 0; n < 200; n++)
		CHECK(put(cache, n, 20000, 0) == 0);
	CHECK(cache_sync(cache) == 0);
	CHECK(truncate(path, 4096) == 0);
	for (uint32_t n = 200; n < 300 && !exists(".broken"); n++) {
		const int rc = put(cache, n, 20000, 0);

		CHECK(rc == (exists(".broken") ? -EIO : 0));
	}
	CHECK(exists(".broken"));
	CHECK(cache_sync(cache) == -EIO && cache_sync(cache) == 0);
	CHECK(put(cache, 1, 20000, 0) == 0 && get(cache, 1, 20000) == 0);
	cache_destroy(cache);
}

static void takes_no_more_than_its_share_of_the_disk(void **state)
{
	struct cache *cache;

	(void)state;
	disk_bytes = 100 << 20;
	cache = open_cache(UINT64_C(1) << 30);
	CHECK(cache_budget_bytes(cache) == 60 << 20);
	cache_destroy(cache);
	cache = open_cache(50 << 20);
	CHECK(cache_budget_bytes(cache) == 50 << 20);
	cache_destroy(cache);
	disk_bytes = 1 << 20;
	cache = open_cache(50 << 20);
	CHECK(cache_budget_bytes(cache) == CACHE_BUDGET_MIN);
	cache_destroy(cache);
	disk_rc = -1; /* nobody knows how large it is */
	cache = open_cache(50 << 20);
	CHECK(cache_budget_bytes(cache) == 50 << 20);
	cache_destroy(cache);
	disk_bytes = UINT64_C(1) << 40;
	disk_rc = 0;
}

static void lives_without_a_file(void **state)
{
	struct cache_options options = { .path = "/nonexistent/cache.db", .budget_bytes = 1 };
	struct cache_figures figures;
	struct cache *cache;

	(void)state;
	CHECK(cache_create(&cache, &options) == 0);
	CHECK(put(cache, 1, 100, 0) == -EIO);
	CHECK(get(cache, 1, 100) == -ENOENT);
	CHECK(cache_flush(cache) == 0);
	for (int i = 0; i < 40; i++) {
		now_ms += 60000; /* it tries again; what cannot be opened is not damaged */
		CHECK(get(cache, 1, 100) == -ENOENT);
	}
	cache_figures(cache, &figures);
	CHECK(figures.budget_bytes == CACHE_BUDGET_MIN && figures.file_bytes == 0);
	CHECK(figures.set_aside == 0);
	cache_destroy(cache);
}

#define IN_A_FOLDER(test) cmocka_unit_test_setup_teardown(test, enter_empty_folder, leave_folder)

int main(void)
{
	const struct CMUnitTest tests[] = {
		IN_A_FOLDER(gives_back_what_was_put_across_a_restart),
		IN_A_FOLDER(holds_its_budget_under_churn),
		IN_A_FOLDER(drops_the_least_useful_first),
		IN_A_FOLDER(knows_what_was_wanted_before_a_restart),
		IN_A_FOLDER(keeps_what_it_was_told_to_keep),
		IN_A_FOLDER(keeps_both_releases_across_a_return),
		IN_A_FOLDER(keeps_no_more_than_three_quarters),
		IN_A_FOLDER(gives_the_disk_back_when_the_budget_shrinks),
		IN_A_FOLDER(unkeeps_nothing_where_a_write_fails_while_it_shrinks),
		IN_A_FOLDER(refuses_what_can_never_fit),
		IN_A_FOLDER(keeps_the_locators_of_this_release_and_the_last),
		IN_A_FOLDER(drops_an_object_whose_bytes_changed),
		IN_A_FOLDER(sets_what_is_no_database_aside),
		IN_A_FOLDER(survives_every_kind_of_truncated_file),
		IN_A_FOLDER(survives_flipped_bits),
		IN_A_FOLDER(goes_on_after_any_write_failed),
		IN_A_FOLDER(takes_no_failed_read_for_damage),
		IN_A_FOLDER(tolerates_a_disk_that_stays_full),
		IN_A_FOLDER(a_sync_tells_once_of_what_the_disk_refused),
		IN_A_FOLDER(a_sync_tells_nothing_of_what_has_no_room),
		IN_A_FOLDER(a_sync_tells_of_what_came_before_the_file_could_be_opened),
		IN_A_FOLDER(a_log_that_does_not_fit_the_file_begins_a_new_cache),
		IN_A_FOLDER(takes_no_more_than_its_share_of_the_disk),
		IN_A_FOLDER(lives_without_a_file),
	};

	fault_install();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
