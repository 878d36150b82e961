#include "app/update.h"

#include <errno.h>

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

int update_root(struct update *update, struct bytes file, const char **why)
{
	struct trust_root next = update->trust;
	int rc;

	if (!update->trusted)
		return refuse(-ENOKEY, why, "no trust root: start once with --trust root/1.json");
	rc = trust_root_next(&next, file, why);
	if (rc == 0) {
		update->trust = next;
		update->have_timestamp = false; /* its key may have changed */
	}
	return rc;
}

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
