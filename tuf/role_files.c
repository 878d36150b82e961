/* Names, sizes and signatures of the files of roles, and the line that says what is wrong. */
#include "tuf/role_files.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* ---- what is wrong */

int tuf_refuse(struct tuf_client *client, int code, const char *format, ...)
{
	va_list list;

	va_start(list, format);
	vsnprintf(client->why, sizeof(client->why), format, list);
	va_end(list);
	return code;
}

/* ---- files */

int tuf_quote(char *out, size_t room, const char *name)
{
	size_t at = 0;

	for (; *name && at + 4 <= room; name++) {
		const unsigned char c = (unsigned char)*name;

		if ((c < 128 && isalnum(c)) || strchr("_.-~", c))
			out[at++] = (char)c;
		else
			at += (size_t)snprintf(out + at, room - at, "%%%02X", c);
	}
	if (room > 0)
		out[at < room ? at : room - 1] = 0;
	return *name || room == 0 ? -EFBIG : 0;
}

/* The name of a role's file; version 0: without one. */
static int file_name(char out[TUF_NAME_MAX], const char *role, uint32_t version)
{
	char quoted[TUF_NAME_MAX];
	int rc = tuf_quote(quoted, sizeof(quoted), role), size;

	size = version > 0 ? snprintf(out, TUF_NAME_MAX, "%" PRIu32 ".%s.json", version, quoted)
			   : snprintf(out, TUF_NAME_MAX, "%s.json", quoted);
	if (rc == 0 && size >= TUF_NAME_MAX)
		rc = -EFBIG;
	return rc;
}

int tuf_load(struct tuf_client *client, const char *role, size_t most, struct buffer *out)
{
	char name[TUF_NAME_MAX];
	const int rc = file_name(name, role, 0);

	buffer_init(out, most);
	return rc < 0 ? rc : client->io.load(client->io.context, name, out);
}

int tuf_fetch(struct tuf_client *client, const char *role, uint32_t version, uint64_t most,
	      struct buffer *out)
{
	char name[TUF_NAME_MAX];
	int rc = file_name(name, role, version);

	buffer_init(out, most < TUF_TARGETS_BYTES_MAX ? (size_t)most : TUF_TARGETS_BYTES_MAX);
	if (rc == 0)
		rc = client->io.fetch(client->io.context, name, out);
	return rc < 0 ? tuf_refuse(client, rc, "%s: not from the server: %s", name, strerror(-rc))
		      : 0;
}

int tuf_store(struct tuf_client *client, const char *role, const struct buffer *file)
{
	char name[TUF_NAME_MAX];
	int rc = file_name(name, role, 0);

	if (rc == 0)
		rc = client->io.store(client->io.context, name, buffer_bytes(file));
	return rc < 0 ? tuf_refuse(client, rc, "%s: not stored: %s", name, strerror(-rc)) : 0;
}

int tuf_open_file(struct tuf_client *client, struct tuf_file *out, const struct buffer *bytes,
		  const char *role, enum tuf_type type, const struct cJSON *keys,
		  const struct cJSON *by)
{
	const char *why = NULL;
	int rc = tuf_file_parse(out, buffer_bytes(bytes), type, &why);

	if (rc < 0)
		return tuf_refuse(client, rc, "%s: %s", role, why ? why : strerror(-rc));
	rc = tuf_file_verify(out, keys, by);
	if (rc < 0)
		tuf_refuse(client, rc, "%s version %" PRIu32 ": %s", role, out->version,
			   rc == -EKEYREJECTED ? "fewer valid signatures than its threshold"
			   : rc == -EBADMSG    ? "two members of one name, or no whole number"
					       : strerror(-rc));
	return rc;
}

int tuf_check_expiry(struct tuf_client *client, const struct tuf_file *file, const char *role)
{
	if (file->expires_s > client->now_s)
		return 0;
	return tuf_refuse(client, -ETIME, "%s version %" PRIu32 " has expired", role,
			  file->version);
}

uint32_t tuf_named_version(const struct tuf_client *client, uint32_t version)
{
	return tuf_root_is_consistent(&client->root) ? version : 0;
}
