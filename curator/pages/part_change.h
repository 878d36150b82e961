/* Changes of a part in parts.json, by fields. Each names the text that it began from, so that two
 * people can change one part, and neither loses a word. */
#ifndef GOPURA_CURATOR_PAGES_PART_CHANGE_H
#define GOPURA_CURATOR_PAGES_PART_CHANGE_H

#include "base/diagnostics.h"
#include "curator/store/parts_file.h"

/* All borrowed. */
struct part_change {
	/* "title", "caption", "reading", "thumbnail", "documents" (their names, each on a line),
	 * "creator" or another element of the credits. */
	const char *field;
	const char *language;  /* "": it has none, as "thumbnail" */
	const char *from, *to; /* "": there is none */
};

/* Makes a change. theirs is cleared, and gets the text that was there. -ESTALE: it is neither
 * from nor to. -EINVAL: there is no such field, or it has languages, or has none; with
 * a diagnostic. -ENOMEM. */
must_check int part_change_make(struct cJSON *part, const struct part_change *change,
				struct buffer *theirs, struct diagnostics *diagnostics);

/* Moves a part before another one; before "": to the end. -ENOENT. */
must_check int part_change_place(const struct parts_file *parts, const char *id,
				 const char *before);
/* Removes a part. -ENOENT. */
must_check int part_change_remove(const struct parts_file *parts, const char *id);

#endif
