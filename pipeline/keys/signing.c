/* Reads signing.ini, and has keys and programs sign. */
#include "pipeline/keys/signing.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/log.h"
#include "base/settings.h"
#include "pipeline/keys/keys.h"
#include "pipeline/keys/signer_program.h"
#include "tuf/private_key.h"
#include "tuf/sign.h"

enum {
	KEY_FILE_BYTES_MAX = 16 << 10,
	SIGNATURE_BYTES_MAX = 1024,
	PROGRAM_S = 600, /* a person may have to come and touch a hardware key */
};

/* ---- signing.ini */

static bool set_signers(const struct setting *setting, void *target, const char *value)
{
	char *to = (char *)target + setting->offset;

	if (strlen(value) >= SIGNING_LIST_BYTES || !value[strspn(value, ", \t")])
		return false;
	snprintf(to, SIGNING_LIST_BYTES, "%s", value);
	return true;
}

static const struct setting settings[] = {
	{ .section = "keys",
	  .name = "targets",
	  .expects = "names of files, separated by commas, or none",
	  .set = set_signers,
	  .offset = offsetof(struct signing, signers[TUF_TARGETS]) },
	{ .section = "keys",
	  .name = "snapshot",
	  .expects = "names of files, separated by commas, or none",
	  .set = set_signers,
	  .offset = offsetof(struct signing, signers[TUF_SNAPSHOT]) },
	{ .section = "keys",
	  .name = "timestamp",
	  .expects = "names of files, separated by commas, or none",
	  .set = set_signers,
	  .offset = offsetof(struct signing, signers[TUF_TIMESTAMP]) },
};

int signing_read(struct signing *out, const char *folder)
{
	struct diagnostics diagnostics = { 0 };
	char path[PATH_MAX];
	int rc = 0;

	*out = (struct signing){ .signers = { [TUF_TARGETS] = "release.key",
					      [TUF_SNAPSHOT] = "release.key",
					      [TUF_TIMESTAMP] = "timestamp.key" } };
	if (snprintf(out->folder, sizeof(out->folder), "%s", folder) >= PATH_MAX ||
	    snprintf(path, sizeof(path), "%s/signing.ini", folder) >= PATH_MAX)
		return -ENAMETOOLONG;
	if (access(path, F_OK) == 0)
		rc = settings_read_file(path, settings, ARRAY_COUNT(settings), out, &diagnostics);
	for (uint32_t i = 0; i < diagnostics.count; i++)
		log_error("pipeline", "%s", diagnostics_get(&diagnostics, i)->text);
	diagnostics_finish(&diagnostics);
	return rc;
}

/* ---- one signer */

/* Signs with a key of gopura, whatever its role: the root says what it may sign. */
static int sign_with_seed(struct buffer *out, struct bytes file, struct bytes message)
{
	uint8_t signature[crypto_sign_BYTES];
	struct signing_key key;
	int rc = keys_decode(&key, file, NULL);

	if (rc == 0) {
		crypto_sign_detached(signature, NULL, message.data, message.size, key.secret);
		buffer_put(out, signature, sizeof(signature));
	}
	sodium_memzero(&key, sizeof(key));
	return rc < 0 ? rc : out->error;
}

/* fd is closed. */
static int sign_with_key(struct buffer *out, int fd, struct bytes message)
{
	const bool is_seed = keys_is_key_file(fd);
	struct buffer file;
	int rc;

	buffer_init(&file, KEY_FILE_BYTES_MAX);
	rc = buffer_read_fd(&file, fd);
	if (rc == 0)
		rc = is_seed ? sign_with_seed(out, buffer_bytes(&file), message)
			     : tuf_private_sign(out, buffer_bytes(&file), message);
	if (file.data)
		sodium_memzero(file.data, file.size);
	buffer_finish(&file);
	return rc;
}

static const char *why_not(int rc)
{
	switch (rc) {
	case -EBADMSG:
		return "neither a key of gopura nor a private key in PEM without a passphrase; for "
		       "one with a passphrase or in hardware, name a program that signs";
	case -EOPNOTSUPP:
		return "only ed25519, ECDSA P-256 and RSA from 2048 bits are keys of The Update "
		       "Framework";
	case -ETIMEDOUT:
		return "it did not sign within ten minutes";
	case -EIO:
		return "it failed; what it said is above";
	default:
		return strerror(-rc);
	}
}

static int sign_with(struct buffer *out, const char *path, const char *name, struct bytes message)
{
	struct stat status;
	int rc, fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);

	if (fd < 0 || fstat(fd, &status) < 0) {
		rc = -errno;
	} else if (!S_ISREG(status.st_mode)) {
		rc = -EINVAL;
	} else if (status.st_mode & 0111) {
		if (status.st_mode & 022)
			log_error("pipeline",
				  "%s: others may change this program; run chmod go-w on it", path);
		rc = status.st_mode & 022 ? -EPERM
					  : signer_program_run(out, path, name, message, PROGRAM_S);
	} else if (status.st_mode & 077) {
		log_error("pipeline", "%s: others may read this key; run chmod 600 on it", path);
		rc = -EPERM;
	} else {
		rc = sign_with_key(out, fd, message);
		fd = -1;
	}
	if (fd >= 0)
		close(fd);
	if (rc < 0 && rc != -EPERM)
		log_error("pipeline", "%s: %s", path, why_not(rc));
	return rc;
}

static int sign_one(const char *path, const char *name, const struct cJSON *keys,
		    const struct cJSON *role, struct bytes message, struct cJSON *signatures)
{
	struct buffer signature;
	int rc;

	buffer_init(&signature, SIGNATURE_BYTES_MAX);
	rc = sign_with(&signature, path, name, message);
	if (rc == 0) {
		rc = tuf_add_signature(signatures, keys, role, message, buffer_bytes(&signature));
		if (rc < 0)
			log_error("pipeline", "%s: %s", path,
				  rc == -EKEYREJECTED
					  ? "its signature is by none of the keys that may sign "
					    "this file; name another in signing.ini, or have a new "
					    "root name this one"
					  : strerror(-rc));
	}
	buffer_finish(&signature);
	return rc;
}

int signing_sign(const struct signing *signing, enum tuf_type type, const char *name,
		 const struct cJSON *keys, const struct cJSON *role, struct bytes message,
		 struct cJSON *signatures)
{
	const char *list = signing->signers[type];
	int rc = sodium_init() < 0 ? -EIO : 0;

	if (strcmp(list, "none") == 0)
		return rc;
	while (rc == 0 && *(list += strspn(list, ", \t"))) {
		const int length = (int)strcspn(list, ", \t");
		char path[2 * PATH_MAX];

		snprintf(path, sizeof(path), "%s%s%.*s", *list == '/' ? "" : signing->folder,
			 *list == '/' ? "" : "/", length, list);
		rc = sign_one(path, name, keys, role, message, signatures);
		list += length;
	}
	return rc;
}
