/* The order of the files, and what each may say in view of those accepted before. */
#include "tuf/workflow.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "base/transient.h"
#include "tuf/role_files.h"
#include "tuf/targets.h"

enum {
	ROOT_BYTES_MAX = 512 << 10,
	TIMESTAMP_BYTES_MAX = 16 << 10,
	SNAPSHOT_BYTES_MAX = 2 << 20,
	ROOTS_MAX = 256, /* versions of the root in one refresh */
};

static int open_top(struct tuf_client *client, struct tuf_file *out, const struct buffer *bytes,
		    enum tuf_type type)
{
	return tuf_open_file(client, out, bytes, tuf_type_names[type], type,
			     tuf_root_keys(&client->root), tuf_root_role(&client->root, type));
}

/* *held becomes *file. */
static void hold(struct tuf_file *held, struct tuf_file *file)
{
	tuf_file_finish(held);
	*held = *file;
	*file = (struct tuf_file){ 0 };
}

/* ---- root (section 5.3) */

static int load_root(struct tuf_client *client)
{
	struct buffer bytes;
	const char *why = NULL;
	int rc = tuf_load(client, "root", ROOT_BYTES_MAX, &bytes);

	if (rc < 0)
		tuf_refuse(client, rc, "no trusted root: %s", strerror(-rc));
	else if ((rc = tuf_file_parse(&client->root, buffer_bytes(&bytes), TUF_ROOT, &why)) < 0)
		tuf_refuse(client, rc, "the trusted root: %s", why ? why : strerror(-rc));
	else if ((rc = tuf_file_verify(&client->root, tuf_root_keys(&client->root),
				       tuf_root_role(&client->root, TUF_ROOT))) < 0)
		tuf_refuse(client, rc, "the trusted root has not enough signatures of its own");
	buffer_finish(&bytes);
	return rc;
}

/* The keys of the root before must have signed it, and its own. */
static int take_root(struct tuf_client *client, const struct buffer *bytes)
{
	const uint32_t next = client->root.version + 1;
	struct tuf_file file = { 0 };
	int rc = open_top(client, &file, bytes, TUF_ROOT);

	if (rc == 0 && file.version != next)
		rc = tuf_refuse(client, -EBADMSG,
				"root %" PRIu32 " says that it is version %" PRIu32, next,
				file.version);
	if (rc == 0) {
		rc = tuf_file_verify(&file, tuf_root_keys(&file), tuf_root_role(&file, TUF_ROOT));
		if (rc < 0)
			tuf_refuse(client, rc,
				   "root %" PRIu32 " has not enough signatures of its own", next);
	}
	if (rc == 0)
		rc = tuf_store(client, "root", bytes);
	if (rc == 0)
		hold(&client->root, &file);
	tuf_file_finish(&file);
	return rc;
}

static int update_root(struct tuf_client *client)
{
	int rc = 0;

	for (int i = 0; i < ROOTS_MAX && rc == 0; i++) {
		struct buffer bytes;

		rc = tuf_fetch(client, "root", client->root.version + 1, ROOT_BYTES_MAX, &bytes);
		if (rc == 0)
			rc = take_root(client, &bytes);
		buffer_finish(&bytes);
	}
	if (rc < 0 && rc != -ENOENT)
		return rc;
	return tuf_check_expiry(client, &client->root, "root");
}

/* ---- timestamp (section 5.4) */

static const cJSON *snapshot_meta(const struct tuf_client *client)
{
	return tuf_meta(&client->timestamp, "snapshot.json");
}

/* What was stored counts against a rollback while its keys are the root's, even if it expired. A
 * failure that says nothing of the file fails the refresh, or it would not count. */
static int load_timestamp(struct tuf_client *client)
{
	struct buffer bytes;
	struct tuf_file file = { 0 };

	int rc = tuf_load(client, "timestamp", TIMESTAMP_BYTES_MAX, &bytes);

	if (rc < 0)
		tuf_refuse(client, rc, "the stored timestamp: %s", strerror(-rc));
	else if ((rc = open_top(client, &file, &bytes, TUF_TIMESTAMP)) == 0)
		hold(&client->timestamp, &file);
	tuf_file_finish(&file);
	buffer_finish(&bytes);
	return is_transient(rc) ? rc : 0;
}

static int take_timestamp(struct tuf_client *client, const struct buffer *bytes)
{
	struct tuf_file file = { 0 };
	const struct tuf_file *held = &client->timestamp;
	int rc = open_top(client, &file, bytes, TUF_TIMESTAMP);
	bool is_new = true;

	if (rc == 0 && held->json) {
		is_new = file.version > held->version;
		if (file.version < held->version ||
		    (is_new && tuf_meta_version(tuf_meta(&file, "snapshot.json")) <
				       tuf_meta_version(snapshot_meta(client))))
			rc = tuf_refuse(client, -ESTALE,
					"timestamp %" PRIu32 " is older than %" PRIu32
					", or names an older snapshot",
					file.version, held->version);
	}
	if (rc == 0 && is_new)
		rc = tuf_check_expiry(client, &file, "timestamp");
	if (rc == 0 && is_new)
		rc = tuf_store(client, "timestamp", bytes);
	if (rc == 0 && is_new)
		hold(&client->timestamp, &file);
	tuf_file_finish(&file);
	return rc < 0 ? rc : tuf_check_expiry(client, &client->timestamp, "timestamp");
}

static int update_timestamp(struct tuf_client *client)
{
	struct buffer bytes;
	int rc = load_timestamp(client);

	if (rc < 0)
		return rc;
	rc = tuf_fetch(client, "timestamp", 0, TIMESTAMP_BYTES_MAX, &bytes);
	if (rc == 0)
		rc = take_timestamp(client, &bytes);
	buffer_finish(&bytes);
	return rc;
}

/* ---- snapshot (section 5.5) */

static int load_snapshot(struct tuf_client *client)
{
	struct buffer bytes;
	struct tuf_file file = { 0 };

	int rc = tuf_load(client, "snapshot", SNAPSHOT_BYTES_MAX, &bytes);

	if (rc < 0)
		tuf_refuse(client, rc, "the stored snapshot: %s", strerror(-rc));
	else if ((rc = open_top(client, &file, &bytes, TUF_SNAPSHOT)) == 0)
		hold(&client->snapshot, &file);
	tuf_file_finish(&file);
	buffer_finish(&bytes);
	return is_transient(rc) ? rc : 0;
}

/* No targets file may go, or go back. */
static int check_rollback(struct tuf_client *client, const struct tuf_file *file)
{
	const cJSON *meta,
		*held = cJSON_GetObjectItemCaseSensitive(client->snapshot.content, "meta");

	cJSON_ArrayForEach(meta, held)
	{
		const cJSON *now = tuf_meta(file, meta->string);

		if (!now || tuf_meta_version(now) < tuf_meta_version(meta))
			return tuf_refuse(client, -ESTALE,
					  "snapshot %" PRIu32
					  " has an older %s than snapshot %" PRIu32 ", or none",
					  file->version, meta->string, client->snapshot.version);
	}
	return 0;
}

static int take_snapshot(struct tuf_client *client, const struct buffer *bytes)
{
	struct tuf_file file = { 0 };
	int rc = 0;

	if (!tuf_matches(snapshot_meta(client), buffer_bytes(bytes)))
		return tuf_refuse(
			client, -EBADMSG,
			"snapshot: not of the length and hashes that the timestamp names");
	rc = open_top(client, &file, bytes, TUF_SNAPSHOT);
	if (rc == 0 && file.version != tuf_meta_version(snapshot_meta(client)))
		rc = tuf_refuse(client, -EBADMSG, "snapshot %" PRIu32 " is not the timestamp's",
				file.version);
	if (rc == 0)
		rc = check_rollback(client, &file);
	if (rc == 0)
		rc = tuf_check_expiry(client, &file, "snapshot");
	if (rc == 0)
		rc = tuf_store(client, "snapshot", bytes);
	if (rc == 0)
		hold(&client->snapshot, &file);
	tuf_file_finish(&file);
	return rc;
}

static int update_snapshot(struct tuf_client *client)
{
	const cJSON *meta = snapshot_meta(client);
	const uint32_t version = tuf_meta_version(meta);
	struct buffer bytes;
	int rc = load_snapshot(client);

	if (rc < 0)
		return rc;
	if (client->snapshot.json && client->snapshot.version == version &&
	    client->snapshot.expires_s > client->now_s)
		return 0;
	rc = tuf_fetch(client, "snapshot", tuf_named_version(client, version),
		       tuf_length(meta, SNAPSHOT_BYTES_MAX), &bytes);
	if (rc == 0)
		rc = take_snapshot(client, &bytes);
	buffer_finish(&bytes);
	return rc;
}

int tuf_client_refresh(struct tuf_client *client, const struct tuf_io *io, int64_t now_s)
{
	int rc;

	*client = (struct tuf_client){ .io = *io, .now_s = now_s };
	rc = load_root(client);
	if (rc == 0)
		rc = update_root(client);
	if (rc == 0)
		rc = update_timestamp(client);
	if (rc == 0)
		rc = update_snapshot(client);
	if (rc == 0)
		rc = tuf_update_targets(client);
	return rc;
}

void tuf_client_finish(struct tuf_client *client)
{
	tuf_file_finish(&client->root);
	tuf_file_finish(&client->timestamp);
	tuf_file_finish(&client->snapshot);
	tuf_file_finish(&client->targets);
}
