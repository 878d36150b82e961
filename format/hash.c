/* Names objects with libsodium's BLAKE2b and converts names to and from hexadecimal text. */
#include "format/hash.h"

#include <errno.h>
#include <pthread.h>
#include <sodium.h>
#include <string.h>

/* libsodium works without sodium_init(), but it uses the processor's fastest BLAKE2b only after
 * it. */
static void pick_fastest(void)
{
	if (sodium_init() < 0)
		return;
}

struct hash hash_of(struct bytes object)
{
	static pthread_once_t once = PTHREAD_ONCE_INIT;
	struct hash hash;

	pthread_once(&once, pick_fastest);
	crypto_generichash(hash.bytes, sizeof(hash.bytes), object.data, object.size, NULL, 0);
	return hash;
}

map_key hash_key(struct hash hash)
{
	map_key key;

	_Static_assert(sizeof(key) == HASH_BYTES, "a key holds a whole name");
	memcpy(&key, hash.bytes, sizeof(key));
	return key;
}

struct hash hash_from_key(map_key key)
{
	struct hash hash;

	memcpy(hash.bytes, &key, sizeof(key));
	return hash;
}

bool hash_equal(struct hash a, struct hash b)
{
	return memcmp(a.bytes, b.bytes, HASH_BYTES) == 0;
}

int hash_compare(struct hash a, struct hash b)
{
	return memcmp(a.bytes, b.bytes, HASH_BYTES);
}

bool hash_is_zero(struct hash hash)
{
	static const struct hash zero;

	return hash_equal(hash, zero);
}

void hash_to_hex(struct hash hash, char hex[HASH_HEX_BYTES])
{
	static const char digits[] = "0123456789abcdef";

	for (int i = 0; i < HASH_BYTES; i++) {
		hex[2 * i] = digits[hash.bytes[i] >> 4];
		hex[2 * i + 1] = digits[hash.bytes[i] & 15];
	}
	hex[2 * HASH_BYTES] = '\0';
}

static int digit_of(char c)
{
	if (c >= '0' && c <= '9')
		return c - '0';
	if (c >= 'a' && c <= 'f')
		return c - 'a' + 10;
	return -1;
}

int hash_from_hex(struct hash *out, const char *hex)
{
	struct hash hash;

	for (int i = 0; i < HASH_BYTES; i++) {
		int high = digit_of(hex[2 * i]);
		int low = high < 0 ? -1 : digit_of(hex[2 * i + 1]);

		if (low < 0)
			return -EBADMSG;
		hash.bytes[i] = (uint8_t)(high << 4 | low);
	}
	if (hex[2 * HASH_BYTES] != '\0')
		return -EBADMSG;
	*out = hash;
	return 0;
}
