/* A table of failures by name and by address. */
#include "curator/accounts/attempts.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

enum kind { BY_NAME, BY_ADDRESS };

static const struct {
	uint32_t free;
	int64_t wait_ms;
} limits[] = {
	[BY_NAME] = { ATTEMPTS_FREE_OF_NAME, ATTEMPTS_WAIT_OF_NAME_MS },
	[BY_ADDRESS] = { ATTEMPTS_FREE_OF_ADDRESS, ATTEMPTS_WAIT_OF_ADDRESS_MS },
};

static uint64_t key_of(struct attempts *attempts, enum kind kind, const char *text)
{
	static const uint8_t none[sizeof(attempts->secret)];
	uint8_t message[128] = { (uint8_t)kind };
	const size_t bytes = strnlen(text, sizeof(message) - 1);
	uint64_t key;

	if (memcmp(attempts->secret, none, sizeof(none)) == 0)
		randombytes_buf(attempts->secret, sizeof(attempts->secret));
	memcpy(message + 1, text, bytes);
	crypto_shorthash((uint8_t *)&key, message, bytes + 1, attempts->secret);
	return key ? key : 1;
}

static struct attempt *find(struct attempts *attempts, uint64_t key)
{
	for (unsigned n = 0; n < ATTEMPTS_MAX; n++)
		if (attempts->list[n].key == key)
			return &attempts->list[n];
	return NULL;
}

/* Returns the entry, which is new, in place of the one that failed longest ago, if there is none.
 */
static struct attempt *get(struct attempts *attempts, uint64_t key, int64_t now_ms)
{
	struct attempt *entry = find(attempts, key), *oldest = &attempts->list[0];

	if (entry && now_ms - entry->last_ms < ATTEMPTS_FORGOTTEN_MS)
		return entry;
	for (unsigned n = 0; n < ATTEMPTS_MAX && !entry; n++) {
		struct attempt *at = &attempts->list[n];

		if (!at->key)
			entry = at;
		else if (at->last_ms < oldest->last_ms)
			oldest = at;
	}
	if (!entry)
		entry = oldest;
	*entry = (struct attempt){ .key = key, .last_ms = now_ms };
	return entry;
}

static void count_failure(struct attempt *entry, enum kind kind, int64_t now_ms)
{
	const uint32_t beyond = entry->failures - limits[kind].free; /* if it is more */
	int64_t wait_ms = limits[kind].wait_ms;

	entry->last_ms = now_ms;
	entry->failures++;
	if (entry->failures <= limits[kind].free)
		return;
	if (beyond < 20 && (int64_t)1000 << beyond < wait_ms)
		wait_ms = (int64_t)1000 << beyond;
	entry->until_ms = now_ms + wait_ms;
}

int64_t attempts_begin(struct attempts *attempts, const char *name, const char *address,
		       int64_t now_ms)
{
	/* In this order, because the second may take the place of a third, never of the first. */
	struct attempt *by_name = get(attempts, key_of(attempts, BY_NAME, name), now_ms);
	struct attempt *by_address;
	int64_t until_ms;

	by_name->last_ms = now_ms;
	by_address = get(attempts, key_of(attempts, BY_ADDRESS, address), now_ms);
	until_ms =
		by_name->until_ms > by_address->until_ms ? by_name->until_ms : by_address->until_ms;
	if (until_ms > now_ms)
		return until_ms - now_ms;
	count_failure(by_name, BY_NAME, now_ms);
	count_failure(by_address, BY_ADDRESS, now_ms);
	return 0;
}

void attempts_succeed(struct attempts *attempts, const char *name, const char *address)
{
	struct attempt *by_name = find(attempts, key_of(attempts, BY_NAME, name));
	struct attempt *by_address = find(attempts, key_of(attempts, BY_ADDRESS, address));

	if (by_name)
		*by_name = (struct attempt){ 0 };
	if (!by_address || by_address->failures == 0)
		return;
	by_address->failures--;
	if (by_address->failures <= ATTEMPTS_FREE_OF_ADDRESS)
		by_address->until_ms = 0;
}
