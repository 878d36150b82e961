/* Verifies the signed files and the locator of a release, then walks its pages breadth first. */
#include "pipeline/release/verify.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/release/verify_pages.h"
#include "pipeline/release/verify_tuf.h"
#include "tuf/tuf_metadata.h"

enum { ROOTS_MAX = 1000, LOCATOR_BYTES_MAX = 256 << 20 };

/* ---- signed metadata ---- */

/* Follows the chain of roots; first is the trusted one, or empty: the release's own. */
static int read_roots(struct verify_walk *walk, struct bytes first, struct buffer *file)
{
	struct verify_report *report = walk->report;
	const char *why = "";
	int rc = 0;

	if (first.size == 0) {
		rc = release_reader_file(walk->reader, "root/1.json", file);
		if (rc < 0)
			return verify_blame_reader(walk, rc);
		first = buffer_bytes(file);
	}
	rc = trust_root_first(&report->trust, first, &why);
	if (rc < 0)
		return diagnostics_add(&report->diagnostics, rc, NULL, 0, "the first root: %s",
				       why);
	while (report->trust.version < ROOTS_MAX) {
		char name[32];

		snprintf(name, sizeof(name), "root/%u.json", report->trust.version + 1);
		rc = release_reader_file(walk->reader, name, file);
		if (rc == -ENOENT)
			return 0;
		if (rc < 0)
			return verify_blame_reader(walk, rc);
		rc = trust_root_next(&report->trust, buffer_bytes(file), &why);
		if (rc < 0)
			return diagnostics_add(&report->diagnostics, rc, name, 0, "%s", why);
	}
	return diagnostics_add(&report->diagnostics, -EBADMSG, NULL, 0, "more than %d roots",
			       ROOTS_MAX);
}

static int check_expiry(struct verify_walk *walk, int64_t now_s, const char *name,
			int64_t expires_s)
{
	if (now_s == 0 || now_s < expires_s)
		return 0;
	return diagnostics_add(&walk->report->diagnostics, -EKEYEXPIRED, name, 0,
			       "expired %" PRId64 " days ago", (now_s - expires_s) / 86400);
}

static int read_release(struct verify_walk *walk, struct buffer *file)
{
	struct verify_report *report = walk->report;
	const char *why = "";
	struct hash name;
	int rc = release_reader_file(walk->reader, "timestamp.json", file);

	if (rc < 0)
		return verify_blame_reader(walk, rc);
	rc = timestamp_decode(&report->timestamp, &report->trust, buffer_bytes(file), &why);
	if (rc < 0)
		return diagnostics_add(&report->diagnostics, rc, "timestamp.json", 0, "%s", why);
	rc = release_reader_file(walk->reader, "release.json", file);
	if (rc < 0)
		return verify_blame_reader(walk, rc);
	rc = release_decode(&report->release, &report->trust, buffer_bytes(file), &why);
	if (rc < 0)
		return diagnostics_add(&report->diagnostics, rc, "release.json", 0, "%s", why);
	name = hash_of(buffer_bytes(file));
	if (!hash_equal(name, report->timestamp.release) ||
	    report->release.sequence != report->timestamp.sequence)
		return diagnostics_add(&report->diagnostics, -EBADMSG, NULL, 0,
				       "timestamp.json names another release.json");
	return 0;
}

/* Returns whether the release is to be verified in the form of The Update Framework alone. */
static bool is_tuf_alone(struct verify_walk *walk, struct bytes trusted, struct buffer *file)
{
	struct tuf_file root = { 0 };
	const char *why;
	bool is_root;

	if (trusted.size == 0)
		return release_reader_file(walk->reader, "release.json", file) == -ENOENT &&
		       release_reader_file(walk->reader, "tuf/1.root.json", file) == 0;
	is_root = tuf_root_first(&root, trusted, &why) == 0;
	tuf_file_finish(&root);
	return is_root;
}

static int read_metadata(struct verify_walk *walk, const struct verify_options *options)
{
	struct buffer file;
	int rc;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	if (is_tuf_alone(walk, options->trusted_root, &file)) {
		buffer_finish(&file);
		rc = verify_tuf_alone(walk, options->trusted_root, options->target, options->now_s);
		return rc < 0 ? rc
			      : check_expiry(walk, options->now_s, "release.json",
					     walk->report->release.expires_s);
	}
	rc = read_roots(walk, options->trusted_root, &file);
	if (rc == 0)
		rc = check_expiry(walk, options->now_s, "the newest root",
				  walk->report->trust.expires_s);
	if (rc == 0)
		rc = read_release(walk, &file);
	if (rc == 0)
		rc = check_expiry(walk, options->now_s, "release.json",
				  walk->report->release.expires_s);
	if (rc == 0)
		rc = check_expiry(walk, options->now_s, "timestamp.json",
				  walk->report->timestamp.expires_s);
	if (rc == 0) /* file holds release.json */
		rc = verify_tuf(walk, buffer_bytes(&file), options->target, options->now_s);
	buffer_finish(&file);
	return rc;
}

/* ---- the locator ---- */

static int read_locator(struct verify_walk *walk)
{
	char name[64] = "locator/";
	struct buffer file;
	int rc;

	hash_to_hex(walk->report->release.root, name + strlen(name));
	buffer_init(&file, LOCATOR_BYTES_MAX);
	rc = release_reader_file(walk->reader, name, &file);
	if (rc < 0) {
		verify_blame_reader(walk, rc);
	} else {
		rc = locator_decode(&walk->locator, buffer_bytes(&file));
		if (rc < 0)
			diagnostics_add(&walk->report->diagnostics, rc, name, 0, "%s",
					rc == -ENOMEM ? "no memory is left"
						      : "damaged, or not a locator");
	}
	walk->report->locator_bytes = (uint32_t)file.size;
	walk->report->pack_count = walk->locator.pack_count;
	buffer_finish(&file);
	return rc;
}

/* Refuses packs without blocks: the walk would never check them. */
static int check_packs_used(struct verify_walk *walk)
{
	bool *used = calloc(walk->locator.pack_count + 1, sizeof(*used));
	uint32_t count = 0;

	if (!used)
		return -ENOMEM;
	for (uint32_t i = 0; i < walk->locator.block_count; i++) {
		count += !used[walk->locator.blocks[i].pack];
		used[walk->locator.blocks[i].pack] = true;
	}
	free(used);
	return count == walk->locator.pack_count
		       ? 0
		       : diagnostics_add(
				 &walk->report->diagnostics, -EBADMSG, NULL, 0,
				 "the locator names %u packs that hold nothing of the release",
				 walk->locator.pack_count - count);
}

/* ---- the walk ---- */

static int check_block(struct verify_walk *walk, const struct verify_page *page)
{
	const struct locator_block *block = locator_find(&walk->locator, page->name);
	uint64_t size = page_child_offset(&page->page, page->page.child_count);
	char hex[HASH_HEX_BYTES];

	if (!block && size == 0)
		return 0;
	hash_to_hex(page->name, hex);
	if (!block)
		return diagnostics_add(&walk->report->diagnostics, -ENOENT, NULL, 0,
				       "the locator has no block of page %s", hex);
	if (block->size != size)
		return diagnostics_add(&walk->report->diagnostics, -EBADMSG, NULL, 0,
				       "the block of page %s has %u bytes, its children %" PRIu64,
				       hex, block->size, size);
	walk->blocks_used++;
	return 0;
}

static int look_into(struct verify_walk *walk, enum page_kind kind, const struct verify_page *page)
{
	static int (*const looks[])(struct verify_walk *, const struct verify_page *) = {
		[PAGE_ROOT] = verify_root_page,       [PAGE_HIERARCHY] = verify_hierarchy_page,
		[PAGE_SAMPLES] = verify_samples_page, [PAGE_BRICK] = verify_brick_page,
		[PAGE_FACE] = verify_face_page,       [PAGE_INFO] = verify_info_page,
		[PAGE_LABELS] = verify_labels_page,   [PAGE_STREAM] = verify_stream_page,
	};
	char hex[HASH_HEX_BYTES];
	int rc;

	hash_to_hex(page->name, hex);
	if (page->page.kind != kind)
		return diagnostics_add(&walk->report->diagnostics, -EBADMSG, NULL, 0,
				       "page %s is of kind %d instead of kind %d", hex,
				       page->page.kind, kind);
	rc = check_block(walk, page);
	if (rc == 0)
		rc = looks[kind](walk, page);
	if (rc < 0)
		diagnostics_add(&walk->report->diagnostics, rc, NULL, 0, "page %s: %s", hex,
				rc == -EBADMSG ? "its payload does not decode" : strerror(-rc));
	return rc;
}

static int do_task(struct verify_walk *walk, const struct verify_task *task)
{
	struct verify_page page = { .name = task->child.hash };
	struct buffer copy;
	struct bytes bytes;
	int rc = release_reader_child(walk->reader, &walk->locator, task->parent, task->offset,
				      &task->child, &bytes);

	if (rc < 0)
		return verify_blame_reader(walk, rc);
	progress_add(walk->progress, bytes.size);
	buffer_init(&copy, PAGE_BYTES_MAX);
	buffer_put(&copy, bytes.data, bytes.size);
	rc = copy.error ? copy.error : page_decode(&page.page, buffer_bytes(&copy));
	if (rc < 0) {
		char hex[HASH_HEX_BYTES];

		hash_to_hex(page.name, hex);
		diagnostics_add(&walk->report->diagnostics, rc, NULL, 0, "object %s is not a page",
				hex);
	} else {
		walk->report->pages[page.page.kind].count++;
		walk->report->pages[page.page.kind].bytes += bytes.size;
		rc = look_into(walk, task->kind, &page);
	}
	page_finish(&page.page);
	buffer_finish(&copy);
	return rc;
}

static int walk_all(struct verify_walk *walk)
{
	struct verify_task root = { .child = { .hash = walk->report->release.root,
					       .size = walk->report->release.root_bytes,
					       .is_page = true },
				    .kind = PAGE_ROOT };
	int rc = verify_queue(walk, &root);

	walk->blocks_used = 1; /* the block of the root page */
	for (uint32_t i = 0; rc == 0 && i < walk->task_count; i++) {
		struct verify_task task = walk->tasks[i]; /* a copy: the array may move */

		rc = do_task(walk, &task);
	}
	if (rc == 0 && walk->blocks_used != walk->locator.block_count)
		rc = diagnostics_add(&walk->report->diagnostics, -EBADMSG, NULL, 0,
				     "the locator has %u blocks, the release has %u",
				     walk->locator.block_count, walk->blocks_used);
	if (rc == 0 && walk->report->hierarchy_triangles != walk->report->root.published_triangles)
		rc = diagnostics_add(
			&walk->report->diagnostics, -EBADMSG, NULL, 0,
			"the root page says %" PRIu64 " published triangles, there are %" PRIu64,
			walk->report->root.published_triangles, walk->report->hierarchy_triangles);
	return rc;
}

int verify_release(struct verify_report *report, const struct verify_options *options)
{
	struct verify_walk walk = { .reader = options->reader, .report = report };
	uint64_t bytes = 0;
	int rc;

	*report = (struct verify_report){ 0 };
	rc = read_metadata(&walk, options);
	if (rc == 0)
		rc = read_locator(&walk);
	if (rc == 0)
		rc = check_packs_used(&walk);
	for (uint32_t i = 0; rc == 0 && i < walk.locator.block_count; i++)
		bytes += walk.locator.blocks[i].size;
	walk.progress = progress_start("verifying", "bytes", bytes);
	if (rc == 0)
		rc = walk_all(&walk);
	progress_end(walk.progress);
	if (rc < 0)
		diagnostics_add(&report->diagnostics, rc, NULL, 0, "%s", strerror(-rc));
	report->read_bytes = release_reader_bytes(options->reader);
	samples_page_finish(&walk.samples);
	hierarchy_finish(&walk.hierarchy);
	info_close(walk.info);
	locator_finish(&walk.locator);
	map_finish(&walk.seen);
	free(walk.tasks);
	return rc;
}
