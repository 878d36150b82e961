/* Who changed which text of a part, and when: the versions of parts.json, by fields. */
#ifndef GOPURA_CURATOR_PAGES_FIELD_HISTORY_H
#define GOPURA_CURATOR_PAGES_FIELD_HISTORY_H

#include "base/diagnostics.h"
#include "curator/session/site.h"

struct cJSON;

enum { FIELD_HISTORY_VERSIONS_MAX = 200, FIELD_HISTORY_ROWS_MAX = 500 };

/* Appends to an array, the newest first: {"version", "author" ("": another program), "time",
 * "field" (title, caption, reading, thumbnail), "language" ("" for thumbnail), "from", "to"}; texts
 * are "" where there is none. Looks at the newest FIELD_HISTORY_VERSIONS_MAX versions. A version
 * that cannot be read as JSON counts as one without the part. Negative errno, with a diagnostic. */
must_check int field_history(struct cJSON *out, struct site *site, const char *id,
			     struct diagnostics *diagnostics);

#endif
