/* Looks into a release folder without keys: which releases there were, and what the current one
 * says about parts. Signatures are checked against the folder's own roots, which is enough for a
 * folder of one's own. */
#ifndef GOPURA_PIPELINE_RELEASE_RELEASE_LOOK_H
#define GOPURA_PIPELINE_RELEASE_RELEASE_LOOK_H

#include "format/metadata.h"

/* Whose releases; strings are borrowed. */
struct release_place {
	const char *folder;
	const char *target; /* as struct tuf_place has it; NULL or "": release.json */
	const char *role;   /* likewise; NULL or "": the top's */
};

/* Reads the chain of roots; version 0: the folder is in the form of The Update Framework alone
 * (docs/tuf.md), of which the place's target is looked at. -ENOENT: nothing was published
 * there yet. -EBADMSG, -EKEYREJECTED, and errors of reading. */
must_check int release_look_trust(struct trust_root *out, const char *folder);
/* Reads release.json, or with a sequence above 0 that of the history. Errors likewise;
 * -EKEYREJECTED also of a release whose keys do not count any more. */
must_check int release_look_at(struct release *out, const struct release_place *place,
			       const struct trust_root *trust, uint64_t sequence);
/* Appends the information database of a release to *out. *size_bytes gets the size of all its
 * objects. Errors likewise; -ENOMEM. */
must_check int release_look_info(struct buffer *out, const char *folder,
				 const struct release *release, uint64_t *size_bytes);

#endif
