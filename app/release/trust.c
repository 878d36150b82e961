/* Decides whether a root, timestamp.json or release.json is accepted, and clears the floors that
 * withdrawn keys may have set. */
#include "app/release/trust.h"

#include <errno.h>
#include <string.h>

static int refuse(int error, const char **why, const char *text)
{
	*why = text;
	return error;
}

int64_t trust_now_s(const struct trust *trust, struct trust_time time)
{
	return time.now_s != 0 && time.now_s < trust->time_floor_s ? trust->time_floor_s
								   : time.now_s;
}

static bool has_expired(const struct trust *trust, struct trust_time time, int64_t expires_s)
{
	return time.now_s != 0 && trust_now_s(trust, time) > expires_s;
}

bool trust_raise_time_floor(struct trust *trust, int64_t issued_s, struct trust_time time)
{
	if (issued_s <= trust->time_floor_s || issued_s > time.now_s + TRUST_CLOCKS_DIFFER_S)
		return false;
	trust->time_floor_s = issued_s;
	return true;
}

int trust_pin(struct trust *trust, struct bytes file, const char **why)
{
	int rc = trust_root_first(&trust->root, file, why);

	trust->trusted = rc == 0;
	return rc;
}

/* ---- which floors a new root clears */

static uint32_t kept_count(const struct role_keys *old, const struct role_keys *next)
{
	uint32_t kept = 0;

	for (uint32_t i = 0; i < old->key_count; i++)
		for (uint32_t j = 0; j < next->key_count; j++)
			kept += memcmp(old->keys[i], next->keys[j], KEY_BYTES) == 0;
	return kept;
}

/* Returns whether somebody who could sign for the role may no longer be able to. */
static bool is_withdrawn(const struct role_keys *old, const struct role_keys *next)
{
	return kept_count(old, next) < old->key_count || next->threshold > old->threshold;
}

/* Returns whether no file signed for the role before is valid now. */
static bool is_replaced(const struct role_keys *old, const struct role_keys *next)
{
	return kept_count(old, next) < next->threshold;
}

static void clear_floors(struct trust *trust, const struct trust_root *old,
			 bool remembered_is_valid)
{
	const struct role_keys *was = old->roles, *now = trust->root.roles;
	const bool stamps_withdrawn = is_withdrawn(&was[META_TIMESTAMP], &now[META_TIMESTAMP]);
	const bool releases_withdrawn = is_withdrawn(&was[META_RELEASE], &now[META_RELEASE]);

	trust->have_timestamp = false; /* the key of the role may have changed */
	if (stamps_withdrawn)
		trust->time_floor_s = 0;
	if (is_replaced(&was[META_TIMESTAMP], &now[META_TIMESTAMP]) ||
	    is_replaced(&was[META_RELEASE], &now[META_RELEASE]) ||
	    (stamps_withdrawn && releases_withdrawn && !remembered_is_valid))
		trust->sequence_floor = 0;
}

int trust_root(struct trust *trust, struct bytes file, struct bytes remembered, const char **why)
{
	const struct trust_root old = trust->root;
	struct trust_root next = trust->root;
	struct release release;
	int rc, decoded;

	if (!trust->trusted)
		return refuse(-ENOKEY, why, "no trust root: start once with --trust root/1.json");
	rc = trust_root_next(&next, file, why);
	if (rc < 0)
		return rc;
	decoded = release_decode(&release, &next, remembered, NULL);
	if (decoded == -ENOMEM)
		return refuse(decoded, why, "no memory is left");
	trust->root = next;
	clear_floors(trust, &old, decoded == 0);
	return 0;
}

/* ---- timestamps and releases */

int trust_timestamp(struct trust *trust, struct bytes file, struct trust_time time,
		    const char **why)
{
	struct timestamp timestamp;
	int rc;

	if (!trust->trusted)
		return refuse(-ENOKEY, why, "no trust root: start once with --trust root/1.json");
	rc = timestamp_decode(&timestamp, &trust->root, file, why);
	if (rc < 0)
		return rc;
	if (has_expired(trust, time, trust->root.expires_s))
		return refuse(-EKEYEXPIRED, why, "the trust root has expired: sign root/N+1.json");
	if (has_expired(trust, time, timestamp.expires_s))
		return refuse(-EKEYEXPIRED, why, "timestamp.json has expired: publish --renew");
	if (timestamp.sequence < trust->sequence_floor ||
	    (trust->have_timestamp && timestamp.sequence < trust->timestamp.sequence))
		return refuse(-ESTALE, why, "timestamp.json is older than what was seen before");
	trust->timestamp = timestamp;
	trust->have_timestamp = true;
	trust_raise_time_floor(trust, timestamp.issued_s, time);
	return 0;
}

static int judge(const struct trust *trust, struct trust_time time, const struct release *release,
		 const char **why)
{
	if (release->sequence < trust->sequence_floor)
		return refuse(-ESTALE, why, "release.json is older than the release that is shown");
	if (has_expired(trust, time, release->expires_s))
		return refuse(-EKEYEXPIRED, why, "release.json has expired: publish --renew");
	return release->sequence > trust->sequence_floor ? 1 : 0;
}

int trust_release(struct trust *trust, struct bytes file, struct trust_time time,
		  struct release *out, const char **why)
{
	int rc;

	if (!trust->trusted)
		return refuse(-ENOKEY, why, "no trust root: start once with --trust root/1.json");
	if (!trust->have_timestamp)
		return refuse(-ESTALE, why, "release.json came without a good timestamp.json");
	rc = release_decode(out, &trust->root, file, why);
	if (rc < 0)
		return rc;
	if (!hash_equal(hash_of(file), trust->timestamp.release) ||
	    out->sequence != trust->timestamp.sequence)
		return refuse(-ESTALE, why, "release.json is not the one timestamp.json names");
	return judge(trust, time, out, why);
}

int trust_target(const struct trust *trust, struct bytes file, struct trust_time time,
		 struct release *out, const char **why)
{
	const int rc = release_decode_target(out, file, why);

	return rc < 0 ? rc : judge(trust, time, out, why);
}

void trust_accept(struct trust *trust, uint64_t sequence)
{
	if (sequence > trust->sequence_floor)
		trust->sequence_floor = sequence;
}
