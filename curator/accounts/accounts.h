/* The accounts of a content folder: DIR/.curator/accounts.json, mode 0600.
 *
 *   {"accounts": [{"name": "ana", "role": "editor", "password": "$argon2id$..."}]}
 *
 * A password is kept as libsodium's argon2id string (RFC 9106; two passes over 64 MB). An account
 * without one is for a museum's own sign-on. */
#ifndef GOPURA_CURATOR_ACCOUNTS_ACCOUNTS_H
#define GOPURA_CURATOR_ACCOUNTS_ACCOUNTS_H

#include <stdbool.h>

#include "base/bytes.h"
#include "base/diagnostics.h"
#include "curator/accounts/role.h"

enum {
	ACCOUNTS_MAX = 1000,
	ACCOUNTS_FILE_BYTES_MAX = 1 << 20,
	ACCOUNT_HASH_BYTES = 128, /* crypto_pwhash_STRBYTES */
	PASSWORD_MIN_BYTES = 10,
	PASSWORD_MAX_BYTES = 256, /* without its end */
};

struct account {
	char name[ACCOUNT_NAME_BYTES];
	enum role role;
	char hash[ACCOUNT_HASH_BYTES]; /* "": none */
};

/* Zeroed: none. */
struct accounts {
	struct account *list; /* owned; in the order of the file */
	uint32_t count, room;
};

void accounts_finish(struct accounts *accounts); /* NULL and zeroed are fine */

/* Returns whether it is 1 to 64 characters of A-Z a-z 0-9 . _ @ + -, the first a letter or digit.
 */
bool account_name_is_valid(const char *name);

/* Parses the file's text. *out is for accounts_finish, and empty on failure. -EBADMSG, with a
 * diagnostic; -ENOMEM. */
must_check int accounts_parse(struct accounts *out, struct bytes text,
			      struct diagnostics *diagnostics);
/* Appends the file's text. */
void accounts_print(struct buffer *out, const struct accounts *accounts);

/* Reads those of a content folder; none if there is no file. -EPERM: others may read or write it.
 * Errors of reading, with a diagnostic. */
must_check int accounts_read(struct accounts *out, const char *folder,
			     struct diagnostics *diagnostics);
/* Makes DIR/.curator if it is missing. Errors of the disk, with a diagnostic. */
must_check int accounts_make_folder(const char *folder, struct diagnostics *diagnostics);
/* Replaces the file, whole or not at all; makes DIR/.curator if it is missing. */
must_check int accounts_write(const struct accounts *accounts, const char *folder,
			      struct diagnostics *diagnostics);
/* Waits for other processes that change the accounts. Returns a descriptor whose closing lets the
 * next one go on, or a negative errno with a diagnostic. */
must_check int accounts_lock(const char *folder, struct diagnostics *diagnostics);

/* Returns an account, borrowed until the list changes, or NULL. */
struct account *accounts_find(const struct accounts *accounts, const char *name);
/* Adds one without a password. -EEXIST, -EINVAL: the name. -EFBIG, -ENOMEM. */
must_check int accounts_add(struct accounts *accounts, const char *name, enum role role);
/* -ENOENT. */
must_check int accounts_remove(struct accounts *accounts, const char *name);

/* Takes a few tenths of a second and 64 MB. -EINVAL: too short or too long. -ENOMEM. */
must_check int account_set_password(struct account *account, const char *password);
/* Takes as long, also for account NULL and for one without a password, which both fail. */
bool account_verify(const struct account *account, const char *password);

#endif
