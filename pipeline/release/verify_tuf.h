/* Verifies what a release says in the form of The Update Framework (docs/tuf.md). */
#ifndef GOPURA_PIPELINE_RELEASE_VERIFY_TUF_H
#define GOPURA_PIPELINE_RELEASE_VERIFY_TUF_H

#include "pipeline/release/verify_walk.h"

/* Goes from tuf/1.root.json to the target release.json as a client without anything would, and
 * compares that with release_file, the bytes of release.json. now_s as in verify_options. Returns
 * 0, also where there is no tuf/1.root.json and release.json names none; otherwise walk's
 * diagnostics say what is wrong. */
must_check int verify_tuf(struct verify_walk *walk, struct bytes release_file, int64_t now_s);

#endif
