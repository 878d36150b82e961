#include "format/metadata.h"

#include <errno.h>
#include <sodium.h>
#include <string.h>

#include "format/metadata_sign.h"
#include "tests/check.h"
#include "tests/format/bend.h"

static struct signing_key keys[6];

static int make_keys(void **state)
{
	(void)state;
	if (sodium_init() < 0)
		return -1;
	for (int i = 0; i < 6; i++) {
		uint8_t seed[crypto_sign_SEEDBYTES] = { (uint8_t)i };

		crypto_sign_seed_keypair(keys[i].public_key, keys[i].secret, seed);
	}
	return 0;
}

static void add_key(struct role_keys *role, int key)
{
	memcpy(role->keys[role->key_count++], keys[key].public_key, KEY_BYTES);
}

/* Root: two of keys 0, 1, 2. Release: key 3. Timestamp: key 4. */
static struct trust_root sample_root(void)
{
	struct trust_root root = { .version = 1, .expires_s = 2000000000 };

	root.roles[META_ROOT].threshold = 2;
	root.roles[META_RELEASE].threshold = 1;
	root.roles[META_TIMESTAMP].threshold = 1;
	for (int i = 0; i < 3; i++)
		add_key(&root.roles[META_ROOT], i);
	add_key(&root.roles[META_RELEASE], 3);
	add_key(&root.roles[META_TIMESTAMP], 4);
	return root;
}

static const struct release sample_release = {
	.sequence = 7,
	.expires_s = 1900000000,
	.root = { { 1, 2, 3 } },
	.root_bytes = 345,
	.comment = "t\xc3\xaate \"quoted\"",
};

static int decode_release(struct bytes bytes, void *data)
{
	struct release release;
	int rc = release_decode(&release, data, bytes, NULL);

	CHECK(rc == 0 || rc == -EBADMSG || rc == -EKEYREJECTED);
	if (rc == 0) /* whatever decodes is what was signed */
		CHECK(release.sequence == 7 && hash_equal(release.root, sample_release.root));
	else
		CHECK(release.sequence == 0);
	return rc;
}

static void a_release_goes_round(void **state)
{
	struct trust_root trust = sample_root();
	struct release back;
	struct buffer file;

	(void)state;
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	CHECK(release_encode(&file, &sample_release, &keys[3], 1) == 0);
	CHECK(release_decode(&back, &trust, buffer_bytes(&file), NULL) == 0);
	CHECK(back.sequence == 7 && back.expires_s == 1900000000 && back.root_bytes == 345);
	CHECK(hash_equal(back.root, sample_release.root));
	CHECK(strcmp(back.comment, sample_release.comment) == 0);
	buffer_finish(&file);
}

static void no_damage_gives_another_release(void **state)
{
	struct trust_root trust = sample_root();
	struct buffer file;

	(void)state;
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	CHECK(release_encode(&file, &sample_release, &keys[3], 1) == 0);
	file.size--; /* the newline at the end is not needed */
	refuses_every_truncation(decode_release, &trust, buffer_bytes(&file));
	CHECK(count_accepted_flips(decode_release, &trust, buffer_bytes(&file)) == 0);
	buffer_finish(&file);
}

static void a_wrong_or_missing_key_is_rejected(void **state)
{
	struct trust_root trust = sample_root();
	struct buffer file;
	const char *why = NULL;
	struct release back;

	(void)state;
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	CHECK(release_encode(&file, &sample_release, &keys[4], 1) == 0); /* the timestamp's */
	CHECK(release_decode(&back, &trust, buffer_bytes(&file), &why) == -EKEYREJECTED);
	CHECK(why != NULL);
	buffer_clear(&file);
	CHECK(release_encode(&file, &sample_release, NULL, 0) == 0);
	CHECK(release_decode(&back, &trust, buffer_bytes(&file), NULL) == -EKEYREJECTED);
	buffer_finish(&file);
}

static void no_file_passes_for_another_roles(void **state)
{
	struct trust_root trust = sample_root();
	struct timestamp stamp = { .sequence = 3, .expires_s = 9, .release = { { 5 } } }, back;
	struct release release;
	struct buffer file;

	(void)state;
	/* The same key in both roles, so that only the role's name tells them apart. */
	memcpy(trust.roles[META_RELEASE].keys[0], keys[4].public_key, KEY_BYTES);
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	CHECK(timestamp_encode(&file, &stamp, &keys[4], 1) == 0);
	CHECK(timestamp_decode(&back, &trust, buffer_bytes(&file), NULL) == 0);
	CHECK(back.sequence == 3 && back.expires_s == 9 && back.release.bytes[0] == 5);
	CHECK(release_decode(&release, &trust, buffer_bytes(&file), NULL) == -EKEYREJECTED);
	buffer_finish(&file);
}

static void a_timestamp_may_say_when_it_was_signed(void **state)
{
	static const struct {
		int64_t issued_s;
		int rc;
	} times[] = { { 0, 0 }, { 1, 0 }, { 9, 0 }, { 10, -EBADMSG } /* after it expires */ };
	const struct trust_root trust = sample_root();

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(times); i++) {
		const struct timestamp stamp = { .sequence = 3,
						 .expires_s = 9,
						 .issued_s = times[i].issued_s };
		struct timestamp back;
		struct buffer file;

		buffer_init(&file, METADATA_FILE_BYTES_MAX);
		CHECK(timestamp_encode(&file, &stamp, &keys[4], 1) == 0);
		CHECK(timestamp_decode(&back, &trust, buffer_bytes(&file), NULL) == times[i].rc);
		CHECK(times[i].rc < 0 || back.issued_s == times[i].issued_s);
		buffer_finish(&file);
	}
}

static void a_root_needs_its_threshold(void **state)
{
	struct trust_root root = sample_root(), back;
	struct signing_key twice[2];
	struct buffer file;

	(void)state;
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	CHECK(trust_root_encode(&file, &root, keys, 2) == 0);
	CHECK(trust_root_first(&back, buffer_bytes(&file), NULL) == 0);
	CHECK(back.version == 1 && back.roles[META_ROOT].key_count == 3);
	CHECK(memcmp(back.roles[META_TIMESTAMP].keys[0], keys[4].public_key, KEY_BYTES) == 0);
	buffer_clear(&file);
	CHECK(trust_root_encode(&file, &root, keys, 1) == 0);
	CHECK(trust_root_first(&back, buffer_bytes(&file), NULL) == -EKEYREJECTED);
	buffer_clear(&file);
	twice[0] = twice[1] = keys[0]; /* one signer, two signatures */
	CHECK(trust_root_encode(&file, &root, twice, 2) == 0);
	CHECK(trust_root_first(&back, buffer_bytes(&file), NULL) == -EKEYREJECTED);
	buffer_finish(&file);
}

static int next_signed(uint32_t version, const int *signers, uint32_t count, bool new_keys)
{
	struct trust_root trust = sample_root(), next = sample_root();
	struct signing_key with[4];
	struct buffer file;
	int rc;

	next.version = version;
	if (new_keys) { /* of 0, 1, 2 only 2 stays */
		memcpy(next.roles[META_ROOT].keys[0], keys[3].public_key, KEY_BYTES);
		memcpy(next.roles[META_ROOT].keys[1], keys[5].public_key, KEY_BYTES);
	}
	for (uint32_t i = 0; i < count; i++)
		with[i] = keys[signers[i]];
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	CHECK(trust_root_encode(&file, &next, with, count) == 0);
	rc = trust_root_next(&trust, buffer_bytes(&file), NULL);
	CHECK(trust.version == (rc == 0 ? version : 1)); /* unchanged on failure */
	buffer_finish(&file);
	return rc;
}

static void the_next_root_is_signed_by_old_and_new(void **state)
{
	(void)state;
	CHECK(next_signed(2, (int[]){ 0, 1 }, 2, false) == 0);
	CHECK(next_signed(3, (int[]){ 0, 1 }, 2, false) == -EBADMSG);
	CHECK(next_signed(1, (int[]){ 0, 1 }, 2, false) == -EBADMSG);
	CHECK(next_signed(2, (int[]){ 0, 1 }, 2, true) == -EKEYREJECTED); /* old only */
	CHECK(next_signed(2, (int[]){ 3, 5 }, 2, true) == -EKEYREJECTED); /* new only */
	CHECK(next_signed(2, (int[]){ 0, 1, 3, 5 }, 4, true) == 0);
	CHECK(next_signed(2, (int[]){ 0, 2, 5 }, 3, true) == 0); /* 2 counts in both */
}

/* Signs payload with the release key, as no encoder of ours would. */
static int decode_payload(const char *payload)
{
	struct trust_root trust = sample_root();
	uint8_t message[1024], signature[crypto_sign_BYTES];
	char payload64[1024], signature64[128], key[HASH_HEX_BYTES], text[4096];
	struct release release;
	int size = snprintf((char *)message, sizeof(message), "gopura-release-v1\n%s", payload);

	crypto_sign_detached(signature, NULL, message, (size_t)size, keys[3].secret);
	sodium_bin2base64(payload64, sizeof(payload64), (const uint8_t *)payload, strlen(payload),
			  sodium_base64_VARIANT_ORIGINAL);
	sodium_bin2base64(signature64, sizeof(signature64), signature, sizeof(signature),
			  sodium_base64_VARIANT_ORIGINAL);
	hash_to_hex(hash_of((struct bytes){ keys[3].public_key, KEY_BYTES }), key);
	size = snprintf(
		text, sizeof(text),
		"{\"payload\":\"%s\",\"signatures\":[{\"key\":\"%s\",\"signature\":\"%s\"}]}",
		payload64, key, signature64);
	return release_decode(&release, &trust, (struct bytes){ (uint8_t *)text, (size_t)size },
			      NULL);
}

#define ROOT "\"root\":\"01020300000000000000000000000000\",\"root_bytes\":345,\"comment\":\"\"}"
#define TYPE "{\"type\":\"release\",\"format\":1,"

static void even_a_signed_payload_is_read_strictly(void **state)
{
	(void)state;
	CHECK(decode_payload(TYPE "\"sequence\":7,\"expires_s\":5," ROOT) == 0);
	CHECK(decode_payload(TYPE "\"later\":[],\"sequence\":7,\"expires_s\":5," ROOT) == 0);
	CHECK(decode_payload(TYPE "\"expires_s\":5," ROOT) == -EBADMSG);
	CHECK(decode_payload(TYPE "\"sequence\":0,\"expires_s\":5," ROOT) == -EBADMSG);
	CHECK(decode_payload(TYPE "\"sequence\":-1,\"expires_s\":5," ROOT) == -EBADMSG);
	CHECK(decode_payload(TYPE "\"sequence\":1.5,\"expires_s\":5," ROOT) == -EBADMSG);
	CHECK(decode_payload(TYPE "\"sequence\":1e300,\"expires_s\":5," ROOT) == -EBADMSG);
	CHECK(decode_payload(TYPE "\"sequence\":\"7\",\"expires_s\":5," ROOT) == -EBADMSG);
	CHECK(decode_payload(TYPE "\"sequence\":7,\"sequence\":8,\"expires_s\":5," ROOT) ==
	      -EBADMSG);
	CHECK(decode_payload(TYPE "\"sequence\":7,\"expires_s\":5," ROOT "x") == -EBADMSG);
	CHECK(decode_payload("{\"type\":\"release\",\"format\":2,\"sequence\":7,"
			     "\"expires_s\":5," ROOT) == -EBADMSG);
	CHECK(decode_payload("{\"type\":\"root\",\"format\":1,\"sequence\":7,"
			     "\"expires_s\":5," ROOT) == -EBADMSG);
	CHECK(decode_payload("[]") == -EBADMSG);
	CHECK(decode_payload("7") == -EBADMSG);
}

static void refuses_what_is_no_envelope(void **state)
{
	static const char *const bad[] = {
		"",
		"{}",
		"[]",
		"null",
		"{\"payload\":\"e30=\"}",
		"{\"payload\":\"e30=\",\"signatures\":{}}",
		"{\"payload\":\"e30=\",\"signatures\":[],\"more\":1}",
		"{\"payload\":\"e3!=\",\"signatures\":[]}",
		"{\"payload\":\"\",\"signatures\":[]}",
		"{\"payload\":\"e30=\",\"payload\":\"e30=\"}",
		"{\"payload\":\"e30=\",\"signatures\":[7]}",
		"{\"payload\":\"e30=\",\"signatures\":[{\"key\":\"00\",\"signature\":\"AAAA\"}]}",
	};
	struct trust_root root = sample_root();
	struct timestamp stamp;

	(void)state;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		struct bytes bytes = { (const uint8_t *)bad[i], strlen(bad[i]) };

		CHECK(timestamp_decode(&stamp, &root, bytes, NULL) == -EBADMSG);
		CHECK(trust_root_first(&(struct trust_root){ 0 }, bytes, NULL) == -EBADMSG);
	}
}

static void a_key_named_twice_is_no_root(void **state)
{
	struct trust_root root = sample_root(), back;
	struct buffer file;

	(void)state;
	memcpy(root.roles[META_ROOT].keys[1], keys[0].public_key, KEY_BYTES);
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	CHECK(trust_root_encode(&file, &root, keys, 3) == 0);
	CHECK(trust_root_first(&back, buffer_bytes(&file), NULL) == -EBADMSG);
	buffer_clear(&file);
	root = sample_root();
	root.roles[META_TIMESTAMP].threshold = 2; /* of one key: could never be met */
	CHECK(trust_root_encode(&file, &root, keys, 3) == 0);
	CHECK(trust_root_first(&back, buffer_bytes(&file), NULL) == -EBADMSG);
	buffer_finish(&file);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_release_goes_round),
		cmocka_unit_test(no_damage_gives_another_release),
		cmocka_unit_test(a_wrong_or_missing_key_is_rejected),
		cmocka_unit_test(no_file_passes_for_another_roles),
		cmocka_unit_test(a_timestamp_may_say_when_it_was_signed),
		cmocka_unit_test(a_root_needs_its_threshold),
		cmocka_unit_test(the_next_root_is_signed_by_old_and_new),
		cmocka_unit_test(even_a_signed_payload_is_read_strictly),
		cmocka_unit_test(refuses_what_is_no_envelope),
		cmocka_unit_test(a_key_named_twice_is_no_root),
	};

	return cmocka_run_group_tests(tests, make_keys, NULL);
}
