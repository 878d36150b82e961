/* What all sessions share: a content folder, its master to draw, and its scans to mark. */
#ifndef GOPURA_CURATOR_SESSION_SITE_H
#define GOPURA_CURATOR_SESSION_SITE_H

#include "curator/select/face_pick.h"
#include "curator/store/documents.h"
#include "pipeline/content/scans.h"
#include "pipeline/hierarchy/master.h"

struct site {
	struct content content;
	struct scans *scans;       /* owned */
	struct master *master;     /* owned */
	const struct mesh *mesh;   /* borrowed from scans */
	struct face_blocks blocks; /* of the mesh */
	bool lit;
	struct documents *documents; /* owned; every file of it that is changed */
};

/* Opens the folder, whose master must be there and of its scans. Takes no lock, because files of
 * .work are replaced whole: gopura-content may build meanwhile. *site is zeroed on failure.
 * Negative errno, with a diagnostic. */
must_check int site_open(struct site *site, const char *folder, struct diagnostics *diagnostics);
void site_close(struct site *site); /* zeroed is fine */

/* Returns whether the scans, or what temple.ini says of them, have changed since the folder was
 * opened: then the numbers of the mesh's faces may be those of other faces. */
bool site_has_other_scans(const struct site *site);

#endif
