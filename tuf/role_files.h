/* The files of roles for the client's workflow: fetched, loaded, stored, opened. */
#ifndef GOPURA_TUF_ROLE_FILES_H
#define GOPURA_TUF_ROLE_FILES_H

#include "tuf/workflow.h"

enum { TUF_TARGETS_BYTES_MAX = 5 << 20, TUF_NAME_MAX = 1024 /* of a quoted name */ };

/* Writes name with all but letters, digits and _.-~ as %XX, as a part of a URL or the name of a
 * file. Returns -EFBIG where it does not fit. */
must_check int tuf_quote(char *out, size_t room, const char *name);

/* Sets client->why and returns code. */
int tuf_refuse(struct tuf_client *client, int code, const char *format, ...) printf_like(3, 4);

/* Load, fetch and store the file of a role. out is initialised with a ceiling of `most`; the caller
 * finishes it, also on failure. version 0: the file's name carries none. */
must_check int tuf_load(struct tuf_client *client, const char *role, size_t most,
			struct buffer *out);
must_check int tuf_fetch(struct tuf_client *client, const char *role, uint32_t version,
			 uint64_t most, struct buffer *out);
must_check int tuf_store(struct tuf_client *client, const char *role, const struct buffer *file);
/* Returns the version that a file's name carries. */
uint32_t tuf_named_version(const struct tuf_client *client, uint32_t version);

/* Parses a role's file and checks its signatures. *out is to be finished also on failure. */
must_check int tuf_open_file(struct tuf_client *client, struct tuf_file *out,
			     const struct buffer *bytes, const char *role, enum tuf_type type,
			     const struct cJSON *keys, const struct cJSON *by);
must_check int tuf_check_expiry(struct tuf_client *client, const struct tuf_file *file,
				const char *role);

#endif
