/* Metadata of The Update Framework: the bytes as a file of each type, with its own signatures; and
 * the same content signed, so that what stands behind the signature is met too. */
#include <cjson/cJSON.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "tuf/sign.h"
#include "tuf/workflow.h"

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

static void read_signed(struct bytes bytes)
{
	cJSON *content = cJSON_ParseWithLength((const char *)bytes.data, bytes.size);
	struct buffer file;
	struct bytes whole;
	struct tuf_client client;
	const struct tuf_io io = { &whole, serve, serve, forget };

	buffer_init(&file, 1 << 20);
	if (content && tuf_sign(&file, content, &signer, 1) == 0) {
		whole = buffer_bytes(&file);
		for (int type = 0; type < TUF_TYPES; type++)
			read_as(whole, (enum tuf_type)type);
		if (tuf_client_refresh(&client, &io, 1800000000) == 0)
			abort(); /* one file cannot be all four */
		tuf_client_finish(&client);
	}
	buffer_finish(&file);
	cJSON_Delete(content);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const uint8_t seed[32] = { 1 };
	const struct bytes bytes = { data, size };

	if (!signer.id[0] && (sodium_init() < 0 || tuf_signer_init(&signer, seed) < 0))
		abort();
	for (int type = 0; type < TUF_TYPES; type++)
		read_as(bytes, (enum tuf_type)type);
	read_signed(bytes);
	return 0;
}
