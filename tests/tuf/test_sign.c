/* Signatures by keys of every kind, and the files that are made of them. */
#include "tuf/sign.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tuf/canonical.h"
#include "tuf/private_key.h"
#include "tuf/public_key.h"

static const struct bytes message = { (const uint8_t *)"{\"version\":1}", 13 };

/* A key with its private and public half in PEM. */
struct pair {
	struct buffer private_key, public_key;
};

static void take_pem(struct buffer *out, BIO *bio)
{
	char *data;
	const long size = BIO_get_mem_data(bio, &data);

	buffer_init(out, 1 << 20);
	buffer_put(out, data, (size_t)size);
	BIO_free(bio);
}

/* Takes the key. */
static struct pair pair_of(EVP_PKEY *key)
{
	BIO *private_key = BIO_new(BIO_s_mem()), *public_key = BIO_new(BIO_s_mem());
	struct pair pair;

	CHECK(key && PEM_write_bio_PKCS8PrivateKey(private_key, key, NULL, NULL, 0, NULL, NULL));
	CHECK(PEM_write_bio_PUBKEY(public_key, key));
	take_pem(&pair.private_key, private_key);
	take_pem(&pair.public_key, public_key);
	EVP_PKEY_free(key);
	return pair;
}

static void finish(struct pair *pair)
{
	buffer_finish(&pair->private_key);
	buffer_finish(&pair->public_key);
}

/* Keys by id: the pair under "k", and one that has signed nothing under "other". */
static cJSON *keys_with(const struct pair *pair, const char *type, const char *scheme)
{
	cJSON *keys = cJSON_CreateObject(), *key = cJSON_AddObjectToObject(keys, "k");
	char text[4096] = "";

	memcpy(text, pair->public_key.data, pair->public_key.size);
	cJSON_AddStringToObject(key, "keytype", type);
	cJSON_AddStringToObject(key, "scheme", scheme);
	cJSON_AddStringToObject(cJSON_AddObjectToObject(key, "keyval"), "public", text);
	return keys;
}

static void signs_and_checks(EVP_PKEY *key, const char *type, const char *scheme)
{
	struct pair pair = pair_of(key);
	cJSON *keys = keys_with(&pair, type, scheme), *signatures = cJSON_CreateArray();
	cJSON *role = cJSON_Parse("{\"keyids\":[\"gone\",\"k\"],\"threshold\":1}");
	struct bytes bad = { (const uint8_t *)"{\"version\":2}", 13 };
	struct buffer signature;

	buffer_init(&signature, 1024);
	CHECK(tuf_private_sign(&signature, buffer_bytes(&pair.private_key), message) == 0);
	CHECK(tuf_add_signature(signatures, keys, role, bad, buffer_bytes(&signature)) ==
	      -EKEYREJECTED);
	CHECK(cJSON_GetArraySize(signatures) == 0);
	for (int i = 0; i < 2; i++) /* a key counts once */
		CHECK(tuf_add_signature(signatures, keys, role, message,
					buffer_bytes(&signature)) == 0);
	CHECK(cJSON_GetArraySize(signatures) == 1);
	buffer_finish(&signature);
	cJSON_Delete(signatures);
	cJSON_Delete(role);
	cJSON_Delete(keys);
	finish(&pair);
}

static void signs_with_ecdsa_and_rsa(void **state)
{
	(void)state;
	signs_and_checks(EVP_EC_gen("P-256"), "ecdsa", "ecdsa-sha2-nistp256");
	signs_and_checks(EVP_RSA_gen(2048), "rsa", "rsassa-pss-sha256");
}

static void refuses_keys_that_are_none(void **state)
{
	struct pair p384 = pair_of(EVP_EC_gen("P-384"));
	const struct bytes text = { (const uint8_t *)"-----BEGIN PRIVATE KEY-----\nAA\n", 31 };
	struct buffer signature;

	(void)state;
	buffer_init(&signature, 1024);
	CHECK(tuf_private_sign(&signature, buffer_bytes(&p384.private_key), message) ==
	      -EOPNOTSUPP);
	CHECK(tuf_private_sign(&signature, buffer_bytes(&p384.public_key), message) == -EBADMSG);
	CHECK(tuf_private_sign(&signature, text, message) == -EBADMSG);
	CHECK(signature.size == 0);
	buffer_finish(&signature);
	finish(&p384);
}

/* Canonical JSON has the line ends of a key in PEM as they are; a file must not. */
static void writes_line_ends_as_json_does(void **state)
{
	cJSON *content = cJSON_Parse("{\"b\":\"two\\nlines\",\"a\":1}"), *read;
	cJSON *signatures = cJSON_CreateArray();
	struct buffer canonical, file;

	(void)state;
	buffer_init(&canonical, 1000);
	buffer_init(&file, 1000);
	CHECK(canonical_write(&canonical, content) == 0);
	CHECK(memchr(canonical.data, '\n', canonical.size));
	CHECK(tuf_write_signed(&file, buffer_bytes(&canonical), signatures) == 0);
	buffer_put_u8(&file, 0);
	CHECK(strcmp((const char *)file.data,
		     "{\"signatures\":[],\"signed\":{\"a\":1,\"b\":\"two\\u000alines\"}}\n") == 0);
	read = cJSON_Parse((const char *)file.data);
	CHECK(strcmp(cJSON_GetObjectItem(cJSON_GetObjectItem(read, "signed"), "b")->valuestring,
		     "two\nlines") == 0);
	buffer_finish(&canonical);
	buffer_finish(&file);
	cJSON_Delete(read);
	cJSON_Delete(content);
	cJSON_Delete(signatures);
}

/* What openssl writes of a key is read, and has made that key's signature. */
static void reads_public_key(EVP_PKEY *key)
{
	struct pair pair = pair_of(key);
	struct tuf_public_key read, again;
	struct tuf_key_name name;
	struct buffer signature, json;
	char hex[2049], *text;

	buffer_init(&signature, 1024);
	CHECK(tuf_private_sign(&signature, buffer_bytes(&pair.private_key), message) == 0);
	for (size_t i = 0; i < signature.size; i++)
		snprintf(hex + 2 * i, 3, "%02x", signature.data[i]);
	CHECK(tuf_public_key_read(&read, buffer_bytes(&pair.public_key)) == 0);
	CHECK(tuf_key_signed(read.entry, message, hex, &name) == 1);
	CHECK(memcmp(&name, &read.name, sizeof(name)) == 0);
	/* the entry, as other tools write it to a file, is the same key */
	text = cJSON_Print(read.entry);
	buffer_init(&json, 1 << 14);
	buffer_put_text(&json, text);
	CHECK(tuf_public_key_read(&again, buffer_bytes(&json)) == 0);
	CHECK(strcmp(read.id, again.id) == 0);
	tuf_public_key_finish(&again);
	CHECK(tuf_public_key_read(&again, buffer_bytes(&pair.private_key)) == -EPERM);
	cJSON_free(text);
	tuf_public_key_finish(&read);
	tuf_public_key_finish(&again);
	buffer_finish(&json);
	buffer_finish(&signature);
	finish(&pair);
}

static void reads_public_keys(void **state)
{
	static const char *const wrong[] = {
		"",
		"no key",
		"{}",
		"-----BEGIN PUBLIC KEY-----\nAA==\n-----END PUBLIC KEY-----\n",
		"{\"keytype\":\"ed25519\",\"scheme\":\"ed25519\",\"keyval\":{}}",
	};
	static const char short_key[] = "{\"keytype\":\"ed25519\",\"scheme\":\"ed25519\","
					"\"keyval\":{\"public\":\"00ff\"}}";
	struct pair p384 = pair_of(EVP_EC_gen("P-384")), rsa = pair_of(EVP_RSA_gen(1024));
	const uint8_t raw[32] = { 1, 2, 3 };
	struct tuf_public_key key;
	struct buffer pem;

	(void)state;
	reads_public_key(EVP_PKEY_Q_keygen(NULL, NULL, "ED25519"));
	reads_public_key(EVP_EC_gen("P-256"));
	reads_public_key(EVP_RSA_gen(2048));
	for (size_t i = 0; i < ARRAY_COUNT(wrong); i++)
		CHECK(tuf_public_key_read(&key, (struct bytes){ (const uint8_t *)wrong[i],
								strlen(wrong[i]) }) == -EBADMSG);
	CHECK(tuf_public_key_read(&key, (struct bytes){ (const uint8_t *)short_key,
							strlen(short_key) }) == -EOPNOTSUPP);
	tuf_public_key_finish(&key);
	CHECK(tuf_public_key_read(&key, buffer_bytes(&p384.public_key)) == -EOPNOTSUPP);
	tuf_public_key_finish(&key);
	CHECK(tuf_public_key_read(&key, buffer_bytes(&rsa.public_key)) == -EOPNOTSUPP);
	tuf_public_key_finish(&key);
	buffer_init(&pem, 1000);
	CHECK(tuf_public_key_write(&pem, raw) == 0);
	CHECK(tuf_public_key_read(&key, buffer_bytes(&pem)) == 0);
	CHECK(strncmp(cJSON_GetObjectItem(cJSON_GetObjectItem(key.entry, "keyval"), "public")
			      ->valuestring,
		      "01020300", 8) == 0);
	tuf_public_key_finish(&key);
	buffer_finish(&pem);
	finish(&p384);
	finish(&rsa);
}

/* ---- OpenSSL without memory */

static long allocations, fails_at = -1; /* the fails_at-th from now on, from 0; -1: none */
static bool fails_on;                   /* all later ones too */

#ifdef __SANITIZE_ADDRESS__
enum { CAN_FAIL = 0 };
#else
enum { CAN_FAIL = 1 };

static bool fails(void)
{
	const long n = allocations++;

	return fails_at >= 0 && (n == fails_at || (fails_on && n > fails_at));
}

void *__libc_malloc(size_t size);
void *__libc_realloc(void *old, size_t size);

void *malloc(size_t size)
{
	return fails() ? NULL : __libc_malloc(size);
}

void *realloc(void *old, size_t size)
{
	return fails() ? NULL : __libc_realloc(old, size);
}
#endif

/* What is asked of OpenSSL while an allocation fails: to sign with a key, to read its public half,
 * to check a signature. */
struct asked {
	struct pair pair;
	struct tuf_public_key key;
	char signature[2049];
};

static int ask_to_sign(const struct asked *asked)
{
	struct buffer signature;
	int rc;

	buffer_init(&signature, 1024);
	rc = tuf_private_sign(&signature, buffer_bytes(&asked->pair.private_key), message);
	buffer_finish(&signature);
	return rc;
}

static int ask_to_read(const struct asked *asked)
{
	struct tuf_public_key key;
	const int rc = tuf_public_key_read(&key, buffer_bytes(&asked->pair.public_key));

	tuf_public_key_finish(&key);
	return rc;
}

static int ask_to_check(const struct asked *asked)
{
	struct tuf_key_name name;
	const int rc = tuf_key_signed(asked->key.entry, message, asked->signature, &name);

	return rc == 1 ? 0 : rc == 0 ? -EKEYREJECTED : rc;
}

/* Without memory there is no other answer than that. */
static void lacks_memory_to(int (*ask)(const struct asked *asked), const struct asked *asked)
{
	int lacked = 0;
	long made;

	allocations = 0;
	CHECK(ask(asked) == 0);
	made = allocations;
	/* Most are those of one decoder after another that is tried. */
	for (long n = 0; n < made; n += n < 8 || n >= made - 16 ? 1 : 61) {
		int rc;

		allocations = 0;
		fails_at = n;
		rc = ask(asked);
		fails_at = -1;
		CHECK(rc == 0 || rc == -ENOMEM);
		lacked += rc == -ENOMEM;
	}
	CHECK(lacked > 0);
}

static void lacks_memory_for(EVP_PKEY *key)
{
	struct asked asked = { .pair = pair_of(key) };
	struct buffer signature;

	buffer_init(&signature, 1024);
	CHECK(tuf_private_sign(&signature, buffer_bytes(&asked.pair.private_key), message) == 0);
	for (size_t i = 0; i < signature.size; i++)
		snprintf(asked.signature + 2 * i, 3, "%02x", signature.data[i]);
	CHECK(tuf_public_key_read(&asked.key, buffer_bytes(&asked.pair.public_key)) == 0);
	lacks_memory_to(ask_to_sign, &asked);
	lacks_memory_to(ask_to_read, &asked);
	lacks_memory_to(ask_to_check, &asked);
	tuf_public_key_finish(&asked.key);
	buffer_finish(&signature);
	finish(&asked.pair);
}

static void a_lack_of_memory_is_no_wrong_key(void **state)
{
	(void)state;
	if (!CAN_FAIL)
		skip();
	for (int on = 0; on < 2; on++) {
		fails_on = on;
		lacks_memory_for(EVP_EC_gen("P-256"));
		lacks_memory_for(EVP_RSA_gen(2048));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(signs_with_ecdsa_and_rsa),
		cmocka_unit_test(refuses_keys_that_are_none),
		cmocka_unit_test(reads_public_keys),
		cmocka_unit_test(a_lack_of_memory_is_no_wrong_key),
		cmocka_unit_test(writes_line_ends_as_json_does),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
