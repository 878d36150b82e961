/* The table of keys. */
#include "curator/accounts/sign_ins.h"

#include <sodium.h>
#include <string.h>

static void make_secret(char out[SIGN_IN_SECRET_BYTES])
{
	uint8_t bytes[(SIGN_IN_SECRET_BYTES - 1) / 2];

	randombytes_buf(bytes, sizeof(bytes));
	sodium_bin2hex(out, SIGN_IN_SECRET_BYTES, bytes, sizeof(bytes));
	sodium_memzero(bytes, sizeof(bytes));
}

static struct hash hash_of_key(const char *key)
{
	return hash_of((struct bytes){ (const uint8_t *)key, strlen(key) });
}

static bool has_ended(const struct sign_in *sign_in, int64_t now_ms)
{
	return now_ms - sign_in->used_ms >= SIGN_IN_IDLE_MS ||
	       now_ms - sign_in->begun_ms >= SIGN_IN_WHOLE_MS;
}

/* Returns a free entry: where there is none, or the account has too many, the one used longest ago
 * is freed. */
static struct sign_in *make_room(struct sign_ins *sign_ins, const char *name, int64_t now_ms)
{
	struct sign_in *vacant = NULL, *oldest = NULL, *own_oldest = NULL;
	unsigned own = 0;

	for (unsigned n = 0; n < SIGN_INS_MAX; n++) {
		struct sign_in *entry = &sign_ins->list[n];

		if (hash_is_zero(entry->key) || has_ended(entry, now_ms)) {
			vacant = entry;
			continue;
		}
		if (!oldest || entry->used_ms < oldest->used_ms)
			oldest = entry;
		if (strcmp(entry->name, name) != 0)
			continue;
		own++;
		if (!own_oldest || entry->used_ms < own_oldest->used_ms)
			own_oldest = entry;
	}
	if (own >= SIGN_INS_OF_ACCOUNT_MAX)
		return own_oldest;
	return vacant ? vacant : oldest;
}

const struct sign_in *sign_ins_begin(struct sign_ins *sign_ins, const char *name, int64_t now_ms,
				     char key[SIGN_IN_SECRET_BYTES])
{
	struct sign_in *entry = make_room(sign_ins, name, now_ms);

	*entry = (struct sign_in){ .begun_ms = now_ms,
				   .used_ms = now_ms,
				   .counted_ms = now_ms,
				   .requests = SIGN_IN_REQUESTS_AT_ONCE };
	make_secret(key);
	make_secret(entry->token);
	entry->key = hash_of_key(key);
	memcpy(entry->name, name, strlen(name) + 1);
	return entry;
}

static struct sign_in *find(struct sign_ins *sign_ins, const char *key)
{
	const struct hash wanted = hash_of_key(key);

	for (unsigned n = 0; *key && n < SIGN_INS_MAX; n++)
		if (hash_equal(sign_ins->list[n].key, wanted))
			return &sign_ins->list[n];
	return NULL;
}

struct sign_in *sign_ins_find(struct sign_ins *sign_ins, const char *key, int64_t now_ms)
{
	struct sign_in *entry = find(sign_ins, key);

	if (!entry || !has_ended(entry, now_ms))
		return entry;
	sodium_memzero(entry, sizeof(*entry));
	return NULL;
}

bool sign_in_may_ask(struct sign_in *sign_in, int64_t now_ms)
{
	const double seconds = (double)(now_ms - sign_in->counted_ms) / 1000;

	sign_in->requests += seconds * SIGN_IN_REQUESTS_PER_S;
	if (sign_in->requests > SIGN_IN_REQUESTS_AT_ONCE)
		sign_in->requests = SIGN_IN_REQUESTS_AT_ONCE;
	sign_in->counted_ms = now_ms;
	if (sign_in->requests < 1)
		return false;
	sign_in->requests--;
	return true;
}

void sign_ins_end(struct sign_ins *sign_ins, const char *key)
{
	struct sign_in *entry = find(sign_ins, key);

	if (entry)
		sodium_memzero(entry, sizeof(*entry));
}

void sign_ins_end_all(struct sign_ins *sign_ins, const char *name)
{
	for (unsigned n = 0; n < SIGN_INS_MAX; n++)
		if (strcmp(sign_ins->list[n].name, name) == 0)
			sodium_memzero(&sign_ins->list[n], sizeof(sign_ins->list[n]));
}

bool sign_in_secret_is(const char *secret, const char *text)
{
	return strlen(secret) == SIGN_IN_SECRET_BYTES - 1 &&
	       strlen(text) == SIGN_IN_SECRET_BYTES - 1 &&
	       sodium_memcmp(secret, text, SIGN_IN_SECRET_BYTES - 1) == 0;
}
