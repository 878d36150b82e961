/* What the publisher's keys sign for The Update Framework. */
#include "pipeline/keys/signing.h"

#include <cjson/cJSON.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/keys/keys.h"
#include "tests/check.h"
#include "tests/close_once.h"
#include "tuf/tuf_metadata.h"

/* {"k": the key} */
static cJSON *keys_of(const struct signing_key *key)
{
	char hex[2 * KEY_BYTES + 1];
	cJSON *keys = cJSON_CreateObject(), *entry = cJSON_AddObjectToObject(keys, "k");

	sodium_bin2hex(hex, sizeof(hex), key->public_key, KEY_BYTES);
	cJSON_AddStringToObject(entry, "keytype", "ed25519");
	cJSON_AddStringToObject(entry, "scheme", "ed25519");
	cJSON_AddStringToObject(cJSON_AddObjectToObject(entry, "keyval"), "public", hex);
	return keys;
}

static void a_key_signs_for_the_roles_that_it_is_named_for(void **state)
{
	const struct bytes message = { (const uint8_t *)"{}", 2 };
	cJSON *role = cJSON_Parse("{\"keyids\": [\"k\"], \"threshold\": 1}");
	char folder[] = "/tmp/gopura-signing-XXXXXX", keys_folder[64], command[80];
	struct publisher_keys made;
	struct signing signing;

	(void)state;
	CHECK(mkdtemp(folder) != NULL);
	snprintf(keys_folder, sizeof(keys_folder), "%s/keys", folder);
	CHECK(keys_make(keys_folder) == 0 && keys_load(&made, keys_folder) == 0);
	CHECK(signing_read(&signing, keys_folder) == 0);
	for (int type = TUF_TIMESTAMP; type < TUF_TYPES; type++) {
		const bool is_timestamp = type == TUF_TIMESTAMP;
		cJSON *keys = keys_of(is_timestamp ? &made.timestamp : &made.release);
		cJSON *signatures = cJSON_CreateArray();

		CHECK(signing_sign(&signing, (enum tuf_type)type, "a file", keys, role, message,
				   signatures) == 0);
		CHECK(cJSON_GetArraySize(signatures) == 1);
		cJSON_Delete(signatures);
		cJSON_Delete(keys);
	}
	keys_finish(&made);
	cJSON_Delete(role);
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	CHECK(system(command) == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_key_signs_for_the_roles_that_it_is_named_for),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
