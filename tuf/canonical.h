/* Canonical JSON: the one form of a JSON value that signatures of The Update Framework cover.
 *
 * Members are sorted by name, nothing stands between tokens, a string escapes only \ and ", and
 * every number is an integer. Source: TUF 1.0.34, section 4.1; the form is OLPC's "Canonical JSON".
 * Python's securesystemslib writes the same bytes. */
#ifndef GOPURA_TUF_CANONICAL_H
#define GOPURA_TUF_CANONICAL_H

#include "base/bytes.h"

struct cJSON;

/* Appends the canonical form of value to out. Returns 0; -EBADMSG: a number that is no integer or
 * is beyond 2^53, or an object with two members of one name, of which another reader could take the
 * other; -ENOMEM; -EFBIG: beyond the ceiling of out. */
must_check int canonical_write(struct buffer *out, const struct cJSON *value);

#endif
