/* Creates, reads and checks the publisher's key files and the signed roots. New files are written
 * so that a power cut leaves either none or a complete one. */
#include "pipeline/keys/keys.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/transient.h"
#include "format/metadata_sign.h"
#include "pipeline/keys/exchange_folder.h"

static const char *const role_names[] = { "root", "release", "timestamp" };

static int key_path(char path[PATH_MAX], const char *folder, const char *name)
{
	return snprintf(path, PATH_MAX, "%s/%s.key", folder, name) < PATH_MAX ? 0 : -ENAMETOOLONG;
}

static const char key_mark[] = "gopura-key-1 ";

enum { KEY_FILE_BYTES_MAX = 255 };

static int complain(const char *path, int rc)
{
	log_error("pipeline", "%s: %s", path, strerror(-rc));
	return rc;
}

bool keys_is_key_file(int fd)
{
	char start[sizeof(key_mark) - 1];

	return pread(fd, start, sizeof(start), 0) == (ssize_t)sizeof(start) &&
	       memcmp(start, key_mark, sizeof(start)) == 0;
}

/* Returns 1 if something is there, 0 if not, or a negative errno, logged: a key that cannot be seen
 * must not be made anew. */
static int is_there(const char *path, struct stat *out)
{
	if (lstat(path, out) == 0)
		return 1;
	return errno == ENOENT || errno == ENOTDIR ? 0 : complain(path, -errno);
}

/* As is_there. An empty file is the remains of a power cut and does not count. */
static int has_named(const char *folder, const char *name)
{
	char path[PATH_MAX];
	struct stat status;
	int rc = key_path(path, folder, name);

	if (rc == 0)
		rc = is_there(path, &status);
	return rc > 0 && S_ISREG(status.st_mode) && status.st_size == 0 ? 0 : rc;
}

static int has_key(const char *folder, enum meta_role role)
{
	return has_named(folder, role_names[role]);
}

static int has_root(const char *folder)
{
	char path[PATH_MAX];
	struct stat status;

	return snprintf(path, sizeof(path), "%s/root/1.json", folder) < PATH_MAX
		       ? is_there(path, &status)
		       : complain(folder, -ENAMETOOLONG);
}

bool keys_are_in(const char *folder)
{
	return has_root(folder) || has_key(folder, META_ROOT) || has_key(folder, META_RELEASE) ||
	       has_key(folder, META_TIMESTAMP);
}

/* ---- creating keys */

/* Makes the folder's entries durable. */
int keys_sync_folder(const char *path)
{
	int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	int rc = fd < 0 || fsync(fd) < 0 ? -errno : 0;

	if (fd >= 0)
		close(fd);
	return rc < 0 ? complain(path, rc) : 0;
}

int keys_write_private(const char *path, const char *text)
{
	char aside[PATH_MAX + 8];
	ssize_t put;
	int fd, rc = 0;

	snprintf(aside, sizeof(aside), "%s.part", path);
	if (unlink(aside) < 0 && errno != ENOENT)
		return -errno;
	fd = open(aside, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
	if (fd < 0)
		return -errno;
	put = write(fd, text, strlen(text));
	if (put < 0 || fsync(fd) < 0)
		rc = -errno;
	else if ((size_t)put != strlen(text))
		rc = -ENOSPC;
	if (close(fd) < 0 && rc == 0)
		rc = -errno;
	if (rc == 0 && rename(aside, path) < 0)
		rc = -errno;
	if (rc < 0)
		unlink(aside);
	return rc;
}

/* The first 32 bytes of a secret key of libsodium are its seed. */
int keys_write_key(const char *path, const char *name, const struct signing_key *key)
{
	char text[192], hex[2 * crypto_sign_SEEDBYTES + 1];
	int rc;

	sodium_bin2hex(hex, sizeof(hex), key->secret, crypto_sign_SEEDBYTES);
	snprintf(text, sizeof(text), "%s%s %s\n", key_mark, name, hex);
	rc = keys_write_private(path, text);
	sodium_memzero(text, sizeof(text));
	sodium_memzero(hex, sizeof(hex));
	return rc < 0 ? complain(path, rc) : 0;
}

static int make_key(struct signing_key *key, const char *folder, const char *name)
{
	char path[PATH_MAX];
	int rc = key_path(path, folder, name);

	crypto_sign_keypair(key->public_key, key->secret);
	return rc < 0 ? rc : keys_write_key(path, name, key);
}

static int write_root(const char *folder, const struct signing_key keys[3])
{
	struct trust_root root = { .version = 1, .expires_s = clock_wall_s() + KEYS_ROOT_LIFE_S };
	char path[PATH_MAX];
	struct buffer file;
	int rc;

	for (int role = META_ROOT; role <= META_TIMESTAMP; role++) {
		root.roles[role].threshold = root.roles[role].key_count = 1;
		memcpy(root.roles[role].keys[0], keys[role].public_key, KEY_BYTES);
	}
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	rc = trust_root_encode(&file, &root, &keys[META_ROOT], 1);
	snprintf(path, sizeof(path), "%s/root/1.json", folder);
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&file), path);
	buffer_finish(&file);
	return rc < 0 ? complain(path, rc) : 0;
}

static int make_folders(const char *folder)
{
	char path[PATH_MAX];

	if (snprintf(path, sizeof(path), "%s/root", folder) >= PATH_MAX)
		return -ENAMETOOLONG;
	if (mkdir(folder, 0700) < 0 && errno != EEXIST)
		return complain(folder, -errno);
	if (mkdir(path, 0755) < 0 && errno != EEXIST)
		return complain(path, -errno);
	return 0;
}

int keys_decode(struct signing_key *out, struct bytes file, const char *role)
{
	uint8_t seed[crypto_sign_SEEDBYTES];
	char text[KEY_FILE_BYTES_MAX + 1] = { 0 }, start[64];
	const char *hex;
	size_t got = 0;
	int rc = 0;

	if (file.size >= sizeof(text))
		return -EBADMSG;
	memcpy(text, file.data, file.size);
	snprintf(start, sizeof(start), "%s%s", key_mark, role ? role : "");
	hex = strrchr(text, ' ');
	if (strncmp(text, start, strlen(start)) != 0 || !hex ||
	    (role && hex != text + strlen(start)) ||
	    sodium_hex2bin(seed, sizeof(seed), hex + 1, strcspn(hex + 1, "\n"), NULL, &got, NULL) !=
		    0 ||
	    got != sizeof(seed))
		rc = -EBADMSG;
	else
		crypto_sign_seed_keypair(out->public_key, out->secret, seed);
	sodium_memzero(text, sizeof(text));
	sodium_memzero(seed, sizeof(seed));
	return rc;
}

static int read_key(struct signing_key *key, const char *folder, const char *name)
{
	char path[PATH_MAX];
	struct buffer file;
	struct stat stat_of;
	int rc = key_path(path, folder, name);

	if (rc < 0)
		return rc;
	buffer_init(&file, KEY_FILE_BYTES_MAX);
	rc = buffer_read_file(&file, path);
	if (rc == 0 && stat(path, &stat_of) == 0 && (stat_of.st_mode & 077)) {
		log_error("pipeline", "%s: others may read this key; run chmod 600 on it", path);
		buffer_finish(&file);
		return -EPERM;
	}
	if (rc == 0)
		rc = keys_decode(key, buffer_bytes(&file), name);
	if (file.data)
		sodium_memzero(file.data, file.size);
	buffer_finish(&file);
	return rc < 0 ? complain(path, rc) : 0;
}

int keys_named(struct signing_key *out, const char *folder, const char *name)
{
	int rc = sodium_init() < 0 ? -EIO : has_named(folder, name);

	if (rc < 0)
		return rc;
	return rc > 0 ? read_key(out, folder, name) : make_key(out, folder, name);
}

int keys_read_key(struct signing_key *out, const char *folder, const char *name)
{
	const int rc = has_named(folder, name);

	if (rc < 0)
		return rc;
	return rc > 0 ? read_key(out, folder, name) : -ENOENT;
}

/* Keys are created in this order. So a folder that has a later key without an earlier one is not an
 * interrupted run: somebody removed the earlier one. */
static int judge_order(const char *folder, const int has[3])
{
	for (int role = META_RELEASE; role <= META_TIMESTAMP; role++)
		if (has[role] && !has[role - 1]) {
			log_error("pipeline",
				  "%s: %s.key exists, but %s.key and root/1.json do not: restore "
				  "them from your copy, or begin with an empty folder",
				  folder, role_names[role], role_names[role - 1]);
			return -EEXIST;
		}
	return 0;
}

/* Creates everything that is missing, and root/1.json last: until it exists there are no keys. */
static int complete(const char *folder)
{
	struct signing_key keys[3];
	int has[3], rc = 0;

	for (int role = META_ROOT; role <= META_TIMESTAMP; role++) {
		has[role] = has_key(folder, (enum meta_role)role);
		if (has[role] < 0)
			return has[role];
	}
	rc = judge_order(folder, has);
	if (rc == 0)
		rc = make_folders(folder);
	for (int role = META_ROOT; rc == 0 && role <= META_TIMESTAMP; role++)
		rc = has[role] ? read_key(&keys[role], folder, role_names[role])
			       : make_key(&keys[role], folder, role_names[role]);
	if (rc == 0)
		rc = keys_sync_folder(folder);
	if (rc == 0)
		rc = write_root(folder, keys);
	sodium_memzero(keys, sizeof(keys));
	return rc;
}

int keys_sync_parent(const char *folder)
{
	char parent[PATH_MAX];
	char *slash;

	snprintf(parent, sizeof(parent), "%s", folder);
	slash = strrchr(parent, '/');
	if (slash && slash != parent)
		*slash = '\0';
	return keys_sync_folder(!slash ? "." : slash == parent ? "/" : parent);
}

int keys_make(const char *folder)
{
	char aside[PATH_MAX];
	struct stat status;
	int rc;

	if (sodium_init() < 0)
		return -EIO;
	rc = has_root(folder);
	if (rc != 0)
		return rc < 0 ? rc : complain(folder, -EEXIST);
	rc = is_there(folder, &status);
	if (rc != 0)
		return rc < 0 ? rc : complete(folder);
	if (snprintf(aside, sizeof(aside), "%s.part", folder) >= PATH_MAX)
		return complain(folder, -ENAMETOOLONG);
	rc = has_root(aside);
	if (rc >= 0)
		rc = rc > 0 ? 0 : complete(aside);
	if (rc == 0 && rename(aside, folder) < 0)
		rc = complain(folder, -errno);
	return rc < 0 ? rc : keys_sync_parent(folder);
}

/* ---- using keys */

int keys_read_root(struct buffer *out, const char *folder, uint32_t version)
{
	char path[PATH_MAX];

	if (snprintf(path, sizeof(path), "%s/root/%u.json", folder, version) >= PATH_MAX)
		return -ENAMETOOLONG;
	return buffer_read_file(out, path);
}

int keys_follow_roots(struct trust_root *trust, const char *folder, const char **why)
{
	struct buffer file;
	int rc;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	while ((rc = keys_read_root(&file, folder, trust->version + 1)) == 0 &&
	       (rc = trust_root_next(trust, buffer_bytes(&file), why)) == 0)
		;
	buffer_finish(&file);
	return rc == -ENOENT ? 0 : rc;
}

static bool role_has(const struct role_keys *role, const struct signing_key *key)
{
	for (uint32_t i = 0; i < role->key_count; i++)
		if (memcmp(role->keys[i], key->public_key, KEY_BYTES) == 0)
			return true;
	return false;
}

static bool names(const struct trust_root *root, const struct publisher_keys *keys)
{
	return role_has(&root->roles[META_RELEASE], &keys->release) &&
	       role_has(&root->roles[META_TIMESTAMP], &keys->timestamp);
}

int keys_read_trust(struct trust_root *trust, const char *folder)
{
	const char *why = "unreadable";
	struct buffer file;
	int rc;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	rc = keys_read_root(&file, folder, 1);
	if (rc == 0)
		rc = trust_root_first(trust, buffer_bytes(&file), &why);
	if (rc == 0)
		rc = keys_follow_roots(trust, folder, &why);
	if (rc < 0 && rc != -ENOENT)
		log_error("pipeline", "%s/root: %s", folder, why);
	buffer_finish(&file);
	return rc;
}

int keys_load(struct publisher_keys *out, const char *folder)
{
	int rc;

	*out = (struct publisher_keys){ 0 };
	if (sodium_init() < 0)
		return -EIO;
	rc = keys_read_trust(&out->trust, folder);
	if (rc == 0)
		rc = exchange_check(folder);
	if (rc == 0)
		rc = read_key(&out->release, folder, role_names[META_RELEASE]);
	if (rc == 0)
		rc = read_key(&out->timestamp, folder, role_names[META_TIMESTAMP]);
	if (rc == 0 && !names(&out->trust, out)) {
		log_error("pipeline", "%s: the newest root does not name these keys", folder);
		rc = -EKEYREJECTED;
	}
	if (rc < 0)
		keys_finish(out);
	return rc;
}

int keys_check_release(const struct publisher_keys *keys, const char *release)
{
	struct trust_root newest = keys->trust;
	const char *why = NULL;
	const int rc = keys_follow_roots(&newest, release, &why);

	if (rc < 0 && (is_transient(rc) || !why))
		return complain(release, rc);
	if (rc < 0)
		log_warn("pipeline", "%s/root/%u.json: %s; terminals refuse it: remove it", release,
			 newest.version + 1, why);
	if (names(&newest, keys))
		return 0;
	log_error("pipeline",
		  "%s/root/%u.json does not name these keys, so terminals would refuse what they "
		  "sign: keys were exchanged elsewhere since; bring the folder of keys from there",
		  release, newest.version);
	return -EKEYREJECTED;
}

void keys_finish(struct publisher_keys *keys)
{
	if (keys)
		sodium_memzero(keys, sizeof(*keys));
}
