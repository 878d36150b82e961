/* Metadata of The Update Framework: the bytes as a file of each type, with its own signatures; and
 * the same content signed, so that what stands behind the signature is met too. An object with the
 * member "stored/root.json" is a whole repository: its members are the contents of files by their
 * names, those that begin with "stored/" what the client has kept. Each is signed, and a sha256 of
 * "right" in what a file says of one before it becomes that one's. */
#include <cjson/cJSON.h>
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tuf/sign.h"
#include "tuf/targets.h"
#include "tuf/workflow.h"

enum { FILES_MAX = 24 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static struct tuf_signer signer;

static const struct cJSON *role_of(const struct tuf_file *file)
{
	return file->json ? tuf_root_role(file, TUF_ROOT) : NULL;
}

static void read_as(struct bytes bytes, enum tuf_type type)
{
	struct tuf_file file;
	const char *why = NULL;
	const int rc = tuf_file_parse(&file, bytes, type, &why);

	if (rc < 0 && (!why || file.json))
		abort();
	if (rc == 0 && (file.version == 0 || !file.content))
		abort();
	if (rc == 0 && type == TUF_ROOT &&
	    tuf_file_verify(&file, tuf_root_keys(&file), role_of(&file)) > 0)
		abort();
	if (rc == 0 && type == TUF_TIMESTAMP &&
	    tuf_meta_version(tuf_meta(&file, "snapshot.json")) == 0)
		abort();
	tuf_file_finish(&file);
}

/* The file is all that the server has and all that is stored; role by role it is one of them. */
static int serve(void *context, const char *name, struct buffer *out)
{
	const struct bytes *file = context;

	(void)name;
	buffer_put(out, file->data, file->size);
	return out->error;
}

static int forget(void *context, const char *name, struct bytes file)
{
	(void)context;
	(void)name;
	(void)file;
	return 0;
}

static void read_signed(const cJSON *content)
{
	struct buffer file;
	struct bytes whole;
	struct tuf_client client;
	const struct tuf_io io = { &whole, serve, serve, forget };

	buffer_init(&file, 1 << 20);
	if (tuf_sign(&file, content, &signer, 1) == 0) {
		whole = buffer_bytes(&file);
		for (int type = 0; type < TUF_TYPES; type++)
			read_as(whole, (enum tuf_type)type);
		if (tuf_client_refresh(&client, &io, 1800000000) == 0)
			abort(); /* one file cannot be all four */
		tuf_client_finish(&client);
	}
	buffer_finish(&file);
}

/* ---- a repository */

struct repository {
	const char *names[FILES_MAX];
	struct buffer files[FILES_MAX];
	int count;
};

static const struct buffer *find(const struct repository *repository, const char *prefix,
				 const char *name)
{
	const size_t skip = strlen(prefix);

	for (int i = 0; i < repository->count; i++)
		if (strncmp(repository->names[i], prefix, skip) == 0 &&
		    strcmp(repository->names[i] + skip, name) == 0)
			return &repository->files[i];
	return NULL;
}

static int give(const struct buffer *file, struct buffer *out)
{
	if (!file)
		return -ENOENT;
	buffer_put(out, file->data, file->size);
	return out->error;
}

static int fetch_one(void *context, const char *name, struct buffer *out)
{
	return give(find(context, "", name), out);
}

static int load_one(void *context, const char *name, struct buffer *out)
{
	return give(find(context, "stored/", name), out);
}

/* The file that an entry of meta is about, under its name with the version or without. */
static const struct buffer *named(const struct repository *repository, const cJSON *meta)
{
	const cJSON *version = cJSON_GetObjectItemCaseSensitive(meta, "version");
	const struct buffer *found = find(repository, "", meta->string);
	char name[200];

	if (found || !cJSON_IsNumber(version))
		return found;
	snprintf(name, sizeof(name), "%d.%s", version->valueint, meta->string);
	return find(repository, "", name);
}

static void correct_hashes(const struct repository *repository, const cJSON *content)
{
	const cJSON *meta;

	cJSON_ArrayForEach(meta, cJSON_GetObjectItemCaseSensitive(content, "meta"))
	{
		cJSON *hashes = cJSON_GetObjectItemCaseSensitive(meta, "hashes");
		const char *is =
			cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(hashes, "sha256"));
		const struct buffer *file = is && meta->string && strcmp(is, "right") == 0
						    ? named(repository, meta)
						    : NULL;
		uint8_t hash[crypto_hash_sha256_BYTES];
		char hex[2 * sizeof(hash) + 1];

		if (!file)
			continue;
		crypto_hash_sha256(hash, file->data, file->size);
		sodium_bin2hex(hex, sizeof(hex), hash, sizeof(hash));
		cJSON_ReplaceItemInObjectCaseSensitive(hashes, "sha256", cJSON_CreateString(hex));
	}
}

static void look_for_targets(struct tuf_client *client)
{
	static const char *const paths[] = { "release.json", "a/deep", "a/b/deep", "none" };

	for (size_t i = 0; i < ARRAY_COUNT(paths); i++) {
		struct tuf_target target;

		if (tuf_client_find(client, paths[i], &target) == 0) {
			if (!target.entry || !target.file[0])
				abort();
			(void)tuf_target_is(&target, (struct bytes){ (const uint8_t *)"abc", 3 });
		}
		tuf_target_finish(&target);
	}
}

/* What a refresh accepted is what each file says of the others. */
static void check_accepted(const struct tuf_client *client, int64_t now_s)
{
	const struct tuf_file *all[] = { &client->root, &client->timestamp, &client->snapshot,
					 &client->targets };

	for (size_t i = 0; i < ARRAY_COUNT(all); i++)
		if (!all[i]->json || all[i]->expires_s <= now_s)
			abort();
	if (tuf_meta_version(tuf_meta(&client->timestamp, "snapshot.json")) !=
		    client->snapshot.version ||
	    tuf_meta_version(tuf_meta(&client->snapshot, "targets.json")) !=
		    client->targets.version)
		abort();
}

static void refresh(const cJSON *contents)
{
	enum { NOW_S = 1800000000 };
	struct repository repository = { .count = 0 };
	const struct tuf_io io = { &repository, fetch_one, load_one, forget };
	struct tuf_client client;
	const cJSON *content;

	cJSON_ArrayForEach(content, contents)
	{
		struct buffer *file = &repository.files[repository.count];

		if (repository.count == FILES_MAX)
			break;
		correct_hashes(&repository, content);
		buffer_init(file, 1 << 20);
		if (tuf_sign(file, content, &signer, 1) < 0)
			buffer_clear(file);
		repository.names[repository.count++] = content->string;
	}
	if (tuf_client_refresh(&client, &io, NOW_S) == 0) {
		check_accepted(&client, NOW_S);
		look_for_targets(&client);
	} else if (!client.why[0]) {
		abort();
	}
	tuf_client_finish(&client);
	for (int i = 0; i < repository.count; i++)
		buffer_finish(&repository.files[i]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const uint8_t seed[32] = { 1 };
	const struct bytes bytes = { data, size };
	cJSON *content;

	if (!signer.id[0] && (sodium_init() < 0 || tuf_signer_init(&signer, seed) < 0))
		abort();
	for (int type = 0; type < TUF_TYPES; type++)
		read_as(bytes, (enum tuf_type)type);
	content = cJSON_ParseWithLength((const char *)data, size);
	if (cJSON_GetObjectItemCaseSensitive(content, "stored/root.json"))
		refresh(content);
	else if (content)
		read_signed(content);
	cJSON_Delete(content);
	return 0;
}
