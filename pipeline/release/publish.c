/* Publishes a release: makes the root page, packs, and writes the signed files if anything
 * changed. */
#include "pipeline/release/publish.h"

#include <assert.h>
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/progress.h"
#include "pipeline/keys/keys_tuf.h"
#include "pipeline/release/published.h"
#include "pipeline/release/release_tuf.h"

enum { DAY_S = 86400 };

int publish_make_folder(const char *path)
{
	char copy[PATH_MAX];
	size_t length = strlen(path);

	if (length == 0 || length >= sizeof(copy))
		return -ENAMETOOLONG;
	memcpy(copy, path, length + 1);
	for (char *at = copy + 1; at <= copy + length; at++) {
		if (*at != '/' && *at != '\0')
			continue;
		char kept = *at;

		*at = '\0';
		if (mkdir(copy, 0755) < 0 && errno != EEXIST) {
			log_error("pipeline", "%s: %s", copy, strerror(errno));
			return -errno;
		}
		*at = kept;
	}
	return 0;
}

static int64_t life_or(int64_t life_s, int days)
{
	return life_s > 0 ? life_s : (int64_t)days * DAY_S;
}

static int64_t timestamp_life_s(const struct publish_target *target)
{
	return life_or(target->timestamp_life_s, TIMESTAMP_LIFE_DAYS);
}

/* Signs in the form of The Update Framework too, if the keys are for both. */
static int sign_tuf(const struct publish_target *target, const struct release *release)
{
	const struct tuf_place place = published_place(target);
	struct buffer file;
	char path[PATH_MAX];
	uint32_t root;
	int rc = keys_last_tuf_root(&root, target->keys_folder);

	if (rc < 0 || root == 0)
		return rc;
	rc = -ENAMETOOLONG;
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	if (snprintf(path, sizeof(path), "%s/release.json", target->release) < (int)sizeof(path))
		rc = buffer_read_file(&file, path);
	if (rc < 0)
		log_error("pipeline", "%s/release.json: %s", target->release, strerror(-rc));
	else
		rc = release_tuf_write(&place, release, buffer_bytes(&file),
				       timestamp_life_s(target), NULL);
	buffer_finish(&file);
	return rc;
}

/* Publishes in the form of The Update Framework alone, where the signature is of the targets. */
static int sign_alone(const struct publish_target *target, const struct release *release)
{
	const struct tuf_place place = published_place(target);
	struct buffer file;
	int rc;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	rc = release_encode(&file, release, NULL, 0);
	if (rc == 0)
		rc = release_tuf_write(&place, release, buffer_bytes(&file),
				       timestamp_life_s(target), target->unsigned_folder);
	if (rc == 0 && !target->unsigned_folder)
		published_drop_earlier(target);
	buffer_finish(&file);
	return rc;
}

/* Signs and writes the files of the release after `before`, of which only the number counts. */
static int sign(struct publish_report *report, const struct publish_target *target,
		const struct page_child *root, const struct release *before)
{
	struct release release = {
		.expires_s = clock_wall_s() + life_or(target->release_life_s, RELEASE_LIFE_DAYS),
		.root = root->hash,
		.root_bytes = root->size,
	};
	int rc = keys_last_tuf_root(&release.tuf_root, target->keys_folder);

	if (rc == 0)
		rc = published_next(&release.sequence, target, before->sequence);
	if (rc < 0)
		return rc;
	if (target->comment && snprintf(release.comment, sizeof(release.comment), "%s",
					target->comment) >= (int)sizeof(release.comment)) {
		log_error("pipeline", "the comment is longer than %zu bytes",
			  sizeof(release.comment) - 1);
		return -EINVAL;
	}
	if (target->tuf_alone) {
		rc = sign_alone(target, &release);
	} else {
		const struct tuf_place place = published_place(target);

		rc = release.tuf_root > 0 ? release_tuf_put_roots(&place) : 0;
		if (rc == 0)
			rc = release_files_write(target->release, target->keys_folder, target->keys,
						 &release, timestamp_life_s(target));
		if (rc == 0)
			rc = sign_tuf(target, &release);
	}
	if (rc == 0) {
		report->release = release;
		report->changed = true;
	}
	return rc;
}

static int renew_timestamp(const struct publish_target *target, const struct release *current)
{
	const struct tuf_place place = published_place(target);
	struct release same;
	struct buffer file;
	int rc;

	if (target->tuf_alone) {
		buffer_init(&file, METADATA_FILE_BYTES_MAX);
		rc = published_file(&place, &same, &file);
		if (rc == 0)
			rc = release_tuf_write(&place, &same, buffer_bytes(&file),
					       timestamp_life_s(target), target->unsigned_folder);
		if (rc == 0 && !target->unsigned_folder)
			published_drop_earlier(target);
		buffer_finish(&file);
		return rc;
	}
	rc = release_files_renew(target->release, target->keys_folder, target->keys,
				 timestamp_life_s(target));
	return rc < 0 ? rc : sign_tuf(target, current);
}

/* Signs the current release under the next number, so that it is valid for its whole life again.
 * Terminals that show it have nothing to load. */
static int renew_release(struct publish_report *report, const struct publish_target *target,
			 const struct release *current)
{
	const struct page_child root = { .hash = current->root, .size = current->root_bytes };
	struct publish_target again = *target;
	int rc;

	again.comment = current->comment;
	rc = sign(report, &again, &root, current);
	if (rc == 0)
		log_info("pipeline",
			 "release %" PRIu64 " has less than two fifths of its life left, so it is "
			 "signed again as release %" PRIu64,
			 current->sequence, report->release.sequence);
	return rc;
}

/* publish_renew, of this release. */
static int renew(struct publish_report *report, const struct publish_target *target,
		 const struct release *current)
{
	const int64_t life_s = life_or(target->release_life_s, RELEASE_LIFE_DAYS);
	int64_t expires_s;
	int rc = published_expires_s(target, current, &expires_s);

	report->release = *current;
	report->changed = false;
	if (rc < 0)
		return rc;
	return expires_s - clock_wall_s() < life_s / 5 * 2 ? renew_release(report, target, current)
							   : renew_timestamp(target, current);
}

int publish_renew(struct publish_report *report, const struct publish_target *target)
{
	struct release current;
	int rc = published_check_clock(target);

	if (rc == 0)
		rc = published_current(target, &current);
	return rc < 0 ? rc : renew(report, target, &current);
}

static int make_root(struct page_child *out, struct object_store *objects,
		     const struct root_page *root, const struct page_child *children,
		     uint32_t child_count)
{
	struct page_child copy[ROOT_CHILDREN_MAX];
	struct page page = { .kind = PAGE_ROOT, .child_count = child_count, .children = copy };
	struct buffer payload;
	int rc;

	assert(child_count >= ROOT_CHILD_COUNT && child_count <= ROOT_CHILDREN_MAX);
	memcpy(copy, children, child_count * sizeof(*copy));
	buffer_init(&payload, PAGE_BYTES_MAX);
	root_page_encode(&payload, root);
	page.payload = buffer_bytes(&payload);
	rc = payload.error ? payload.error : object_store_add_page(objects, &page, out);
	buffer_finish(&payload);
	return rc;
}

struct pack_bar {
	struct progress *progress;
	uint64_t done;
};

static void show_packing(void *data, uint64_t done_bytes)
{
	struct pack_bar *bar = data;

	progress_add(bar->progress, done_bytes - bar->done);
	bar->done = done_bytes;
}

/* Packs the release, reusing blocks of the previous release if its locator can be read. */
static int pack(struct publish_report *report, const struct publish_target *target,
		struct object_store *objects, const struct page_child *root,
		const struct release *before)
{
	struct pack_bar bar = { .progress = progress_start("packing", "bytes", 0) };
	struct pack_options options = { .release = target->release,
					.objects = objects,
					.root = *root,
					.pack_bytes = target->pack_bytes,
					.progress = show_packing,
					.progress_data = &bar };
	struct locator locator = { 0 };
	int rc = 0;

	if (before && before->sequence > 0)
		rc = pack_read_locator(&locator, target->release, before->root);
	if (rc == 0 && locator.block_count > 0)
		options.before = &locator;
	else if (rc < 0)
		log_warn("pipeline",
			 "the locator of release %" PRIu64 " cannot be read (%s), so all "
			 "objects are packed again",
			 before->sequence, strerror(-rc));
	rc = pack_release(&options, &report->packs);
	progress_end(bar.progress);
	locator_finish(&locator);
	return rc;
}

int publish_parts(struct publish_report *report, const struct publish_target *target,
		  struct object_store *objects, const struct root_page *root,
		  const struct page_child *children, uint32_t child_count)
{
	struct release before;
	struct page_child page;
	struct locator whole = { 0 };
	bool same;
	int rc = publish_make_folder(target->release);

	*report = (struct publish_report){ 0 };
	if (rc == 0)
		rc = make_root(&page, objects, root, children, child_count);
	if (rc < 0)
		return rc;
	rc = published_check_clock(target);
	if (rc < 0)
		return rc;
	rc = published_current(target, &before);
	if (rc < 0 && rc != -ENOENT)
		return rc;
	report->release = before;
	same = rc == 0 && hash_equal(before.root, page.hash) &&
	       pack_read_whole(&whole, target->release, page.hash) == 0;
	locator_finish(&whole);
	if (!same)
		rc = pack(report, target, objects, &page, &before);
	if (rc < 0)
		return rc;
	if (same && target->above == 0 &&
	    (!target->comment || strcmp(target->comment, before.comment) == 0))
		return renew(report, target, &before);
	return sign(report, target, &page, &before);
}

int publish_again(struct publish_report *report, const struct publish_target *target,
		  uint64_t sequence)
{
	struct release current, again;
	struct page_child root;
	struct locator locator;
	int rc = published_check_clock(target);

	if (rc == 0)
		rc = published_current(target, &current);
	*report = (struct publish_report){ 0 };
	if (rc < 0) {
		if (rc == -ENOENT)
			log_error("pipeline", "%s: nothing has been published there yet",
				  target->release);
		return rc;
	}
	rc = sequence ? published_at(target, sequence, &again)
		      : published_before(target, &current, &again);
	if (rc == -ENOENT && sequence)
		log_error("pipeline", "%s: there was no release %" PRIu64, target->release,
			  sequence);
	else if (rc == -ENOENT)
		log_error("pipeline", "%s: there is no earlier release to return to",
			  target->release);
	if (rc < 0)
		return rc;
	rc = pack_read_whole(&locator, target->release, again.root);
	locator_finish(&locator);
	if (rc < 0) {
		log_error("pipeline",
			  "release %" PRIu64
			  " is not whole any more, so no terminal could load it: "
			  "its %s",
			  again.sequence,
			  rc == -ENODATA ? "packs are not all there" : "locator cannot be read");
		return rc;
	}
	root = (struct page_child){ .hash = again.root, .size = again.root_bytes };
	return sign(report, target, &root, &current);
}
