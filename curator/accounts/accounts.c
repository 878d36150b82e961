/* Reads, changes and writes accounts.json. */
#include "curator/accounts/accounts.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/array.h"
#include "base/json_tree.h"

static const char file_name[] = ".curator/accounts.json";

void accounts_finish(struct accounts *accounts)
{
	if (!accounts)
		return;
	free(accounts->list);
	*accounts = (struct accounts){ 0 };
}

bool account_name_is_valid(const char *name)
{
	static const char good[] =
		"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._@+-";
	const size_t bytes = strlen(name);

	return bytes > 0 && bytes < ACCOUNT_NAME_BYTES && strspn(name, good) == bytes &&
	       !strchr("._@+-", name[0]);
}

/* ---- the text */

static const char *text_of(const cJSON *object, const char *key)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);

	return cJSON_IsString(item) ? item->valuestring : "";
}

/* An argon2id string as libsodium writes it, or none. Others could not be printed again. */
static bool is_hash(const char *text)
{
	static const char letters[] = "$,=+/0123456789abcdefghijklmnopqrstuvwxyz"
				      "ABCDEFGHIJKLMNOPQRSTUVWXYZ";

	return strlen(text) < ACCOUNT_HASH_BYTES && text[strspn(text, letters)] == '\0';
}

static int parse_account(struct accounts *accounts, const cJSON *row,
			 struct diagnostics *diagnostics)
{
	const char *name = text_of(row, "name"), *hash = text_of(row, "password");
	enum role role;
	int rc;

	if (role_parse(&role, text_of(row, "role")) < 0)
		return diagnostics_add(diagnostics, -EBADMSG, file_name, 0,
				       "an account has no role: it is reader, editor or publisher");
	if (!is_hash(hash))
		return diagnostics_add(diagnostics, -EBADMSG, file_name, 0,
				       "a password is not one that 'gopura-curator user' wrote");
	rc = accounts_add(accounts, name, role);
	if (rc == -EEXIST || rc == -EINVAL || rc == -EFBIG)
		return diagnostics_add(diagnostics, -EBADMSG, file_name, 0,
				       "the name of an account is missing, wrong or there twice");
	if (rc == 0)
		memcpy(accounts->list[accounts->count - 1].hash, hash, strlen(hash) + 1);
	return rc;
}

int accounts_parse(struct accounts *out, struct bytes text, struct diagnostics *diagnostics)
{
	cJSON *root;
	int rc = json_parse(&root, text);
	const cJSON *list = cJSON_GetObjectItemCaseSensitive(root, "accounts"), *row;

	*out = (struct accounts){ 0 };
	if (rc == -ENOMEM)
		rc = diagnostics_add(diagnostics, rc, file_name, 0, "no memory is left");
	else if (!cJSON_IsArray(list))
		rc = diagnostics_add(diagnostics, -EBADMSG, file_name, 0,
				     "is not a list of accounts: take it from a backup, or remove "
				     "it and make the accounts anew");
	else
		cJSON_ArrayForEach(row, list)
		{
			rc = parse_account(out, row, diagnostics);
			if (rc < 0)
				break;
		}
	cJSON_Delete(root);
	if (rc < 0)
		accounts_finish(out);
	return rc;
}

void accounts_print(struct buffer *out, const struct accounts *accounts)
{
	/* Names, roles and argon2id strings have no character that JSON would escape. */
	buffer_put_text(out, "{\"accounts\": [");
	for (uint32_t n = 0; n < accounts->count; n++) {
		const struct account *account = &accounts->list[n];

		buffer_print(out, "%s\n  {\"name\": \"%s\", \"role\": \"%s\"", n > 0 ? "," : "",
			     account->name, role_name(account->role));
		if (account->hash[0])
			buffer_print(out, ", \"password\": \"%s\"", account->hash);
		buffer_put_text(out, "}");
	}
	buffer_put_text(out, "\n]}\n");
}

/* ---- the file */

static int path_of(char path[PATH_MAX], const char *folder, const char *name,
		   struct diagnostics *diagnostics)
{
	if (snprintf(path, PATH_MAX, "%s/%s", folder, name) < PATH_MAX)
		return 0;
	return diagnostics_add(diagnostics, -ENAMETOOLONG, folder, 0, "is too long a path");
}

static int read_file(struct buffer *text, const char *path, struct diagnostics *diagnostics)
{
	struct stat stat;
	int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);

	if (fd < 0)
		return errno == ENOENT ? -ENOENT
				       : diagnostics_add(diagnostics, -errno, path, 0, "%s",
							 strerror(errno));
	if (fstat(fd, &stat) == 0 && (!S_ISREG(stat.st_mode) || stat.st_mode & 077)) {
		close(fd);
		return diagnostics_add(
			diagnostics, -EPERM, path, 0,
			"others may read it: chmod 600 it, and choose new passwords");
	}
	return buffer_read_fd(text, fd);
}

int accounts_read(struct accounts *out, const char *folder, struct diagnostics *diagnostics)
{
	char path[PATH_MAX];
	struct buffer text;
	int rc = path_of(path, folder, file_name, diagnostics);

	*out = (struct accounts){ 0 };
	if (rc < 0)
		return rc;
	buffer_init(&text, ACCOUNTS_FILE_BYTES_MAX);
	rc = read_file(&text, path, diagnostics);
	if (rc == 0)
		rc = accounts_parse(out, buffer_bytes(&text), diagnostics);
	buffer_finish(&text);
	return rc == -ENOENT ? 0 : rc;
}

int accounts_make_folder(const char *folder, struct diagnostics *diagnostics)
{
	static const char ignored[] = "*\n"; /* a history of the content has no passwords */
	char path[PATH_MAX];
	struct stat is;
	int rc = path_of(path, folder, ".curator", diagnostics);

	if (rc < 0)
		return rc;
	if (mkdir(path, 0711) < 0 && errno != EEXIST)
		return diagnostics_add(diagnostics, -errno, path, 0, "%s", strerror(errno));
	/* The publisher, which may be another user, finds what it knows the name of. What is secret
	 * has a mode of its own. Whoever does not own the folder leaves it as it is. */
	if (stat(path, &is) < 0 || (chmod(path, (is.st_mode & 07777) | 0711) < 0 && errno != EPERM))
		return diagnostics_add(diagnostics, -errno, path, 0, "%s", strerror(errno));
	rc = path_of(path, folder, ".curator/.gitignore", diagnostics);
	if (rc < 0 || access(path, F_OK) == 0)
		return rc;
	rc = bytes_write_file((struct bytes){ (const uint8_t *)ignored, strlen(ignored) }, path);
	return rc < 0 ? diagnostics_add(diagnostics, rc, path, 0, "%s", strerror(-rc)) : 0;
}

/* As bytes_write_file, which would let everybody read it. */
static int write_secret(struct bytes bytes, const char *path)
{
	char temporary[BYTES_PATH_MAX];
	int fd = bytes_begin_file(temporary, path), rc;

	if (fd < 0)
		return fd;
	rc = bytes_fill_file(fd, bytes);
	if (rc == 0 && fchmod(fd, 0600) < 0)
		rc = -errno;
	if (close(fd) < 0 && rc == 0)
		rc = -errno;
	if (rc == 0 && rename(temporary, path) < 0)
		rc = -errno;
	if (rc < 0)
		unlink(temporary);
	return rc < 0 ? rc : bytes_sync_folder_of(path);
}

int accounts_write(const struct accounts *accounts, const char *folder,
		   struct diagnostics *diagnostics)
{
	char path[PATH_MAX];
	struct buffer text;
	int rc = accounts_make_folder(folder, diagnostics);

	if (rc == 0)
		rc = path_of(path, folder, file_name, diagnostics);
	if (rc < 0)
		return rc;
	buffer_init(&text, ACCOUNTS_FILE_BYTES_MAX);
	accounts_print(&text, accounts);
	rc = text.error;
	if (rc == 0)
		rc = write_secret(buffer_bytes(&text), path);
	if (rc < 0)
		diagnostics_add(diagnostics, rc, path, 0, "%s", strerror(-rc));
	buffer_finish(&text);
	return rc;
}

int accounts_lock(const char *folder, struct diagnostics *diagnostics)
{
	char path[PATH_MAX];
	int fd, rc = accounts_make_folder(folder, diagnostics);

	if (rc == 0)
		rc = path_of(path, folder, ".curator/lock", diagnostics);
	if (rc < 0)
		return rc;
	fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
	if (fd < 0 || flock(fd, LOCK_EX) < 0) {
		rc = diagnostics_add(diagnostics, -errno, path, 0, "%s", strerror(errno));
		if (fd >= 0)
			close(fd);
		return rc;
	}
	if (path_of(path, folder, file_name, NULL) == 0)
		bytes_drop_leftovers(path); /* of a command that was killed */
	return fd;
}

/* ---- the list */

struct account *accounts_find(const struct accounts *accounts, const char *name)
{
	for (uint32_t n = 0; n < accounts->count; n++)
		if (strcmp(accounts->list[n].name, name) == 0)
			return &accounts->list[n];
	return NULL;
}

int accounts_add(struct accounts *accounts, const char *name, enum role role)
{
	struct account account = { .role = role };
	int rc;

	if (!account_name_is_valid(name))
		return -EINVAL;
	if (accounts_find(accounts, name))
		return -EEXIST;
	rc = ARRAY_RESERVE(accounts->list, accounts->room, accounts->count + 1, ACCOUNTS_MAX);
	if (rc < 0)
		return rc;
	memcpy(account.name, name, strlen(name) + 1);
	accounts->list[accounts->count++] = account;
	return 0;
}

int accounts_remove(struct accounts *accounts, const char *name)
{
	struct account *account = accounts_find(accounts, name);
	const struct account *end = accounts->list + accounts->count;

	if (!account)
		return -ENOENT;
	memmove(account, account + 1, (size_t)(end - account - 1) * sizeof(*account));
	accounts->count--;
	return 0;
}

/* ---- passwords */

int account_set_password(struct account *account, const char *password)
{
	const size_t bytes = strlen(password);

	if (bytes < PASSWORD_MIN_BYTES || bytes > PASSWORD_MAX_BYTES)
		return -EINVAL;
	if (sodium_init() < 0 ||
	    crypto_pwhash_str(account->hash, password, bytes, crypto_pwhash_OPSLIMIT_INTERACTIVE,
			      crypto_pwhash_MEMLIMIT_INTERACTIVE) != 0)
		return -ENOMEM;
	return 0;
}

bool account_verify(const struct account *account, const char *password)
{
	/* Of no password, with the same limits: who asks must not learn from the time whether there
	 * is such an account. */
	static const char nobodys[] = "$argon2id$v=19$m=65536,t=2,p=1$AAAAAAAAAAAAAAAAAAAAAA$"
				      "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA";
	const bool has_one = account && account->hash[0];
	const size_t bytes = strlen(password);

	if (sodium_init() < 0 || bytes > PASSWORD_MAX_BYTES)
		return false;
	return crypto_pwhash_str_verify(has_one ? account->hash : nobodys, password, bytes) == 0 &&
	       has_one;
}
