/* Parts and their regions in the content folder: parts.json and regions/ID.faces, as
 * docs/information.md has them. Any thread; each call waits for the one before. */
#ifndef GOPURA_CURATOR_SESSION_PART_STORE_H
#define GOPURA_CURATOR_SESSION_PART_STORE_H

#include "base/bytes.h"
#include "base/diagnostics.h"
#include "curator/region/region_set.h"
#include "curator/session/site.h"

/* Appends the parts as a JSON array of {"id", "title", "faces"}: its title in the release's first
 * language that it has, and whether its region is a list of faces. [] if there is no parts.json.
 * Negative errno, with a diagnostic. */
must_check int part_store_list(struct site *site, struct buffer *out,
			       struct diagnostics *diagnostics);

/* All borrowed. */
struct part_to_save {
	const char *id;
	const char *title;    /* "": as it is */
	const char *language; /* of the title; "": the release's first */
	const char *author;   /* an account; "": nobody signed in */
};

/* Writes the region to regions/ID.faces, and the part to parts.json: a new one at the end, or into
 * the one that has that id the region, and the title. Everything else in the file stays as it is.
 * Both files are one version of the documents (curator/store/documents.h).
 * -EINVAL: the region is empty, lies on several scans or on one without face numbers, a new part
 * has no title, or parts.json is not valid. Errors of the disk. All with a diagnostic. */
must_check int part_store_save(struct site *site, const struct region_set *set,
			       const struct part_to_save *save, struct diagnostics *diagnostics);

/* Replaces the region by that of a part, as one change. -ENOENT: there is no such part; -EINVAL:
 * its region is not a list of faces, or the list is not valid. All with a diagnostic. */
must_check int part_store_open(struct site *site, struct region_set *set, const char *id,
			       struct diagnostics *diagnostics);

#endif
