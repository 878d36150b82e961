/* Copies what the museum hands over, and makes the rest. */
#include "pipeline/keys/keys_team.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/log.h"
#include "pipeline/keys/keys.h"
#include "pipeline/keys/keys_path_private.h"
#include "pipeline/keys/keys_tuf.h"
#include "tuf/public_key.h"

enum { FILE_BYTES_MAX = 64 << 10 };

static int make_folders(const char *folder)
{
	char path[PATH_MAX];
	int rc = keys_join(path, folder, "tuf");

	if (rc == 0 && mkdir(folder, 0700) < 0 && errno != EEXIST)
		rc = keys_complain(folder, "", -errno, NULL);
	if (rc == 0 && mkdir(path, 0755) < 0 && errno != EEXIST)
		rc = keys_complain(folder, "tuf", -errno, NULL);
	return rc;
}

static int put(const char *folder, const char *name, struct bytes file)
{
	char path[PATH_MAX];
	int rc = keys_join(path, folder, name);

	if (rc == 0 && (rc = bytes_write_file(file, path)) < 0)
		keys_complain(folder, name, rc, NULL);
	return rc;
}

/* ---- what the museum hands over */

/* Copies one root. -ENOENT: there are no more. */
static int copy_root(const char *folder, const char *from, uint32_t version)
{
	struct buffer theirs, ours;
	char name[64];
	int had, rc;

	buffer_init(&theirs, FILE_BYTES_MAX);
	buffer_init(&ours, FILE_BYTES_MAX);
	snprintf(name, sizeof(name), "tuf/%" PRIu32 ".root.json", version);
	rc = keys_read_tuf_root(&theirs, from, version);
	had = keys_read_tuf_root(&ours, folder, version);
	if (rc == -ENOENT && version == 1)
		keys_complain(from, name, rc,
			      "missing; the museum hands over the folder tuf of its keys");
	else if (rc < 0 && rc != -ENOENT)
		keys_complain(from, name, rc, NULL);
	else if (rc == 0 && had < 0 && had != -ENOENT)
		rc = keys_complain(folder, name, had, NULL);
	else if (rc == 0 && had == 0 && !bytes_equal(buffer_bytes(&theirs), buffer_bytes(&ours)))
		rc = keys_complain(
			folder, name, -EEXIST,
			"another root than the museum's; begin with an empty folder (--keys)");
	else if (rc == 0 && had < 0)
		rc = put(folder, name, buffer_bytes(&theirs));
	buffer_finish(&theirs);
	buffer_finish(&ours);
	return rc;
}

static int copy_roots(const char *folder, const char *from)
{
	uint32_t version = 1;
	int rc;

	while ((rc = copy_root(folder, from, version)) == 0)
		version++;
	return rc == -ENOENT && version > 1 ? 0 : rc;
}

/* Copies a key, if the museum hands it over. */
static int copy_key(const char *folder, const char *from, const char *name)
{
	char path[PATH_MAX];
	struct signing_key key;
	struct buffer file;
	int rc = keys_has(from, name);

	if (rc <= 0)
		return rc;
	buffer_init(&file, 255);
	rc = keys_join(path, from, name);
	if (rc == 0)
		rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = keys_decode(&key, buffer_bytes(&file), NULL);
	buffer_put_u8(&file, 0); /* ends the text */
	if (rc == 0)
		rc = file.error;
	if (rc < 0)
		keys_complain(from, name, rc, rc == -EBADMSG ? "not a key of gopura" : NULL);
	else if ((rc = keys_join(path, folder, name)) == 0 &&
		 (rc = keys_write_private(path, (const char *)file.data)) < 0)
		keys_complain(folder, name, rc, NULL);
	if (file.data)
		sodium_memzero(file.data, file.size);
	sodium_memzero(&key, sizeof(key));
	buffer_finish(&file);
	return rc;
}

/* ---- what is the team's own */

static int make_own_key(const char *folder, const char *role)
{
	struct signing_key key;
	struct buffer file;
	char name[128];
	int rc = keys_named(&key, folder, role);

	buffer_init(&file, FILE_BYTES_MAX);
	snprintf(name, sizeof(name), "%s.pub", role);
	if (rc == 0 && (rc = tuf_public_key_write(&file, key.public_key)) < 0)
		keys_complain(folder, name, rc, NULL);
	if (rc == 0)
		rc = put(folder, name, buffer_bytes(&file));
	sodium_memzero(&key, sizeof(key));
	buffer_finish(&file);
	return rc;
}

static int make_signing(const char *folder, const char *role)
{
	const int snapshot = keys_has(folder, "snapshot.key");
	const int timestamp = keys_has(folder, "timestamp.key");
	const int signing = keys_has(folder, "signing.ini");
	char text[512];
	int size;

	if (snapshot < 0 || timestamp < 0 || signing < 0)
		return -EIO; /* which one was said */
	if (signing)
		return 0;
	size = snprintf(text, sizeof(text),
			"[keys]\ntargets = %s.key\nsnapshot = %s\ntimestamp = %s\n", role,
			snapshot ? "snapshot.key" : "none", timestamp ? "timestamp.key" : "none");
	return put(folder, "signing.ini", (struct bytes){ (const uint8_t *)text, (size_t)size });
}

int keys_make_team(const char *folder, const char *role, const char *handed_over)
{
	int rc = keys_has(folder, "root/1.json");

	if (rc > 0)
		return keys_complain(
			folder, "root/1.json", -EEXIST,
			"these keys publish a temple by themselves; keep those of the role "
			"in another folder (--keys)");
	if (rc < 0)
		return rc;
	if (keys_has(handed_over, "release.key") > 0 || keys_has(handed_over, "root.key") > 0)
		log_warn("pipeline",
			 "%s has the museum's own keys, with which one can publish every temple: "
			 "hand over tuf, snapshot.key and timestamp.key alone",
			 handed_over);
	rc = make_folders(folder);
	if (rc == 0)
		rc = copy_roots(folder, handed_over);
	if (rc == 0)
		rc = copy_key(folder, handed_over, "snapshot.key");
	if (rc == 0)
		rc = copy_key(folder, handed_over, "timestamp.key");
	if (rc == 0)
		rc = make_own_key(folder, role);
	if (rc == 0)
		rc = make_signing(folder, role);
	return rc < 0 ? rc : keys_sync_folder(folder);
}
