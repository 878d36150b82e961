#include "app/release/trust.h"

#include <errno.h>
#include <string.h>

#include <sodium.h>

#include "format/metadata_sign.h"
#include "tests/check.h"

enum { NOW_S = 1700000000, DAY_S = 86400, POOL = 4 };

static struct signing_key root_key, root_key_2, release_key, timestamp_key, stranger;
static struct signing_key release_pool[POOL], timestamp_pool[POOL];
static const struct trust_time now = { NOW_S }, no_clock = { 0 };

static void make_key(struct signing_key *key)
{
	CHECK(crypto_sign_keypair(key->public_key, key->secret) == 0);
}

static void give_role(struct trust_root *root, enum meta_role role, const struct signing_key *key)
{
	struct role_keys *keys = &root->roles[role];

	memcpy(keys->keys[keys->key_count++], key->public_key, KEY_BYTES);
	keys->threshold = 1;
}

static struct trust_root root_of(uint32_t version, const struct signing_key *key)
{
	struct trust_root root = { .version = version, .expires_s = NOW_S + 365 * DAY_S };

	give_role(&root, META_ROOT, key);
	give_role(&root, META_RELEASE, &release_key);
	give_role(&root, META_TIMESTAMP, &timestamp_key);
	return root;
}

static int set_up(void **state)
{
	(void)state;
	CHECK(sodium_init() >= 0);
	make_key(&root_key);
	make_key(&root_key_2);
	make_key(&release_key);
	make_key(&timestamp_key);
	make_key(&stranger);
	for (int i = 0; i < POOL; i++) {
		make_key(&release_pool[i]);
		make_key(&timestamp_pool[i]);
	}
	return 0;
}

static void pin(struct trust *trust)
{
	const struct trust_root root = root_of(1, &root_key);
	struct buffer file;
	const char *why;

	*trust = (struct trust){ 0 };
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	CHECK(trust_root_encode(&file, &root, &root_key, 1) == 0);
	CHECK(trust_pin(trust, buffer_bytes(&file), &why) == 0);
	buffer_finish(&file);
}

/* A release of this sequence as a server would offer it, timestamp first; what the kiosk says. */
struct offer {
	uint64_t sequence, timestamp_sequence;                 /* the second 0: the same */
	int64_t expires_s, timestamp_expires_s;                /* 0: in a day */
	const struct signing_key *release_key, *timestamp_key; /* NULL: the right ones */
	bool other_file; /* the timestamp names another release.json */
	struct trust_time time;
};

static int take(struct trust *trust, const struct offer *offer, const char **why)
{
	struct release release = { .sequence = offer->sequence, .root_bytes = 100 };
	struct timestamp timestamp = { 0 };
	struct buffer file, stamp;
	struct release got;
	int rc;

	memset(release.root.bytes, (int)offer->sequence, HASH_BYTES);
	release.expires_s = offer->expires_s ? offer->expires_s : NOW_S + DAY_S;
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	buffer_init(&stamp, METADATA_FILE_BYTES_MAX);
	CHECK(release_encode(&file, &release,
			     offer->release_key ? offer->release_key : &release_key, 1) == 0);
	timestamp.sequence =
		offer->timestamp_sequence ? offer->timestamp_sequence : offer->sequence;
	timestamp.expires_s =
		offer->timestamp_expires_s ? offer->timestamp_expires_s : NOW_S + DAY_S;
	timestamp.release = hash_of(buffer_bytes(&file));
	timestamp.release.bytes[0] ^= offer->other_file;
	CHECK(timestamp_encode(&stamp, &timestamp,
			       offer->timestamp_key ? offer->timestamp_key : &timestamp_key,
			       1) == 0);
	*why = NULL;
	rc = trust_timestamp(trust, buffer_bytes(&stamp), offer->time, why);
	if (rc == 0)
		rc = trust_release(trust, buffer_bytes(&file), offer->time, &got, why);
	if (rc == 1) {
		CHECK(got.sequence == offer->sequence);
		trust_accept(trust, got.sequence);
	}
	CHECK(rc >= 0 || (*why && **why));
	buffer_finish(&file);
	buffer_finish(&stamp);
	return rc;
}

static int offer_stamp(struct trust *trust, uint64_t sequence, struct bytes release)
{
	const struct timestamp timestamp = { .sequence = sequence,
					     .expires_s = NOW_S + DAY_S,
					     .release = hash_of(release) };
	struct buffer stamp;
	const char *why;
	int rc;

	buffer_init(&stamp, METADATA_FILE_BYTES_MAX);
	CHECK(timestamp_encode(&stamp, &timestamp, &timestamp_key, 1) == 0);
	rc = trust_timestamp(trust, buffer_bytes(&stamp), now, &why);
	buffer_finish(&stamp);
	return rc;
}

static void takes_a_newer_release_once(void **state)
{
	struct trust trust;
	const char *why;

	(void)state;
	pin(&trust);
	CHECK(take(&trust, &(struct offer){ .sequence = 1, .time = now }, &why) == 1);
	CHECK(take(&trust, &(struct offer){ .sequence = 1, .time = now }, &why) == 0);
	CHECK(take(&trust, &(struct offer){ .sequence = 7, .time = now }, &why) == 1);
}

static void refuses_a_rollback(void **state)
{
	struct trust trust;
	const char *why;

	(void)state;
	pin(&trust);
	CHECK(take(&trust, &(struct offer){ .sequence = 5, .time = now }, &why) == 1);
	CHECK(take(&trust, &(struct offer){ .sequence = 4, .time = now }, &why) == -ESTALE);
	/* A fresh timestamp over an old release. */
	CHECK(take(&trust, &(struct offer){ .sequence = 4, .timestamp_sequence = 6, .time = now },
		   &why) == -ESTALE);
}

static void refuses_mix_and_match(void **state)
{
	struct trust trust;
	const char *why;

	(void)state;
	pin(&trust);
	CHECK(take(&trust, &(struct offer){ .sequence = 2, .other_file = true, .time = now },
		   &why) == -ESTALE);
}

static void refuses_a_freeze_where_the_clock_is_set(void **state)
{
	struct offer late = { .sequence = 3, .expires_s = NOW_S - DAY_S };
	struct trust trust;
	const char *why;

	(void)state;
	pin(&trust);
	late.time = now;
	CHECK(take(&trust, &late, &why) == -EKEYEXPIRED);
	late.expires_s = 0;
	late.timestamp_expires_s = NOW_S - 1;
	CHECK(take(&trust, &late, &why) == -EKEYEXPIRED);
	late.time = no_clock;
	CHECK(take(&trust, &late, &why) == 1);
}

static void refuses_strangers(void **state)
{
	struct trust trust;
	const char *why;

	(void)state;
	pin(&trust);
	CHECK(take(&trust, &(struct offer){ .sequence = 2, .release_key = &stranger, .time = now },
		   &why) == -EKEYREJECTED);
	CHECK(take(&trust,
		   &(struct offer){ .sequence = 2, .timestamp_key = &stranger, .time = now },
		   &why) == -EKEYREJECTED);
	/* One role's key does not sign for another. */
	CHECK(take(&trust,
		   &(struct offer){ .sequence = 2, .release_key = &timestamp_key, .time = now },
		   &why) == -EKEYREJECTED);
}

static int offer_root(struct trust *trust, uint32_t version, const struct signing_key *own,
		      const struct signing_key *signers, uint32_t signer_count)
{
	const struct trust_root root = root_of(version, own);
	struct buffer file;
	const char *why;
	int rc;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	CHECK(trust_root_encode(&file, &root, signers, signer_count) == 0);
	rc = trust_root(trust, buffer_bytes(&file), (struct bytes){ NULL, 0 }, &why);
	buffer_finish(&file);
	return rc;
}

static void follows_a_key_rotation_signed_by_old_and_new_keys(void **state)
{
	const struct signing_key both[2] = { root_key, root_key_2 };
	struct trust trust;

	(void)state;
	pin(&trust);
	CHECK(offer_root(&trust, 2, &root_key_2, &root_key_2, 1) < 0);
	CHECK(offer_root(&trust, 2, &root_key_2, &root_key, 1) < 0);
	CHECK(offer_root(&trust, 3, &root_key_2, both, 2) < 0); /* one was left out */
	CHECK(trust.root.version == 1);
	CHECK(offer_root(&trust, 2, &root_key_2, both, 2) == 0);
	CHECK(trust.root.version == 2);
	CHECK(offer_root(&trust, 2, &root_key_2, both, 2) < 0); /* again */
	CHECK(offer_root(&trust, 3, &root_key_2, &root_key_2, 1) == 0);
}

/* A root whose releases need two of two keys. */
static void refuses_a_release_below_the_threshold(void **state)
{
	const struct signing_key both[2] = { release_key, stranger };
	const struct release release = {
		.sequence = 2, .expires_s = NOW_S + DAY_S, .root = { { 1 } }, .root_bytes = 100
	};
	struct trust_root root = root_of(1, &root_key);
	struct buffer file, one, two;
	struct trust trust = { 0 };
	struct release got;
	const char *why = "";

	(void)state;
	give_role(&root, META_RELEASE, &stranger);
	root.roles[META_RELEASE].threshold = 2;
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	buffer_init(&one, METADATA_FILE_BYTES_MAX);
	buffer_init(&two, METADATA_FILE_BYTES_MAX);
	CHECK(trust_root_encode(&file, &root, &root_key, 1) == 0);
	CHECK(trust_pin(&trust, buffer_bytes(&file), &why) == 0);
	CHECK(release_encode(&one, &release, both, 1) == 0);
	CHECK(release_encode(&two, &release, both, 2) == 0);
	CHECK(offer_stamp(&trust, 2, buffer_bytes(&one)) == 0);
	CHECK(trust_release(&trust, buffer_bytes(&one), now, &got, &why) == -EKEYREJECTED);
	CHECK(strstr(why, "threshold"));
	CHECK(offer_stamp(&trust, 2, buffer_bytes(&two)) == 0);
	CHECK(trust_release(&trust, buffer_bytes(&two), now, &got, &why) == 1);
	buffer_finish(&file);
	buffer_finish(&one);
	buffer_finish(&two);
}

static void refuses_all_under_a_root_that_has_expired(void **state)
{
	const struct trust_time late = { NOW_S + 366 * DAY_S };
	struct offer offer = { .sequence = 2,
			       .expires_s = late.now_s + DAY_S,
			       .timestamp_expires_s = late.now_s + DAY_S,
			       .time = late };
	struct trust trust;
	const char *why;

	(void)state;
	pin(&trust);
	CHECK(take(&trust, &offer, &why) == -EKEYEXPIRED && strstr(why, "root"));
	offer.time = no_clock;
	CHECK(take(&trust, &offer, &why) == 1);
}

/* ---- a root that takes keys away */

/* "ab 2": keys a and b of the pool, two of them needed. */
static void give_keys(struct role_keys *role, const struct signing_key *pool, const char *keys)
{
	role->key_count = 0;
	for (; *keys != ' '; keys++)
		memcpy(role->keys[role->key_count++], pool[*keys - 'a'].public_key, KEY_BYTES);
	role->threshold = (uint32_t)(keys[1] - '0');
}

static void encode_root(struct buffer *out, uint32_t version, const char *releases,
			const char *timestamps)
{
	struct trust_root root = root_of(version, &root_key);

	give_keys(&root.roles[META_RELEASE], release_pool, releases);
	give_keys(&root.roles[META_TIMESTAMP], timestamp_pool, timestamps);
	buffer_clear(out);
	CHECK(trust_root_encode(out, &root, &root_key, 1) == 0);
}

static void a_root_that_takes_keys_away_clears_what_they_had_set(void **state)
{
	static const struct {
		const char *releases, *timestamps;           /* of root 1 */
		const char *next_releases, *next_timestamps; /* of root 2 */
		char signer;                                 /* of the release in use */
		bool sequence_stays, time_stays;
	} roots[] = {
		/* nothing changes, or a key is added: old files are as good as they were */
		{ "a 1", "a 1", "a 1", "a 1", 'a', true, true },
		{ "a 1", "a 1", "ab 1", "ab 1", 'a', true, true },
		{ "ab 2", "ab 2", "abc 1", "abc 1", 'a', true, true },
		/* one role's only key, or both */
		{ "a 1", "a 1", "b 1", "a 1", 'a', false, true },
		{ "a 1", "a 1", "a 1", "b 1", 'a', false, false },
		{ "a 1", "a 1", "b 1", "b 1", 'a', false, false },
		/* the threshold */
		{ "ab 1", "a 1", "ab 2", "a 1", 'a', true, true },
		{ "ab 1", "ab 1", "ab 2", "ab 2", 'a', false, false },
		{ "a 1", "a 1", "ab 2", "a 1", 'a', false, true },
		/* one of two keys in one role: the other role never lost a key, so no thief could
		 * publish, and old files signed by the key that stays must not come back */
		{ "ab 1", "a 1", "bc 1", "a 1", 'a', true, true },
		{ "a 1", "ab 1", "a 1", "bc 1", 'a', true, false },
		/* one of two keys in both roles: it depends on who signed the release in use */
		{ "ab 1", "ab 1", "bc 1", "bc 1", 'b', true, false },
		{ "ab 1", "ab 1", "bc 1", "bc 1", 'a', false, false },
		{ "ab 1", "ab 1", "bc 1", "bc 1", ' ', false, false }, /* not known */
	};
	const uint64_t thief = (uint64_t)1 << 53;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(roots); i++) {
		const struct release release = {
			.sequence = thief, .expires_s = NOW_S, .root = { { 1 } }, .root_bytes = 100
		};
		struct buffer file, used;
		struct trust trust = { 0 };
		const char *why = "";

		buffer_init(&file, METADATA_FILE_BYTES_MAX);
		buffer_init(&used, METADATA_FILE_BYTES_MAX);
		encode_root(&file, 1, roots[i].releases, roots[i].timestamps);
		CHECK(trust_pin(&trust, buffer_bytes(&file), &why) == 0);
		trust.sequence_floor = thief;
		trust.time_floor_s = NOW_S;
		trust.have_timestamp = true;
		if (roots[i].signer != ' ')
			CHECK(release_encode(&used, &release, &release_pool[roots[i].signer - 'a'],
					     1) == 0);
		encode_root(&file, 2, roots[i].next_releases, roots[i].next_timestamps);
		CHECK(trust_root(&trust, buffer_bytes(&file), buffer_bytes(&used), &why) == 0);
		if (trust.sequence_floor != (roots[i].sequence_stays ? thief : 0))
			fail_msg("root %zu: the sequence floor is wrong", i);
		if (trust.time_floor_s != (roots[i].time_stays ? NOW_S : 0))
			fail_msg("root %zu: the time floor is wrong", i);
		CHECK(!trust.have_timestamp);
		buffer_finish(&file);
		buffer_finish(&used);
	}
}

static void a_root_that_is_refused_clears_nothing(void **state)
{
	struct trust trust;
	struct buffer file;
	const char *why;

	(void)state;
	pin(&trust);
	trust.sequence_floor = 9;
	trust.time_floor_s = NOW_S;
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	encode_root(&file, 2, "a 1", "a 1");
	file.data[file.size / 2] ^= 1;
	CHECK(trust_root(&trust, buffer_bytes(&file), (struct bytes){ NULL, 0 }, &why) < 0);
	CHECK(trust.sequence_floor == 9 && trust.time_floor_s == NOW_S);
	buffer_finish(&file);
}

/* ---- the time floor */

static void only_a_signed_timestamp_raises_the_time_floor(void **state)
{
	struct timestamp timestamp = { .sequence = 1, .expires_s = NOW_S + 900 * DAY_S };
	struct trust trust;
	struct buffer stamp;
	const char *why;

	(void)state;
	pin(&trust);
	buffer_init(&stamp, METADATA_FILE_BYTES_MAX);
	for (int i = 0; i < 3; i++) {
		/* none is said, then one, then an earlier one */
		timestamp.issued_s = i == 0 ? 0 : NOW_S - i * DAY_S;
		buffer_clear(&stamp);
		CHECK(timestamp_encode(&stamp, &timestamp, &timestamp_key, 1) == 0);
		CHECK(trust_timestamp(&trust, buffer_bytes(&stamp), now, &why) == 0);
		CHECK(trust.time_floor_s == (i == 0 ? 0 : NOW_S - DAY_S));
	}
	for (int i = 0; i < 2; i++) {
		/* further ahead than clocks differ; as far, by a clock that is not set */
		timestamp.issued_s = NOW_S + DAY_S + (i == 0);
		buffer_clear(&stamp);
		CHECK(timestamp_encode(&stamp, &timestamp, &timestamp_key, 1) == 0);
		CHECK(trust_timestamp(&trust, buffer_bytes(&stamp), i == 0 ? now : no_clock,
				      &why) == 0);
		CHECK(trust.time_floor_s == NOW_S - DAY_S);
	}
	timestamp.issued_s = NOW_S + DAY_S;
	buffer_clear(&stamp);
	CHECK(timestamp_encode(&stamp, &timestamp, &stranger, 1) == 0);
	CHECK(trust_timestamp(&trust, buffer_bytes(&stamp), now, &why) == -EKEYREJECTED);
	CHECK(trust.time_floor_s == NOW_S - DAY_S);
	buffer_finish(&stamp);
}

static void takes_nothing_without_a_trust_root(void **state)
{
	struct trust trust = { 0 };
	const char *why;

	(void)state;
	CHECK(take(&trust, &(struct offer){ .sequence = 2, .time = now }, &why) == -ENOKEY);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(takes_a_newer_release_once),
		cmocka_unit_test(refuses_a_rollback),
		cmocka_unit_test(refuses_mix_and_match),
		cmocka_unit_test(refuses_a_freeze_where_the_clock_is_set),
		cmocka_unit_test(refuses_strangers),
		cmocka_unit_test(follows_a_key_rotation_signed_by_old_and_new_keys),
		cmocka_unit_test(refuses_a_release_below_the_threshold),
		cmocka_unit_test(refuses_all_under_a_root_that_has_expired),
		cmocka_unit_test(a_root_that_takes_keys_away_clears_what_they_had_set),
		cmocka_unit_test(a_root_that_is_refused_clears_nothing),
		cmocka_unit_test(only_a_signed_timestamp_raises_the_time_floor),
		cmocka_unit_test(takes_nothing_without_a_trust_root),
	};

	return cmocka_run_group_tests(tests, set_up, NULL);
}
