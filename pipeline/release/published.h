/* What was published before, in the form that the target is published in: that of The Update
 * Framework where it is alone (docs/tuf.md), else the earlier one. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISHED_H
#define GOPURA_PIPELINE_RELEASE_PUBLISHED_H

#include "pipeline/release/publish.h"

/* Returns where the target is published in the form of The Update Framework; borrowed from it. */
struct tuf_place published_place(const struct publish_target *target);

/* The three return -ENOENT if there is none; other errors are logged. Nothing that our own keys did
 * not sign is read. */
must_check int published_current(const struct publish_target *target, struct release *out);
/* The release of that sequence. */
must_check int published_at(const struct publish_target *target, uint64_t sequence,
			    struct release *out);
/* The newest release before `current` that had another root. */
must_check int published_before(const struct publish_target *target, const struct release *current,
				struct release *out);

/* Finds when terminals begin to refuse the current release, with whatever names it but the
 * timestamp. Errors are logged. */
must_check int published_expires_s(const struct publish_target *target,
				   const struct release *current, int64_t *out);

/* Compares this machine's clock with when the last timestamp was signed. What is signed by a clock
 * that is years behind has expired already, and by one that is ahead, keeps terminals from what is
 * signed by the right one afterwards. Returns 0; -ECANCELED: it is a day behind, or further ahead
 * than nobody publishes, and the target does not trust it. Errors are logged. */
must_check int published_check_clock(const struct publish_target *target);

/* Finds the sequence of the next release: above that of the current one and target->above, and
 * above the versions of what others published in its place. Errors of tuf_folder_open: nothing can
 * be published then. */
must_check int published_next(uint64_t *out, const struct publish_target *target, uint64_t current);

/* Removes release.json and timestamp.json of the earlier form, once a release was published in the
 * other alone. history/ and root/ stay. */
void published_drop_earlier(const struct publish_target *target);

/* Reads the current release in the form of The Update Framework, and its release.json into file. */
must_check int published_file(const struct tuf_place *place, struct release *out,
			      struct buffer *file);

#endif
