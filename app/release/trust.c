#include "app/release/trust.h"

#include <errno.h>
#include <string.h>

static int refuse(int error, const char **why, const char *text)
{
	*why = text;
	return error;
}

static bool has_expired(struct update_time time, int64_t expires_s)
{
	return time.now_s != 0 && time.now_s > expires_s;
}

int update_pin(struct update *update, struct bytes file, const char **why)
{
	int rc = trust_root_first(&update->trust, file, why);

	update->trusted = rc == 0;
	return rc;
}

/* ---- what a new root leaves of what the old one's keys set */

static uint32_t kept_count(const struct role_keys *old, const struct role_keys *next)
{
	uint32_t kept = 0;

	for (uint32_t i = 0; i < old->key_count; i++)
		for (uint32_t j = 0; j < next->key_count; j++)
			kept += memcmp(old->keys[i], next->keys[j], KEY_BYTES) == 0;
	return kept;
}

/* Somebody who could sign for the role may not be able to any more. */
static bool is_withdrawn(const struct role_keys *old, const struct role_keys *next)
{
	return kept_count(old, next) < old->key_count || next->threshold > old->threshold;
}

/* No file that was signed for the role before is good now. */
static bool is_replaced(const struct role_keys *old, const struct role_keys *next)
{
	return kept_count(old, next) < next->threshold;
}

static void clear_floors(struct update *update, const struct trust_root *old,
			 struct bytes remembered)
{
	const struct role_keys *was = old->roles, *now = update->trust.roles;
	const bool stamps_withdrawn = is_withdrawn(&was[META_TIMESTAMP], &now[META_TIMESTAMP]);
	const bool releases_withdrawn = is_withdrawn(&was[META_RELEASE], &now[META_RELEASE]);
	struct release release;

	update->have_timestamp = false; /* its key may have changed */
	if (stamps_withdrawn)
		update->time_floor_s = 0;
	if (is_replaced(&was[META_TIMESTAMP], &now[META_TIMESTAMP]) ||
	    is_replaced(&was[META_RELEASE], &now[META_RELEASE]) ||
	    (stamps_withdrawn && releases_withdrawn &&
	     release_decode(&release, &update->trust, remembered, NULL) < 0))
		update->sequence_floor = 0;
}

int update_root(struct update *update, struct bytes file, struct bytes remembered, const char **why)
{
	const struct trust_root old = update->trust;
	struct trust_root next = update->trust;
	int rc;

	if (!update->trusted)
		return refuse(-ENOKEY, why, "no trust root: start once with --trust root/1.json");
	rc = trust_root_next(&next, file, why);
	if (rc == 0) {
		update->trust = next;
		clear_floors(update, &old, remembered);
	}
	return rc;
}

/* ---- timestamps and releases */

int update_timestamp(struct update *update, struct bytes file, struct update_time time,
		     const char **why)
{
	struct timestamp timestamp;
	int rc;

	if (!update->trusted)
		return refuse(-ENOKEY, why, "no trust root: start once with --trust root/1.json");
	rc = timestamp_decode(&timestamp, &update->trust, file, why);
	if (rc < 0)
		return rc;
	if (has_expired(time, update->trust.expires_s))
		return refuse(-EKEYEXPIRED, why, "the trust root has expired: sign root/N+1.json");
	if (has_expired(time, timestamp.expires_s))
		return refuse(-EKEYEXPIRED, why, "timestamp.json has expired: sign a new one");
	if (timestamp.sequence < update->sequence_floor ||
	    (update->have_timestamp && timestamp.sequence < update->timestamp.sequence))
		return refuse(-ESTALE, why, "timestamp.json is older than what was seen before");
	update->timestamp = timestamp;
	update->have_timestamp = true;
	if (timestamp.issued_s > update->time_floor_s)
		update->time_floor_s = timestamp.issued_s;
	return 0;
}

int update_release(struct update *update, struct bytes file, struct update_time time,
		   struct release *out, const char **why)
{
	int rc;

	if (!update->trusted)
		return refuse(-ENOKEY, why, "no trust root: start once with --trust root/1.json");
	if (!update->have_timestamp)
		return refuse(-ESTALE, why, "release.json came without a good timestamp.json");
	rc = release_decode(out, &update->trust, file, why);
	if (rc < 0)
		return rc;
	if (!hash_equal(hash_of(file), update->timestamp.release) ||
	    out->sequence != update->timestamp.sequence)
		return refuse(-ESTALE, why, "release.json is not the one timestamp.json names");
	if (out->sequence < update->sequence_floor)
		return refuse(-ESTALE, why, "release.json is older than the release that is shown");
	if (has_expired(time, out->expires_s))
		return refuse(-EKEYEXPIRED, why, "release.json has expired: publish again");
	return out->sequence > update->sequence_floor ? 1 : 0;
}

void update_accept(struct update *update, uint64_t sequence)
{
	if (sequence > update->sequence_floor)
		update->sequence_floor = sequence;
}
