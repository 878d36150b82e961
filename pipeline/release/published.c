/* Chooses between the signed files of a release folder. */
#include "pipeline/release/published.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "pipeline/keys/keys_tuf.h"

enum {
	CLOCK_BEHIND_S = 86400, /* several machines may publish into one folder */
	CLOCK_AHEAD_S = 400 * 86400,
};

struct tuf_place published_place(const struct publish_target *target)
{
	return (struct tuf_place){ .release = target->release,
				   .keys_folder = target->keys_folder,
				   .target = target->tuf_target,
				   .role = target->tuf_role };
}

/* -ENOKEY: there is no root or role, which is logged, and not the same as nothing published. */
static int open_folder(struct tuf_folder *out, const struct tuf_place *place)
{
	const int rc = tuf_folder_open(out, place);

	return rc == -ENOENT ? -ENOKEY : rc;
}

int published_file(const struct tuf_place *place, struct release *out, struct buffer *file)
{
	struct tuf_folder folder;
	int rc = open_folder(&folder, place);

	if (rc == 0)
		rc = tuf_folder_current(&folder, out, file);
	tuf_folder_finish(&folder);
	return rc;
}

int published_current(const struct publish_target *target, struct release *out)
{
	const struct tuf_place place = published_place(target);
	struct buffer file;
	int rc;

	*out = (struct release){ 0 };
	if (!target->tuf_alone)
		return release_files_current(out, target->release, target->keys_folder,
					     target->keys);
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	rc = published_file(&place, out, &file);
	buffer_finish(&file);
	return rc;
}

static int64_t earlier(int64_t expires_s, const struct tuf_file *file)
{
	return file->json && file->expires_s < expires_s ? file->expires_s : expires_s;
}

int published_expires_s(const struct publish_target *target, const struct release *current,
			int64_t *out)
{
	const struct tuf_place place = published_place(target);
	struct tuf_folder folder;
	uint32_t root;
	int rc = keys_last_tuf_root(&root, target->keys_folder);

	*out = current->expires_s;
	if (rc < 0 || root == 0)
		return rc;
	rc = open_folder(&folder, &place);
	*out = earlier(earlier(*out, tuf_folder_naming(&folder)), &folder.snapshot);
	tuf_folder_finish(&folder);
	return rc;
}

static int last_issued_s(const struct publish_target *target, int64_t *out)
{
	const struct tuf_place place = published_place(target);
	struct tuf_folder folder;
	int rc;

	if (!target->tuf_alone)
		return release_files_issued_s(out, target->release, target->keys);
	rc = open_folder(&folder, &place);
	*out = tuf_folder_issued_s(&folder);
	tuf_folder_finish(&folder);
	return rc;
}

struct date {
	char text[32];
};

static struct date date_of(int64_t at_s)
{
	const time_t time_s = (time_t)at_s;
	struct date date = { "" };
	struct tm tm;

	if (gmtime_r(&time_s, &tm))
		strftime(date.text, sizeof(date.text), "%Y-%m-%d %H:%M", &tm);
	return date;
}

int published_check_clock(const struct publish_target *target)
{
	const int64_t now_s = clock_wall_s();
	int64_t issued_s;
	int rc = target->trust_clock ? 0 : last_issued_s(target, &issued_s);

	if (rc < 0 || target->trust_clock || issued_s == 0 ||
	    (now_s >= issued_s - CLOCK_BEHIND_S && now_s <= issued_s + CLOCK_AHEAD_S))
		return rc;
	log_error("pipeline",
		  "the clock of this machine says %s UTC, but the last timestamp in %s was signed "
		  "at %s UTC: set the clock; if it is right, publish once with --trust-clock",
		  date_of(now_s).text, target->release, date_of(issued_s).text);
	return -ECANCELED;
}

/* Reads the release of a version, or with before the newest one below it with another root. */
static int look_back(const struct tuf_place *place, uint64_t version, const struct release *before,
		     struct release *out)
{
	struct tuf_folder folder;
	struct buffer file;
	int rc = tuf_folder_open(&folder, place);

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	if (rc == 0 && !before) {
		rc = tuf_folder_at(&folder, version, out, &file);
	} else if (rc == 0) {
		rc = -ENOENT;
		while (rc == -ENOENT && --version > 0) {
			rc = tuf_folder_at(&folder, version, out, &file);
			if (rc == 0 && hash_equal(out->root, before->root))
				rc = -ENOENT;
		}
	}
	buffer_finish(&file);
	tuf_folder_finish(&folder);
	return rc;
}

int published_at(const struct publish_target *target, uint64_t sequence, struct release *out)
{
	const struct tuf_place place = published_place(target);

	if (!target->tuf_alone)
		return release_files_at(out, target->release, target->keys_folder, target->keys,
					sequence);
	return look_back(&place, sequence, NULL, out);
}

int published_before(const struct publish_target *target, const struct release *current,
		     struct release *out)
{
	const struct tuf_place place = published_place(target);

	if (!target->tuf_alone)
		return release_files_before(out, target->release, target->keys_folder, target->keys,
					    current);
	return look_back(&place, current->sequence, current, out);
}

/* A terminal that still reads the earlier form would take what stays of it for the newest release,
 * until it expires. */
void published_drop_earlier(const struct publish_target *target)
{
	static const char *const names[] = { "timestamp.json", "release.json" };
	char path[PATH_MAX];

	for (size_t i = 0; i < ARRAY_COUNT(names); i++)
		if (snprintf(path, sizeof(path), "%s/%s", target->release, names[i]) <
			    (int)sizeof(path) &&
		    unlink(path) == 0)
			log_info("pipeline",
				 "removed %s: releases are in the form of The Update Framework "
				 "alone from now on",
				 path);
}

int published_next(uint64_t *out, const struct publish_target *target, uint64_t current)
{
	const struct tuf_place place = published_place(target);
	struct tuf_folder folder;
	uint32_t root;
	int rc = keys_last_tuf_root(&root, target->keys_folder);

	if (target->above > current)
		current = target->above;
	*out = current + 1;
	if (rc < 0 || root == 0)
		return rc;
	rc = open_folder(&folder, &place);
	if (tuf_folder_naming_version(&folder) > current)
		*out = tuf_folder_naming_version(&folder) + 1ull;
	tuf_folder_finish(&folder);
	return rc;
}
