/* Parts and their regions in the content folder: parts.json and regions/ID.faces, as
 * docs/information.md has them. Any thread; each call waits for the one before. */
#ifndef GOPURA_CURATOR_SESSION_PART_STORE_H
#define GOPURA_CURATOR_SESSION_PART_STORE_H

#include "base/bytes.h"
#include "base/diagnostics.h"
#include "curator/region/region_set.h"
#include "curator/session/request.h"
#include "curator/session/site.h"

/* The part that a region was opened from, or was saved as last. */
struct open_part {
	char id[REQUEST_ID_BYTES];    /* "": none; the region is not a part's yet */
	char tag[DOCUMENT_TAG_BYTES]; /* of regions/ID.faces then; "": there was none */
};

/* Appends the parts as a JSON array of {"id", "title", "titles", "faces"}: its title in the
 * release's first language that it has, all its titles by language, and whether its region is a
 * list of faces. [] if there is no parts.json. Negative errno, with a diagnostic. */
must_check int part_store_list(struct site *site, struct buffer *out,
			       struct diagnostics *diagnostics);

/* All borrowed. */
struct part_to_save {
	const char *id;
	bool is_new;          /* if the id is taken, it gets a number */
	bool replaces;        /* whatever others have saved since it was opened */
	const char *title;    /* "": as it is */
	const char *from;     /* the title that this one replaces; "": there was none */
	const char *language; /* of the title; "": the release's first */
	const char *author;   /* an account; "": nobody signed in */
};

/* Writes the region to regions/ID.faces, and the part to parts.json: a new one at the end, or into
 * the one that is open the region, and the title. Everything else in the file stays as it is.
 * Both files are one version of the documents (curator/store/documents.h). *open becomes the part
 * as saved.
 * -ESTALE: somebody has saved another region or title since it was opened; -ENOENT: it has been
 * removed since. -EINVAL: the region is empty, lies on several scans or on one without face
 * numbers, the scans have been replaced, another part is open, a new part has no title, or
 * parts.json is not valid. Errors of the
 * disk. All with a diagnostic. */
must_check int part_store_save(struct site *site, const struct region_set *set,
			       const struct part_to_save *save, struct open_part *open,
			       struct diagnostics *diagnostics);

/* Replaces the region by that of a part, as one change, and *open by the part. A part with a shape
 * has nothing marked. -ENOENT: there is no such part; -EINVAL: its list of faces is not valid, or
 * of other scans than those of the mesh. All
 * with a diagnostic; then nothing has changed. */
must_check int part_store_open(struct site *site, struct region_set *set, const char *id,
			       struct open_part *open, struct diagnostics *diagnostics);

#endif
