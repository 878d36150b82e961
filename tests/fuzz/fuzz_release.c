/* Signed metadata: the bytes as a file of each role; and as a payload that a key holder signed, so
 * that what stands behind the signature is met too. */
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/metadata.h"
#include "format/metadata_sign.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static struct signing_key key;
static struct trust_root trust;

static void prepare(void)
{
	static const uint8_t seed[crypto_sign_SEEDBYTES] = { 1 };

	if (key.public_key[0] || key.public_key[1])
		return;
	crypto_sign_seed_keypair(key.public_key, key.secret, seed);
	trust.version = 1;
	for (int role = META_ROOT; role <= META_TIMESTAMP; role++) {
		trust.roles[role] = (struct role_keys){ .threshold = 1, .key_count = 1 };
		memcpy(trust.roles[role].keys[0], key.public_key, KEY_BYTES);
	}
}

static void decode_all(struct bytes file)
{
	struct trust_root root = trust, first;
	struct timestamp timestamp;
	struct release release, target;
	const char *why[5] = { NULL };
	const int refused[5] = { trust_root_next(&root, file, &why[0]),
				 trust_root_first(&first, file, &why[1]),
				 release_decode(&release, &trust, file, &why[2]),
				 release_decode_target(&target, file, &why[3]),
				 timestamp_decode(&timestamp, &trust, file, &why[4]) };

	for (size_t i = 0; i < ARRAY_COUNT(refused); i++)
		if ((refused[i] < 0) != (why[i] != NULL))
			abort();
	if (refused[0] == 0 && root.version != 2)
		abort();
	if (refused[1] == 0 && first.roles[META_ROOT].threshold == 0)
		abort();
	if ((refused[2] == 0 && release.sequence == 0) ||
	    (refused[3] == 0 && target.sequence == 0) ||
	    (refused[4] == 0 && timestamp.sequence == 0))
		abort();
}

static void decode_signed(const char *role, const uint8_t *data, size_t size)
{
	uint8_t message[8192], signature[crypto_sign_BYTES];
	char payload[12000], signature64[128], name[HASH_HEX_BYTES], file[16384];
	int prefix = snprintf((char *)message, 64, "gopura-%s-v1\n", role), length;

	memcpy(message + prefix, data, size);
	crypto_sign_detached(signature, NULL, message, (size_t)prefix + size, key.secret);
	sodium_bin2base64(payload, sizeof(payload), data, size, sodium_base64_VARIANT_ORIGINAL);
	sodium_bin2base64(signature64, sizeof(signature64), signature, sizeof(signature),
			  sodium_base64_VARIANT_ORIGINAL);
	hash_to_hex(hash_of((struct bytes){ key.public_key, KEY_BYTES }), name);
	length = snprintf(file, sizeof(file),
			  "{\"payload\":\"%s\",\"signatures\":[{\"key\":\"%s\","
			  "\"signature\":\"%s\"}]}",
			  payload, name, signature64);
	decode_all((struct bytes){ (uint8_t *)file, (size_t)length });
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	prepare();
	decode_all((struct bytes){ data, size });
	if (size > 8000)
		return 0;
	decode_signed("root", data, size);
	decode_signed("release", data, size);
	decode_signed("timestamp", data, size);
	return 0;
}
