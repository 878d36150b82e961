/* Verifies what a release says in the form of The Update Framework (docs/tuf.md). */
#ifndef GOPURA_PIPELINE_RELEASE_VERIFY_TUF_H
#define GOPURA_PIPELINE_RELEASE_VERIFY_TUF_H

#include "pipeline/release/verify_walk.h"

/* Goes from tuf/1.root.json to the target (its path; NULL: release.json) as a client without
 * anything would, and compares that with release_file, the bytes of release.json. now_s as in
 * verify_options. Returns 0, also where there is no tuf/1.root.json and release.json names none;
 * otherwise walk's diagnostics say what is wrong. */
must_check int verify_tuf(struct verify_walk *walk, struct bytes release_file, const char *target,
			  int64_t now_s);

/* Verifies a release that is in this form alone, and fills the report's release and expiry times.
 * root: the first one, trusted; empty: the release's own. target: its path; NULL: release.json. */
must_check int verify_tuf_alone(struct verify_walk *walk, struct bytes root, const char *target,
				int64_t now_s);

#endif
