/* The regions of a content folder that are lists of faces. They are checked before hours of work
 * begin, placed when the information is compiled, and found on the mesh where parts are labelled.
 * Places are kept in .work/faces, so that only a new list or another scan needs the mesh. */
#ifndef GOPURA_PIPELINE_CONTENT_PART_FACES_H
#define GOPURA_PIPELINE_CONTENT_PART_FACES_H

#include "pipeline/content/info_build.h"
#include "pipeline/content/scans.h"
#include "pipeline/import/face_list.h"

/* The faces of one part. */
struct part_faces {
	char *id; /* owned */
	uint32_t scan;
	struct face_list list; /* owned */
	struct hash key;       /* of the list and all scans; set when it is placed */
	float place_m[7];      /* centre, radius, anchor; likewise */
	bool placed;
	uint32_t *triangles; /* of the mesh, ascending; owned; NULL until part_faces_find_all */
	uint32_t triangle_count;
};

struct part_faces_all {
	struct scans *scans;      /* borrowed */
	struct part_faces *parts; /* owned */
	uint32_t part_count, part_room;
	struct buffer kept; /* what .work/faces holds; empty until the first list is placed */
	bool has_kept;
};

/* scans is borrowed. */
void part_faces_init(struct part_faces_all *all, struct scans *scans);
void part_faces_finish(struct part_faces_all *all); /* frees everything; zeroed is fine */

/* Checks a list and remembers it: judge_faces of info_build_options, with a struct part_faces_all
 * as data. Reads at most the headers of the scans. -EINVAL with a diagnostic; -ENOMEM. */
int part_faces_judge(void *data, struct info_faces *faces, struct diagnostics *diagnostics);
/* Places a list that was judged: place_faces of info_build_options. Also the errors of
 * scans_get_mesh. */
int part_faces_place(void *data, struct info_faces *faces, struct diagnostics *diagnostics);
/* Keeps the places of all lists for the next time. Errors of the disk, with a diagnostic. */
must_check int part_faces_keep(const struct part_faces_all *all, struct diagnostics *diagnostics);

/* Finds the triangles of every list. -ENOMEM and the errors of scans_get_mesh, with a
 * diagnostic. */
must_check int part_faces_find_all(struct part_faces_all *all, struct diagnostics *diagnostics);
/* Returns the faces of a part, borrowed. NULL: its region is not a list of faces. */
const struct part_faces *part_faces_of(const struct part_faces_all *all, const char *id);

#endif
