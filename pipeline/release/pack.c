/* Walks the pages of a release breadth first, writes their blocks into packs or reuses old ones,
 * and writes the locator. */
#include "pipeline/release/pack.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/array.h"
#include "base/log.h"

/* Marks a block in a new pack while the names of new packs are not known. */
#define NEW_PACK (1u << 31)

struct packer {
	const struct pack_options *options;
	struct pack_result *result;
	struct map seen;          /* pages that are queued or done */
	struct page_child *queue; /* owned; pages in breadth-first order */
	uint32_t queue_count, queue_room;
	struct locator_block *blocks; /* owned; pack is an index into before, or NEW_PACK | index */
	uint32_t block_count, block_room;
	struct hash *packs; /* owned; names of new packs */
	uint32_t pack_count, pack_room;
	struct buffer pack;     /* the pack being filled */
	uint64_t *before_bytes; /* owned; of each pack of before; 0: it is missing */
};

static int path_of(char path[PATH_MAX], const char *release, const char *folder, struct hash name)
{
	char hex[HASH_HEX_BYTES];

	hash_to_hex(name, hex);
	return snprintf(path, PATH_MAX, "%s/%s/%s", release, folder, hex) < PATH_MAX
		       ? 0
		       : -ENAMETOOLONG;
}

/* Returns the size of each pack that a locator names, 0 if it is missing; owned by the caller.
 * NULL: no memory. */
static uint64_t *measure_packs(const char *release, const struct locator *locator)
{
	uint64_t *bytes = calloc(locator->pack_count + 1, sizeof(*bytes));
	char path[PATH_MAX];
	struct stat status;

	for (uint32_t i = 0; bytes && i < locator->pack_count; i++)
		if (path_of(path, release, "packs", locator->packs[i]) == 0 &&
		    access(path, R_OK) == 0 && stat(path, &status) == 0)
			bytes[i] = (uint64_t)status.st_size;
	return bytes;
}

static bool holds(uint64_t bytes, const struct locator_block *block)
{
	return (uint64_t)block->offset + block->size <= bytes;
}

static int queue_page(struct packer *packer, const struct page_child *page)
{
	int rc = map_add(&packer->seen, hash_key(page->hash), 0);

	if (rc <= 0)
		return rc;
	rc = ARRAY_RESERVE(packer->queue, packer->queue_room, packer->queue_count + 1, UINT32_MAX);
	if (rc == 0)
		packer->queue[packer->queue_count++] = *page;
	return rc;
}

static int add_block(struct packer *packer, const struct locator_block *block)
{
	int rc = ARRAY_RESERVE(packer->blocks, packer->block_room, packer->block_count + 1,
			       UINT32_MAX);

	if (rc == 0)
		packer->blocks[packer->block_count++] = *block;
	return rc;
}

static int end_pack(struct packer *packer)
{
	struct bytes bytes = buffer_bytes(&packer->pack);
	struct hash name;
	char path[PATH_MAX];
	int rc;

	if (bytes.size == 0)
		return 0;
	rc = ARRAY_RESERVE(packer->packs, packer->pack_room, packer->pack_count + 1, NEW_PACK - 1);
	if (rc < 0)
		return rc;
	name = hash_of(bytes);
	rc = path_of(path, packer->options->release, "packs", name);
	/* The same pack may exist from a run that was interrupted later. Its name proves that it is
	 * complete. */
	if (rc == 0)
		rc = bytes_write_file(bytes, path);
	if (rc < 0) {
		log_error("pipeline", "%s: %s", path, strerror(-rc));
		return rc;
	}
	packer->packs[packer->pack_count++] = name;
	packer->result->packs_written++;
	packer->result->written_bytes += bytes.size;
	buffer_clear(&packer->pack);
	return 0;
}

/* Returns the page's block in the earlier release, if its pack still has it. */
static const struct locator_block *block_before(const struct packer *packer, struct hash page,
						uint64_t size)
{
	const struct locator *before = packer->options->before;
	const struct locator_block *block = before ? locator_find(before, page) : NULL;

	return block && block->size == size && holds(packer->before_bytes[block->pack], block)
		       ? block
		       : NULL;
}

static int write_block(struct packer *packer, struct hash page, const struct page_child *children,
		       uint32_t child_count, uint64_t size)
{
	uint64_t most = packer->options->pack_bytes ? packer->options->pack_bytes : PACK_BYTES;
	struct locator_block block = { .page = page, .size = (uint32_t)size };
	int rc = size > PACK_BYTES_MAX ? -EFBIG : 0;

	if (rc < 0)
		log_error("pipeline",
			  "all pictures and spoken texts, or all published patches, have %.2f GB "
			  "together, and at most %.2f are possible: leave some out, make them "
			  "smaller, or lower publish_share",
			  (double)size / 1e9, PACK_BYTES_MAX / 1e9);
	if (rc == 0 && packer->pack.size > 0 && packer->pack.size + size > most)
		rc = end_pack(packer);
	block.pack = NEW_PACK | packer->pack_count;
	block.offset = (uint32_t)packer->pack.size;
	for (uint32_t i = 0; rc == 0 && i < child_count; i++) {
		rc = object_store_read(packer->options->objects, children[i].hash, &packer->pack);
		if (rc < 0) {
			char hex[HASH_HEX_BYTES];

			hash_to_hex(children[i].hash, hex);
			log_error("pipeline", "object %s: %s", hex, strerror(-rc));
		}
	}
	packer->result->blocks_written++;
	return rc < 0 ? rc : add_block(packer, &block);
}

static int place_block(struct packer *packer, struct hash page, const struct page_child *children,
		       uint32_t child_count)
{
	const struct locator_block *before;
	struct locator_block block;
	uint64_t size = 0;

	for (uint32_t i = 0; i < child_count; i++)
		size += children[i].size;
	if (size == 0)
		return 0;
	/* The zero hash names another root's block in another release. */
	before = hash_is_zero(page) ? NULL : block_before(packer, page, size);
	if (!before)
		return write_block(packer, page, children, child_count, size);
	packer->result->blocks_reused++;
	packer->result->reused_bytes += size;
	block = *before;
	block.page = page; /* a locator has the beginning of its name alone */
	return add_block(packer, &block);
}

static int place_page(struct packer *packer, struct hash name)
{
	struct buffer object;
	struct page page = { 0 };
	int rc;

	buffer_init(&object, PAGE_BYTES_MAX);
	rc = object_store_read(packer->options->objects, name, &object);
	if (rc == 0)
		rc = page_decode(&page, buffer_bytes(&object));
	if (rc == 0)
		rc = place_block(packer, name, page.children, page.child_count);
	for (uint32_t i = 0; rc == 0 && i < page.child_count; i++)
		if (page.children[i].is_page)
			rc = queue_page(packer, &page.children[i]);
	page_finish(&page);
	buffer_finish(&object);
	return rc;
}

static int place_all(struct packer *packer)
{
	int rc = place_block(packer, (struct hash){ 0 }, &packer->options->root, 1);

	if (rc == 0)
		rc = queue_page(packer, &packer->options->root);
	for (uint32_t i = 0; rc == 0 && i < packer->queue_count; i++) {
		rc = place_page(packer, packer->queue[i].hash);
		if (packer->options->progress)
			packer->options->progress(packer->options->progress_data,
						  packer->result->written_bytes +
							  packer->pack.size +
							  packer->result->reused_bytes);
	}
	return rc < 0 ? rc : end_pack(packer);
}

/* Numbers the packs: first the reused old ones in their order, then the new ones. */
static int make_locator(struct packer *packer, struct locator *locator)
{
	uint32_t count = packer->options->before ? packer->options->before->pack_count : 0;
	uint32_t *number = calloc(count + 1, sizeof(*number)), reused = 0;

	locator->packs = calloc(count + packer->pack_count + 1, sizeof(*locator->packs));
	if (!number || !locator->packs) {
		free(number);
		return -ENOMEM;
	}
	for (uint32_t i = 0; i < packer->block_count; i++)
		if (!(packer->blocks[i].pack & NEW_PACK))
			number[packer->blocks[i].pack] = 1;
	for (uint32_t i = 0; i < count; i++) {
		if (!number[i])
			continue;
		number[i] = reused;
		locator->packs[reused++] = packer->options->before->packs[i];
	}
	for (uint32_t i = 0; i < packer->pack_count; i++)
		locator->packs[reused + i] = packer->packs[i];
	for (uint32_t i = 0; i < packer->block_count; i++) {
		uint32_t pack = packer->blocks[i].pack;

		packer->blocks[i].pack =
			pack & NEW_PACK ? reused + (pack & ~NEW_PACK) : number[pack];
	}
	free(number);
	packer->result->packs_reused = reused;
	locator->pack_count = reused + packer->pack_count;
	locator->block_count = packer->block_count;
	locator->blocks = packer->blocks;
	return 0;
}

static int write_locator(struct packer *packer)
{
	struct locator locator = { 0 };
	struct buffer file;
	char path[PATH_MAX];
	int rc = make_locator(packer, &locator);

	buffer_init(&file, 256 << 20);
	if (rc == 0) {
		locator_encode(&file, &locator);
		rc = file.error;
	}
	if (rc == 0)
		rc = path_of(path, packer->options->release, "locator", packer->options->root.hash);
	if (rc == 0) {
		rc = bytes_write_file(buffer_bytes(&file), path);
		if (rc < 0)
			log_error("pipeline", "%s: %s", path, strerror(-rc));
	}
	packer->result->locator_bytes = file.size;
	buffer_finish(&file);
	free(locator.packs);
	return rc;
}

static int make_folder(const char *release, const char *name, char path[PATH_MAX])
{
	if (snprintf(path, PATH_MAX, "%s/%s", release, name) >= PATH_MAX)
		return -ENAMETOOLONG;
	if (mkdir(path, 0755) == 0 || errno == EEXIST)
		return 0;
	log_error("pipeline", "%s: %s", path, strerror(errno));
	return -errno;
}

/* Makes both folders, and removes what a publisher that was killed left there. Other publishers,
 * who may be teams of other temples, wait until *fd is closed. */
static int begin(const char *release, int *fd)
{
	char packs[PATH_MAX], locator[PATH_MAX];
	int rc = make_folder(release, "packs", packs);

	*fd = -1;
	if (rc == 0)
		rc = make_folder(release, "locator", locator);
	if (rc < 0)
		return rc;
	*fd = open(packs, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (*fd < 0) {
		rc = -errno;
		log_error("pipeline", "%s: %s", packs, strerror(-rc));
		return rc;
	}
	if (flock(*fd, LOCK_EX | LOCK_NB) < 0 && errno == EWOULDBLOCK)
		log_info("pipeline", "%s: waiting for another publisher", packs);
	if (flock(*fd, LOCK_EX) < 0)
		log_debug("pipeline", "%s: cannot be locked: %s", packs, strerror(errno));
	bytes_sweep_folder(packs, INT64_MAX);
	bytes_sweep_folder(locator, INT64_MAX);
	return 0;
}

int pack_release(const struct pack_options *options, struct pack_result *result)
{
	struct packer packer = { .options = options, .result = result };
	int fd, rc = begin(options->release, &fd);

	*result = (struct pack_result){ 0 };
	buffer_init(&packer.pack, (size_t)PACK_BYTES_MAX + PACK_BYTES);
	if (rc == 0 && options->before) {
		packer.before_bytes = measure_packs(options->release, options->before);
		rc = packer.before_bytes ? 0 : -ENOMEM;
	}
	if (rc == 0)
		rc = place_all(&packer);
	if (rc == 0)
		rc = write_locator(&packer);
	buffer_finish(&packer.pack);
	map_finish(&packer.seen);
	free(packer.queue);
	free(packer.blocks);
	free(packer.packs);
	free(packer.before_bytes);
	if (fd >= 0)
		close(fd);
	return rc;
}

int pack_read_locator(struct locator *out, const char *release, struct hash root)
{
	struct buffer file;
	char path[PATH_MAX];
	int rc = path_of(path, release, "locator", root);

	*out = (struct locator){ 0 };
	buffer_init(&file, 256 << 20);
	if (rc == 0)
		rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = locator_decode(out, buffer_bytes(&file));
	buffer_finish(&file);
	return rc;
}

int pack_read_whole(struct locator *out, const char *release, struct hash root)
{
	int rc = pack_read_locator(out, release, root);
	uint64_t *bytes = rc == 0 ? measure_packs(release, out) : NULL;

	if (rc == 0 && !bytes)
		rc = -ENOMEM;
	for (uint32_t i = 0; rc == 0 && i < out->block_count; i++) {
		const uint32_t pack = out->blocks[i].pack;
		char hex[HASH_HEX_BYTES];

		if (holds(bytes[pack], &out->blocks[i]))
			continue;
		hash_to_hex(out->packs[pack], hex);
		log_warn("pipeline", "%s/packs/%s is %s", release, hex,
			 bytes[pack] > 0 ? "cut off" : "missing");
		rc = -ENODATA;
	}
	free(bytes);
	return rc;
}
