/* What a release is made from: a content folder's scans, and its parts, pages and tours. A command
 * makes one and hands it to every stage, so that each source is read once. One thread. */
#ifndef GOPURA_PIPELINE_CONTENT_SOURCES_H
#define GOPURA_PIPELINE_CONTENT_SOURCES_H

#include "format/scenery.h"
#include "pipeline/content/info_build.h"
#include "pipeline/content/scans.h"

struct sources;

/* Reads nothing yet. content is borrowed for the lifetime. *out is owned by the caller; NULL on
 * failure. -ENOMEM. */
must_check int sources_create(struct sources **out, const struct content *content);
void sources_destroy(struct sources *sources); /* NULL is fine */
const struct content *sources_content(const struct sources *sources);
/* The scans, borrowed. */
struct scans *sources_scans(struct sources *sources);

/* Nothing is logged from now on: sources_found has every fault and warning. */
void sources_be_quiet(struct sources *sources);
/* Returns what was found in the folder's files, borrowed until the next call. */
const struct diagnostics *sources_found(const struct sources *sources);

/* Checks parts, pages, pictures, tours and scenes, so that faults are found before the long work.
 * The scans are imported only if there are tours, whose ways must not lead through them. -EINVAL:
 * every fault was logged. Other errors are logged too. */
must_check int sources_check(struct sources *sources);
/* The same without the ways of tours and without scenes: no scan is read. */
must_check int sources_check_texts(struct sources *sources);
/* Gets the compiled parts, pages and tours, checked likewise. *out is borrowed for the lifetime. */
must_check int sources_info(struct sources *sources, const struct info_built **out);

/* Gets what stands beside the scans; without nodes if there are no scenes. Errors are logged.
 * *out is borrowed for the lifetime. */
must_check int sources_scenery(struct sources *sources, const struct scenery **out);

/* The faces of a part whose region is a list of them. */
struct sources_faces {
	struct hash key; /* of the list and the scans */
	/* of the mesh, ascending; borrowed. NULL before sources_find_faces. */
	const uint32_t *triangles;
	uint32_t triangle_count;
};
/* Finds the triangles of all lists. Call it after sources_info. Negative errno, with a diagnostic.
 */
must_check int sources_find_faces(struct sources *sources, struct diagnostics *diagnostics);
/* Returns false if the part's region is not a list of faces. Call it after sources_info. */
bool sources_faces_of(const struct sources *sources, const char *part, struct sources_faces *out);

#endif
