/* The texts that a session sends to its browser, as docs/curator.md has them. Each is owned by the
 * caller (free); NULL: no memory is left. */
#ifndef GOPURA_CURATOR_SESSION_ANSWERS_H
#define GOPURA_CURATOR_SESSION_ANSWERS_H

#include "curator/region/region_set.h"
#include "curator/session/site.h"

/* of: the type of the message that it answers; NULL: of none, or of one that was not understood.
 * conflict: what others have done to the part meanwhile; NULL: nothing. */
must_check char *answer_error(const char *of, const char *conflict, const char *text);
/* opened: the part that the region is of since this message, "" if of none; NULL: as before. */
must_check char *answer_region(const struct region_set *set, bool has_marks, const char *opened);
/* saved: the part that has been; NULL: none. An error where the list cannot be read. */
must_check char *answer_parts(struct site *site, const char *saved);
must_check char *answer_point(const float point_m[3]); /* NULL: there is nothing */
must_check char *answer_hello(const struct site *site);

#endif
