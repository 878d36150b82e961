/* Makes targets, snapshot and timestamp one from another. */
#include "pipeline/release/release_tuf.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "pipeline/keys/exchange_folder.h"
#include "pipeline/keys/keys_tuf.h"
#include "pipeline/release/release_files.h"
#include "pipeline/release/tuf_staged.h"
#include "tuf/sign.h"

static int complain(const char *release, const char *name, int rc)
{
	log_error("pipeline", "%s/%s: %s", release, name, strerror(-rc));
	return rc;
}

static int refuse_exchanged(const struct tuf_folder *folder, const char *what)
{
	log_error("pipeline",
		  "%s/tuf: %s is signed with a key that was exchanged since, and says what others "
		  "may publish or have published: the museum looks at it by `gopura-content "
		  "delegate RELEASE --keys FOLDER`, and signs it anew with --renew",
		  folder->place.release, what);
	return -EKEYREJECTED;
}

/* ---- the folder */

/* Makes all folders of a path below the release. */
static int make_folders(const char *release, const char *name)
{
	char path[PATH_MAX];
	size_t begin, at;

	if (snprintf(path, sizeof(path), "%s/%s", release, name) >= (int)sizeof(path))
		return complain(release, name, -ENAMETOOLONG);
	begin = strlen(release) + 1;
	do {
		const char kept = path[at = begin + strcspn(path + begin, "/")];

		path[at] = '\0';
		if (mkdir(path, 0755) < 0 && errno != EEXIST)
			return complain(release, name, -errno);
		path[at] = kept;
		begin = at + 1;
	} while (path[at]);
	return 0;
}

/* Returns a descriptor whose close unlocks the folder, or a negative errno. */
static int lock(const char *release)
{
	char path[PATH_MAX];
	int fd;

	snprintf(path, sizeof(path), "%s/tuf", release);
	fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd >= 0 && flock(fd, LOCK_EX) < 0)
		log_debug("pipeline", "%s: cannot be locked: %s", path, strerror(errno));
	return fd < 0 ? complain(release, "tuf", -errno) : fd;
}

int release_tuf_put_roots(const struct tuf_place *place)
{
	struct buffer file;
	char name[64];
	int rc = make_folders(place->release, "tuf");

	buffer_init(&file, TUF_FOLDER_FILE_BYTES_MAX);
	for (uint32_t version = 1; rc == 0; version++) {
		rc = keys_read_tuf_root(&file, place->keys_folder, version);
		snprintf(name, sizeof(name), "tuf/%" PRIu32 ".root.json", version);
		if (rc == 0)
			rc = release_files_put(place->release, name, buffer_bytes(&file));
		else if (rc != -ENOENT)
			complain(place->keys_folder, name, rc);
	}
	buffer_finish(&file);
	return rc == -ENOENT ? 0 : rc;
}

/* tuf/targets/FOLDER/SHA256.NAME */
static int put_target(const struct tuf_place *place, struct bytes release_file)
{
	const char *path = tuf_folder_target(place), *slash = strrchr(path, '/');
	const int before = slash ? (int)(slash + 1 - path) : 0;
	cJSON *all = cJSON_CreateObject();
	const cJSON *entry = tuf_add_file(all, "target", 0, release_file);
	const cJSON *hash = cJSON_GetObjectItem(cJSON_GetObjectItem(entry, "hashes"), "sha256");
	char name[PATH_MAX];
	int rc = hash ? 0 : complain(place->release, "tuf/targets", -ENOMEM);

	if (hash) {
		snprintf(name, sizeof(name), "tuf/targets/%.*s", before, path);
		name[strlen(name) - 1] = '\0';
		rc = make_folders(place->release, name);
		snprintf(name, sizeof(name), "tuf/targets/%.*s%s.%s", before, path,
			 hash->valuestring, path + before);
	}
	cJSON_Delete(all);
	return rc < 0 ? rc : release_files_put(place->release, name, release_file);
}

/* ---- contents */

static cJSON *drop_unless(cJSON *content, bool whole)
{
	if (whole)
		return content;
	cJSON_Delete(content);
	return NULL;
}

/* Returns an object that is a member of content, which is made where there is none. */
static cJSON *object_in(cJSON *content, const char *name)
{
	cJSON *object = cJSON_GetObjectItemCaseSensitive(content, name);

	return object ? object : cJSON_AddObjectToObject(content, name);
}

/* The targets of a key that was exchanged are carried on only if somebody looked at them. */
static const struct tuf_file *last_top(const struct tuf_folder *folder, bool renews)
{
	static const struct tuf_file none = { .json = NULL };

	return folder->top_is_signed || renews ? &folder->top : &none;
}

static cJSON *naming_content(const struct tuf_folder *folder, const struct release *what,
			     struct bytes release_file)
{
	const char *target = tuf_folder_target(&folder->place);
	const struct tuf_file *last = tuf_folder_naming(folder);
	cJSON *content = tuf_next_content(last == &folder->top ? last_top(folder, false) : last,
					  TUF_TARGETS, (uint32_t)what->sequence, what->expires_s);
	cJSON *all = object_in(content, "targets"), *custom;
	char root[HASH_HEX_BYTES];

	cJSON_DeleteItemFromObjectCaseSensitive(all, target);
	custom = cJSON_AddObjectToObject(tuf_add_file(all, target, 0, release_file), "custom");
	hash_to_hex(what->root, root);
	return drop_unless(content, cJSON_AddStringToObject(custom, "root_page", root) &&
					    cJSON_AddNumberToObject(custom, "root_page_bytes",
								    what->root_bytes));
}

/* Adds what a snapshot or timestamp says of a file. What is not signed yet has no length and hash
 * that would stay, so its version must do. */
static cJSON *naming(cJSON *content, const char *role, uint32_t version,
		     const struct tuf_staged *file, bool is_whole)
{
	cJSON *meta = object_in(content, "meta"), *entry;
	char name[PATH_MAX];

	snprintf(name, sizeof(name), "%s.json", role);
	cJSON_DeleteItemFromObjectCaseSensitive(meta, name);
	if (is_whole)
		entry = tuf_add_file(meta, name, version, buffer_bytes(&file->file));
	else
		entry = cJSON_AddNumberToObject(cJSON_AddObjectToObject(meta, name), "version",
						version);
	return drop_unless(content, entry != NULL);
}

/* ---- the files, from the target up */

/* The three files of a release; snapshot and naming may be empty: those that are there stay. */
struct next {
	struct tuf_folder folder;
	struct signing signing;
	struct tuf_staged files[TUF_TYPES];
	const char *unsigned_folder;
	int64_t timestamp_life_s;
	bool renews; /* as struct tuf_change has it */
};

static void complain_behind(const struct tuf_place *place)
{
	log_error("pipeline",
		  "%s/tuf has later roots than %s/tuf: keys were exchanged elsewhere since; bring "
		  "the folder of keys from there, or what the museum hands over",
		  place->release, place->keys_folder);
}

static int stage(struct next *next, enum tuf_type type, uint32_t version, cJSON *content)
{
	struct tuf_staged *staged = &next->files[type];
	int rc = tuf_staged_init(staged, &next->folder, type, version, content);

	if (rc == 0)
		rc = tuf_staged_sign(staged, &next->signing);
	if (rc == -EKEYREJECTED && next->folder.is_ahead)
		complain_behind(&next->folder.place);
	if (rc == 0)
		rc = tuf_staged_write(staged);
	return rc == 0 && !next->unsigned_folder ? tuf_staged_check(staged) : rc;
}

static uint32_t last_snapshot(const struct tuf_folder *folder)
{
	const cJSON *meta =
		folder->timestamp.json ? tuf_meta(&folder->timestamp, "snapshot.json") : NULL;

	return meta ? tuf_meta_version(meta) : 0;
}

/* Returns whether the entries of the last snapshot go into the next one. */
static bool carries_on(const struct next *next)
{
	return next->folder.snapshot_is_signed ||
	       (next->renews && next->folder.snapshot_was_signed);
}

/* What others published must not be lost with a snapshot that cannot be trusted. */
static int check_snapshot(const struct next *next)
{
	const struct tuf_folder *folder = &next->folder;
	const cJSON *meta = cJSON_GetObjectItemCaseSensitive(folder->snapshot.content, "meta");

	if (!folder->snapshot.json || carries_on(next) || cJSON_GetArraySize(meta) < 2)
		return 0;
	if (folder->snapshot_was_signed)
		return refuse_exchanged(folder, "the last snapshot");
	log_error(
		"pipeline",
		"%s/tuf: the last snapshot is not signed with the keys of the newest root, and it "
		"has files of other roles: sign it with these keys first",
		folder->place.release);
	return -EKEYREJECTED;
}

/* Stages the file that names the release, or all delegations, and the snapshot that names it.
 * content is taken. */
static int stage_naming(struct next *next, uint32_t version, int64_t expires_s, cJSON *content,
			uint32_t *snapshot)
{
	const struct tuf_file none = { .json = NULL };
	const struct tuf_folder *folder = &next->folder;
	const uint32_t last = last_snapshot(folder);
	int rc = check_snapshot(next);

	/* The releases of others may live longer than this one. */
	if (folder->snapshot_is_signed && expires_s < folder->snapshot.expires_s)
		expires_s = folder->snapshot.expires_s;
	*snapshot = last + 1 > version ? last + 1 : version;
	if (rc < 0)
		cJSON_Delete(content);
	else
		rc = stage(next, TUF_TARGETS, version, content);
	if (rc == 0)
		rc = stage(next, TUF_SNAPSHOT, *snapshot,
			   naming(tuf_next_content(carries_on(next) ? &folder->snapshot : &none,
						   TUF_SNAPSHOT, *snapshot, expires_s),
				  tuf_folder_naming_name(folder), version,
				  &next->files[TUF_TARGETS], !next->unsigned_folder));
	return rc;
}

/* Reads the snapshot that stays, so that the timestamp can name its bytes. */
static int keep_snapshot(struct next *next, struct tuf_staged *out)
{
	char path[PATH_MAX];

	buffer_init(&out->file, TUF_FOLDER_FILE_BYTES_MAX);
	snprintf(path, sizeof(path), "%s/tuf/%" PRIu32 ".snapshot.json", next->folder.place.release,
		 last_snapshot(&next->folder));
	return buffer_read_file(&out->file, path);
}

static int stage_timestamp(struct next *next, uint32_t snapshot)
{
	const struct tuf_file none = { .json = NULL };
	const int64_t now_s = clock_wall_s();
	/* Never below the snapshot's: where a folder was brought back from a backup, that is above
	 * all that terminals have seen (struct publish_target, above). */
	const uint32_t after = next->folder.timestamp.version + 1;
	struct tuf_staged kept = { .name = "" };
	const bool is_new = next->files[TUF_SNAPSHOT].name[0] != '\0';
	cJSON *content;
	int rc = is_new ? 0 : keep_snapshot(next, &kept);

	if (rc < 0) {
		tuf_staged_finish(&kept);
		return complain(next->folder.place.release, "tuf", rc);
	}
	content = naming(tuf_next_content(&none, TUF_TIMESTAMP, after > snapshot ? after : snapshot,
					  now_s + next->timestamp_life_s),
			 "snapshot", snapshot, is_new ? &next->files[TUF_SNAPSHOT] : &kept,
			 !is_new || !next->unsigned_folder);
	/* A member of ours, which other clients ignore: terminals know then that it is not earlier.
	 */
	if (content && !cJSON_AddNumberToObject(content, "issued_s", (double)now_s))
		content = drop_unless(content, false);
	tuf_staged_finish(&kept);
	return stage(next, TUF_TIMESTAMP, 0, content);
}

/* ---- writing them */

/* In an order in which no reader finds a name before the file that it names. */
static const enum tuf_type order[] = { TUF_TARGETS, TUF_SNAPSHOT, TUF_TIMESTAMP };

static int put_all(const struct next *next)
{
	char name[160];
	int rc = 0;

	for (size_t i = 0; i < ARRAY_COUNT(order) && rc == 0; i++) {
		const struct tuf_staged *staged = &next->files[order[i]];

		snprintf(name, sizeof(name), "tuf/%s", staged->name);
		if (staged->name[0])
			rc = release_files_put(next->folder.place.release, name,
					       buffer_bytes(&staged->file));
	}
	return rc;
}

static int keep_all(const struct next *next)
{
	int rc = 0;

	for (size_t i = 0; i < ARRAY_COUNT(order) && rc == 0; i++)
		if (next->files[order[i]].name[0])
			rc = tuf_staged_keep(&next->files[order[i]], next->unsigned_folder);
	return rc;
}

static void finish(struct next *next)
{
	for (int type = 0; type < TUF_TYPES; type++)
		tuf_staged_finish(&next->files[type]);
	tuf_folder_finish(&next->folder);
}

/* Returns whether that release is published already, whole. */
static bool is_current(const struct tuf_folder *folder, struct bytes release_file)
{
	struct release release;
	struct buffer file;
	bool same;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	same = folder->snapshot_is_signed && tuf_folder_naming(folder)->json &&
	       tuf_folder_current(folder, &release, &file) == 0 &&
	       bytes_equal(buffer_bytes(&file), release_file);
	buffer_finish(&file);
	return same;
}

static int make_all(struct next *next, const struct release *what, struct bytes release_file)
{
	const struct tuf_folder *folder = &next->folder;
	uint32_t snapshot = last_snapshot(folder);
	int rc = 0;

	if (!is_current(folder, release_file)) {
		if (what->sequence > UINT32_MAX ||
		    what->sequence < tuf_folder_naming_version(folder))
			return complain(folder->place.release, "tuf", -ERANGE);
		rc = put_target(&folder->place, release_file);
		if (rc == 0)
			rc = stage_naming(next, (uint32_t)what->sequence, what->expires_s,
					  naming_content(folder, what, release_file), &snapshot);
	}
	return rc < 0 ? rc : stage_timestamp(next, snapshot);
}

/* Opens and locks the folder. */
static int begin(struct next *next, const struct tuf_place *place, int *fd)
{
	int rc = make_folders(place->release, "tuf/targets");

	*fd = rc < 0 ? rc : lock(place->release);
	if (*fd < 0)
		return *fd;
	rc = exchange_check(place->keys_folder);
	if (rc == 0)
		rc = signing_read(&next->signing, place->keys_folder);
	if (rc == 0)
		rc = tuf_folder_open(&next->folder, place);
	if (rc == 0 && !next->renews && tuf_folder_needs_renewal(&next->folder))
		rc = refuse_exchanged(&next->folder, "targets.json");
	return rc;
}

/* Writes what was made if rc is 0, unlocks and frees. Returns rc, or what failed. */
static int end(struct next *next, int fd, int rc)
{
	if (rc == 0)
		rc = release_tuf_put_roots(&next->folder.place);
	if (rc == 0)
		rc = next->unsigned_folder ? keep_all(next) : put_all(next);
	finish(next);
	if (fd >= 0)
		close(fd);
	return rc;
}

int release_tuf_write(const struct tuf_place *place, const struct release *what,
		      struct bytes release_file, int64_t timestamp_life_s,
		      const char *unsigned_folder)
{
	struct next next = { .unsigned_folder = unsigned_folder,
			     .timestamp_life_s = timestamp_life_s };
	int fd, rc = begin(&next, place, &fd);

	if (rc == 0)
		rc = make_all(&next, what, release_file);
	return end(&next, fd, rc);
}

/* ---- targets.json without a release */

static int change_all(struct next *next, const struct tuf_change *change)
{
	const struct tuf_folder *folder = &next->folder;
	const uint32_t version = folder->top_version + 1;
	cJSON *content = tuf_next_content(last_top(folder, change->renews), TUF_TARGETS, version,
					  change->expires_s);
	uint32_t snapshot;
	int rc = object_in(content, "targets") ? 0 : -ENOMEM;

	if (rc == 0)
		rc = change->edit(change->context, folder, content);
	if (rc < 0) {
		cJSON_Delete(content);
		return rc;
	}
	rc = stage_naming(next, version, change->expires_s, content, &snapshot);
	return rc < 0 ? rc : stage_timestamp(next, snapshot);
}

int release_tuf_change(const struct tuf_place *place, const struct tuf_change *change,
		       int64_t timestamp_life_s, const char *unsigned_folder)
{
	struct next next = { .unsigned_folder = unsigned_folder,
			     .timestamp_life_s = timestamp_life_s,
			     .renews = change->renews };
	int fd, rc = begin(&next, place, &fd);

	if (rc == 0)
		rc = change_all(&next, change);
	return end(&next, fd, rc);
}

/* ---- signatures that were made elsewhere */

static int outdated(const char *folder, const char *name)
{
	log_error("pipeline",
		  "%s/%s: something else was published since it was written: publish again with "
		  "--write-unsigned",
		  folder, name);
	return -ESTALE;
}

/* Reads what was staged: a timestamp, and the snapshot and targets that it names where they are
 * new. */
static int read_staged(struct next *next, const char *staged_folder)
{
	const struct tuf_folder *folder = &next->folder;
	struct tuf_staged *files = next->files;
	struct tuf_file timestamp = { 0 }, snapshot = { 0 };
	const char *why;
	char name[PATH_MAX];
	uint32_t version = 0, naming_version;
	int rc = tuf_staged_read(&files[TUF_TIMESTAMP], folder, staged_folder, TUF_TIMESTAMP, 0);

	if (rc == -ENOENT)
		return complain(staged_folder, "timestamp.json", rc);
	if (rc == 0)
		rc = tuf_file_parse(&timestamp, buffer_bytes(&files[TUF_TIMESTAMP].file),
				    TUF_TIMESTAMP, &why);
	if (rc == 0 && timestamp.version <= folder->timestamp.version)
		rc = outdated(staged_folder, "timestamp.json");
	if (rc == 0)
		version = tuf_meta_version(tuf_meta(&timestamp, "snapshot.json"));
	tuf_file_finish(&timestamp);
	if (rc < 0 || version == last_snapshot(folder))
		return rc;
	if (version < last_snapshot(folder))
		return outdated(staged_folder, "timestamp.json");
	rc = tuf_staged_read(&files[TUF_SNAPSHOT], folder, staged_folder, TUF_SNAPSHOT, version);
	if (rc == -ENOENT)
		complain(staged_folder, "the snapshot that timestamp.json names", rc);
	if (rc == 0)
		rc = tuf_file_parse(&snapshot, buffer_bytes(&files[TUF_SNAPSHOT].file),
				    TUF_SNAPSHOT, &why);
	if (rc < 0)
		return rc;
	snprintf(name, sizeof(name), "%s.json", tuf_folder_naming_name(folder));
	naming_version =
		tuf_meta(&snapshot, name) ? tuf_meta_version(tuf_meta(&snapshot, name)) : 0;
	tuf_file_finish(&snapshot);
	if (naming_version <= tuf_folder_naming_version(folder))
		return outdated(staged_folder, name);
	rc = tuf_staged_read(&files[TUF_TARGETS], folder, staged_folder, TUF_TARGETS,
			     naming_version);
	return rc == -ENOENT ? complain(staged_folder, name, rc) : rc;
}

/* Who may sign a release often has no key of the files that all temples share. */
static int sign_shared(struct next *next)
{
	static const enum tuf_type shared[] = { TUF_SNAPSHOT, TUF_TIMESTAMP };
	int rc = 0;

	for (size_t i = 0; i < ARRAY_COUNT(shared) && rc == 0; i++) {
		struct tuf_staged *staged = &next->files[shared[i]];

		if (!staged->name[0] || tuf_staged_is_signed(staged))
			continue;
		rc = tuf_staged_sign(staged, &next->signing);
		if (rc == 0)
			rc = tuf_staged_write(staged);
	}
	return rc;
}

/* All that lack signatures are named, not only the first. */
static int check_staged(const struct next *next)
{
	int rc = 0;

	for (size_t i = 0; i < ARRAY_COUNT(order); i++)
		if (next->files[order[i]].name[0] && tuf_staged_check(&next->files[order[i]]) < 0)
			rc = -EKEYREJECTED;
	return rc;
}

int release_tuf_add_signatures(const struct tuf_place *place, const char *staged_folder)
{
	/* What is carried on was decided when it was staged. A role needs valid delegations. */
	struct next next = { .renews = !place->role || !place->role[0] };
	int fd, rc = begin(&next, place, &fd);

	if (rc == 0)
		rc = read_staged(&next, staged_folder);
	if (rc == 0)
		rc = sign_shared(&next);
	if (rc == 0)
		rc = check_staged(&next);
	return end(&next, fd, rc);
}
